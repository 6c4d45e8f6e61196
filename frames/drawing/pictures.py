"""Pictures of frames without a display: mesh and mode shapes, and what pictures of shaken frames are made of.

A machine may be unable to render (no OpenGL library): `pounding.frames.drawing.rendering.cannot_render` tells so in one
sentence, and callers then go on without pictures.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.drawing.shapes import RIM, THICKNESS, Shape, box, plan, shape_of
from pounding.frames.errors import FrameError
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

FLOOR, COLUMN, GHOST, TABLE, INK = "#dbe3ea", "#5b87b0", "#8d979f", "#e9e4da", "#30343a"
"""Colours of floors, columns, the undeformed frame, the table and lines."""

MAP, STRESS_MAP = "viridis", "YlOrRd"
"""Colour maps of displacement and of stress; what is not stressed stays light."""

LIGHT: dict[str, Any] = {"ambient": 0.55, "diffuse": 0.5, "specular": 0.0}
"""Even light, so that colours can be compared with the colour bar."""

VIEW = (0.42, -1.0, 0.30)
"""Direction from the frame to the camera: x, the direction of shaking, lies across the picture."""


class Margins(NamedTuple):
    """Shares of a picture's width and height that are kept free for words and bars."""

    left: float = 0.04
    right: float = 0.04
    top: float = 0.1
    bottom: float = 0.03


@contextmanager
def bare_plotter(size: tuple[int, int], **options: Any) -> Iterator[Any]:
    """Give a plotter without smooth edges, on a machine that is known to render; `drawing` finds out whether it does.

    Args:
        size: Width and height [pixels].
        options: Arguments of pyvista's `Plotter`.
    """
    made = _bare(size, **options)
    try:
        yield made
    finally:
        made.close()


