"""Sticks whose floors turn: a translation and a rotation about the vertical for each floor.

The centre of mass of a floor is the middle of its plan. The springs of a storey act at its centre of stiffness, which lies
the eccentricity e off the middle, across the shaking. A point at y moves by u - y theta, so the springs of a storey of
stiffness k bear k (d - e t) for a drift d and a turn t, and its torsional stiffness about the centre of stiffness adds to
that: the one-storey system of Chopra, *Dynamics of Structures*, chapter 9 (unsymmetric-plan buildings), in several storeys.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pounding.frames.chain import chain, storeys_of
from pounding.frames.definition import StickFrame, Torsion
from pounding.frames.reduction.craig_bampton import dense_modes

Real = NDArray[np.float64]


def twisting(frame: StickFrame, torsion: Torsion, mass: Real, stiffness: Real) -> tuple[Real, Real]:
    """Return mass and stiffness (2 n, 2 n) on the floors' displacements in the middle [m] and rotations [rad].

    Args:
        frame: The stick.
        torsion: What its file says of its torsion.
        mass: Mass of the floors (n, n) [kg].
        stiffness: Stiffness of the floors' sway (n, n) [N/m].
    """
    inertia = floor_inertia(frame, torsion, mass)
    turning = _turning(torsion, mass, inertia, stiffness)
    if isinstance(torsion.eccentricity_m, list):
        storeys, off = storeys_of(stiffness), np.asarray(torsion.eccentricity_m, float)
        coupling, own = chain(storeys * off), chain(storeys * off**2)
    else:
        coupling, own = torsion.eccentricity_m * stiffness, torsion.eccentricity_m**2 * stiffness
    nothing = np.zeros_like(mass)
    return (
        np.block([[mass, nothing], [nothing, inertia]]),
        np.block([[stiffness, -coupling], [-coupling, own + turning]]),
    )


def floor_inertia(frame: StickFrame, torsion: Torsion, mass: Real) -> Real:
    """Return the moment of inertia of the floors about the vertical through their middle (n, n) [kg m^2].

    Unless stated it is that of a uniform floor, m (a^2 + b^2) / 12.

    Args:
        frame: The stick.
        torsion: What its file says of its torsion.
        mass: Mass of the floors (n, n) [kg].
    """
    if torsion.floor_inertia_kg_m2:
        return np.diag(np.asarray(torsion.floor_inertia_kg_m2, float))
    length, width = frame.plan_m
    return np.asarray(mass * (length**2 + width**2) / 12.0)


def _turning(torsion: Torsion, mass: Real, inertia: Real, stiffness: Real) -> Real:
    """Return the torsional stiffness about the centres of stiffness (n, n) [N m/rad]."""
    if torsion.frequency_ratio is None:
        return chain(np.asarray(torsion.stiffness_n_m_per_rad, float))
    sway = dense_modes(stiffness, mass)[0][0]
    # Distributed over the height as the sway's, so that both have the same shapes where the inertias allow it.
    turn = dense_modes(stiffness, inertia)[0][0]
    return np.asarray((torsion.frequency_ratio * sway / turn) ** 2 * stiffness)


def ratios_of(shapes: Real, plain_shapes: Real, turning_shapes: Real, mass: Real, ratios: Real) -> Real:
    """Return the damping ratio of each mode of a twisting stick (2 n,).

    A mode has the ratios of the sways and the turns without eccentricity that it is made of, weighted by their share in its
    kinetic energy; the i-th turn has the ratio of the i-th sway.

    Args:
        shapes: Its mass-normalised shapes (2 n, 2 n).
        plain_shapes: Shapes of the sway without eccentricity (n, n), mass-normalised.
        turning_shapes: The same of the rotation (n, n).
        mass: Its mass (2 n, 2 n) [kg, kg m^2].
        ratios: Damping ratio of each sway (n,) [-].
    """
    half = len(ratios)
    sways = (plain_shapes.T @ mass[:half, :half] @ shapes[:half]) ** 2
    turns = (turning_shapes.T @ mass[half:, half:] @ shapes[half:]) ** 2
    return np.asarray(ratios @ (sways + turns))
