"""Frames that still move when the shaking ends: a run that ends with it may not have seen their largest motion."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.frames import ReducedFrame
from pounding.frames.response.exact import free_response

Real = NDArray[np.floating[Any]]

INSTANTS = 400
"""Instants of one longest period at which a frame that rings down is looked at."""
FARTHER = 1.001
"""Largest motion after the end over that before from which on it is said: what is less shows in no digit."""


def cut_short(frame: ReducedFrame, roof_m: Real, place: Real, rate: Real) -> list[str]:
    """Return a sentence where a frame moves farther after the end of a run than in it, if its table then rests.

    Frames that yield, and those with laws in storeys, are not asked: they do not ring down as their modes do.

    Args:
        frame: The frame.
        roof_m: Displacement of its roof in the run (m,) [m].
        place, rate: Its coordinates (n,) [m and rad] and their rates (n,) [m/s and rad/s] at the end, relative to the table.
    """
    definition = frame.definition
    if definition.yielding is not None or definition.storey_law:
        return []
    times = np.linspace(0.0, 1.0 / float(frame.frequencies_hz[0]), INSTANTS)
    ringing, _ = free_response(frame, place, rate, times, outputs=[int(frame.floor_x[-1])])
    within, after = float(np.abs(roof_m).max()), float(np.abs(ringing).max())
    if after <= FARTHER * within:
        return []
    return [
        f"{frame.name}: the record ends while the frame still moves: afterwards its roof goes to {1e3 * after:.4g} mm, "
        f"and to {1e3 * within:.4g} mm before; let the record end with some seconds of rest (rows of zero acceleration)"
    ]