@contextmanager
def drawing(scene: Any, path: str | Path | None, size: tuple[int, int], **options: Any) -> Iterator[Any]:
    """Give the caller's plotter or, without, a new one, and write at the end what was drawn if a file is asked for.

    A new plotter stays open for the caller if no file is asked for; else it is closed.

    Args:
        scene: A pyvista plotter, or None.
        path: File to write, or None.
        size: Width and height of a new plotter [pixels].
        options: Arguments of pyvista's `Plotter`.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    made, stays = (_opened(size, **options), False) if scene is None else (scene, True)
    try:
        yield made
        if path is not None:
            save(made, path)
        stays = stays or path is None
    finally:
        if not stays:
            made.close()


def _opened(size: tuple[int, int], **options: Any) -> Any:
    reason = cannot_render()
    if reason:
        raise FrameError(reason)
    made = _bare(size, **options)
    made.enable_anti_aliasing("ssaa")
    return made


def _bare(size: tuple[int, int], **options: Any) -> Any:
    import pyvista  # only here: importing it takes half a second, and may fail where nothing can be drawn

    pyvista.OFF_SCREEN = True
    made = pyvista.Plotter(off_screen=True, window_size=list(size), **options)
    made.set_background("white")
    made.disable_anti_aliasing()
    return made


def image(scene: Any) -> NDArray[np.uint8]:
    """Return what a plotter shows now (height, width, 3)."""
    # A screenshot alone would show the image that was rendered last.
    scene.render()
    return np.ascontiguousarray(scene.screenshot(return_img=True))


def grid(shape: Shape, displacement: Real | None = None, *, factor: float = 1.0) -> Any:
    """Return a shape as a pyvista surface, displaced by ``factor`` times the displacement (nodes, 3) [m].

    Args:
        shape: Floors and columns.
        displacement: Displacement of each node (nodes, 3) [m]; none when None.
        factor: By how much the displacement is enlarged [-].
    """
    import pyvista

    nodes: Real = shape.nodes if displacement is None else shape.nodes + factor * displacement
    faces = np.column_stack([np.full(len(shape.quads), 4), shape.quads])
    # A copy: pyvista would otherwise share the memory, and moving the picture would move the frame's mesh.
    return pyvista.PolyData(np.array(nodes, float), faces.ravel())


def add_lines(scene: Any, shape: Shape, nodes: Real, *, ghost: bool = False, colour: str = "") -> Any:
    """Add the outlines of floors and columns and return them; pale ones for a frame at rest.

    Args:
        scene: The plotter.
        shape: Floors and columns.
        nodes: Where the nodes are (nodes, 3) [m].
        ghost: Draw a pale frame at rest.
        colour: Draw a frame of another run in thick lines of this colour.
    """
    import pyvista

    lines = np.column_stack([np.full(len(shape.outline), 2), shape.outline])
    drawn = pyvista.PolyData(np.array(nodes, float), lines=lines.ravel())
    style = {"color": GHOST, "line_width": 1.0} if ghost else {"color": INK, "line_width": 1.2}
    if colour:
        style = {"color": colour, "line_width": 2.0}
    scene.add_mesh(drawn, **style)
    return drawn


def add_surface(scene: Any, surface: Any, **style: Any) -> None:
    """Add a surface evenly lit, a hair behind the lines that are drawn on it.

    Args:
        scene: The plotter.
        surface: A pyvista surface.
        style: Arguments of pyvista's `add_mesh`.
    """
    actor = scene.add_mesh(surface, **(LIGHT | style))
    actor.mapper.SetResolveCoincidentTopologyToPolygonOffset()


def add_plain(scene: Any, shape: Shape, displacement: Real | None = None, **mesh: Any) -> Any:
    """Add a frame in plain colours, floors lighter than columns, and return its surface.

    Args:
        scene: The plotter.
        shape: Floors and columns.
        displacement: Displacement of each node (nodes, 3) [m]; none when None.
        mesh: Arguments of pyvista's `add_mesh`.
    """
    surface = grid(shape, displacement)
    for members, colour in ((~shape.is_column, FLOOR), (shape.is_column, COLUMN)):
        part = surface.extract_cells(np.flatnonzero(members))
        add_surface(scene, part, color=colour, **mesh)
    return surface


def add_table(scene: Any, bounds: tuple[float, float, float, float], *, unit: float = 1.0) -> None:
    """Add the table under a plan.

    Args:
        scene: The plotter; the subplot that is active.
        bounds: Least x, largest x, least y, largest y [m].
        unit: Size of the frames over that of the thesis' frames [-].
    """
    import pyvista

    left, right, front, back = bounds
    rim = unit * RIM
    slab = pyvista.Box((left - rim, right + rim, front - rim, back + rim, -unit * THICKNESS, 0.0))
    add_surface(scene, slab, color=TABLE)
    scene.add_mesh(slab.extract_feature_edges(), color=INK, line_width=1.0)


def look(scene: Any, low: Real, high: Real, *, margins: Margins | None = None) -> None:
    """Point the camera along `VIEW` at a box, without perspective, so that lengths can be compared.

    Args:
        scene: The plotter; the subplot that is active.
        low: Least coordinates of the box (3,) [m].
        high: Largest coordinates of the box (3,) [m].
        margins: What to keep free of the picture; a little when None.
    """
    margins = margins or Margins()
    back = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    across, upward = corners @ right, corners @ up
    width, height = scene.renderer.GetSize()
    used = 1.0 - margins.left - margins.right, 1.0 - margins.top - margins.bottom
    scale = max(np.ptp(upward) / used[1], np.ptp(across) / used[0] * height / width)
    middle = [
        (across.max() + across.min()) / 2.0 + scale * width / height * (margins.right - margins.left) / 2.0,
        (upward.max() + upward.min()) / 2.0 + scale * (margins.top - margins.bottom) / 2.0,
    ]
    focus = middle[0] * right + middle[1] * up
    # Without perspective the distance changes nothing, but what lies behind the camera is cut off.
    distance = 10.0 * max(1.0, float(np.linalg.norm(corners, axis=1).max()))
    scene.camera_position = [tuple(focus + distance * back), tuple(focus), (0.0, 0.0, 1.0)]
    scene.enable_parallel_projection()
    scene.camera.parallel_scale = scale / 2.0
    scene.renderer.ResetCameraClippingRange()


def letters(scene: Any, size: float) -> int:
    """Return a font size for the picture at hand that is ``size`` in one of 640 by 800 pixels."""
    width, height = scene.window_size
    return int(max(5, round(size * min(width / 640.0, height / 800.0))))


def caption(scene: Any, words: str, *, size: int = 11, place: tuple[float, float] = (0.02, 0.98)) -> Any:
    """Write words whose upper left corner is at a place in the picture, as shares of its width and height.

    Args:
        scene: The plotter.
        words: What is written.
        size: Font size in a picture of 640 by 800 pixels.
        place: Place (x, y) as shares of the picture's width and height.
    """
    font = {"font_size": letters(scene, size), "font": "arial", "color": "black"}
    actor = scene.add_text(words, position=place, viewport=True, **font)
    actor.prop.justification_vertical = "top"
    return actor


def bar(scene: Any, title: str, **changes: Any) -> dict[str, Any]:
    """Return pyvista's arguments for an upright colour bar at the right.

    Args:
        scene: The plotter.
        title: Words above the bar.
        changes: Arguments that replace the ones here.
    """
    fonts = {"title_font_size": letters(scene, 16), "label_font_size": letters(scene, 15)}
    place = {"vertical": True, "position_x": 0.86, "position_y": 0.3, "height": 0.42, "width": 0.07}
    return {"title": f"{title}\n ", "color": "black", "n_labels": 5, "fmt": "%.3g"} | fonts | place | changes


def save(scene: Any, path: str | Path) -> None:
    """Write what a plotter shows; the file is there whole or not at all."""
    with replacing(path) as part:
        scene.screenshot(part)


def mesh_picture(
    reduced: ReducedFrame,
    path: str | Path | None = None,
    *,
    size: tuple[int, int] = (640, 800),
    scene: Any = None,
) -> Any:
    """Draw the mesh of a frame, floors and columns in two colours, with its elements.

    Args:
        reduced: The frame.
        path: Image file to write; none when None.
        size: Width and height [pixels].
        scene: A pyvista plotter to draw into; a new one when None.

    Returns:
        The plotter; one that was made here stays open if no file was asked for.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    shape = shape_of(reduced)
    with drawing(scene, path, size) as drawn:
        add_plain(drawn, shape, show_edges=True, edge_color="#6a737c", line_width=0.6)
        add_table(drawn, plan(reduced))
        caption(drawn, f"Frame {reduced.name}: {len(shape.quads)} elements, {len(shape.nodes)} nodes")
        drawn.add_axes(color="black", line_width=3, viewport=(0.0, 0.0, 0.2, 0.16))
        look(drawn, *box(reduced), margins=Margins(left=0.1, bottom=0.08))
    return drawn


