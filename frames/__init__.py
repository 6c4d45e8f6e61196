"""Frames: from geometry as data, by shell finite elements, to a small exact model for the dynamics.

``frames.build(frames.load("10"))`` is the 10-storey frame of the thesis. `definition` says what a frame is, `fe` makes
its finite elements, `reduction` condenses them to a `ReducedFrame`, `response` computes how that moves, and `drawing`
shows it.
"""

from pounding.frames.building import build
from pounding.frames.definition import (
    Columns,
    Frame,
    Joints,
    Material,
    Plate,
    PlateFrame,
    Published,
    StickFrame,
    changed,
)
from pounding.frames.errors import FrameError
from pounding.frames.fe.mesh import Density
from pounding.frames.loading import from_mapping, load, names
from pounding.frames.reduction.reduced_frame import ReducedFrame

__all__ = [
    "Columns",
    "Density",
    "Frame",
    "FrameError",
    "Joints",
    "Material",
    "Plate",
    "PlateFrame",
    "Published",
    "ReducedFrame",
    "StickFrame",
    "build",
    "changed",
    "from_mapping",
    "load",
    "names",
]
