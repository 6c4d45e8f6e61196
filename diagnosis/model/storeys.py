"""The baseline frames as storeys: masses, stiffness and damping of the floors' x displacements, and what varies them.

All frames of a case stand on one table, so they make one block-diagonal system; each keeps its own floors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import block_diag, eigh

from pounding.constants import STANDARD_GRAVITY

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame


DISCREPANT_MODES = 6
"""Lowest modes of a frame whose stiffness may differ from the model's in ways that no storey gives."""


@dataclass(frozen=True)
class StoreyFrame:
    """One frame condensed to its floors.

    Attributes:
        name: The frame's name.
        mass, stiffness: Matrices of the floors' displacements relative to the table [kg], [N/m], shape (n, n).
        damping_ratio: Damping ratio of each mode, shape (n,).
        height_m: Height of each floor above the base, shape (n,).
        joint_derivative: d stiffness / d log(joint stiffness) [N/m], shape (n, n), or None where a frame has no joints.
        joint_stiffness: Joint stiffness of the baseline model [N m/rad], or NaN.
        patterns: Change of the stiffness for a unit relative change of each storey's, (storeys, n, n), where the
            frame is more than a chain of storeys.
        gyration_m: Radius of gyration of a floor about the vertical [m].
    """

    name: str
    mass: np.ndarray
    stiffness: np.ndarray
    damping_ratio: np.ndarray
    height_m: np.ndarray
    joint_derivative: np.ndarray | None = None
    joint_stiffness: float = float("nan")
    patterns: np.ndarray | None = None
    gyration_m: float = 0.163

    @property
    def floors(self) -> int:
        """Number of floors, which is that of storeys."""
        return len(self.height_m)

    @cached_property
    def drift(self) -> np.ndarray:
        """Rows that turn floor displacements into drifts, shape (storeys, floors)."""
        return np.eye(self.floors) - np.eye(self.floors, k=-1)

    @cached_property
    def storey_stiffness(self) -> np.ndarray:
        """Shear for a unit drift in one storey alone [N/m], shape (storeys,)."""
        above = np.tril(np.ones((self.floors, self.floors)))
        return np.asarray(np.einsum("is,ij,js->s", above, self.stiffness, above))

    def storey_pattern(self, storey: int) -> np.ndarray:
        """Return the change of the stiffness for a unit relative change of a storey's (from 0) [N/m]."""
        if self.patterns is not None:
            return np.asarray(self.patterns[storey])
        row = self.drift[storey]
        return float(self.storey_stiffness[storey]) * np.outer(row, row)

    @cached_property
    def modal_rows(self) -> np.ndarray:
        """Rows that turn floor displacements into the lowest modes' displacements times their frequencies.

        Mass-normalised, [kg^0.5 rad/s], shape (modes, floors); the modes are those of `discrepancies`.
        """
        squares, shapes = eigh(self.stiffness, self.mass)
        rows = np.sqrt(np.maximum(squares, 0.0))[:, None] * (self.mass @ shapes).T
        return np.asarray(rows[:DISCREPANT_MODES])

    @property
    def discrepancies(self) -> list[tuple[int, int]]:
        """Pairs of modes (from 0) between which the stiffness may be other than the model's, a mode with itself included."""
        modes = range(min(self.floors, DISCREPANT_MODES))
        return [(one, other) for one in modes for other in modes if one <= other]

    @cached_property
    def floor_mass(self) -> np.ndarray:
        """Row sums of the mass matrix [kg], shape (floors,)."""
        return np.asarray(self.mass.sum(axis=1))

    @cached_property
    def geometric(self) -> np.ndarray:
        """Stiffness that the frame's own weight takes away, shape (floors, floors) [N/m]."""
        weight = STANDARD_GRAVITY * np.cumsum(self.floor_mass[::-1])[::-1]
        storey_height = np.diff(self.height_m, prepend=0.0)
        return np.asarray(self.drift.T @ np.diag(weight / storey_height) @ self.drift)


def from_reduced(reduced: ReducedFrame, name: str | None = None) -> StoreyFrame:
    """Return the storeys of a reduced frame."""
    mass, stiffness, damping = (np.asarray(matrix, float) for matrix in reduced.storey_model())
    squares, shapes = eigh(stiffness, mass)
    ratio = np.einsum("im,ij,jm->m", shapes, damping, shapes) / (2 * np.sqrt(squares))
    return StoreyFrame(
        name=name or reduced.name,
        mass=mass,
        stiffness=stiffness,
        damping_ratio=ratio,
        height_m=np.asarray(reduced.heights_m, float),
    )


