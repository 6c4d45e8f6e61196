"""Frames as VTK files (`.vtu`), for ParaView and any other reader: mesh, mode shapes, deformed frame."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import meshio
import numpy as np
from numpy.typing import NDArray

from pounding.frames.drawing.shapes import Shape, shape_of
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


def write(
    path: str | Path,
    shape: Shape,
    *,
    point_data: Mapping[str, Real] | None = None,
    cell_data: Mapping[str, Real] | None = None,
) -> None:
    """Write a shape with fields on its nodes and elements as an unstructured grid.

    Args:
        path: File to write, ``.vtu``.
        shape: What to write.
        point_data: Fields by name, (nodes,) or (nodes, 3).
        cell_data: Fields by name, (elements,).

    Raises:
        FrameError: The file cannot be written.
    """
    cells = {"part": shape.level, "is_column": shape.is_column.astype(np.int64)} | dict(cell_data or {})
    mesh = meshio.Mesh(
        shape.nodes,
        [("quad", shape.quads)],
        point_data={name: np.asarray(values) for name, values in (point_data or {}).items()},
        cell_data={name: [np.asarray(values)] for name, values in cells.items()},
    )
    with replacing(path) as part:
        meshio.write(part, mesh, file_format="vtu")


def write_mesh(reduced: ReducedFrame, path: str | Path) -> None:
    """Write the mesh of a frame, floors and storeys numbered as ``part``."""
    write(path, shape_of(reduced))


def write_modes(reduced: ReducedFrame, path: str | Path, *, modes: int = 3) -> None:
    """Write the lowest mode shapes as vector fields like ``mode 1, 2.25 Hz``, each with largest length 1.

    Args:
        reduced: The frame.
        path: File to write, `.vtu`.
        modes: Number of modes.
    """
    shape = shape_of(reduced)
    fields = {}
    for mode in range(min(modes, len(reduced.frequencies_hz))):
        moved = shape.moved(reduced.shapes[:, mode])
        name = f"mode {mode + 1}, {reduced.frequencies_hz[mode]:.4g} Hz"
        fields[name] = moved / np.linalg.norm(moved, axis=1).max()
    write(path, shape, point_data=fields)


def write_deformed(
    reduced: ReducedFrame, q: Real, path: str | Path, *, stress_pa: Real | None = None
) -> None:
    """Write a deformed frame: the displacement (warp by it to see it) and, if given, the stress.

    Args:
        reduced: The frame.
        q: Its coordinates (n,) [m].
        path: File to write.
        stress_pa: Von Mises' stress of each element (elements,) [Pa].
    """
    shape = shape_of(reduced)
    cells = {} if stress_pa is None else {"von Mises stress [Pa]": stress_pa}
    write(path, shape, point_data={"displacement [m]": shape.moved(q)}, cell_data=cells)
