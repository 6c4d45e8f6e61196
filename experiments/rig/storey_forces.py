"""The forces that a storey or a floor may have beyond its linear stiffness and damping, each defined here and nowhere else.

Frame files name them (`[[storey_law]]`, `pounding.frames.storey_laws`), and the effects of the diagnosis are made of them.
"""

from __future__ import annotations

import math

from numba import njit

from pounding.calling import STEP
from pounding.experiments.rig.laws import Numbers, memoryless, remembering, remembering_turns

CREEP = 0.05
"""Rate below which a damper of a lower power than the first is nearly linear, as a share of that at which it is as strong as
a linear one. It would be stiff without limit at rest: no step of time follows that, and its force chatters."""
STRIBECK_RATE = 5e-3
"""Rate of sliding [m/s] at which what static friction has beyond the sliding one has fallen to 1/e (dry metals 1e-3 to 1e-2,
Canudas de Wit et al. 1995)."""
PRESSED_M = 1e-3
"""Depth [m] at which a stop of another power pushes as the straight one does."""
DRAG_RATE = 0.3
"""Rate [m/s] at which drag of another power is as large as that of the second: about the largest on a shaking table."""


@memoryless
def damper(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 v: p0 the damper [N s/m]; p1 what the power of the rate has beyond the first, the force at p2 [m/s] being
    the same."""
    square, creep = (v / p[2]) ** 2, CREEP**2 if p[1] < 0.0 else 0.0
    return p[0] * v * math.pow((square + creep) / (1.0 + creep), 0.5 * p[1])


@memoryless
def quadratic_damper(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 v abs(v): p0 the damper [N s^2/m^2]."""
    return p[0] * v * abs(v)


@remembering
def friction(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return the force of a stiff joint that slides; it remembers its elastic force and the drift.

    p: force [N], stiffness [N/m] and damping [N s/m] while stuck, the rate [m/s] at which sliding has worn half of it
    away; infinite for one that nothing wears; what breaks it loose beyond the force, as a share of it (Stribeck's curve).
    """
    limit = p[0]
    if p[4] != 0.0:
        limit *= 1.0 + p[4] * math.exp(-((v / STRIBECK_RATE) ** 2))
    held = min(max(state[0] + p[1] * (d - state[1]), -limit), limit)
    new[0], new[1] = held, d
    return min(max(held + p[2] * v, -limit), limit) / (1.0 + abs(v) / p[3])


@remembering
def bristles(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return the force of bristles that bend and then slide; it remembers force and drift (Dahl 1968, exponent 1).

    dF/dd = (p0 sign(v) - F) / (p1 sign(v)), solved exactly for a drift that goes one way since it was remembered.
    p: friction force [N], drift [m] in which it would be reached at the stiffness with which it starts.
    """
    moved = d - state[1]
    slides_at = p[0] if moved >= 0.0 else -p[0]
    new[0] = slides_at + (state[0] - slides_at) * math.exp(-abs(moved) / p[1])
    new[1] = d
    return new[0]


@memoryless
def cubic_spring(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 d^3: p0 the spring [N/m^3]."""
    return p[0] * d * d * d


@njit(cache=True, error_model="numpy")
def _stiff_share(way: float, whole: float, sharpness: float) -> float:
    """Return which share of the elastic stiffness is left after a part of the whole way to yielding, all of it before."""
    gone: float = min(max(way / whole, 0.0), 1.0) ** sharpness
    return 1.0 - gone


@remembering_turns(2)
def yielding(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return what a part of a storey that yields with a rounded knee lacks of its elastic force.

    It remembers its force and the drift, and at which force and which way it turned last (by the midpoint rule). p: yield
    force [N], elastic stiffness [N/m], sharpness of the knee, and how it unloads: with 0 it is elastic until its force
    changes sign (Bouc 1967, Wen 1976), with 1 it rounds from where it turned (Masing 1926, Menegotto and Pinto 1973), and in
    between from that share of the force there.
    """
    step = p[1] * (d - state[1])
    turned, ahead = state[2], state[3]
    if step != 0.0 and step * ahead <= 0.0:
        turned, ahead = state[0], math.copysign(1.0, step)
    begun = p[3] * ahead * turned
    whole = max(p[0] - begun, 1e-9 * p[0])
    middle = state[0] + 0.5 * step * _stiff_share(ahead * state[0] - begun, whole, p[2])
    force = state[0] + step * _stiff_share(ahead * middle - begun, whole, p[2])
    new[0], new[1], new[2], new[3] = min(max(force, -p[0]), p[0]), d, turned, ahead
    return new[0] - p[1] * d


@memoryless
def growing_spring(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 d t / p1, at most p0 d: p0 the spring [N/m], p1 the time [s] at which it is whole."""
    return p[0] * min(t / p[1], 1.0) * d


@memoryless
def stop(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p1 (d - p0) beyond the gap p0 [m], or its mirror where p0 is negative; p1 the stiffness [N/m].

    p2 the loss [s/m], by which the force at the depth `PRESSED_M` is larger while it is pressed and smaller while it is let
    go; p3 what the power of the depth has beyond the first, the force at that depth being the same; p4 by how much the loss
    grows with less than the depth: none where it grows with it (Hunt and Crossley 1975), 1 where a dashpot stands beside
    the spring and is there at once (Kelvin and Voigt). It never pulls. Of a step in which it touches or lets go, the force
    is that of the part in which it is touched: else a small change of the motion would move a whole push by a step.
    """
    side = 1.0 if p[0] >= 0.0 else -1.0
    depth = side * (d - p[0])
    way = p[STEP] * abs(v)
    deepest = depth + 0.5 * way
    if deepest <= 0.0:
        return 0.0
    touched = 1.0
    if deepest < way:
        depth, touched = 0.5 * deepest, deepest / way
    loss = p[2] if p[4] == 0.0 else p[2] * (depth / PRESSED_M) ** -p[4]
    force = touched * side * p[1] * depth * max(1.0 + loss * side * v, 0.0)
    return force if p[3] == 0.0 else force * (depth / PRESSED_M) ** p[3]


@memoryless
def drag(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 v abs(v) at the rate `DRAG_RATE`, p0 the drag [N s^2/m^2]; p1 what its power has beyond the second."""
    force: float = p[0] * v * DRAG_RATE * (abs(v) / DRAG_RATE) ** (1.0 + p[1])
    return force
