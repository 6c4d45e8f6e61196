"""Exponential integration of modal equations with a few local forces of any law.

The linear part is exact for forces that are linear between two steps; the local forces are found by
fixed-point iteration at the end of each step (an exponential trapezoidal rule, second order; Hochbruck and
Ostermann 2010, Acta Numerica 19, section 2). Nothing of the engine that the diagnosis uses is in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import mul
from typing import Protocol

import numpy as np
from scipy.linalg import expm
from scipy.signal import lfilter

from pounding.diagnosis.hidden.modes import Modes

CORRECTIONS = 3
"""Most fixed-point iterations of the local forces in each step."""

FINER = 8
"""Parts of a step in which a contact may be closed."""

NEAR_M = 2e-5
"""Distance from which a contact counts as near [m]."""

SETTLED = 1e-9
"""Relative change of a force that ends them."""


class Law(Protocol):
    """A local force with a memory; positive resists a positive deformation."""

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the force [N] for a trial deformation [m] and rate [m/s] at `time` [s]; change no memory.

        Args:
            time: Time [s].
            deformation: Deformation that is tried [m].
            rate: Its time derivative [m/s].
            step: Time since the last accepted state [s].
        """

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Take the last trial as what happened.

        Args:
            time: Time [s].
            deformation: Deformation that was reached [m].
            rate: Its time derivative [m/s].
            step: Time since the last accepted state [s].
        """


@dataclass(frozen=True)
class Local:
    """A law and the row of modal coordinates that it stretches.

    Attributes:
        law: The law.
        row: Deformation per modal coordinate, shape (modes,); the force acts against it on the same row.
        carried: Rate that the table adds to the deformation's [m/s], shape (steps + 1,), or None.
    """

    law: Law
    row: np.ndarray
    carried: np.ndarray | None = None


@dataclass(frozen=True)
class Response:
    """Modal displacement, rate and acceleration, (modes, samples) each, and local forces, (laws, samples)."""

    q: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    forces: np.ndarray


def integrate(modes: Modes, drive: np.ndarray, step_s: float, locals_: Sequence[Local] = ()) -> Response:
    """Return the response from rest.

    Args:
        modes: The structure.
        drive: Generalised force per unit modal mass, shape (modes, samples).
        step_s: Time between samples [s].
        locals_: Local forces beside the drive.
    """
    count = len(modes.omega)
    system = np.block([[np.zeros((count, count)), np.eye(count)], [-np.diag(modes.omega**2), -modes.damping]])
    flow, early, late = _propagators(system, count, step_s)
    rows = np.array([local.row for local in locals_]).reshape(len(locals_), count)
    forces = np.zeros((len(locals_), drive.shape[1]))
    if locals_:
        states = _march(system, drive, rows, locals_, step_s, forces)
    else:
        states = _filtered(flow, early @ drive[:, :-1] + late @ drive[:, 1:])
    q, rate = states[:count], states[count:]
    acceleration = drive - modes.omega[:, None] ** 2 * q - modes.damping @ rate - rows.T @ forces
    return Response(q, rate, acceleration, forces)


def _filtered(flow: np.ndarray, driven: np.ndarray) -> np.ndarray:
    """Return the states of x[k + 1] = flow x[k] + driven[k] from rest; each eigenvector is a filter."""
    poles, vectors = np.linalg.eig(flow)
    # Of a conjugate pair one is enough.
    kept = np.flatnonzero(poles.imag >= 0)
    weight = np.where(poles[kept].imag > 0, 2.0, 1.0)
    parts = np.linalg.inv(vectors)[kept] @ driven
    summed = np.array(
        [lfilter([1.0], [1.0, -pole], part) for pole, part in zip(poles[kept], parts, strict=True)]
    )
    return np.column_stack([np.zeros(len(flow)), ((vectors[:, kept] * weight) @ summed).real])


def _propagators(system: np.ndarray, count: int, step_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the flow of a step and the effect of the forces at its start and its end (first-order hold)."""
    size = 2 * count
    grown = np.zeros((size + 2 * count, size + 2 * count))
    grown[:size, :size] = system * step_s
    grown[count:size, size : size + count] = step_s * np.eye(count)
    grown[size : size + count, size + count :] = np.eye(count)
    powers = expm(grown)
    late = powers[:size, size + count :]
    return powers[:size, :size], powers[:size, size : size + count] - late, late


