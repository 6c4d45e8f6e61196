"""Laws about a motion, to first order: what a small change of the motion changes of their forces and of their memories."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from pounding.calling import MEMORY, called
from pounding.diagnosis.model.laws import PlacedLaw, placed_arrays
from pounding.diagnosis.model.storeys import Modes

NUDGE = 1e-5
"""Change of drift, rate and memory by which slopes are taken, as a share of the largest."""


@dataclass(frozen=True)
class Tangents:
    """Laws along a run's motion, as predicted before each sample and as the filter leaves it there: two rows a sample.

    Attributes:
        rows: Modal row of the drift on which each law acts, shape (laws, modes).
        room: 1 where it acts on the rate in the room, which has the table's in it, else 0, shape (laws,).
        forces: Force of each law [N], shape (2 samples, laws).
        slopes: Of this force and of what the law remembers then, by drift, rate and what it remembered, shape
            (2 samples, laws, 1 + remembered, 2 + remembered).
    """

    rows: np.ndarray
    room: np.ndarray
    forces: np.ndarray
    slopes: np.ndarray


@dataclass(frozen=True)
class _Along:
    """Laws along a run: each sample twice, as predicted and as the filter leaves it.

    Attributes:
        laws: Address of each law. parameters: Its parameters, shape (laws, parameters).
        rows, room: Of `Tangents`.
        drift, rate: On which each law acts, shape (laws, 2 samples) [m] and [m/s].
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
    def of(
        cls, placed: Sequence[PlacedLaw], modes: Modes, states: tuple[np.ndarray, np.ndarray], step_s: float
    ) -> _Along:
        samples, n = len(states[0]), len(modes.omega)
        laws, rows, room, parameters = placed_arrays(placed, modes.floors, step_s * (samples - 1))
        both = np.stack(states, axis=1).reshape(2 * samples, -1)
        drift = rows @ both[:, :n].T
        rate = rows @ both[:, n : 2 * n].T + room[:, None] * both[:, -1]
        return cls(laws, parameters, rows, room, drift, rate, step_s)


def law_forces(
    placed: Sequence[PlacedLaw], modes: Modes, states: tuple[np.ndarray, np.ndarray], step_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces of laws along a run [N], (2 samples, laws), and the modal rows on which they act, (laws, modes).

    Args:
        placed: The laws at their places.
        modes: Modes of the run.
        states: Its states as predicted and as the filter leaves them, each (samples, states).
        step_s: Sampling step [s].
    """
    along = _Along.of(placed, modes, states, step_s)
    forces = np.zeros(along.drift.shape)
    for j, address in enumerate(along.laws):
        memory = np.zeros((along.drift.shape[1], MEMORY))
        _forces(address, along.parameters[j], along.drift[j], along.rate[j], step_s, forces[j], memory)
    return np.ascontiguousarray(forces.T), along.rows


def tangents(
    placed: Sequence[PlacedLaw], modes: Modes, states: tuple[np.ndarray, np.ndarray], step_s: float
) -> Tangents | None:
    """Return the slopes of laws along a run, None where there is no law.

    Args:
        placed: The laws at their places.
        modes: Modes of the run.
        states: Its states as predicted and as the filter leaves them, each (samples, states).
        step_s: Sampling step [s].
    """
    if not placed:
        return None
    along = _Along.of(placed, modes, states, step_s)
    remembered = max(one.law.followed for one in placed)
    forces = np.zeros(along.drift.shape)
    each = np.zeros((*forces.shape, 1 + remembered, 2 + remembered))
    for j, address in enumerate(along.laws):
        motion = along.parameters[j], along.drift[j], along.rate[j], step_s
        memory = np.zeros((along.drift.shape[1], MEMORY))
        _forces(address, *motion, forces[j], memory)
        moved = along.drift[j], along.rate[j], *memory.T[: placed[j].law.followed]
        nudge = NUDGE * np.array([np.abs(one).max() for one in moved])
        _slopes(address, *motion, nudge, memory, each[j])
    slopes = each.swapaxes(0, 1)
    used = 1 + np.flatnonzero(slopes[:, :, 1:].any(axis=(0, 1, 3)))
    slopes = slopes[:, :, np.r_[0, used]][..., np.r_[0, 1, 1 + used]]
    # Where the motion has blown up there is no slope.
    slopes = np.ascontiguousarray(np.where(np.isfinite(slopes), slopes, 0.0))
    return Tangents(along.rows, along.room, np.ascontiguousarray(forces.T), slopes)


@njit(cache=True)
def _forces(
    address: int,
    parameters: np.ndarray,
    drift: np.ndarray,
    rate: np.ndarray,
    step_s: float,
    forces: np.ndarray,
    memory: np.ndarray,
) -> None:
    """Fill in the forces of one law, shape (2 samples,), and what it remembered before each, (2 samples, remembered)."""
    new = np.zeros(memory.shape[1])
    for k in range(drift.size):
        for i in range(new.size):
            new[i] = memory[k, i]
        forces[k] = called(address, parameters, memory[k], drift[k], rate[k], step_s * (k // 2), new)
        if k + 1 < drift.size:
            for i in range(new.size):
                memory[k + 1, i] = new[i]


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
    """Fill in the slopes of one law's forces and of its memories, shape (2 samples, 1 + most, 2 + most).

    `nudge` is by how much drift [m], rate [m/s] and each memory that is followed are changed, shape (2 + memories,); what
    is always zero is not.
    """
    there, new = np.zeros(MEMORY), np.zeros(MEMORY)
    for k in range(drift.size):
        time = step_s * (k // 2)
        for i in range(nudge.size):
            if nudge[i] == 0.0:
                continue
            for side in (1.0, -1.0):
                by = side / (2.0 * nudge[i])
                d, v = drift[k], rate[k]
                for j in range(MEMORY):
                    there[j], new[j] = memory[k, j], 0.0
                if i == 0:
                    d += side * nudge[0]
                elif i == 1:
                    v += side * nudge[1]
                else:
                    there[i - 2] += side * nudge[i]
                slopes[k, 0, i] += by * called(address, parameters, there, d, v, time, new)
                for j in range(nudge.size - 2):
                    slopes[k, 1 + j, i] += by * new[j]
