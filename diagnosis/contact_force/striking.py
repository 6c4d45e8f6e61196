"""What contact laws make of the motion just before impacts, compiled: the force of one, the spectra of many."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

STEP_S = 2e-5
"""Step of a simulated impact, of second order: a fiftieth of a short one."""
SLOWEST = 1e-3
"""[m/s] Least velocity at first touch to which Hertz-damp's dashpot refers."""


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def strike(
    free: np.ndarray,
    free_rate: np.ndarray,
    held: np.ndarray,
    held_rate: np.ndarray,
    kind: int,
    gap: float,
    stiffness: float,
    damper: float,
    ratio: float,
    mass: float,
) -> np.ndarray:
    """Return the force [N] of each step of an impact.

    Args:
        free, free_rate: Relative displacement [m] and velocity [m/s] without the force, shape (steps,).
        held, held_rate: What a unit force over one step takes from them n steps later, shape (steps,).
        kind, gap, stiffness, damper, ratio, mass: The law (see `Law.numbers`).
    """
    steps = free.size
    force = np.zeros(steps)
    # Backwards, what a force of before takes now stands in the order of the forces.
    back, back_rate = held[steps - 1 :: -1].copy(), held_rate[steps - 1 :: -1].copy()
    pressed, last = steps, 0
    speed = 0.0
    for i in range(steps):
        d = free[i] - gap
        v = free_rate[i]
        # From the first to the last step with a force, over neighbours, which a processor takes several at a time.
        if last > 0:
            before, begin, end = force[pressed:last], steps - 1 - i + pressed, steps - 1 - i + last
            taken, taken_rate = back[begin:end], back_rate[begin:end]
            for j in range(before.size):
                d -= before[j] * taken[j]
                v -= before[j] * taken_rate[j]
        # The force is held over the step, so it is that of its middle.
        d += 0.5 * STEP_S * v
        if d <= 0.0:
            speed = 0.0
            continue
        if speed == 0.0:
            speed = max(v, SLOWEST)
        if kind <= 1:
            push = stiffness * d + damper * v
        else:
            push = stiffness * d * np.sqrt(d)
            if kind == 4:
                push *= 1.0 + ratio * v / speed
            elif kind == 3 and v > 0.0:
                push += v * (
                    damper if damper >= 0.0 else 2.0 * ratio * np.sqrt(stiffness * np.sqrt(d) * mass)
                )
        if push > 0.0:
            force[i] = push
            pressed, last = min(pressed, i), i + 1
    return force


@njit(cache=True, nogil=True)
def differences(
    first: np.ndarray,
    free: np.ndarray,
    free_rate: np.ndarray,
    prior: np.ndarray,
    turn: np.ndarray,
    seen: np.ndarray,
    hertz: np.ndarray,
    held: np.ndarray,
    held_rate: np.ndarray,
    law: tuple[int, float, float, float, float, float],
    added: np.ndarray,
    delay_s: float,
    which: np.ndarray,
    errors: np.ndarray,
) -> np.ndarray:
    """Return logarithmic spectra as a law and a filter make them less those seen, phases within half a turn, (asked, 7).

    Args:
        first: Where each impact begins in the arrays of all, and where the last one ends, shape (impacts + 1,).
        free, free_rate: Relative displacement [m] and velocity [m/s] without contact, shape (steps of all,).
        prior: Standard deviations of displacement and velocity before each impact, shape (impacts, 2).
        turn: exp(-i omega t) times the step, shape (frequencies, steps of all).
        seen: Logarithmic spectra: magnitudes, then phases but the first, shape (impacts, 7).
        hertz: Angular frequencies of the phases [rad/s], shape (impacts, 3).
        held, held_rate: What a unit force over one step takes from displacement and velocity n steps later, shape (steps,).
        law: Kind and numbers of the law (see `Law.numbers`).
        added: What the filter adds to each logarithmic spectrum, shape (7,).
        delay_s: Delay of the filter [s].
        which: Numbers of the impacts that are asked for, shape (asked,).
        errors: Errors of displacement and velocity before each of them [prior standard deviations], shape (asked, 2).
    """
    kind, gap, stiffness, damper, ratio, mass = law
    lines = turn.shape[0]
    found = np.empty((len(which), 2 * lines - 1))
    for row in range(len(which)):
        i = which[row]
        begin, end = first[i], first[i + 1]
        moved, faster = prior[i, 0] * errors[row, 0], prior[i, 1] * errors[row, 1]
        before = free[begin:end] + moved + faster * STEP_S * np.arange(end - begin)
        force = strike(
            before, free_rate[begin:end] + faster, held, held_rate, kind, gap, stiffness, damper, ratio, mass
        )
        for k in range(lines):
            value = 0.0j
            for at in range(end - begin):
                if force[at] != 0.0:
                    value += turn[k, begin + at] * force[at]
            found[row, k] = math.log(max(abs(value), 1e-12)) + added[k] - seen[i, k]
            if k > 0:
                p = lines + k - 1
                phase = math.atan2(value.imag, value.real) + added[p] - seen[i, p]
                found[row, p] = (phase - hertz[i, k - 1] * delay_s + math.pi) % (2.0 * math.pi) - math.pi
    return found
