"""The forces that a storey or a floor may have beyond its linear stiffness and damping, each defined here and nowhere else.

Frame files name them (`[[storey_law]]`, `pounding.frames.storey_laws`), and the effects of the diagnosis are made of them.
"""

from __future__ import annotations

import math

from numba import njit

from pounding.experiments.rig.laws import Numbers, memoryless, remembering

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
    return p[0] * v if p[1] == 0.0 else p[0] * v * (abs(v) / p[2]) ** p[1]


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
def _stiff_share(force: float, limit: float, sharpness: float, unloading: float, step: float) -> float:
    """Return which share of the elastic stiffness is left at a force that changes by `step`."""
    lost: float = min(abs(force) / limit, 1.0) ** sharpness
    if force * step <= 0.0:
        return 1.0 - unloading * lost
    return max(1.0 - lost, 0.0)


@remembering
def yielding(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return what a part of a storey that yields with a rounded knee lacks of its elastic force.

    It remembers its force and the drift (Bouc 1967, Wen 1976, by the midpoint rule). p: yield force [N], elastic
    stiffness [N/m], sharpness of the knee, share of the elastic stiffness that is lost as unloading begins.
    """
    first, step = state[0], p[1] * (d - state[1])
    middle = first + 0.5 * step * _stiff_share(first, p[0], p[2], p[3], step)
    force = first + step * _stiff_share(middle, p[0], p[2], p[3], step)
    new[0], new[1] = min(max(force, -p[0]), p[0]), d
    return new[0] - p[1] * d


@memoryless
def growing_spring(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 d t / p1, at most p0 d: p0 the spring [N/m], p1 the time [s] at which it is whole."""
    return p[0] * min(t / p[1], 1.0) * d


@memoryless
def stop(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p1 (d - p0) beyond the gap p0 [m], or its mirror where p0 is negative; p1 the stiffness [N/m].

    p2 the loss [s/m], by which the force is larger while it is pressed and smaller while it is let go (Hunt and Crossley
    1975); p3 what the power of the depth has beyond the first, the force at `PRESSED_M` being the same.
    """
    side = 1.0 if p[0] >= 0.0 else -1.0
    depth = side * (d - p[0])
    if depth <= 0.0:
        return 0.0
    force = side * p[1] * depth * max(1.0 + p[2] * side * v, 0.0)
    return force if p[3] == 0.0 else force * (depth / PRESSED_M) ** p[3]


@memoryless
def drag(p: Numbers, state: Numbers, d: float, v: float, t: float, new: Numbers) -> float:
    """Return p0 v abs(v) at the rate `DRAG_RATE`, p0 the drag [N s^2/m^2]; p1 what its power has beyond the second."""
    force: float = p[0] * v * DRAG_RATE * (abs(v) / DRAG_RATE) ** (1.0 + p[1])
    return force
