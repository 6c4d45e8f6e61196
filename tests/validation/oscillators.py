"""Oscillators of one storey and what drives them, for the published cases and the closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding import frames
from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

HEAVIEST_KG = 1e9
"""Mass of a wall: the largest that a floor may have [kg]."""

WALL_HZ = 500.0
"""So stiff a wall follows the table [Hz]."""


def oscillator(name: str, mass_kg: float, frequency_hz: float, damping_ratio: float) -> ReducedFrame:
    """Return a building of one storey.

    Args:
        name: Its name.
        mass_kg: Mass of its floor [kg].
        frequency_hz: Its frequency [Hz].
        damping_ratio: Its damping ratio [-].
    """
    return frames.build(
        frames.StickFrame(
            name=name,
            storeys=1,
            storey_height_m=3.5,
            floor_mass_kg=[mass_kg],
            frequency_hz=[frequency_hz],
            damping_ratio=damping_ratio,
        )
    )


def wall() -> ReducedFrame:
    """Return a neighbour that hardly moves."""
    return oscillator("wall", HEAVIEST_KG, WALL_HZ, 0.05)


def after_a_kick(velocity_m_s: float, acceleration_m_s2: Real, step_s: float) -> Real:
    """Return an acceleration that starts with a velocity: a triangle over two steps goes before it.

    Args:
        velocity_m_s: The velocity at the first sample [m/s].
        acceleration_m_s2: The acceleration from then on (m,) [m/s^2].
        step_s: Its sample step [s].
    """
    return np.concatenate([[0.0, velocity_m_s / step_s], acceleration_m_s2])