def modes_picture(
    reduced: ReducedFrame,
    path: str | Path | None = None,
    *,
    modes: int = 3,
    size: tuple[int, int] = (1100, 760),
    scene: Any = None,
) -> Any:
    """Draw the lowest mode shapes side by side, coloured by displacement, the frame at rest as outline.

    Args:
        reduced: The frame.
        path: Image file to write; none when None.
        modes: Number of modes.
        size: Width and height [pixels].
        scene: A pyvista plotter to draw into, with a subplot for each mode; a new one when None.

    Returns:
        The plotter; one that was made here stays open if no file was asked for.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    shape = shape_of(reduced)
    count = min(modes, len(reduced.frequencies_hz))
    # A third of the plan is seen well.
    factor = 0.33 * reduced.plan_m[0]
    low, high = box(reduced, factor)
    with drawing(scene, path, size, shape=(1, count), border=False) as drawn:
        for mode in range(count):
            drawn.subplot(0, mode)
            moved = shape.moved(reduced.shapes[:, mode])
            moved = moved / np.linalg.norm(moved, axis=1).max()
            surface = grid(shape, factor * moved)
            name = "displacement / largest displacement"
            surface[name] = np.abs(moved[:, 0])
            where = {"vertical": False, "height": 0.06, "width": 0.9, "position_x": 0.05, "position_y": 0.02}
            place = bar(drawn, name, **where)
            middle = mode == count // 2
            add_surface(drawn, surface, cmap=MAP, clim=(0, 1), scalar_bar_args=place, show_scalar_bar=middle)
            add_lines(drawn, shape, surface.points)
            add_lines(drawn, shape, shape.nodes, ghost=True)
            words = f"mode {mode + 1}: {reduced.frequencies_hz[mode]:.2f} Hz"
            caption(drawn, words, size=13, place=(0.2, 0.98))
            look(drawn, low, high, margins=Margins(bottom=0.14))
    return drawn
