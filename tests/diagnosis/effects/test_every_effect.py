"""Every effect at every place: its evidence is the derivative of the prediction, and exudyn agrees with the prediction.

Nothing here names an effect but where one needs another size than the rest; an effect that is added is tried as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.every_storey import AllCoulombFriction
from pounding.diagnosis.effects.frame import TorsionalEccentricity
from pounding.diagnosis.effects.rivals import FadingFriction
from pounding.diagnosis.effects.storey import CoulombFriction, StoreyEffect
from pounding.diagnosis.effects.tuned import TRIED_DAMPING
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.filtering import run_filter, run_signatures, whitened
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.inference.motions import motions
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model import observations
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.model.twin import simulate_engine
from tests.diagnosis.models import measured, three_storeys

SHARE = 0.01
"""Part of its prior width at which an effect is small."""
LONG = 1000


def bench() -> Model:
    """The bench with joints, so that every effect has a place."""
    frame = three_storeys().frames[0]
    joints = 6e4 * frame.drift.T @ np.diag([0.3, 0.2, 0.1]) @ frame.drift
    structure = Structure((replace(frame, joint_derivative=joints, joint_stiffness=1000.0),))
    return Model(structure, measured().observed, Prior())


BASELINE = bench()
FILTERED = run_filter(BASELINE, np.zeros(len(BASELINE.std)), starting_noise(BASELINE, (0,), 0.01), (0,))
SIZES = scales(BASELINE, FILTERED)
MOTION = motions(BASELINE, FILTERED)[0]
EVERYWHERE = [effect for kind in kinds() for effect in places(kind, BASELINE)]
ON_THE_FRAME = [effect for effect in EVERYWHERE if effect.where not in ("channel", "logger")]


def name(effect: Effect) -> str:
    return f"{type(effect).__name__}-{effect.index}"


def middle(effect: Effect) -> tuple[float, ...]:
    shapes = effect.grid(SIZES)
    return shapes[len(shapes) // 2]


class Sliding:
    """A friction joint as it is scored: it slides from a drift on, and nothing damps it while it sticks."""

    def __init__(self, effect: CoulombFriction | AllCoulombFriction, shape: tuple[float, ...]) -> None:
        self.each = {effect: 1.0} if isinstance(effect, CoulombFriction) else weighed(effect)
        self.shape = shape

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        for effect, weight in self.each.items():
            force, stiffness, *rest = effect.unit(BASELINE, self.shape)
            numbers = (weight * values[0] * force, weight * values[0] * stiffness, *rest)
            assembly.laws.append(PlacedLaw(effect.law, effect.row(model), numbers))


def weighed(effect: AllCoulombFriction) -> dict[CoulombFriction, float]:
    """The friction of each storey by its weight."""
    storeys = [one for one in effect.each(BASELINE) if isinstance(one, CoulombFriction)]
    return {one: effect.weight(BASELINE, one) for one in storeys}


def innovations(effect: Effect, shape: tuple[float, ...], amplitude: float) -> np.ndarray:
    """The whitened innovations of the baseline with a little of an effect."""
    values = effect.values(amplitude, shape)
    if isinstance(effect, TorsionalEccentricity):
        # What is tuned is scored with a damping of its own.
        values[2] = TRIED_DAMPING / float(FILTERED.modes.ratio[0])
    acting = (effect, values)
    if isinstance(effect, CoulombFriction | AllCoulombFriction):
        acting = (Sliding(effect, shape), np.array([amplitude]))  # type: ignore[assignment]
    gains = FILTERED.gains
    if len(BASELINE.modes(BASELINE.assemble(FILTERED.values, [acting])).omega) > BASELINE.structure.floors:
        # What has coordinates of its own needs a filter of its own.
        there = run_filter(BASELINE, FILTERED.values, FILTERED.noise, (0,), [acting])
        return whitened(there.prediction.innovations[0], FILTERED.filters[0]).ravel()
    found = BASELINE.predict(FILTERED.values, gains, [acting], (0,)).innovations[0]
    return whitened(found, FILTERED.filters[0]).ravel()


@pytest.mark.parametrize("effect", EVERYWHERE, ids=name)
def test_what_is_scored_is_the_derivative_of_the_prediction(effect: Effect) -> None:
    shape = middle(effect)
    size = (effect.sign or 1) * SHARE * effect.size(BASELINE, SIZES, shape)
    terms = effect.terms(BASELINE, FILTERED.modes, MOTION, shape)
    column = run_signatures(BASELINE, FILTERED, 0, [terms])[:, 0]
    change = (innovations(effect, shape, size) - innovations(effect, shape, 2 * size)) / size
    cosine = column @ change / np.linalg.norm(column) / np.linalg.norm(change)
    # A late sensor is the measured series moved, with its noise; its rate is that of the prediction.
    moved = effect.name in ("sensor_delay", "clock_rate")
    assert cosine > (0.5 if moved else 0.95)
    if not moved:
        assert np.linalg.norm(column) == pytest.approx(np.linalg.norm(change), rel=0.1)


def shaken() -> Model:
    """The bench with one run that is short enough for the engine."""
    runs = tuple(
        replace(run, table=run.table[:LONG], time_s=run.time_s[:LONG], measured=run.measured[:LONG],
                contact=run.contact[:LONG])
        for run in BASELINE.observed.runs[:1]
    )  # fmt: skip
    return Model(BASELINE.structure, replace(BASELINE.observed, runs=runs), BASELINE.prior)


SHAKEN = shaken()


def strong(effect: Effect) -> np.ndarray:
    """Return the parameters of an effect that is as strong as its prior expects."""
    share = 1.0
    if isinstance(effect, FadingFriction):
        # Friction that falls as it slides moves a stronger joint by stick and slip, which no solver repeats.
        share = 0.25
    shape = middle(effect)
    values = effect.values((effect.sign or 1) * share * effect.size(SHAKEN, SIZES, shape), shape)
    if isinstance(effect, FadingFriction):
        values[2] = 0.5 * SIZES.drift_rate[effect.index]
    return values


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest rms difference of a channel over its rms."""
    return float((root_mean_square(one - other) / root_mean_square(one)).max())


