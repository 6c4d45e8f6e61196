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

from diagnosis.hidden.modes import Modes

CORRECTIONS = 3
"""Most fixed-point iterations of the local forces in each step."""

SETTLED = 1e-9
"""Relative change of a force that ends them."""


class Law(Protocol):
    """A local force with a memory; positive resists a positive deformation."""

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the force [N] for a trial deformation [m] and rate [m/s] at `time` [s]; change no memory."""

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Take the last trial as what happened."""


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
    driven = early @ drive[:, :-1] + late @ drive[:, 1:]
    forces = np.zeros((len(locals_), drive.shape[1]))
    if locals_:
        states = np.zeros((2 * count, drive.shape[1]))
        _march(flow, driven, -early @ rows.T, -late @ rows.T, rows, locals_, step_s, states, forces)
    else:
        states = _filtered(flow, driven)
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


def _march(
    flow: np.ndarray,
    driven: np.ndarray,
    early: np.ndarray,
    late: np.ndarray,
    rows: np.ndarray,
    locals_: Sequence[Local],
    step_s: float,
    states: np.ndarray,
    forces: np.ndarray,
) -> None:
    """Fill `states` and `forces` step by step."""
    laws = [local.law for local in locals_]
    count, kinds = rows.shape[1], len(laws)
    observe = np.zeros((2 * kinds, 2 * count))
    observe[:kinds, :count] = rows
    observe[kinds:, count:] = rows
    carried = np.array([
        np.zeros(states.shape[1]) if local.carried is None else local.carried for local in locals_
    ])  # fmt: skip
    seen_late = [[float(entry) for entry in line] for line in observe @ late]
    # Column by column in memory, because the loop walks through time.
    states_in_time = np.zeros((states.shape[1], states.shape[0]))
    pushes = np.ascontiguousarray(driven.T)
    state = np.zeros(2 * count)
    force = [law.force(0.0, 0.0, float(carried[i, 0]), step_s) for i, law in enumerate(laws)]
    forces[:, 0] = force
    numbers = range(kinds)
    for index, push in enumerate(pushes):
        free = flow @ state + push + early @ force
        seen = (observe @ free).tolist()
        time = (index + 1) * step_s
        for i in numbers:
            seen[kinds + i] += carried[i, index + 1]
        for _ in range(CORRECTIONS):
            now = [seen[j] + _dot(seen_late[j], force) for j in range(2 * kinds)]
            last, force = (
                force,
                [law.force(time, now[i], now[kinds + i], step_s) for i, law in enumerate(laws)],
            )
            if all(abs(force[i] - last[i]) <= SETTLED * abs(force[i]) for i in numbers):
                break
        for i in numbers:
            laws[i].accept(time, now[i], now[kinds + i], step_s)
        state = free + late @ force
        states_in_time[index + 1] = state
        forces[:, index + 1] = force
    states[:] = states_in_time.T


def _dot(one: list[float], other: list[float]) -> float:
    return sum(map(mul, one, other))