class _Stepper:
    """One length of step: the flow of the states, and what forces at its two ends do."""

    def __init__(self, system: np.ndarray, rows: np.ndarray, step_s: float) -> None:
        kinds, count = rows.shape
        self.step_s = step_s
        self.flow, early, late = _propagators(system, count, step_s)
        self.drive_early, self.drive_late = early, late
        self.early, self.late = -early @ rows.T, -late @ rows.T
        self.observe = np.zeros((2 * kinds, 2 * count))
        self.observe[:kinds, :count] = rows
        self.observe[kinds:, count:] = rows
        self.seen_late = [[float(entry) for entry in line] for line in self.observe @ self.late]

    def free(self, state: np.ndarray, push: np.ndarray, force: list[float], carried: list[float]) -> Free:
        """Return the state without the forces at the step's end, and its deformations and rates."""
        free = self.flow @ state + push + self.early @ force
        seen = (self.observe @ free).tolist()
        for i, rate in enumerate(carried):
            seen[len(carried) + i] += rate
        return free, seen

    def settle(
        self, laws: Sequence[Law], time: float, free: Free, force: list[float]
    ) -> tuple[np.ndarray, list[float]]:
        """Return the state and the forces at the end of the step."""
        state, seen = free
        kinds = len(laws)
        for _ in range(CORRECTIONS):
            now = [seen[j] + _dot(self.seen_late[j], force) for j in range(2 * kinds)]
            last, force = (
                force,
                [law.force(time, now[i], now[kinds + i], self.step_s) for i, law in enumerate(laws)],
            )
            if all(abs(one - other) <= SETTLED * abs(one) for one, other in zip(force, last, strict=True)):
                break
        for i, law in enumerate(laws):
            law.accept(time, now[i], now[kinds + i], self.step_s)
        return state + self.late @ force, force


Free = tuple[np.ndarray, list[float]]


def _march(
    system: np.ndarray,
    drive: np.ndarray,
    rows: np.ndarray,
    locals_: Sequence[Local],
    step_s: float,
    forces: np.ndarray,
) -> np.ndarray:
    """Return the states, (2 modes, samples), and fill `forces`, both step by step.

    A step in which a contact may be closed is taken in `FINER` parts; its force is then the mean over them.
    """
    laws = [local.law for local in locals_]
    gaps = [(i, law.closes_at) for i, law in enumerate(laws) if hasattr(law, "closes_at")]
    coarse = _Stepper(system, rows, step_s)
    fine = _Stepper(system, rows, step_s / FINER) if gaps else coarse
    samples = drive.shape[1]
    carried = np.zeros((samples, len(laws)))
    for i, local in enumerate(locals_):
        if local.carried is not None:
            carried[:, i] = local.carried
    pushes = np.ascontiguousarray((coarse.drive_early @ drive[:, :-1] + coarse.drive_late @ drive[:, 1:]).T)
    states = np.zeros((samples, len(system)))
    state = states[0]
    force = [law.force(0.0, 0.0, float(carried[0, i]), step_s) for i, law in enumerate(laws)]
    forces[:, 0] = force
    for index, push in enumerate(pushes):
        free = coarse.free(state, push, force, carried[index + 1].tolist())
        # Near enough to meet within the step, or still together at its start.
        if any(free[1][i] > gap - NEAR_M or force[i] > 0.0 for i, gap in gaps):
            ends = drive[:, index], drive[:, index + 1]
            state, force, mean = _in_parts(
                fine, laws, index * step_s, state, force, ends, carried[index + 1].tolist()
            )
        else:
            state, force = coarse.settle(laws, (index + 1) * step_s, free, force)
            mean = force
        states[index + 1] = state
        forces[:, index + 1] = mean
    return states.T


def _in_parts(
    fine: _Stepper,
    laws: Sequence[Law],
    time: float,
    state: np.ndarray,
    force: list[float],
    ends: tuple[np.ndarray, np.ndarray],
    carried: list[float],
) -> tuple[np.ndarray, list[float], list[float]]:
    """Return state, forces and mean forces after a step taken in parts."""
    total = np.zeros(len(laws))
    for part in range(FINER):
        early = ends[0] + (ends[1] - ends[0]) * part / FINER
        late = ends[0] + (ends[1] - ends[0]) * (part + 1) / FINER
        push = fine.drive_early @ early + fine.drive_late @ late
        free = fine.free(state, push, force, carried)
        state, force = fine.settle(laws, time + (part + 1) * fine.step_s, free, force)
        total += force
    return state, force, (total / FINER).tolist()


def _dot(one: list[float], other: list[float]) -> float:
    product: float = sum(map(mul, one, other))
    return product