def both(acting: Sequence[tuple[Effect, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the channels by the fast simulator and by the engine."""
    nuisance = np.zeros(len(SHAKEN.std))
    return simulate(SHAKEN, nuisance, acting, [0])[0], simulate_engine(SHAKEN, nuisance, acting, [0])[0]


@pytest.mark.parametrize("effect", ON_THE_FRAME, ids=name)
def test_the_engine_agrees_with_the_prediction_within_one_per_cent(effect: Effect) -> None:
    fast, engine = both([(effect, strong(effect))])
    without = simulate(SHAKEN, np.zeros(len(SHAKEN.std)), [], [0])[0]
    error = difference(fast, engine)
    assert error < 0.01
    assert difference(fast, without) > max(0.05, 5 * error)


@pytest.mark.parametrize("kind", ["sensor_gain", "sensor_delay", "sensor_offset", "clock_rate"])
def test_the_engine_has_the_sensors_faults(kind: str) -> None:
    effect = next(effect for effect in EVERYWHERE if effect.name == kind)
    fast, engine = both([(effect, strong(effect))])
    assert difference(fast, engine) < 0.001


@pytest.mark.parametrize("index", [0, 2])
def test_strong_fading_friction_is_the_same_law_too(index: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the prediction's own step is what parts the two, they agree at a finer one."""
    effect = next(e for e in EVERYWHERE if isinstance(e, FadingFriction) and e.index == index)
    values = effect.values(effect.size(SHAKEN, SIZES, middle(effect)), middle(effect))
    values[2] = SIZES.drift_rate[index]
    coarse, _ = both([(effect, values)])
    monkeypatch.setattr(observations, "SUBSTEP_S", observations.SUBSTEP_S / 8)
    fast, engine = both([(effect, values)])
    assert difference(fast, engine) < 0.005
    assert difference(fast, engine) < difference(coarse, engine)


def test_a_law_with_memory_acts_in_a_storey_of_every_frame() -> None:
    """Two friction joints at once: each has a memory of its own, in the prediction and in the engine."""
    joints = [effect for effect in EVERYWHERE if type(effect) is CoulombFriction]
    fast, engine = both([(joint, strong(joint) * [0.3, 1.0, 1.0, 1.0]) for joint in joints[:2]])
    assert isinstance(joints[0], StoreyEffect)
    assert difference(fast, engine) < 0.01
