"""Effects that act in one storey, as a force that opposes its drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect, Quantity, Scales
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly, floor_mass, storey_pattern, storey_stiffness
from pounding.diagnosis.model.predictor import BUMPER, CUBIC, DAMPER, FADING, FRICTION, HYSTERESIS, LOOSENING
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, force_term, pattern_terms

SHARPNESS = 8.0
SHARPEST = 30.0
"""Exponent of a yielding part's knee: where its refinement starts, and where it is as good as infinite."""
STICKING_RATIO = 0.3
STIFFEST = 60.0
STICKING = 15.0
"""Stiffness of a stuck friction joint as a multiple of the storey's: stiff, yet within the simulator's step."""


@njit(cache=True)
def _yielding(drift: np.ndarray, limit: float) -> np.ndarray:
    """Return the elastic part of a drift whose elastic part is at most `limit` [m], shape (samples,)."""
    elastic = np.empty(drift.size)
    now, last = 0.0, 0.0
    for k in range(drift.size):
        now = min(max(now + drift[k] - last, -limit), limit)
        last = drift[k]
        elastic[k] = now
    return elastic


@dataclass(frozen=True)
class StoreyEffect(Effect):
    """An effect with a force f(d, v, t) in a storey."""

    where = "storey"

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return the force that opposes the drift, for a unit amplitude, shape (samples,)."""
        raise NotImplementedError

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force as a term."""
        return [force_term(motion, lambda m: -self.force(model, m, shape), self.row(model) @ modes.floors)]

    def row(self, model: Model) -> np.ndarray:
        """Return the row of floors that gives the drift the law acts on, (floors,)."""
        return np.asarray(model.structure.drift[self.index])

    def drift(self, motion: Motion) -> np.ndarray:
        """Return that drift [m], (samples,)."""
        return np.asarray(motion.drift[:, self.index])

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return kind and parameters of the law in `pounding.diagnosis.model.predictor`."""
        raise NotImplementedError

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the law to the assembly."""
        kind, parameters = self.law(model, values)
        assembly.laws.append((kind, self.row(model), parameters, (0, 0)))

    def stiffness(self, model: Model) -> float:
        """Return the believed stiffness of the storey [N/m]."""
        return storey_stiffness(model.structure, self.index)


@CATALOGUE.add
@dataclass(frozen=True)
class StiffnessChange(StoreyEffect):
    """The storey's stiffness times (1 + x) at all times: the force x k d."""

    name = "stiffness_change"
    linear = True
    quantities = (Quantity("relative_change", "1"),)

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3."""
        return 0.3

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return k d, with what it does to the joints at its ends."""
        return pattern_terms(motion, storey_pattern(model.structure, self.index), modes.floors)

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change the matrix."""
        assembly.stiffness += max(float(values[0]), -0.95) * storey_pattern(model.structure, self.index)


@CATALOGUE.add
@dataclass(frozen=True)
class DampingChange(StoreyEffect):
    """A viscous damper: c v, negative where the frame has less than believed."""

    name = "damping_change"
    linear = True
    quantities = (Quantity("damping", "N s/m"),)

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the damper that gives the storey alone five per cent of critical in the first mode."""
        first = float(scales.omega[model.structure.index(str(self.frame))][0])
        return 0.1 * self.stiffness(model) / first

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return v."""
        return motion.drift_rate[:, self.index]

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return a damper."""
        return DAMPER, (float(values[0]),)


@CATALOGUE.add
@dataclass(frozen=True)
class CoulombFriction(StoreyEffect):
    """Friction F sign(v), stuck below F."""

    name = "coulomb_friction"
    quantities: ClassVar[tuple[Quantity, ...]] = (
        Quantity("friction_force", "N"),
        Quantity("sticking_stiffness", "1", reported=False),
    )
    sign = 1

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the storey's rms shear."""
        return 0.3 * float(scales.shear[self.index])

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return drifts at which the joint begins to slide [m], standing for its stiffness against its force."""
        return [(float(scales.drift[self.index]) * share,) for share in (0.005, 0.02, 0.1, 0.3)]

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return the sign of the velocity, as a stiff joint that slides."""
        return _yielding(np.ascontiguousarray(motion.drift[:, self.index]), shape[0]) / shape[0]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return friction force and stiffness while stuck, as a multiple of the storey's."""
        return np.array([amplitude, STICKING])

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return a stiff joint that slides at F, damped while stuck."""
        stiffness = min(float(values[1]), STIFFEST) * self.stiffness(model)
        damping = 2 * STICKING_RATIO * np.sqrt(stiffness * floor_mass(model.structure, self.index) / 2)
        return FRICTION, (abs(float(values[0])), stiffness, float(damping))

    def logarithmic(self) -> tuple[bool, ...]:
        """Both are positive."""
        return (True, True)


@dataclass(frozen=True)
class FadingFriction(CoulombFriction):
    """Friction that fast sliding wears down: a foil of the friction that leads, and so at no place of its own."""

    name = "fading_friction"
    rival = True
    quantities = (*CoulombFriction.quantities, Quantity("rate", "m/s"))

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return friction force, stiffness while stuck and a rate of 1 m/s."""
        return np.array([*super().values(amplitude, shape), 1.0])

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return friction that has lost half of itself at a rate."""
        _, friction = super().law(model, values)
        return FADING, (*friction, max(abs(float(values[2])), 1e-9))

    def logarithmic(self) -> tuple[bool, ...]:
        """All are positive."""
        return (True, True, True)


@CATALOGUE.add
@dataclass(frozen=True)
class CubicStiffness(StoreyEffect):
    """A spring k3 d^3."""

    name = "cubic_stiffness"
    quantities = (Quantity("cubic_stiffness", "N/m^3"),)

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return what makes 0.3 of the linear force at twice the rms drift."""
        return 0.3 * self.stiffness(model) / (2 * float(scales.drift[self.index])) ** 2

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return d^3."""
        return motion.drift[:, self.index] ** 3

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return a cubic spring."""
        return CUBIC, (float(values[0]),)


