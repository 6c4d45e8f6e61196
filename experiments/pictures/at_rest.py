"""Groups of frames at rest, each on a table of its own, all at one scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding.experiments.pictures.scenes import USUAL_PLAN_M
from pounding.frames.drawing.pictures import Margins, add_plain, add_table, drawing, letters, look
from pounding.frames.drawing.shapes import RIM, plan, shape_of

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

SIDE_BY_SIDE_M, APART_M = 0.02, 0.5
"""Room between the frames of a group, and between two groups, for frames of the usual plan [m]."""


def picture(
    groups: Mapping[str, Sequence[ReducedFrame]],
    path: str | Path | None = None,
    *,
    size: tuple[int, int] = (1120, 460),
    scene: Any = None,
) -> Any:
    """Draw groups of frames at rest, each on a table of its own with its name before it, all at one scale.

    Args:
        groups: Frames of each group from left to right, by what is written.
        path: Image file to write; none when None.
        size: Width and height [pixels].
        scene: A pyvista plotter to draw into; a new one when None.

    Returns:
        The plotter; one that was made here stays open if no file was asked for.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    with drawing(scene, path, size) as drawn:
        start, unit = 0.0, 1.0
        points, words, heights = [], [], [0.0]
        for name, frames in groups.items():
            unit = frames[0].plan_m[0] / USUAL_PLAN_M
            first = start
            for frame in frames:
                shape, (left, right, _, _) = shape_of(frame), plan(frame)
                nodes = shape.nodes + [start - left, 0.0, 0.0]
                add_plain(drawn, replace(shape, nodes=nodes))
                start += right - left + SIDE_BY_SIDE_M * unit
                heights.append(float(frame.heights_m[-1]))
            front, back = min(plan(f)[2] for f in frames), max(plan(f)[3] for f in frames)
            add_table(drawn, (first, start - SIDE_BY_SIDE_M * unit, front, back), unit=unit)
            points.append([0.5 * (first + start), front - 3.0 * RIM * unit, -6.0 * RIM * unit])
            words.append(name)
            start += APART_M * unit
        style = {
            "font_size": letters(drawn, 20),
            "text_color": "black",
            "bold": False,
            "font_family": "arial",
        }
        style |= {"shape": None, "show_points": False, "always_visible": True}
        drawn.add_point_labels(points, words, justification_horizontal="center", **style)
        low, high = np.array([0.0, points[0][1], points[0][2]]), np.array([start, 0.5 * unit, max(heights)])
        look(drawn, low, high, margins=Margins(top=0.03))
    return drawn
