"""Recipes for the damping of a frame: each knows the ratios of the baseline model, and none gives just these."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.linalg import eigh

from tests.planar_world.baseline import Real, modes

Recipe = Literal["caughey", "mildrayleigh", "rayleigh", "joints"]
"""Ratios of their own for all modes (Caughey); somewhat more in the lowest and the upper modes; proportional to mass and
stiffness (Rayleigh); in part the loss of each floor's joints, in part modal."""
USUAL: tuple[Recipe, ...] = ("caughey", "mildrayleigh", "joints")
SMALL = 0.02
"""Relative change of a joint by which its share of the stiffness is taken."""


def modal(mass: Real, stiffness: Real, ratios: Real) -> Real:
    """Return the damping matrix (floors, floors) that gives every mode its ratio (modes,) [N s/m]."""
    squares, shapes = eigh(stiffness, mass)
    weighed = mass @ shapes
    found: Real = weighed @ np.diag(2 * ratios * np.sqrt(squares)) @ weighed.T
    return found


def ratios_of(mass: Real, stiffness: Real, damping: Real) -> Real:
    """Return the damping ratios (modes,) [-] of a damping matrix (floors, floors) [N s/m], couplings left out."""
    frequencies, shapes = modes(mass, stiffness)
    found: Real = np.diag(shapes.T @ damping @ shapes) / (4 * np.pi * frequencies)
    return found


def mild_rayleigh(baseline: Real, frequencies: Real) -> Real:
    """Return ratios (modes,) [-] that rise a little at both ends of the frequencies (modes,) [Hz]."""
    first, fourth = frequencies[0], frequencies[min(3, len(frequencies) - 1)]
    found: Real = baseline * (0.82 + 0.06 * (first / frequencies) + 0.12 * frequencies / fourth * 0.8)
    return found


def rayleigh(baseline: Real, frequencies: Real, strength: float) -> Real:
    """Return the ratios (modes,) [-] of Rayleigh's damping, pinned at the modes 1 and 3.

    Args:
        baseline: Ratios of the baseline model (modes,) [-].
        frequencies: Of the modes (modes,) [Hz].
        strength: Share of Rayleigh's ratios in them; the others are the baseline ones [-].
    """
    circular = frequencies * 2 * np.pi
    pins = [[1 / circular[0], circular[0]], [1 / circular[2], circular[2]]]
    by_mass, by_stiffness = np.linalg.solve(pins, 2 * baseline[:2])
    pinned = strength * (by_mass / circular + by_stiffness * circular) / 2
    found: Real = pinned + (1 - strength) * baseline
    return found


def from_joints(
    mass: Real,
    stiffness: Real,
    baseline: Real,
    joints: Real,
    each: list[tuple[float, Real]],
    share: float,
) -> Real:
    """Return a damping matrix (floors, floors) [N s/m] of which a share is the loss of the joints.

    A joint's moment lags behind its turn by one time for all joints, as it does in a Kelvin-Voigt spring.

    Args:
        mass: (floors, floors) [kg].
        stiffness: (floors, floors) [N/m].
        baseline: Ratios of the baseline model (modes,) [-].
        joints: Share of all joints in the stiffness (floors, floors) [N/m].
        each: Of each floor's joints, the weight [-] of their loss and their share in the stiffness (floors, floors) [N/m].
        share: What the joints give of the damping of the lowest three modes, in the median [-].
    """
    frequencies, shapes = modes(mass, stiffness)
    circular = frequencies * 2 * np.pi
    by_joints = np.diag(shapes.T @ joints @ shapes) / (2 * circular)
    lag = share * np.median(baseline[:3] / by_joints[:3])
    rest = np.clip(baseline - lag * by_joints, 0.25 * baseline, None)
    damping = modal(mass, stiffness, rest)
    for weight, one in each:
        damping = damping + lag * weight * one
    return damping