@dataclass(frozen=True)
class Coupling:
    """Damping by which the rates of modes push others, and these them (non-classical damping).

    Attributes:
        pairs: Numbers of both modes of each pair, shape (pairs, 2).
        rates: Modal force of each mode of a pair for a unit rate of the other [1/s], shape (pairs,).
    """

    pairs: np.ndarray
    rates: np.ndarray

    @classmethod
    def none(cls) -> Coupling:
        """Return that of modes which damping leaves apart."""
        return cls(np.zeros((0, 2), np.int64), np.zeros(0))

    @classmethod
    def of(cls, pairs: Sequence[tuple[int, int]], rates: np.ndarray) -> Coupling:
        """Return that of pairs of modes, without those that it does not couple.

        Args:
            pairs: Numbers of both modes of each.
            rates: Modal force of each mode of a pair for a unit rate of the other [1/s], shape (pairs,).
        """
        which = np.flatnonzero(rates)
        return cls(np.array(pairs, np.int64).reshape(-1, 2)[which], rates[which])

    @classmethod
    def strongest(cls, omega: np.ndarray, damping: np.ndarray, count: int) -> Coupling:
        """Return that of the pairs which it changes most: what it does over how far apart the modes are.

        Args:
            omega: Angular frequencies [rad/s], shape (modes,).
            damping: Modal damping matrix [1/s], shape (modes, modes).
            count: Number of pairs.
        """
        one, other = np.triu_indices(len(omega), 1)
        apart = np.maximum(np.abs(omega[one] - omega[other]), 1e-9 * omega.max())
        most = np.argsort(-np.abs(damping[one, other]) / apart, kind="stable")[:count]
        return cls(np.column_stack([one, other])[most], damping[one, other][most])

    def matrix(self, modes: int) -> np.ndarray:
        """Return it as a modal damping matrix [1/s], shape (modes, modes)."""
        found = np.zeros((modes, modes))
        one, other = self.pairs.T
        found[one, other] = found[other, one] = self.rates
        return found


