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

CONTRACT = {"contract"}
"""Freedom of the compiler: product and sum may be one instruction, which rounds once where two do twice. NaN stay NaN, and
sums keep their order.

The compiled loops here and in `sensitivity`, `law_feedback` and `tangents` assign number by number: for the assignment of a
whole row numba compiles its messages about shapes as well, which takes as long as the loop itself.
"""


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
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
    motion: Real,
) -> None:
    """Add the modal forces of all effects; `rows` holds for each the modal row of its drift.

    Drift and rate of each are written to `motion`, shape (effects, 2), unless that is empty.
    """
    modes = eta.size
    numbers, remembered, then = parameters.ctypes.data, memory.ctypes.data, new.ctypes.data
    of_parameters, of_memory = 8 * parameters.shape[1], 8 * memory.shape[1]
    for j in range(laws.size):
        d = 0.0
        v = room[j] * table_rate
        for m in range(modes):
            d += rows[j, m] * eta[m]
            v += rows[j, m] * rate[m]
        if motion.size > 0:
            motion[j, 0], motion[j, 1] = d, v
        before, after = remembered + j * of_memory, then + j * of_memory
        pull = -called_at(laws[j], numbers + j * of_parameters, before, d, v, time, after)
        if keep:
            for i in range(memory.shape[1]):
                memory[j, i] = new[j, i]
        for m in range(modes):
            force[m] += rows[j, m] * pull


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _coupled(pairs: Real, couplings: Real, rate: Real, force: Real) -> None:
    """Add the modal forces by which damping couples modes."""
    for j in range(couplings.size):
        one, other = pairs[j, 0], pairs[j, 1]
        force[one] -= couplings[j] * rate[other]
        force[other] -= couplings[j] * rate[one]


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def _whole_step(steps: Real, decay: Real) -> tuple[Real, Real]:
    """Return what a force at the middle of each substep leaves at the step's end, and the step's transition.

    Args:
        steps: Exact step matrices of each mode over a substep, shape (6, modes).
        decay: What is left of a decaying force at the middle of each substep, shape (substeps,).

    Returns:
        Displacement and rate for a unit force in each substep, shape (substeps + 1, 2, modes), the last row for a unit
        force that decays; a11, a12, a21, a22 of the whole step, shape (4, modes).
    """
    substeps, modes = decay.size, steps.shape[1]
    left = np.zeros((substeps + 1, 2, modes))
    whole = np.zeros((4, modes))
    for m in range(modes):
        a, b, c, d = 1.0, 0.0, 0.0, 1.0
        for back in range(substeps):
            j = substeps - 1 - back
            left[j, 0, m] = a * steps[4, m] + b * steps[5, m]
            left[j, 1, m] = c * steps[4, m] + d * steps[5, m]
            left[substeps, 0, m] += decay[j] * left[j, 0, m]
            left[substeps, 1, m] += decay[j] * left[j, 1, m]
            a, b, c, d = (
                a * steps[0, m] + b * steps[2, m],
                a * steps[1, m] + b * steps[3, m],
                c * steps[0, m] + d * steps[2, m],
                c * steps[1, m] + d * steps[3, m],
            )
        whole[0, m], whole[1, m], whole[2, m], whole[3, m] = a, b, c, d
    return left, whole


