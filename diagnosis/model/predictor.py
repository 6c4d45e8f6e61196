"""The one loop over time: modal frames with effects, corrected by each sample as far as a gain says.

With a gain of zero it is a simulator; with the steady Kalman gain it predicts each sample from those before it.
Forces are evaluated at the middle of each substep (exponential midpoint rule, second order), the linear modes are exact.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pounding.calling import MEMORY, called_at

Real = NDArray[Any]

# What a channel measures.
ACCELERATION, DISPLACEMENT, VELOCITY, ABSOLUTE_DISPLACEMENT, TABLE_DISPLACEMENT = range(5)

TABLE_MOVED, TABLE_VELOCITY = -2, -1
"""Where the table's displacement [m] and velocity [m/s] are among the states, whatever the number of modes."""

LEAK = 2.0 * math.pi * 0.002
"""[rad/s] below which the table's displacement, integrated from its acceleration, is forgotten: far below a run's."""


@njit(cache=True)
def _effect_forces(
    laws: Real,
    rows: Real,
    room: Real,
    parameters: Real,
    memory: Real,
    new: Real,
    eta: Real,
    rate: Real,
    table_rate: float,
    time: float,
    keep: bool,
    force: Real,
) -> None:
    """Add the modal forces of all effects; `rows` holds for each the modal row of its drift."""
    modes = eta.size
    numbers, remembered, then = parameters.ctypes.data, memory.ctypes.data, new.ctypes.data
    of_parameters, of_memory = 8 * parameters.shape[1], 8 * memory.shape[1]
    for j in range(laws.size):
        d = 0.0
        v = room[j] * table_rate
        for m in range(modes):
            d += rows[j, m] * eta[m]
            v += rows[j, m] * rate[m]
        before, after = remembered + j * of_memory, then + j * of_memory
        pull = -called_at(laws[j], numbers + j * of_parameters, before, d, v, time, after)
        if keep:
            for i in range(memory.shape[1]):
                memory[j, i] = new[j, i]
        for m in range(modes):
            force[m] += rows[j, m] * pull


@njit(cache=True)
def _advance(steps: Real, eta: Real, rate: Real, force: Real, new_eta: Real, new_rate: Real) -> None:
    for m in range(eta.size):
        new_eta[m] = steps[m, 0] * eta[m] + steps[m, 1] * rate[m] + steps[m, 4] * force[m]
        new_rate[m] = steps[m, 2] * eta[m] + steps[m, 3] * rate[m] + steps[m, 5] * force[m]


