"""The drift of a storey, from the motion of a frame's floors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.motion import FrameMotion

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


def storey_drift(motion: FrameMotion, row: Real) -> tuple[Real, Real]:
    """Return a drift (m,) [m] and its rate (m,) [m/s] through a run.

    Args:
        motion: Motion of the frame.
        row: What the floors' displacements contribute to the drift (storeys,).
    """
    floors = motion.reduced.floor_x
    return motion.displacement_m[:, floors] @ row, motion.velocity_m_s[:, floors] @ row


def storey_row(frame: ReducedFrame, storey: int) -> Real:
    """Return what the floors' displacements contribute to a storey's drift (storeys,).

    Args:
        frame: The frame.
        storey: Its storey, from 1.
    """
    row = np.zeros(frame.storeys)
    row[storey - 1] = 1.0
    if storey > 1:
        row[storey - 2] = -1.0
    return row
