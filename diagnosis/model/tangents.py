"""Laws about a motion, to first order: what a small change of the motion changes of their forces and of their memories."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from pounding.calling import MEMORY, called_at
from pounding.diagnosis.model.kalman import LinearSystem
from pounding.diagnosis.model.laws import PlacedLaw, placed_arrays
from pounding.diagnosis.model.storeys import Modes

NUDGE = 1e-5
"""Change of drift, rate and memory by which slopes are taken, as a share of the largest."""


@dataclass(frozen=True)
class Tangents:
    """Laws along a run's motion, where the predictor evaluates them: at each sample, and at the middle of each substep.

    Attributes:
        rows: Modal row of the drift on which each law acts, shape (laws, modes).
        room: 1 where it acts on the rate in the room, which has the table's in it, else 0, shape (laws,).
        forces: Force of each law [N] at each sample as predicted and in the middle of each substep, shape (samples, 1 +
            substeps, laws).
        left: Its force at each sample where the filter leaves the motion [N], shape (samples, laws).
        at_sample: Slopes of the force at a sample by drift, rate and what the law remembers, shape (samples, laws, 2 +
            remembered).
        within: Slopes of the force in the middle of each substep, and of what the law remembers after it, by drift and rate
            there and what it remembered before, shape (samples, substeps, laws, 1 + remembered, 2 + remembered).
        half: What half a substep makes of the states, and forces held over it, as `LinearSystem.held` has them.
    """

    rows: np.ndarray
    room: np.ndarray
    forces: np.ndarray
    left: np.ndarray
    at_sample: np.ndarray
    within: np.ndarray
    half: tuple[np.ndarray, np.ndarray]

    @property
    def answers(self) -> np.ndarray:
        """Whether any slope of a law is by its drift, and by its rate, shape (2, laws)."""
        by_sample = self.at_sample[..., :2].any(axis=0)
        return np.asarray((by_sample | self.within[..., :2].any(axis=(0, 1, 3))).T)

    def unanswering(self) -> Tangents:
        """Return the laws as if a change of the motion changed none of their forces."""
        return replace(self, at_sample=0.0 * self.at_sample, within=0.0 * self.within)


@dataclass(frozen=True)
class Along:
    """A run's motion as laws meet it.

    Attributes:
        before, after: States as predicted and as the filter leaves them, each (samples, states).
        middle: Drift [m] and rate [m/s] of each law in the middle of each substep, shape (samples, substeps, laws, 2).
        step_s: Sampling step [s].
    """

    before: np.ndarray
    after: np.ndarray
    middle: np.ndarray
    step_s: float


@dataclass(frozen=True)
class _Met:
    """Laws and the motion that they meet: at each sample as predicted and as left, then in the middle of each substep.

    Attributes:
        laws: Address of each law. parameters: Its parameters, shape (laws, parameters).
        rows, room: Of `Tangents`.
        drift, rate: On which each law acts, shape (laws, samples, 2 + substeps) [m] and [m/s].
        step_s: Sampling step [s].
    """

    laws: np.ndarray
    parameters: np.ndarray
    rows: np.ndarray
    room: np.ndarray
    drift: np.ndarray
    rate: np.ndarray
    step_s: float

    @classmethod
    def of(cls, placed: Sequence[PlacedLaw], modes: Modes, along: Along) -> _Met:
        samples, substeps = along.middle.shape[:2]
        n, step_s = len(modes.omega), along.step_s
        laws, rows, room, parameters = placed_arrays(
            placed, modes.floors, step_s * (samples - 1), step_s / substeps
        )
        each = np.empty((2, len(placed), samples, 2 + substeps))
        for number, states in enumerate((along.before, along.after)):
            each[0, :, :, number] = rows @ states[:, :n].T
            each[1, :, :, number] = rows @ states[:, n : 2 * n].T + room[:, None] * states[:, -1]
        each[:, :, :, 2:] = along.middle.transpose(3, 2, 0, 1)
        return cls(laws, parameters, rows, room, each[0], each[1], step_s)

    def forces(self, j: int, left: bool = True) -> tuple[np.ndarray, np.ndarray]:
        """Return the forces of a law, (samples, 2 + substeps), and what it remembered before each, (..., MEMORY).

        Those that the filter leaves are zero unless they are wanted.
        """
        force = np.zeros(self.drift.shape[1:])
        memory = np.zeros((*force.shape, MEMORY))
        motion = self.drift[j], self.rate[j], self.step_s
        _forces(self.laws[j], self.parameters[j], *motion, left, force, memory)
        return force, memory


def law_forces(placed: Sequence[PlacedLaw], modes: Modes, along: Along) -> np.ndarray:
    """Return the forces of laws along a run [N], at each sample as predicted and in the middle of each substep.

    Args:
        placed: The laws at their places.
        modes: Modes of the run.
        along: Its motion.

    Returns:
        Shape (samples, 1 + substeps, laws).
    """
    met = _Met.of(placed, modes, along)
    forces = [met.forces(j, left=False)[0] for j in range(len(placed))]
    return np.delete(np.stack(forces, axis=2), 1, axis=1)


def tangents(placed: Sequence[PlacedLaw], modes: Modes, system: LinearSystem, along: Along) -> Tangents:
    """Return the slopes of laws along a run.

    Args:
        placed: The laws at their places; one at least.
        modes: Modes of the run.
        system: The linear system of these.
        along: Its motion.
    """
    met = _Met.of(placed, modes, along)
    remembered, (laws, samples, each) = max(one.law.followed for one in placed), met.drift.shape
    forces = np.zeros((samples, each, laws))
    # Of what laws answer, single precision is enough.
    at_sample = np.zeros((samples, laws, 2 + remembered), np.float32)
    within = np.zeros((samples, each - 2, laws, 1 + remembered, 2 + remembered), np.float32)
    for j, address in enumerate(met.laws):
        forces[:, :, j], memory = met.forces(j)
        moved = met.drift[j], met.rate[j], *np.moveaxis(memory, -1, 0)[: placed[j].law.followed]
        nudge = NUDGE * np.array([np.abs(one).max() for one in moved])
        slopes = np.zeros((samples, each, 1 + remembered, 2 + remembered))
        _slopes(address, met.parameters[j], met.drift[j], met.rate[j], met.step_s, nudge, memory, slopes)
        # Where the motion has blown up there is no slope.
        slopes[~np.isfinite(slopes)] = 0.0
        at_sample[:, j], within[:, :, j] = slopes[:, 0, 0], slopes[:, 2:]
    used = 1 + np.flatnonzero(within[..., 1:, :].any(axis=(0, 1, 2, 4)))
    if len(used) < remembered:
        at_sample = np.ascontiguousarray(at_sample[..., np.r_[0, 1, 1 + used]])
        within = np.ascontiguousarray(within[..., np.r_[0, used], :][..., np.r_[0, 1, 1 + used]])
    return Tangents(
        rows=met.rows,
        room=met.room,
        forces=np.delete(forces, 1, axis=1),
        left=forces[:, 1],
        at_sample=at_sample,
        within=within,
        half=system.held(along.step_s / (2 * along.middle.shape[1])),
    )


@njit(cache=True)
def _forces(
    address: int,
    parameters: np.ndarray,
    drift: np.ndarray,
    rate: np.ndarray,
    step_s: float,
    left: bool,
    forces: np.ndarray,
    memory: np.ndarray,
) -> None:
    """Fill in the forces of one law, (samples, 2 + substeps), and what it remembered before each, (..., remembered).

    At a sample a law is only asked, as the predictor asks it: it remembers what it does in the substeps. What the filter
    leaves there is `left` out if it is not wanted.
    """
    samples, each = drift.shape
    now, new = np.zeros(memory.shape[2]), np.zeros(memory.shape[2])
    numbers, remembered, then = parameters.ctypes.data, now.ctypes.data, new.ctypes.data
    for k in range(samples):
        for i in range(each):
            if i == 1 and not left:
                continue
            time = step_s * (k if i < 2 else k + (i - 1.5) / (each - 2))
            for m in range(now.size):
                memory[k, i, m] = now[m]
            forces[k, i] = called_at(address, numbers, remembered, drift[k, i], rate[k, i], time, then)
            if i >= 2:
                for m in range(now.size):
                    now[m] = new[m]


@njit(cache=True)
def _slopes(
    address: int,
    parameters: np.ndarray,
    drift: np.ndarray,
    rate: np.ndarray,
    step_s: float,
    nudge: np.ndarray,
    memory: np.ndarray,
    slopes: np.ndarray,
) -> None:
    """Fill in the slopes of one law's forces and of its memories, shape (samples, 2 + substeps, 1 + most, 2 + most).

    `nudge` is by how much drift [m], rate [m/s] and each memory that is followed are changed, shape (2 + memories,); what
    is always zero is not. What the filter leaves at a sample has none.
    """
    samples, each = drift.shape
    there, new = np.zeros(MEMORY), np.zeros(MEMORY)
    numbers, remembered, then = parameters.ctypes.data, there.ctypes.data, new.ctypes.data
    for k in range(samples):
        for i in range(each):
            if i == 1:
                continue
            time = step_s * (k if i < 2 else k + (i - 1.5) / (each - 2))
            for m in range(MEMORY):
                there[m] = memory[k, i, m]
            for n in range(nudge.size):
                if nudge[n] == 0.0:
                    continue
                for side in (1.0, -1.0):
                    by = side / (2.0 * nudge[n])
                    d, v = drift[k, i], rate[k, i]
                    if n == 0:
                        d += side * nudge[0]
                    elif n == 1:
                        v += side * nudge[1]
                    else:
                        there[n - 2] = memory[k, i, n - 2] + side * nudge[n]
                    slopes[k, i, 0, n] += by * called_at(address, numbers, remembered, d, v, time, then)
                    for m in range(nudge.size - 2):
                        slopes[k, i, 1 + m, n] += by * new[m]
                if n >= 2:
                    there[n - 2] = memory[k, i, n - 2]
