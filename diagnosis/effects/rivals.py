"""Rivals outside the catalogue: what nobody listed, tried so that its evidence speaks for an unknown effect."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.bases import FrameEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, Quantity, Scales
from pounding.diagnosis.effects.storey import Bumper, CoulombFriction
from pounding.diagnosis.effects.tuned import TRIED_DAMPING, bandwidths, oscillator
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly, floor_mass
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, force_term


@CATALOGUE.add
@dataclass(frozen=True)
class Appendage(FrameEffect):
    """A mass on a spring that nobody listed."""

    name = "appendage"
    absorbing = True
    common = True
    where = "floor"
    rival = True
    quantities = (
        Quantity("mass", "kg", logarithmic=True),
        Quantity("frequency", "Hz", logarithmic=True),
        Quantity("damping_ratio", "1", logarithmic=True),
    )
    sign = 1

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return angular frequencies [rad/s] from below the first to beyond the third frequency, a bandwidth apart."""
        modes = np.sort(np.concatenate(scales.omega))[:3]
        return [(float(value),) for value in bandwidths(0.5 * modes[0], 1.3 * modes[-1])]

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return a tenth of the floor's mass."""
        return 0.1 * floor_mass(model.structure, self.index)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force of a unit mass on a spring that is driven by the floor."""

        def pull(m: Motion) -> np.ndarray:
            relative = oscillator(-m.acceleration[:, self.index], shape[0], motion.run.step_s)
            return np.asarray(shape[0] ** 2 * relative)

        return [force_term(motion, pull, modes.floors[self.index], linear=False)]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return mass, frequency and damping."""
        return np.array([max(amplitude, 1e-6), shape[0] / (2 * np.pi), TRIED_DAMPING])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add a coordinate."""
        weight, omega, damping_ratio = float(values[0]), 2 * np.pi * float(values[1]), float(values[2])
        floor = self.index

        def extend(
            mass: np.ndarray, stiffness: np.ndarray, damping: np.ndarray
        ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            n = len(mass)
            larger = [np.zeros((n + 1, n + 1)) for _ in range(3)]
            row = np.zeros(n + 1)
            row[n], row[floor] = 1.0, -1.0
            spring = weight * omega**2 * np.outer(row, row)
            damper = 2 * damping_ratio * omega * weight * np.outer(row, row)
            for new, old in zip(larger, (mass, stiffness, damping), strict=True):
                new[:n, :n] = old
            larger[0][n, n] = weight
            return larger[0], larger[1] + spring, larger[2] + damper

        assembly.extensions.append(extend)
        assembly.influence.append(1.0)
        assembly.dampers += 1


@CATALOGUE.add
@dataclass(frozen=True)
class FadingFriction(CoulombFriction):
    """Friction that fast sliding wears down; the search tries it where plain friction leads, and nowhere else."""

    name = "fading_friction"
    rival = True
    default = False
    quantities = (
        *CoulombFriction.quantities[:2],
        Quantity("rate", "m/s", logarithmic=True),
        CoulombFriction.quantities[3],
    )

    def unit(self, model: Model, shape: tuple[float, ...]) -> tuple[float, ...]:
        """Return friction of 1 N that slides from the drift `shape` and has lost half of itself at 1 m/s."""
        return (*super().unit(model, shape)[:3], 1.0)

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return friction force, stiffness while stuck, a rate of 1 m/s and damping ratio while stuck."""
        force, stiffness, _, damping_ratio = super().values(amplitude, shape)
        return np.array([force, stiffness, 1.0, damping_ratio])

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return friction that has lost half of itself at a rate, with no breakaway."""
        plain = super().numbers(model, np.array([*values[:2], 0.0, values[3]]))
        return (*plain[:3], max(abs(float(values[2])), 1e-9))


@CATALOGUE.add
@dataclass(frozen=True)
class Tie(Bumper):
    """A stop between floors two storeys apart, or between the second floor and the table."""

    name = "tie"
    where = "upper storey"
    rival = True
    quantities = Bumper.quantities[:2]

    def row(self, model: Model) -> np.ndarray:
        """Return the row of both storeys' drifts together, (floors,)."""
        return np.asarray(model.structure.drift[self.index - 1 : self.index + 1].sum(axis=0))

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return gaps [m] on both sides, of both storeys' drifts together."""
        both = slice(self.index - 1, self.index + 1)
        ends = (float(scales.highest[both].sum()), float(scales.lowest[both].sum()))
        return [(end * share,) for end in ends for share in (0.25, 0.55)]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return gap and stiffness."""
        return super().values(amplitude, shape)[:2]

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return gap and stiffness of a straight stop without loss."""
        return (*super().numbers(model, values), 0.0, 0.0, 0.0)