@dataclass(frozen=True)
class Modes:
    """Modes of all frames together, mass-normalised.

    Attributes:
        omega: Angular frequencies [rad/s], shape (modes,).
        ratio: Damping ratios, shape (modes,).
        floors: Shapes at the floors [kg^-0.5], shape (floors, modes).
        participation: Modal force of a unit table acceleration, shape (modes,).
        added: Shapes at the coordinates that effects added [kg^-0.5], shape (modes less floors, modes); none by default.
        coupling: What damping couples of the modes; nothing by default.
    """

    omega: np.ndarray
    ratio: np.ndarray
    floors: np.ndarray
    participation: np.ndarray
    added: np.ndarray | None = None
    coupling: Coupling = field(default_factory=Coupling.none)

    @property
    def shapes(self) -> np.ndarray:
        """Shapes at all coordinates [kg^-0.5], shape (modes, modes)."""
        return self.floors if self.added is None else np.vstack([self.floors, self.added])

    def swing(self, times_s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return what becomes of a displacement and of a rate of one when nothing pushes, each (times, modes).

        Displacement by displacement, displacement by rate [s], rate by displacement [1/s], rate by rate.

        Args:
            times_s: Times since [s], shape (times,).
        """
        ratio = np.minimum(self.ratio, 0.95)
        damped = self.omega * np.sqrt(1 - ratio**2)
        decay = np.exp(-np.outer(times_s, ratio * self.omega))
        phase = np.outer(times_s, damped)
        cosine, sine = decay * np.cos(phase), decay * np.sin(phase)
        lost, moved = ratio * self.omega / damped * sine, sine / damped
        return cosine + lost, moved, -(self.omega**2) * moved, cosine - lost

    def step(self, step_s: float) -> np.ndarray:
        """Return the exact step of each mode under a constant force, shape (6, modes).

        `swing` over the step, then displacement and rate by a unit of modal force.

        Args:
            step_s: Length of the step [s].
        """
        if step_s not in self._steps:
            a11, a12, a21, a22 = (one[0] for one in self.swing(np.array([step_s])))
            self._steps[step_s] = np.stack([a11, a12, a21, a22, (1 - a11) / self.omega**2, a12])
        return self._steps[step_s]

    @cached_property
    def _steps(self) -> dict[float, np.ndarray]:
        return {}


@dataclass(frozen=True)
class Structure:
    """All frames of a case on one table."""

    frames: tuple[StoreyFrame, ...]

    @property
    def floors(self) -> int:
        """Number of floors of all frames."""
        return sum(frame.floors for frame in self.frames)

    @cached_property
    def drift(self) -> np.ndarray:
        """Rows that turn floor displacements into drifts, shape (storeys, floors)."""
        return np.asarray(block_diag(*(frame.drift for frame in self.frames)))

    @cached_property
    def lowest_hz(self) -> float:
        """Lowest frequency of all frames [Hz]."""
        return min(
            float(np.sqrt(max(eigh(frame.stiffness, frame.mass, eigvals_only=True)[0], 0.0))) / (2 * np.pi)
            for frame in self.frames
        )

    def first(self, frame: int) -> int:
        """Return the index of a frame's first floor (and storey) among all."""
        return sum(other.floors for other in self.frames[:frame])

    def span(self, frame: int) -> slice:
        """Return the floors of a frame among all."""
        start = self.first(frame)
        return slice(start, start + self.frames[frame].floors)

    def index(self, name: str) -> int:
        """Return the number of the frame of that name."""
        return [frame.name for frame in self.frames].index(name)

    @cached_property
    def couplings(self) -> list[tuple[int, int]]:
        """Pairs of modes, numbered among those of all frames, that the damping of a frame may couple."""
        return [
            (self.first(number) + one, self.first(number) + other)
            for number, one, other in self.discrepancies
            if one != other
        ]

    @cached_property
    def coupling_size(self) -> np.ndarray:
        """Geometric mean of both modes' damping in the baseline frame [1/s] for each of `couplings`, shape (pairs,)."""
        omega = [solve_modes(frame.mass, frame.stiffness)[0] for frame in self.frames]
        damping = 2.0 * np.concatenate(omega) * np.concatenate([frame.damping_ratio for frame in self.frames])
        return np.array([np.sqrt(damping[one] * damping[other]) for one, other in self.couplings])

    @cached_property
    def discrepancies(self) -> list[tuple[int, int, int]]:
        """Frame and pair of modes (all from 0) of each number by which its stiffness may be other than the model's."""
        return [
            (number, one, other)
            for number, frame in enumerate(self.frames)
            for one, other in frame.discrepancies
        ]

    def place(self, storey: int) -> tuple[str, int]:
        """Return frame and storey (or floor) number from 1 of an index among all."""
        for number, frame in enumerate(self.frames):
            if storey < self.first(number) + frame.floors:
                return frame.name, storey - self.first(number) + 1
        raise IndexError(storey)


LIGHTEST = 1e-3
"""Share of the heaviest floor that any keeps in a trial that would leave it nothing."""
SLOWEST = 1e-2
"""Share of the highest frequency that any mode keeps in a trial that would leave it no stiffness."""
NONE_LEFT = 1e-4
"""Share of the highest frequency below which a mode has no stiffness: that of no building that stands is so low."""


def solve_modes(mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return angular frequencies [rad/s] and mass-normalised shapes; a mass or stiffness that is not positive is made so.

    Args:
        mass, stiffness: Matrices of a frame, or of a trial of it, each (floors, floors) [kg] and [N/m].
    """
    squares, shapes = squared(mass, stiffness)
    signs = np.sign(shapes.sum(axis=0))
    highest = np.abs(squares).max()
    kept = np.where(squares > NONE_LEFT**2 * highest, squares, SLOWEST**2 * highest)
    return np.sqrt(kept), shapes * np.where(signs == 0, 1.0, signs)


def squared(mass: np.ndarray, stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return squared angular frequencies [rad^2/s^2], which may be negative, and mass-normalised shapes.

    A trial may take more from a floor than it has, when an effect and the calibration both do: a mass that is not positive
    is made so.

    Args:
        mass, stiffness: Matrices of a frame, or of a trial of it, each (floors, floors) [kg] and [N/m].
    """
    try:
        squares, shapes = eigh(stiffness, mass)
    except np.linalg.LinAlgError:
        own, floors = np.linalg.eigh(mass)
        lightest = LIGHTEST * float(np.abs(own).max())
        squares, shapes = eigh(stiffness, floors * np.maximum(own, lightest) @ floors.T)
    return squares, shapes
