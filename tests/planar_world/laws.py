"""Forces along one direction of the structure: each a law of a drift d [m] and its rate v [m/s].

The numbers of a law stand in `Law.values` in the order that its function takes them. A law adds its force to that of the
linear frame, except for the yielding part: it is a share of the frame's own stiffness, so its elastic force is subtracted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from tests.planar_world.baseline import Real

FRICTION, CUBIC, YIELDING, DRAG, STOP, LOOSENING, RATTLE, DRIFT_FRICTION = range(1, 9)

HARDENING, ROUNDNESS, ROUNDNESS_LOST, ROUNDNESS_AFTER = 0.02, 6.0, 4.0, 0.3
"""Of the law of Menegotto and Pinto: b, R0, a1 and a2."""

STATES = 10
"""What a law remembers, for the yielding part: drift and force where it last turned; drift and force where the asymptotes
meet; direction; roundness R; drift and force a step ago; largest and least drift so far."""


@dataclass(frozen=True)
class Law:
    """A force along a direction.

    Attributes:
        kind: One of the constants above.
        direction: Makes the drift of the displacements (freedoms,) [-].
        values: Numbers of the law, in SI.
    """

    kind: int
    direction: Real
    values: tuple[float, ...]


def friction(direction: Real, force: float) -> Law:
    """Return Coulomb friction of a force [N] along a direction (freedoms,): any smaller force while it sticks."""
    return Law(FRICTION, direction, (force,))


def drift_friction(direction: Real, slope: float) -> Law:
    """Return friction that grows with the drift, by a slope [N/m], along a direction (freedoms,)."""
    return Law(DRIFT_FRICTION, direction, (slope,))


def cubic(direction: Real, stiffness: float) -> Law:
    """Return a spring k3 d^3 [N/m^3] along a direction (freedoms,)."""
    return Law(CUBIC, direction, (stiffness,))


def yielding(direction: Real, force: float, stiffness: float) -> Law:
    """Return a part that yields at a force [N] after a stiffness [N/m] (Menegotto and Pinto 1973).

    From each turn on, the force follows b e + (1 - b) e / (1 + e^R)^(1/R) between the point of the turn and that where
    the asymptotes of slopes k and b k meet, e being the share of the way. R is R0 at first, and R0 - a1 x / (a2 + x)
    after a turn, x being the way of the previous extreme from the new asymptotes' meeting point in yield drifts.

    Args:
        direction: (freedoms,) [-].
        force: Yield force [N].
        stiffness: Before yielding [N/m]; it is part of the frame's own.
    """
    shape = (HARDENING, ROUNDNESS, ROUNDNESS_LOST, ROUNDNESS_AFTER)
    return Law(YIELDING, direction, (force, stiffness, *shape))


def drag(direction: Real, coefficient: float) -> Law:
    """Return drag c v |v| of every floor in a direction (freedoms,) [N s^2/m^2].

    v is each floor's velocity relative to the table, as if the air moved with it.
    """
    return Law(DRAG, direction, (coefficient,))


def stop(direction: Real, gap: float, stiffness: float, dashpot: float) -> Law:
    """Return a stop of a spring beside a dashpot (Kelvin and Voigt) that does not pull, on one side.

    Args:
        direction: (freedoms,) [-].
        gap: Clearance [m]; its sign is the side.
        stiffness: [N/m].
        dashpot: [N s/m].
    """
    return Law(STOP, direction, (gap, stiffness, dashpot))


def rattle(direction: Real, gap: float, stiffness: float, dashpot: float, sliding: float) -> Law:
    """Return what holds a loose mass: stops on both sides as `stop`, and a dashpot of its sliding between them.

    Args:
        direction: (freedoms,) [-].
        gap: Clearance on either side [m].
        stiffness: Of the stops [N/m].
        dashpot: Of the stops [N s/m].
        sliding: [N s/m].
    """
    return Law(RATTLE, direction, (gap, stiffness, dashpot, sliding))


def loosening(freedoms: int, change: float) -> Law:
    """Return the slow change of a storey's columns by a share [-] over a run, in proportion to time.

    The stiffness is a polynomial of second degree in the share; its coefficients are `Structure.loosening`.
    """
    return Law(LOOSENING, np.zeros(freedoms), (change,))


@njit(cache=True)
def friction_force(limit: float, rate: float, mobility: float, step: float) -> float:
    """Return the friction [N] of a step: what stops the slip within it, or the limit (set-valued, implicit).

    Args:
        limit: [N].
        rate: Of the slip [m/s].
        mobility: Acceleration of the slip by a unit of force [1/kg].
        step: [s].
    """
    impulse = rate / mobility
    if impulse > limit * step:
        impulse = limit * step
    if impulse < -limit * step:
        impulse = -limit * step
    return impulse / step


@njit(cache=True)
def stop_force(depth: float, rate: float, stiffness: float, dashpot: float) -> float:
    """Return the force of a stop [N] at a depth [m] and its rate [m/s]; none where it is open or would pull."""
    force = 0.0
    if depth > 0:
        force = stiffness * depth + dashpot * rate
        if force < 0:
            force = 0.0
    return force


@njit(cache=True)
def yielding_force(drift: float, values: Real, state: Real) -> float:
    """Return the force of a yielding part beyond its elastic one [N], and move what it remembers.

    Args:
        drift: [m].
        values: Of the law, as in `Law.values`.
        state: As in `STATES` (10,).
    """
    limit, stiffness, hardening, roundness = values[0], values[1], values[2], values[3]
    yields = limit / stiffness
    if state[4] == 0.0 and abs(drift) > 1e-9:
        state[4] = 1.0 if drift > 0 else -1.0
        state[2] = state[4] * yields
        state[3] = state[4] * limit
        state[5] = roundness
        state[8] = yields
        state[9] = -yields
    elif (drift - state[6]) * state[4] < -1e-11:
        _turn(values, state)
    if state[4] == 0.0:
        force = stiffness * drift
    else:
        way = state[2] - state[0]
        if abs(way) < 1e-12:
            force = state[7]
        else:
            share = (drift - state[0]) / way
            if share < 0.0:
                share = 0.0
            rounded = hardening * share + (1 - hardening) * share / (1.0 + share ** state[5]) ** (
                1.0 / state[5]
            )
            force = state[1] + rounded * (state[3] - state[1])
    state[6] = drift
    state[7] = force
    if drift > state[8]:
        state[8] = drift
    if drift < state[9]:
        state[9] = drift
    return float(force - stiffness * drift)


@njit(cache=True)
def _turn(values: Real, state: Real) -> None:
    """Begin a new branch where the drift turned a step ago."""
    limit, stiffness, hardening, roundness = values[0], values[1], values[2], values[3]
    state[0] = state[6]
    state[1] = state[7]
    state[4] = -state[4]
    side = state[4]
    meeting = (side * limit * (1 - hardening) - state[1] + stiffness * state[0]) / (
        stiffness * (1 - hardening)
    )
    state[2] = meeting
    state[3] = state[1] + stiffness * (meeting - state[0])
    extreme = state[9] if side < 0 else state[8]
    away = abs(extreme - meeting) / (limit / stiffness)
    state[5] = roundness - values[4] * away / (values[5] + away)


@njit(cache=True)
def force_along(
    kind: int, values: Real, drift: float, rate: float, mobility: float, step: float, state: Real
) -> float:
    """Return the force of a law along its direction [N]; drag and loosening act on every floor, not here.

    Args:
        kind: Of the law.
        values: Of the law.
        drift: [m].
        rate: Of the drift [m/s].
        mobility: Acceleration of the drift by a unit of force [1/kg].
        step: [s].
        state: What the law remembers (10,), which is moved.
    """
    if kind == FRICTION:
        return friction_force(values[0], rate, mobility, step)
    if kind == DRIFT_FRICTION:
        return friction_force(values[0] * abs(drift), rate, mobility, step)
    if kind == CUBIC:
        return float(values[0] * drift * drift * drift)
    if kind == YIELDING:
        return yielding_force(drift, values, state)
    if kind == STOP:
        side = math.copysign(1.0, values[0])
        return stop_force(side * drift - abs(values[0]), side * rate, values[1], values[2]) * side
    if kind == RATTLE:
        side = 1.0 if drift > 0 else -1.0
        held = stop_force(abs(drift) - values[0], side * rate, values[1], values[2]) * side
        return float(held + values[3] * rate)
    return 0.0
