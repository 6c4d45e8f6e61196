"""The catalogue: every effect once, with its equation, prior, places, sketch, and what it does to the models.

d is the drift of a storey, v its rate, u a floor's displacement relative to the table, w its absolute velocity. An effect is
one class and touches no other module. It gives

- its parameters with names and units, their typical sizes (`size`, `grid`) and its places (`where`),
- `terms`: the force (or the change of an input or a sensor) that a unit of its amplitude makes on a predicted motion,
- `apply`: the same effect in an assembly, from which both the fast simulator (`pounding.diagnosis.model.model`) and the
  exudyn rig (`pounding.diagnosis.model.twin`) are made; a force is a law (`pounding.experiments.rig.laws`) for all three,
- `described`: its row and its sketch in docs/diagnosis/catalogue.md.

A module of this folder that defines kinds of effects and adds them to `CATALOGUE` is found by `candidates.kinds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from pounding.diagnosis.case.place import KEYS, in_words
from pounding.diagnosis.effects.describing import Description
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion
from pounding.diagnosis.settings import SETTINGS

CHANNEL_UNIT = "unit of the channel"


@dataclass(frozen=True)
class Quantity:
    """A parameter of an effect.

    Attributes:
        name, unit: Its name, and its unit as reported. per_si: How many of that unit an SI unit is.
        reported: Whether it is reported.
        logarithmic: Whether it keeps its sign, and is refined as a logarithm.
        spread: Prior standard deviation [SI] of a departure from zero; zero where the prior follows from the motion.
        symbol: How the equation of its effect in the documentation calls it, in LaTeX; empty where there is none.
        ends: Least and largest value [SI] to which it is refined.
    """

    name: str
    unit: str
    per_si: float = 1.0
    reported: bool = True
    logarithmic: bool = False
    spread: float = 0.0
    symbol: str = ""
    ends: tuple[float, float] = (-np.inf, np.inf)


@dataclass(frozen=True)
class Scales:
    """Typical sizes of a case's motion, from which amplitudes get their prior widths.

    Attributes:
        drift, drift_rate: rms of each storey [m], [m/s]. highest, lowest: extremes of each drift [m].
        shear: rms storey shear [N]. acceleration, rate: rms absolute floor motion [m/s^2], [m/s].
        output: rms of each channel in SI. omega: angular frequencies [rad/s] of each frame, a list.
    """

    drift: np.ndarray
    drift_rate: np.ndarray
    highest: np.ndarray
    lowest: np.ndarray
    shear: np.ndarray
    acceleration: np.ndarray
    rate: np.ndarray
    output: np.ndarray
    omega: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Effect:
    """An effect at a place. Subclasses say what it does; `index` is the storey, floor or channel among all.

    Attributes:
        frame, storey, floor, channel, contact, left, right: The place as reported, counted from 1.
        test: The only modal test in which it acts; None where it acts in all.
    """

    index: int = 0
    frame: str | None = None
    storey: int | None = None
    floor: int | None = None
    channel: str | None = None
    contact: int | None = None
    left: str | None = None
    right: str | None = None
    test: str | None = None

    name: ClassVar[str] = ""
    quantities: ClassVar[tuple[Quantity, ...]] = ()
    where: ClassVar[str] = ""
    """``storey``, ``upper storey``, ``all storeys``, ``floor``, ``frame``, ``channel``, ``logger`` or nothing."""
    amplitude: ClassVar[int] = 0
    """Which parameter says how strong it is."""
    typical: ClassVar[float]
    """Prior standard deviation of the amplitude in SI, where it is the same in every case; else `size` gives it."""
    sign: ClassVar[int] = 0
    """+1 or -1 where only one sign of the amplitude makes sense, else 0."""
    linear: ClassVar[bool] = False
    """Whether its one parameter is its amplitude, and `terms` are its derivative at any size."""
    rival: ClassVar[bool] = False
    """Whether this is outside the catalogue and stands for 'something else'."""
    default: ClassVar[bool] = True
    """Whether it is tried in every diagnosis; else only where it is asked for."""
    described: ClassVar[Description | None] = None
    """What the catalogue in the documentation says and draws of it; None for what is no effect of its own there."""
    nonlinear: ClassVar[bool] = False
    """Whether its share of the motion depends on how strong the shaking is."""
    dissipates: ClassVar[bool] = False
    """Whether it takes energy in every cycle."""
    absorbing: ClassVar[bool] = False
    """Whether a little of it mends what every baseline frame has wrong: its modes, or losses that are not viscous."""
    common: ClassVar[bool] = False
    """Whether every real frame has a little of it and no model: what all storeys share, a plan not quite symmetric, a part
    that sways by itself."""
    common_beside: ClassVar[bool] = False
    """Whether every real frame has a little of it beside what is missing: how its base, its joints and its weight soften it
    is in every model, and never quite right."""

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return the share of its size that its law may get wrong on a frame, whatever the data say [-].

        What is never quite right in any model is a part of what softens a frame beside what is missing. What is wrong with a
        reading has no law: its size is by definition.

        Args:
            model: The baseline model.
            values: Its parameters in SI, shape (parameters,).
            scales: Typical sizes of the motion.
        """
        del model, values, scales
        ours = SETTINGS.refinement
        if self.frame is None:
            return 0.0
        return ours.law_error_everywhere if self.common_beside else ours.law_error

    def is_common(self, values: np.ndarray, scales: Scales) -> bool:
        """Return whether every real frame has a little of it and no model, with these parameters.

        Args:
            values: Its SI parameters, shape (parameters,).
            scales: Typical sizes of the case's motion.
        """
        del values, scales
        return self.common

    def place(self) -> dict[str, Any]:
        """Return effect and place as in the report."""
        tested = {} if self.test is None else {"test": self.test}
        return {"effect": self.name} | {key: getattr(self, key) for key in KEYS} | tested

    @property
    def key(self) -> tuple[object, ...]:
        """Effect and place, by which it is told from others."""
        return tuple(self.place().values())

    def label(self) -> str:
        """Return effect and place in words."""
        where = in_words(**{key: getattr(self, key) for key in KEYS})
        tested = "" if self.test is None else f"only in the {self.test.replace('_', ' ')}"
        return ", ".join(word for word in (self.name.replace("_", " "), where, tested) if word)

    def entries(self) -> list[dict[str, Any]]:
        """Return the places under which the effect is reported; more than one if it stands for several."""
        return [self.place()]

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return the values of what is not an amplitude at which the effect is scored."""
        del scales
        return [()]

    def departed(self, model: Model, without: np.ndarray, beside: np.ndarray) -> bool:
        """Return whether a nuisance parameter has moved in its stead further than calibration may, and with it none does.

        Where others of its kind stay as far away, something else moves them, and most likely that one, too.

        Args:
            model: The baseline model.
            without, beside: Nuisance parameters without the effect and beside it in their own units, each (nuisance,).
        """
        del model, without, beside
        return False

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the prior standard deviation of the amplitude in SI.

        Args:
            model: The baseline model.
            scales: Typical sizes of the motion.
            shape: Values of what is not an amplitude, one of `grid`.
        """
        del model, scales, shape
        return self.typical

    def largest(self, model: Model) -> float:
        """Return the largest amplitude in SI that it can have."""
        del model
        return float("inf")

    def relative_to(self, model: Model) -> list[int]:
        """Return the numbers of the nuisance parameters that change by their sum what its first parameter is relative to."""
        del model
        return []

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the terms that a unit amplitude adds to the innovations.

        Args:
            model: The baseline model.
            modes: Modes of the filtered model.
            motion: Motion of a run of the filtered model.
            shape: Values of what is not an amplitude, one of `grid`.
        """
        raise NotImplementedError

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the SI parameters of an amplitude in the order of `quantities`, shape (parameters,).

        Args:
            amplitude: The amplitude in SI.
            shape: Values of what is not an amplitude, one of `grid`.
        """
        return np.array([amplitude, *shape])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Put the effect on an assembly.

        Args:
            assembly: The assembly, which is changed in place.
            values: SI parameters in the order of `quantities`, shape (parameters,).
            model: The baseline model.
        """
        raise NotImplementedError

    def logarithmic(self) -> tuple[bool, ...]:
        """Return which parameters are refined as logarithms, because they can only be positive."""
        return tuple(one.logarithmic for one in self.quantities)


GROUPS = {
    "On a frame or a floor": ("frame", "floor"),
    "In a storey": ("storey", "upper storey"),
    "In all storeys of a frame": ("all storeys",),
    "At the table and in the sensors": ("", "channel", "logger"),
}
"""Places by the heading under which the documentation has them, in the order in which candidates are tried."""


@dataclass(frozen=True)
class Registry:
    """The kinds of effects."""

    kinds: list[type[Effect]] = field(default_factory=list)

    def add(self, kind: type[Effect]) -> type[Effect]:
        """Register a kind; used as a decorator."""
        self.kinds.append(kind)
        return kind

    def ordered(self) -> list[type[Effect]]:
        """Return the kinds by groups of places, in each those always tried, those asked for, those outside the catalogue.

        Alike ones stand as they do in their module, and modules by name: the order is not that of imports.
        """
        alike = sorted(self.kinds, key=lambda kind: (kind.rival, not kind.default, kind.__module__))
        return [kind for places in GROUPS.values() for kind in alike if kind.where in places]

    def optional(self) -> list[type[Effect]]:
        """Return the kinds that are tried only where they are asked for; rivals are no answer to ask for."""
        return [kind for kind in self.kinds if not kind.default and not kind.rival]

    def names(self) -> list[str]:
        """Return the names of the effects that a diagnosis may give without being asked for them."""
        return [kind.name for kind in self.kinds if kind.default and not kind.rival]


CATALOGUE = Registry()


def places(kind: type[Effect], model: Model) -> Sequence[Effect]:
    """Return a kind of effect at each of its places; a channel that no run has is none."""
    structure, observed = model.structure, model.observed
    where = kind.where
    if where in ("storey", "upper storey"):
        spots = [structure.place(i) for i in range(structure.floors)]
        lowest = 2 if where == "upper storey" else 1
        return [
            kind(index=i, frame=frame, storey=number)
            for i, (frame, number) in enumerate(spots)
            if number >= lowest
        ]
    if where == "floor":
        spots = [structure.place(i) for i in range(structure.floors)]
        return [kind(index=i, frame=frame, floor=number) for i, (frame, number) in enumerate(spots)]
    if where in ("frame", "all storeys"):
        # All storeys of a frame that has but one are that storey.
        least = 2 if where == "all storeys" else 1
        return [
            kind(index=i, frame=frame.name)
            for i, frame in enumerate(structure.frames)
            if frame.floors >= least
        ]
    if where == "channel":
        seen = observed.seen()
        return [kind(index=i, channel=name) for i, name in enumerate(observed.names) if seen[i]]
    if where == "logger":
        return [_logger(kind, model, members) for members in loggers(model)]
    return [kind()]


def loggers(model: Model) -> list[tuple[int, ...]]:
    """Return groups of channels that may sit on a logger of their own: one kind of quantity, or one frame."""
    observed = model.observed
    seen = observed.seen()
    everything = tuple(int(c) for c in np.flatnonzero(seen))
    groups = [
        tuple(int(c) for c in np.flatnonzero(seen & (observed.quantity == kind)))
        for kind in np.unique(observed.quantity)
    ]
    groups += [
        tuple(int(c) for c in np.flatnonzero(seen & model.at_frame(frame)))
        for frame in range(len(model.structure.frames))
    ]
    return [group for group in dict.fromkeys(groups) if 2 <= len(group) < len(everything)]


def _logger(kind: type[Effect], model: Model, members: tuple[int, ...]) -> Effect:
    names = tuple(model.observed.names[c] for c in members)
    return kind(index=members[0], channel=names[0], members=members, channels=names)  # type: ignore[call-arg]
