"""The scale of a frame: as its file states it, or full scale where its storeys are a building's."""

from __future__ import annotations

from pounding.frames.definition import Frame
from pounding.frames.errors import FrameError
from pounding.scale import FULL_SCALE, Scale, scale_of

LOWEST_STOREY_M = 2.0
"""A frame all of whose storeys are at least so high is a building at full scale, unless its file says otherwise [m]."""


def known_scale(frame: Frame) -> Scale | None:
    """Return the scale of a frame, None where neither its file nor its storeys tell it."""
    if frame.scale is not None:
        return scale_of(frame.scale, f"frame {frame.name}: scale", FrameError)
    return FULL_SCALE if min(frame.storey_heights_m) >= LOWEST_STOREY_M else None


def required_scale(frame: Frame) -> Scale:
    """Return the scale of a frame, for work that cannot be done without it.

    Raises:
        FrameError: Neither its file nor its storeys tell it.
    """
    known = known_scale(frame)
    if known is None:
        raise FrameError(
            f"frame {frame.name}: a storey of {min(frame.storey_heights_m):g} m is lower than a building's and the frame's "
            'file states no scale, so the time of the record is not known; write scale = "1:30" for a model of that '
            "scale (scale = 1 keeps the record's time) into the file, or give --time-factor"
        )
    return known
