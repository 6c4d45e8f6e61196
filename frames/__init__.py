"""Frames: from geometry as data, by shell finite elements, to a small exact model for the dynamics.

``frames.build(frames.load("10"))`` is the 10-storey frame of the thesis. `definition` says what a frame is, `fe` makes
its finite elements, `reduction` condenses them to a `ReducedFrame`, `response` computes how that moves, and `drawing`
shows it.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from pounding.frames.definition import (
    Columns,
    Frame,
    Joints,
    Material,
    Plate,
    PlateFrame,
    Published,
    Slab,
    StickFrame,
    changed,
)
from pounding.frames.errors import FrameError
from pounding.frames.loading import from_mapping, load, names

if TYPE_CHECKING:
    from pounding.frames.building import build
    from pounding.frames.fe.mesh import Density
    from pounding.frames.reduction.reduced_frame import ReducedFrame
else:
    # The finite elements take a third of a second to import, and frame files are read without them.
    _LATER = {"build": "building", "Density": "fe.mesh", "ReducedFrame": "reduction.reduced_frame"}

    def __getattr__(name: str) -> object:
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_LATER[name]}"), name)


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
    "Slab",
    "StickFrame",
    "build",
    "changed",
    "from_mapping",
    "load",
    "names",
]
