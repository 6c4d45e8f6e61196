"""Frames: from geometry as data, by shell finite elements, to a small exact model for the dynamics.

``frames.build(frames.load("10"))`` is the 10-storey frame of the thesis.
"""

from frames.building import build
from frames.definition import (
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
from frames.errors import FrameError
from frames.loading import from_mapping, load, names
from frames.mesh import Density
from frames.reduction import ReducedFrame

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
