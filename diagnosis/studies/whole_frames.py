"""Peaks as data: the largest displacements of floors in known shakings, and what an effect of a whole frame makes of them.

A peak says less than a history, so effects act in all storeys or floors of a frame alike, with one size. The model leaves
more than the stated uncertainty of the peaks whatever is in it; how much more (a standard deviation of the logarithm) is a
quantity of its own, and the evidence is averaged over it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import logsumexp

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.case.numbers import Peak
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.frame import AddedMass, AirDrag, BaseRocking, PDelta
from pounding.diagnosis.effects.storey import (
    CoulombFriction,
    CubicStiffness,
    DampingChange,
    Hysteresis,
    Loosening,
    StiffnessChange,
)
from pounding.diagnosis.effects.table_and_sensors import TableGain, TableTilt
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.observations import Observations, RunData
from pounding.diagnosis.model.predictor import DISPLACEMENT
from pounding.diagnosis.model.storeys import StoreyFrame, Structure

UNEXPLAINED = np.geomspace(0.02, 1.0, 25)
"""Standard deviations of the logarithm of a peak that a model may leave, equally likely on a logarithmic scale."""
YIELDING_SHARE = 0.3
"""Part of each storey's stiffness that yields where hysteresis acts in a whole frame."""
LARGEST = 1e3
"""[m]: a frame that moves this far has run away."""

Loads = list[tuple[Acting, np.ndarray]]


@dataclass(frozen=True)
class WholeFrame:
    """An effect of the catalogue in a whole frame, with one size.

    Attributes:
        name: The effect's name. what: What its size means. unit: Its unit.
        sizes: Sizes tried, equally likely; the first is no effect at all.
        make: From the baseline frame and a size to what acts.
    """

    name: str
    what: str
    unit: str
    sizes: tuple[float, ...]
    make: Callable[[Model, float], Loads]


def _storeys(
    kind: type[Effect], values: Callable[[Model, Any, float], Any]
) -> Callable[[Model, float], Loads]:
    def make(model: Model, size: float) -> Loads:
        if size == 0:
            return []
        return [(effect, np.array(values(model, effect, size))) for effect in places(kind, model)]

    return make


def _first(model: Model) -> float:
    return float(model.plain_modes(model.assemble(np.zeros(len(model.std)))).omega[0])


def _added_mass(model: Model, size: float) -> Loads:
    mass = model.structure.frames[0].floor_mass
    return (
        [(effect, np.array([size * mass[effect.index]])) for effect in places(AddedMass, model)]
        if size
        else []
    )


def _whole(make: Callable[[str], Acting]) -> Callable[[Model, float], Loads]:
    def one(model: Model, size: float) -> Loads:
        return [(make(model.structure.frames[0].name), np.array([size]))] if size else []

    return one


def _drag(model: Model, size: float) -> Loads:
    effect = AirDrag(frame=model.structure.frames[0].name)
    return [(effect, effect.values(size, ()))] if size else []


def _rocking(model: Model, size: float) -> Loads:
    return [(BaseRocking(frame=model.structure.frames[0].name), np.array([1e3 / size]))] if size else []


def _even(low: float, high: float, count: int) -> tuple[float, ...]:
    return (0.0, *(float(x) for x in np.linspace(low, high, count) if abs(x) > 1e-12))


def _log(low: float, high: float, count: int) -> tuple[float, ...]:
    return (0.0, *(float(x) for x in np.geomspace(low, high, count)))