@njit(cache=True, nogil=True, error_model="numpy", fastmath=CONTRACT)
def predict(
    modes: Real,
    pairs: Real,
    couplings: Real,
    half: Real,
    full: Real,
    participation: Real,
    floors: Real,
    latent_rows: Real,
    known_mid: Real,
    known_at: Real,
    directions: Real,
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
    whole: bool,
) -> tuple[Real, Real, Real, Real, Real]:
    """Run the predictor over one run.

    Args:
        modes: Angular frequency [rad/s] and damping ratio of each mode, shape (modes, 2).
        pairs: Numbers of the modes that damping couples, shape (pairs, 2).
        couplings: Modal force of each for a unit rate of the other [1/s], shape (pairs,).
        half, full: Exact step matrices of each mode over half a substep and a whole one, shape (6, modes):
            a11, a12, a21, a22 and the response of both states to a constant modal force.
        participation: Modal participation of a unit table acceleration, shape (modes,).
        floors: Mass-normalised shapes at the floors, shape (floors, modes).
        latent_rows: Modal rows of the drifts on which latent forces act, shape (storeys, modes).
        known_mid: Known forces but the table's at the middle of each substep, shape (samples, substeps, known).
        known_at: The same at the samples, shape (samples, known).
        directions: Modal forces that a unit of each known force makes at midpoints and at samples, shape
            (2, known, modes).
        table_mid: Table acceleration at the middle of the substeps [m/s^2], shape (samples, substeps).
        quantities, channel_floor: What each channel measures, and at which floor (0 is the first), shape (channels,).
        measured: Measured samples in SI, NaN where missing, shape (samples, channels).
        gain: Filter gain, shape (channels, 2 modes + storeys + 3); zeros for a simulation.
        decay: Rates of the latent forces and of the table noise [1/s], shape (2,).
        step_s: Sampling step [s].
        laws: Address of each effect's law (`pounding.experiments.rig.laws`), shape (effects,).
        rows: Modal row of the drift on which it acts, shape (effects, modes).
        room: 1 where it acts on the rate in the room, which has the table's in it, else 0, shape (effects,).
        parameters: Its parameters in SI, shape (effects, NUMBERS).
        whole: Whether states and outputs are wanted, too; else those have no samples.

    Returns:
        Innovations (samples, channels), NaN samples as zero; predicted states (samples, states); filtered states;
        outputs as predicted (samples, channels); drift and rate on which each effect acts at the middle of each substep
        (samples, substeps, effects, 2).
    """
    samples, channels = measured.shape
    n = modes.shape[0]
    storeys = latent_rows.shape[0]
    states = 2 * n + storeys + 3
    substeps = table_mid.shape[1]
    known = directions.shape[1]
    h = step_s / substeps
    # All latent forces decay alike, and so does what they push each mode with.
    middle = np.arange(1, 2 * substeps, 2) * (h / 2)
    latent_left, noise_left = np.exp(-decay[0] * middle), np.exp(-decay[1] * middle)
    latent_end, noise_end = math.exp(-decay[0] * step_s), math.exp(-decay[1] * step_s)
    latent_steps, transition = _whole_step(full, latent_left)
    noise_steps, _ = _whole_step(full, noise_left)
    held = np.zeros((2, n))
    for j in range(substeps):
        for m in range(n):
            held[0, m] += latent_steps[j, 0, m]
            held[1, m] += latent_steps[j, 1, m]
    stiffness = modes[:, 0] ** 2
    damping = 2.0 * modes[:, 0] * modes[:, 1]
    z = np.zeros(states)
    innovations = np.zeros((samples, channels))
    kept = samples if whole else 0
    outputs = np.zeros((kept, channels))
    before = np.zeros((kept, states))
    after = np.zeros((kept, states))
    middles = np.zeros((kept, substeps, laws.size, 2), np.float32)
    unseen = np.zeros((0, 2), np.float32)
    memory = np.zeros((laws.size, MEMORY))
    new = np.zeros((laws.size, MEMORY))
    force = np.zeros(n)
    latent = np.zeros(n)
    last = np.zeros(n)
    eta_mid = np.zeros(n)
    rate_mid = np.zeros(n)
    eta = z[:n]
    rate = z[n : 2 * n]
    correcting = False
    for c in range(channels):
        for i in range(states):
            correcting = correcting or gain[c, i] != 0.0
    for k in range(samples):
        if whole:
            for i in range(states):
                before[k, i] = z[i]
        time = k * step_s
        for m in range(n):
            force[m] = -stiffness[m] * eta[m] - damping[m] * rate[m]
        _coupled(pairs, couplings, rate, force)
        for i in range(known):
            for m in range(n):
                force[m] += known_at[k, i] * directions[1, i, m]
        for s in range(storeys):
            for m in range(n):
                force[m] += latent_rows[s, m] * z[2 * n + s]
        _effect_forces(
            laws, rows, room, parameters, memory, new, eta, rate, z[states - 1], time, False, force, unseen
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
            if whole:
                outputs[k, c] = y
            if not math.isnan(measured[k, c]):
                innovations[k, c] = measured[k, c] - y
        if correcting:
            for c in range(channels):
                for i in range(states):
                    z[i] += gain[c, i] * innovations[k, c]
        if whole:
            for i in range(states):
                after[k, i] = z[i]
        for m in range(n):
            latent[m] = 0.0
        for s in range(storeys):
            for m in range(n):
                latent[m] += latent_rows[s, m] * z[2 * n + s]
            z[2 * n + s] *= latent_end
        noise = z[states - 3]
        z[states - 3] = noise * noise_end
        if laws.size == 0:
            # A linear frame goes through all substeps at once.
            for m in range(n):
                eta_mid[m] = transition[0, m] * eta[m] + transition[1, m] * rate[m]
                rate_mid[m] = transition[2, m] * eta[m] + transition[3, m] * rate[m]
                eta_mid[m] += latent_steps[substeps, 0, m] * latent[m]
                rate_mid[m] += latent_steps[substeps, 1, m] * latent[m]
                eta_mid[m] += noise_steps[substeps, 0, m] * noise * participation[m]
                rate_mid[m] += noise_steps[substeps, 1, m] * noise * participation[m]
            for j in range(substeps):
                for m in range(n):
                    force[m] = -participation[m] * table_mid[k, j]
                for i in range(known):
                    for m in range(n):
                        force[m] += known_mid[k, j, i] * directions[0, i, m]
                for m in range(n):
                    eta_mid[m] += latent_steps[j, 0, m] * force[m]
                    rate_mid[m] += latent_steps[j, 1, m] * force[m]
            if couplings.size > 0:
                # The impulse of what couples modes is exact: a mode's rate, integrated, is how far it has moved.
                for m in range(n):
                    last[m] = (eta_mid[m] - eta[m]) / step_s
                    force[m] = 0.0
                _coupled(pairs, couplings, last, force)
                for m in range(n):
                    eta_mid[m] += held[0, m] * force[m]
                    rate_mid[m] += held[1, m] * force[m]
            for m in range(n):
                eta[m], rate[m] = eta_mid[m], rate_mid[m]
        for j in range(substeps):
            table = table_mid[k, j] - noise * noise_left[j]
            if laws.size > 0:
                for m in range(n):
                    force[m] = latent_left[j] * latent[m] - participation[m] * table
                for i in range(known):
                    for m in range(n):
                        force[m] += known_mid[k, j, i] * directions[0, i, m]
                for m in range(n):
                    there = force[m] + last[m]
                    eta_mid[m] = half[0, m] * eta[m] + half[1, m] * rate[m] + half[4, m] * there
                    rate_mid[m] = half[2, m] * eta[m] + half[3, m] * rate[m] + half[5, m] * there
                    last[m] = 0.0
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
                    last,
                    middles[k, j] if whole else unseen,
                )
                _coupled(pairs, couplings, rate_mid, last)
                for m in range(n):
                    there = force[m] + last[m]
                    moved = full[0, m] * eta[m] + full[1, m] * rate[m] + full[4, m] * there
                    rate[m] = full[2, m] * eta[m] + full[3, m] * rate[m] + full[5, m] * there
                    eta[m] = moved
            z[states - 1] += h * (table - 1.4 * LEAK * z[states - 1] - LEAK**2 * z[states - 2])
            z[states - 2] += h * z[states - 1]
    return innovations, before, after, outputs, middles