@CATALOGUE.add
@dataclass(frozen=True)
class Hysteresis(StoreyEffect):
    """A part k_y of the storey's stiffness yields at F_y; small motions feel nothing of it.

    How sharp the knee is no catalogue says, so the exponent of Bouc and Wen is refined with the rest.
    """

    name = "hysteresis"
    absorbing = True
    quantities = (
        Quantity("yield_force", "N"),
        Quantity("stiffness", "N/m"),
        Quantity("sharpness", "1", reported=False),
    )
    sign = 1

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the storey's stiffness."""
        return 0.3 * self.stiffness(model)

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return yield drifts [m]."""
        largest = float(max(scales.highest[self.index], -scales.lowest[self.index]))
        return [(largest * share,) for share in (0.06, 0.12, 0.2, 0.32, 0.46, 0.62, 0.8)]

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return what the yielding part lacks of its elastic force."""
        drift = np.ascontiguousarray(motion.drift[:, self.index])
        return _yielding(drift, shape[0]) - drift

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return yield force, stiffness and the sharpness of the knee."""
        return np.array([amplitude * shape[0], amplitude, SHARPNESS])

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return the yielding part less its elastic force."""
        sharpness = min(max(float(values[2]), 1.0), SHARPEST)
        return HYSTERESIS, (abs(float(values[0])), abs(float(values[1])), sharpness)

    def logarithmic(self) -> tuple[bool, ...]:
        """All are positive."""
        return (True, True, True)


@CATALOGUE.add
@dataclass(frozen=True)
class Loosening(StoreyEffect):
    """The storey's stiffness falls linearly over each run to (1 + x) of itself: x k (t / T) d."""

    name = "loosening"
    quantities = (Quantity("final_relative_change", "1"),)
    sign = -1

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3."""
        return 0.3

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return k (t / T) d."""
        share = np.linspace(0.0, 1.0, len(motion.drift))
        return self.stiffness(model) * share * motion.drift[:, self.index]

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return a spring that grows with time, up to the duration of the run."""
        return LOOSENING, (max(float(values[0]), -0.95) * self.stiffness(model), float("nan"))


@CATALOGUE.add
@dataclass(frozen=True)
class Bumper(StoreyEffect):
    """A stop: k (d - g) beyond the gap g, or its mirror where g is negative."""

    name = "bumper"
    quantities = (Quantity("gap", "mm", 1000.0), Quantity("stiffness", "N/m"))
    sign = 1

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the storey's stiffness."""
        return self.stiffness(model)

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return gaps [m] on both sides."""
        shares = (0.1, 0.25, 0.4, 0.55, 0.7, 0.84)
        ends = (float(scales.highest[self.index]), float(scales.lowest[self.index]))
        return [(end * share,) for end in ends for share in shares]

    def force(self, model: Model, motion: Motion, shape: tuple[float, ...]) -> np.ndarray:
        """Return the penetration."""
        beyond = self.drift(motion) - shape[0]
        return np.maximum(beyond, 0.0) if shape[0] >= 0 else np.minimum(beyond, 0.0)

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return gap and stiffness."""
        return np.array([shape[0], amplitude])

    def law(self, model: Model, values: np.ndarray) -> tuple[int, tuple[float, ...]]:
        """Return a stop."""
        return BUMPER, (float(values[0]), abs(float(values[1])))

    def logarithmic(self) -> tuple[bool, ...]:
        """The stiffness is positive."""
        return (False, True)


@CATALOGUE.add
@dataclass(frozen=True)
class Tie(Bumper):
    """A stop between floors two storeys apart, or the second floor and the table: nobody listed it, so it is a foil."""

    name = "tie"
    where = "upper storey"
    rival = True

    def row(self, model: Model) -> np.ndarray:
        """Return the row of both storeys' drifts together, (floors,)."""
        return np.asarray(model.structure.drift[self.index - 1 : self.index + 1].sum(axis=0))

    def drift(self, motion: Motion) -> np.ndarray:
        """Return both storeys' drifts together [m], (samples,)."""
        return np.asarray(motion.drift[:, self.index - 1 : self.index + 1].sum(axis=1))

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return gaps [m] on both sides, of both storeys' drifts together."""
        both = slice(self.index - 1, self.index + 1)
        ends = (float(scales.highest[both].sum()), float(scales.lowest[both].sum()))
        return [(end * share,) for end in ends for share in (0.25, 0.55)]
