"""Forces that single changes add to the storeys of a frame: friction, drag, damping, slip and yielding.

Each function returns a force for all values of its parameter at once (`single_changes.Force`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.studies.single_changes import Force, Storeys, modes

Real = NDArray[np.float64]
SLIDERS = 6
"""Springs that slip one after another in `softening`."""
SLIP_M_S = 0.005
"""Drift rate at which the smoothed Coulomb friction reaches three quarters of its force [m/s]."""
COLUMNS, PLASTIC_MODULUS_M3 = 4, 0.04 * 0.002**2 / 4
"""Columns of a storey and the plastic section modulus of each, the same in all frames of the thesis [m^3]."""


def drifts(floors: Real) -> Real:
    """Return drifts of the storeys (..., n) from motions of the floors (..., n)."""
    return np.diff(floors, axis=-1, prepend=0.0)


def storey_forces(forces: Real) -> Real:
    """Return the forces on the floors (..., n) of forces that storeys hold against their drift (..., n)."""
    return np.diff(forces, axis=-1, append=0.0)


def coulomb_friction(body: Storeys, values: Real) -> Force:
    """Return friction of `values` [N] in every storey, smoothed below `SLIP_M_S`."""
    size = values[:, None]

    def force(_u: Real, v: Real, _w: Real) -> Real:
        return storey_forces(size * np.tanh(drifts(v) / SLIP_M_S))

    return force


def air_drag(body: Storeys, values: Real) -> Force:
    """Return drag c w abs(w) of `values` [N s^2/m^2] on every floor."""

    def force(_u: Real, _v: Real, w: Real) -> Real:
        return -values[:, None] * w * np.abs(w)

    return force


def quadratic_damping(body: Storeys, values: Real) -> Force:
    """Return drag q v abs(v) of `values` [N s^2/m^2] in every storey, v its drift rate."""

    def force(_u: Real, v: Real, _w: Real) -> Real:
        rate = drifts(v)
        return storey_forces(values[:, None] * rate * np.abs(rate))

    return force


def cubic_stiffness(body: Storeys, values: Real) -> Force:
    """Return the storey force k d (d / 1 mm)^2 times `values`: the share that a drift of 1 mm adds [-]."""
    stiffness = body.storey_stiffness

    def force(u: Real, _v: Real, _w: Real) -> Real:
        drift = drifts(u)
        return storey_forces(values[:, None] * stiffness * drift * (drift / 1e-3) ** 2)

    return force


def damping_by_drift(body: Storeys, values: Real) -> Force:
    """Return drag in every storey whose damping ratio grows by `values` for each mm of drift [-].

    In a cycle of amplitude d a drag a abs(drift) rate takes 4 / 3 a w d^3, a damping ratio x d / 1 mm takes
    2 pi k x d^3 / 1 mm; both are the same at the first frequency w for a = 3 pi k x / (2 w 1 mm).
    """
    omega = modes(body).omega[0]
    size = 1.5 * np.pi * values[:, None] * body.storey_stiffness / omega / 1e-3

    def force(u: Real, v: Real, _w: Real) -> Real:
        return storey_forces(size * np.abs(drifts(u)) * drifts(v))

    return force


def hysteresis(body: Storeys, values: Real, *, share: float | Real) -> Force:
    """Return the loss of force where a share of each storey's stiffness slips at a drift of `values` [mm].

    Args:
        body: The storeys.
        values: Drift at which a storey slips, one a variant (values,) [mm].
        share: Share of the stiffness that slips [-], one for all or one a variant (values,).
    """
    return _slider(
        np.multiply.outer(share, body.storey_stiffness),
        np.multiply.outer(1e-3 * values, np.ones(len(body.mass))),
    )


def softening(body: Storeys, values: Real) -> Force:
    """Return the loss of force of storeys k d / (1 + d / x) with x of `values` [mm], unloading after Masing.

    Springs in parallel (Iwan 1967, J. Appl. Mech. 34(3)) of which a share 1 - (1 + d / x)^-2 has slipped at a
    drift d.
    """
    slipped = (np.arange(SLIDERS) + 0.5) / SLIDERS
    springs = [
        _slider(
            body.storey_stiffness / SLIDERS,
            np.multiply.outer(1e-3 * factor * values, np.ones(len(body.mass))),
        )
        for factor in 1.0 / np.sqrt(1.0 - slipped) - 1.0
    ]

    def force(u: Real, v: Real, w: Real) -> Real:
        return np.asarray(np.sum([spring(u, v, w) for spring in springs], axis=0))

    return force


def column_yielding(body: Storeys, values: Real) -> Force:
    """Return the loss of force where columns yield, ideally plastic, at a stress of `values` [MPa].

    A storey's plastic shear is that of plastic moments at both ends of all columns, over the storey's height.
    """
    heights = np.diff(body.height_m, prepend=0.0)
    shear = 2.0 * COLUMNS * 1e6 * values[:, None] * PLASTIC_MODULUS_M3 / heights
    return _slider(body.storey_stiffness, shear / body.storey_stiffness)


def _slider(stiffness: Real, limit: Real) -> Force:
    """Return the loss of force of springs (n,) or (values, n) [N/m] that slip at elastic drifts `limit` (values, n) [m].

    The slider's state is carried from call to call, so a force serves one run only.
    """
    state = {"elastic": np.zeros_like(limit), "drift": np.zeros((1, limit.shape[1]))}

    def force(u: Real, _v: Real, _w: Real) -> Real:
        drift = drifts(u)
        state["elastic"] = np.clip(state["elastic"] + drift - state["drift"], -limit, limit)
        state["drift"] = drift
        return storey_forces(stiffness * (state["elastic"] - drift))

    return force