@njit(cache=True)
def predict(
    modes: Real,
    half: Real,
    full: Real,
    participation: Real,
    floors: Real,
    latent_rows: Real,
    known_mid: Real,
    known_at: Real,
    table_mid: Real,
    quantities: Real,
    channel_floor: Real,
    measured: Real,
    gain: Real,
    decay: Real,
    step_s: float,
    laws: Real,
    rows: Real,
    room: Real,
    parameters: Real,
) -> tuple[Real, Real, Real, Real]:
    """Run the predictor over one run.

    Args:
        modes: Angular frequency [rad/s] and damping ratio of each mode, shape (modes, 2).
        half, full: Exact step matrices of each mode over half a substep and a whole one, shape (modes, 6):
            a11, a12, a21, a22 and the response of both states to a constant modal force.
        participation: Modal participation of a unit table acceleration, shape (modes,).
        floors: Mass-normalised shapes at the floors, shape (floors, modes).
        latent_rows: Modal rows of the drifts on which latent forces act, shape (storeys, modes).
        known_mid: Known modal forces but the table's at the middle of each substep, shape (samples, substeps, modes).
        known_at: The same at the samples, shape (samples, modes).
        table_mid: Table acceleration at the middle of the substeps [m/s^2], shape (samples, substeps).
        quantities, channel_floor: What each channel measures, and at which floor (0 is the first), shape (channels,).
        measured: Measured samples in SI, NaN where missing, shape (samples, channels).
        gain: Filter gain, shape (2 modes + storeys + 3, channels); zeros for a simulation.
        decay: Rates of the latent forces and of the table noise [1/s], shape (2,).
        step_s: Sampling step [s].
        laws: Address of each effect's law (`pounding.diagnosis.model.laws`), shape (effects,).
        rows: Modal row of the drift on which it acts, shape (effects, modes).
        room: 1 where it acts on the rate in the room, which has the table's in it, else 0, shape (effects,).
        parameters: Its parameters in SI, shape (effects, PARAMETERS).

    Returns:
        Innovations (samples, channels), NaN samples as zero; predicted states (samples, states); filtered states;
        outputs as predicted (samples, channels).
    """
    samples, channels = measured.shape
    n = modes.shape[0]
    storeys = latent_rows.shape[0]
    states = 2 * n + storeys + 3
    substeps = table_mid.shape[1]
    h = step_s / substeps
    latent_half = math.exp(-decay[0] * h / 2)
    noise_half = math.exp(-decay[1] * h / 2)
    z = np.zeros(states)
    innovations = np.zeros((samples, channels))
    outputs = np.zeros((samples, channels))
    before = np.zeros((samples, states))
    after = np.zeros((samples, states))
    memory = np.zeros((laws.size, MEMORY))
    new = np.zeros((laws.size, MEMORY))
    force = np.zeros(n)
    last = np.zeros(n)
    eta_mid = np.zeros(n)
    rate_mid = np.zeros(n)
    new_eta = np.zeros(n)
    new_rate = np.zeros(n)
    eta = z[:n]
    rate = z[n : 2 * n]
    correcting = False
    for i in range(states):
        for c in range(channels):
            if gain[i, c] != 0.0:
                correcting = True
    for k in range(samples):
        before[k] = z
        time = k * step_s
        for m in range(n):
            force[m] = known_at[k, m] - modes[m, 0] ** 2 * eta[m] - 2.0 * modes[m, 0] * modes[m, 1] * rate[m]
        for s in range(storeys):
            for m in range(n):
                force[m] += latent_rows[s, m] * z[2 * n + s]
        _effect_forces(
            laws, rows, room, parameters, memory, new, eta, rate, z[states - 1], time, False, force
        )
        for c in range(channels):
            y = 0.0
            f = channel_floor[c]
            q = quantities[c]
            if q == ACCELERATION:
                for m in range(n):
                    y += floors[f, m] * force[m]
            elif q == VELOCITY:
                for m in range(n):
                    y += floors[f, m] * rate[m]
            elif q == TABLE_DISPLACEMENT:
                y = z[states - 2]
            else:
                for m in range(n):
                    y += floors[f, m] * eta[m]
                if q == ABSOLUTE_DISPLACEMENT:
                    y += z[states - 2]
            outputs[k, c] = y
            if not math.isnan(measured[k, c]):
                innovations[k, c] = measured[k, c] - y
        if correcting:
            for i in range(states):
                for c in range(channels):
                    z[i] += gain[i, c] * innovations[k, c]
        after[k] = z
        for j in range(substeps):
            for s in range(storeys):
                z[2 * n + s] *= latent_half
            z[states - 3] *= noise_half
            table = table_mid[k, j] - z[states - 3]
            for m in range(n):
                force[m] = known_mid[k, j, m] - participation[m] * table
            for s in range(storeys):
                for m in range(n):
                    force[m] += latent_rows[s, m] * z[2 * n + s]
            _advance(half, eta, rate, force + last, eta_mid, rate_mid)
            for m in range(n):
                last[m] = -force[m]
            _effect_forces(
                laws,
                rows,
                room,
                parameters,
                memory,
                new,
                eta_mid,
                rate_mid,
                z[states - 1],
                time + (j + 0.5) * h,
                True,
                force,
            )
            for m in range(n):
                last[m] += force[m]
            _advance(full, eta, rate, force, new_eta, new_rate)
            for m in range(n):
                eta[m] = new_eta[m]
                rate[m] = new_rate[m]
            for s in range(storeys):
                z[2 * n + s] *= latent_half
            z[states - 3] *= noise_half
            z[states - 1] += h * (table - 1.4 * LEAK * z[states - 1] - LEAK**2 * z[states - 2])
            z[states - 2] += h * z[states - 1]
    return innovations, before, after, outputs