CATALOGUE = (
    WholeFrame(
        "damping_change",
        "damping ratio of the first mode more by this, dampers in proportion to the storeys' stiffness",
        "1",
        _even(-0.003, 0.045, 17),
        _storeys(DampingChange, lambda b, e, x: e.values(2 * x * e.stiffness(b) / _first(b), ())),
    ),
    WholeFrame(
        "coulomb_friction",
        "friction force in every storey",
        "N",
        _log(0.1, 30.0, 13),
        _storeys(CoulombFriction, lambda b, e, x: e.values(x, ())),
    ),
    WholeFrame(
        "air_drag",
        "drag of every floor",
        "N s^2/m^2",
        _log(0.3, 100.0, 13),
        _drag,
    ),
    WholeFrame(
        "cubic_stiffness",
        "share by which a drift of 1 mm stiffens a storey",
        "1",
        _even(-0.008, 0.04, 13),
        _storeys(CubicStiffness, lambda b, e, x: [x * 1e6 * e.stiffness(b)]),
    ),
    WholeFrame(
        "hysteresis",
        "drift at which 0.3 of a storey's stiffness yields",
        "mm",
        _log(0.1, 6.0, 12),
        _storeys(
            Hysteresis,
            lambda b, e, x: e.values(YIELDING_SHARE * e.stiffness(b), (1e-3 * x,)),
        ),
    ),
    WholeFrame(
        "loosening",
        "change of all storeys' stiffness by the end",
        "1",
        _even(-0.5, -0.05, 10),
        _storeys(Loosening, lambda b, e, x: [x, 0.0]),
    ),
    WholeFrame(
        "stiffness_change",
        "change of all storeys' stiffness",
        "1",
        _even(-0.25, 0.25, 21),
        _storeys(StiffnessChange, lambda b, e, x: [x]),
    ),
    WholeFrame("added_mass", "share of its mass on every floor", "1", _even(-0.2, 0.2, 17), _added_mass),
    WholeFrame(
        "p_delta", "weight beyond the frame's own", "1", _even(0.25, 4.0, 16), _whole(lambda name: PDelta(frame=name))
    ),
    WholeFrame("base_rocking", "turn of the base under a moment", "rad/(kN m)", _log(2e-4, 0.02, 11), _rocking),
    WholeFrame("table_gain", "change of the table's motion", "1", _even(-0.4, 0.4, 17), _whole(lambda name: TableGain())),
    WholeFrame(
        "table_tilt", "pitch of the table by its acceleration", "rad s^2/m", _even(-0.002, 0.002, 17),
        _whole(lambda name: TableTilt()),
    ),
)  # fmt: skip
"""A table's or sensor's delay and offset do not change a peak relative to the table, and are left out."""


class PeakModel:
    """A baseline frame under known shakings, for the peaks measured in them."""

    def __init__(
        self, frame: StoreyFrame, runs: Sequence[RunData], peaks: Sequence[Peak], prior: Prior
    ) -> None:
        """Take a frame, the shakings (their `measured` is not looked at), the peaks on it and the priors.

        Args:
            frame: The frame.
            runs: The shakings; their `measured` is not looked at.
            peaks: Peaks measured on the frame.
            prior: Prior standard deviations of its nuisance parameters.
        """
        self.peaks = tuple(peaks)
        self.names = [run.name for run in runs]
        floors = sorted({peak.floor for peak in peaks})
        blank = tuple(
            RunData(run.name, run.step_s, run.time_s, run.table, np.zeros((len(run.table), len(floors))),
                    np.zeros((len(run.table), 0)))
            for run in runs
        )  # fmt: skip
        kinds = np.full(len(floors), DISPLACEMENT)
        seen = Observations(
            tuple(f"floor {floor}" for floor in floors),
            np.ones(len(floors)),
            kinds,
            np.array(floors) - 1,
            blank,
        )
        self.model = Model(Structure((frame,)), seen, prior)
        self.column = {floor: column for column, floor in enumerate(floors)}

    def predict(self, effect: WholeFrame, size: float) -> np.ndarray:
        """Return the peaks [m] with an effect of a size, shape (peaks,); infinite where the frame runs away."""
        loads = effect.make(self.model, size)
        with np.errstate(over="ignore", invalid="ignore"):
            outputs = self.model.predict(np.zeros(len(self.model.std)), None, loads).outputs
        found = []
        for peak in self.peaks:
            series = outputs[self.names.index(peak.run)][:, self.column[peak.floor]]
            value = float(series.max() if peak.side == "max" else -series.min())
            found.append(value if np.isfinite(value) and 0 < value < LARGEST else np.inf)
        return np.array(found)


def log_likelihood(predicted: np.ndarray, peaks: Sequence[Peak]) -> np.ndarray:
    """Return the log likelihood of peaks for each unexplained scatter, (sizes, scatters).

    Args:
        predicted: Peaks for each size of an effect [m], shape (sizes, peaks).
        peaks: What was measured.
    """
    if not peaks:
        return np.zeros((len(predicted), len(UNEXPLAINED)))
    value = np.array([peak.value for peak in peaks])
    own = np.array([peak.std for peak in peaks]) / value
    residual = np.minimum(np.abs(np.log(predicted / value)), 10.0)
    variance = UNEXPLAINED[:, None] ** 2 + own**2
    return np.asarray(
        -0.5 * np.sum(residual[:, None, :] ** 2 / variance + np.log(2 * np.pi * variance), axis=-1)
    )


def evidence(likelihood: np.ndarray) -> float:
    """Return the log evidence of a log likelihood, shape (sizes, scatters), all of these being equally likely."""
    return float(logsumexp(likelihood) - np.log(likelihood.size))
