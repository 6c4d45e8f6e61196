"""The motion of a linear frame by its modes, quick enough to fit frames to readings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.linalg import eigh

from tests.planar_world.baseline import Real
from tests.planar_world.integration import DURATION_S, Motion
from tests.planar_world.measuring import SAMPLES, SAMPLING_HZ, Channel

MODAL_STEP_S = 5e-4
EVERY = round(1 / SAMPLING_HZ / MODAL_STEP_S)
TIMES: Real = np.arange(round(DURATION_S / MODAL_STEP_S) + 1, dtype=np.float64) * MODAL_STEP_S


def modal_readings(
    mass: Real, stiffness: Real, ratios: Real, tables: Sequence[Real], channels: Sequence[Channel]
) -> Real:
    """Return what ideal sensors read of a frame (times of all runs, channels), in their units.

    Args:
        mass: (floors, floors) [kg].
        stiffness: (floors, floors) [N/m].
        ratios: Damping ratios of the modes (modes,) [-].
        tables: The table's acceleration at `TIMES` in each run (times,) [m/s^2].
        channels: All but the table's.
    """
    squares, shapes = eigh(stiffness, mass)
    circular = np.sqrt(squares)
    share = shapes.T @ mass @ np.ones(len(mass))
    found = []
    for table in tables:
        moved, rate = _oscillators(circular, ratios, table, MODAL_STEP_S)
        moved, rate = moved[::EVERY], rate[::EVERY]
        pull = -(2 * ratios * circular * rate + circular * circular * moved)
        motion = Motion((moved * share) @ shapes.T, (pull * share) @ shapes.T)
        found.append(np.column_stack([channel.reads(motion)[:SAMPLES] for channel in channels]))
    return np.concatenate(found)


@njit(cache=True)
def _oscillators(circular: Real, ratios: Real, table: Real, step: float) -> tuple[Real, Real]:
    """Return displacements and velocities (times, modes) of oscillators, exact for a force linear over a step.

    Args:
        circular: Circular frequencies (modes,) [rad/s].
        ratios: Damping ratios (modes,) [-].
        table: Its acceleration (times,) [m/s^2].
        step: [s].
    """
    displacements = np.zeros((len(table), len(circular)))
    velocities = np.zeros((len(table), len(circular)))
    for mode in range(len(circular)):
        w, z = circular[mode], ratios[mode]
        damped = w * np.sqrt(1 - z**2)
        decay, sine, cosine = np.exp(-z * w * step), np.sin(damped * step), np.cos(damped * step)
        a11, a12 = decay * (cosine + z * w / damped * sine), decay * sine / damped
        a21, a22 = -(w**2) * decay * sine / damped, decay * (cosine - z * w / damped * sine)
        q = v = 0.0
        for index in range(len(table) - 1):
            force = -table[index]
            slope = (-table[index + 1] - force) / step
            # The particular solution is a straight line.
            level, rising = force / w**2 - 2 * z * slope / w**3, slope / w**2
            dq, dv = q - level, v - rising
            q = a11 * dq + a12 * dv + level + rising * step
            v = a21 * dq + a22 * dv + rising
            displacements[index + 1, mode] = q
            velocities[index + 1, mode] = v
    return displacements, velocities
