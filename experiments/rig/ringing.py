"""Frames that still move when the shaking ends: a run that ends with it may not have seen their largest motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.frames import ReducedFrame

Real = NDArray[np.floating[Any]]

INSTANTS = 400
"""Instants of one longest period at which a frame that rings down is looked at."""


def cut_short(frame: ReducedFrame, roof_m: Real, place: Real, rate: Real) -> list[str]:
    """Return a sentence where a frame moves farther after the end of a run than in it, if its table then rests.

    Frames that yield, and those with laws in storeys, are not asked: they do not ring down as their modes do.

    Args:
        frame: The frame.
        roof_m: Displacement of its roof in the run (m,) [m].
        place, rate: Its coordinates (n,) and their rates (n,) at the end.
    """
    definition = frame.definition
    if definition.yielding is not None or definition.storey_law:
        return []
    within, after = float(np.abs(roof_m).max()), float(np.abs(_ringing(frame, place, rate)).max())
    if after <= 1.001 * within:
        return []
    return [
        f"{frame.name}: the record ends while the frame still moves: afterwards its roof goes to {1e3 * after:.4g} mm, "
        f"and to {1e3 * within:.4g} mm before; let the record end with some seconds of rest (rows of zero acceleration)"
    ]


def _ringing(frame: ReducedFrame, place: Real, rate: Real) -> Real:
    """Return the displacement of the roof in one longest period after the end (INSTANTS,) [m], the table at rest."""
    omega = 2.0 * np.pi * frame.frequencies_hz
    ratio = np.minimum(frame.damping_ratios, 0.999)
    turning = omega * np.sqrt(1.0 - ratio**2)
    start, speed = (frame.shapes.T @ (frame.mass @ one) for one in (place, rate))
    time = np.linspace(0.0, 1.0 / float(frame.frequencies_hz[0]), INSTANTS)[:, None]
    sway = start * np.cos(turning * time) + (speed + ratio * omega * start) / turning * np.sin(turning * time)
    return np.asarray((np.exp(-ratio * omega * time) * sway) @ frame.shapes[frame.floor_x[-1]])
