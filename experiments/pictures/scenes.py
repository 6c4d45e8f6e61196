"""Pictures of a run: frames on their table, coloured by stress, with a scale bar and the time.

Displacements are relative to the table. They and the gaps are enlarged by one factor, so that frames that
touch in the picture touch in the run.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.experiments.pictures.palette import BLUE
from pounding.experiments.pictures.series import places
from pounding.experiments.results.dataset import labels
from pounding.frames.drawing.pictures import (
    INK,
    MAP,
    STRESS_MAP,
    Margins,
    add_lines,
    add_surface,
    add_table,
    bar,
    caption,
    drawing,
    grid,
    letters,
    look,
)
from pounding.frames.drawing.shapes import RIM, THICKNESS, Shape, plan, shape_of
from pounding.frames.response.stress import StressMap, stress_map

if TYPE_CHECKING:
    from pounding.experiments.rig.contact_history import ContactHistory
    from pounding.experiments.rig.motion import FrameMotion, Motion
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

DRAWN_MOVEMENT = 0.25
"""The largest displacement is drawn as about this share of a frame's length along x."""

ARROW_M = 0.28
"""Length at which the largest contact force is drawn beside frames of `USUAL_PLAN_M` [m]."""

USUAL_PLAN_M = 0.4
"""Length along x of the thesis' frames [m]: arrows, rims and ticks grow with the frames."""

ARROW = {"shaft_radius": 0.03, "tip_radius": 0.08}

RED = "#b3262e"

BEHIND = BLUE
"""Colour of the lines of another run."""


class Instant(NamedTuple):
    """What differs from image to image.

    Attributes:
        time_s: The moment [s].
        coordinates: Coordinates of each frame, (n,) [m].
        forces_n: Force of each contact [N].
        behind: Coordinates of each frame in another run, drawn as lines; empty without one.
    """

    time_s: float
    coordinates: tuple[Real, ...]
    forces_n: tuple[float, ...]
    behind: tuple[Real, ...] = ()


class Place(NamedTuple):
    """Where a contact is: the frame on its left (0 is the first), the floor of each of the two, and y along their edge [m].

    A floor between two whole numbers is a place on columns.
    """

    left: int
    floors: tuple[float, float]
    y_m: float = 0.0

    @property
    def words(self) -> str:
        """Where it is, in words."""
        whole = next((floor for floor in self.floors if float(floor).is_integer()), self.floors[0])
        return f"contact at floor {whole:g}" + (f", y = {self.y_m:g} m" if self.y_m else "")


@dataclass(frozen=True, eq=False)
class Setting:
    """What is the same in all images of a run.

    Attributes:
        frames: The frames, from left to right.
        shift_m: Where the middle of each stands along x [m].
        factor: Enlargement of displacements and gaps.
        contacts: Place of each contact.
        extreme: The run at `largest_moment`: colours and arrows are scaled to it.
        title: First line of the caption.
    """

    frames: tuple[ReducedFrame, ...]
    shift_m: tuple[float, ...]
    factor: float
    contacts: tuple[Place, ...]
    extreme: Instant
    title: str


def setting(motion: Motion, *, title: str = "") -> Setting:
    """Return what is the same in all images of a run.

    Args:
        motion: The run.
        title: First line of the caption; the frames' names when empty.
    """
    factor = enlargement(motion)
    pairs = list(pairwise(frame.name for frame in motion.frames))
    return Setting(
        frames=tuple(frame.reduced for frame in motion.frames),
        shift_m=tuple(places(motion, factor=factor)),
        factor=factor,
        contacts=tuple(
            Place(
                pairs.index((c.left, c.right)),
                (c.floor, c.floor if c.right_floor is None else c.right_floor),
                c.y_m,
            )
            for c in motion.contacts
        ),
        extreme=instants(motion, [largest_moment(motion)])[0],
        title=title or " and ".join(f"frame {name}" for name in labels(motion)),
    )


def instants(
    motion: Motion, times_s: ArrayLike, *, exposure_s: float = 0.0, behind: Motion | None = None
) -> list[Instant]:
    """Return what a run shows at some times.

    Args:
        motion: The run.
        times_s: The times (k,) [s].
        exposure_s: Time that an image stands for [s]. Its force is the largest in so long a time before it,
            for an impact may begin and end between two images.
        behind: Another run of the same frames, to be drawn as lines.
    """
    times = np.asarray(times_s, float)
    moved = zip(*(frame.sampled(times)[0] for frame in motion.frames), strict=True)
    forces = [_forces(contact, times, exposure_s) for contact in motion.contacts]
    rows = zip(*forces, strict=True) if forces else [()] * len(times)
    lines: Any = [()] * len(times)
    if behind is not None:
        lines = zip(*(frame.sampled(times)[0] for frame in behind.frames), strict=True)
    return [
        Instant(float(time), tuple(q), tuple(float(force) for force in row), tuple(other))
        for time, q, row, other in zip(times, moved, rows, lines, strict=True)
    ]


def _forces(contact: ContactHistory, times_s: Real, exposure_s: float) -> Real:
    """Return the largest force (k,) [N] of a contact in the time before each moment, that moment included."""
    now = contact.at(times_s)[2]
    times, force = contact.sampled()
    first, last = (np.searchsorted(times, edge, side="right") for edge in (times_s - exposure_s, times_s))
    before = [force[a:b].max(initial=0.0) for a, b in zip(first, last, strict=True)]
    return np.maximum(now, before)


def largest_moment(motion: Motion) -> float:
    """Return the time [s] of the largest contact force or, with none, of the largest roof displacement."""
    forces = [contact.sampled() for contact in motion.contacts]
    if any(force.max(initial=0.0) > 0.0 for _, force in forces):
        times, force = max(forces, key=lambda history: history[1].max())
        return float(times[force.argmax()])
    frame = max(motion.frames, key=lambda f: np.abs(_roof(f)).max())
    return float(frame.time_s[np.abs(_roof(frame)).argmax()])


def picture(
    motion: Motion,
    path: str | Path | None = None,
    *,
    time_s: float | None = None,
    title: str = "",
    size: tuple[int, int] | None = None,
    behind: Motion | None = None,
    scene: Any = None,
) -> Any:
    """Draw the deformed frames on their table at one moment, at rest as outline.

    Args:
        motion: The run.
        path: Image file to write; none when None.
        time_s: The moment [s]; that of `largest_moment` when None.
        title: First line of the caption.
        size: Width and height [pixels].
        behind: Another run of the same frames, drawn as blue lines.
        scene: A pyvista plotter to draw into; a new one when None.

    Returns:
        The plotter; one that was made here stays open if no file was asked for.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    moment = largest_moment(motion) if time_s is None else time_s
    with drawing(scene, path, size or size_of(motion)) as drawn:
        stage = Stage(drawn, setting(motion, title=title))
        stage.add_rest()
        stage.show(instants(motion, [moment], behind=behind)[0])
    return drawn


class Stage:
    """Frames on a table in a plotter, moved from image to image.

    Args:
        scene: The plotter.
        setting: What stays the same.
    """

    def __init__(self, scene: Any, setting: Setting) -> None:
        self._scene, self._setting = scene, setting
        self._unit = setting.frames[0].plan_m[0] / USUAL_PLAN_M
        stressed = all(frame.is_mesh for frame in setting.frames)
        self._actors = [
            _Actor(scene, frame, place, setting.factor, stressed)
            for frame, place in zip(setting.frames, setting.shift_m, strict=True)
        ]
        extreme = zip(self._actors, setting.extreme.coordinates, strict=True)
        largest = max(actor.values(q).max() for actor, q in extreme)
        for number, actor in enumerate(self._actors):
            actor.add(largest or 1.0, with_bar=number == 0)
        self._arrows = [[self._arrow(side) for side in (-1.0, 1.0)] for _ in setting.contacts]
        self._dress()
        self._caption = caption(scene, "")

    def _dress(self) -> None:
        frames, shift = self._setting.frames, self._setting.shift_m
        plans = [np.array(plan(frame)) + [x, x, 0.0, 0.0] for frame, x in zip(frames, shift, strict=True)]
        left, right = min(p[0] for p in plans), max(p[1] for p in plans)
        front, back = min(p[2] for p in plans), max(p[3] for p in plans)
        rim, thickness = self._unit * RIM, self._unit * THICKNESS
        add_table(self._scene, (left, right, front, back), unit=self._unit)
        reach = max(rim, DRAWN_MOVEMENT * frames[0].plan_m[0])
        low = np.array([left - reach, front - rim, -thickness])
        high = np.array([right + reach, back + rim, max(frame.heights_m[-1] for frame in frames)])
        self._scale_bar(np.array([left, front - rim, -thickness]))
        look(self._scene, low, high, margins=Margins(left=0.05, right=0.17, top=0.13, bottom=0.1))

    def _scale_bar(self, corner: Real) -> None:
        """Draw how long a round displacement is drawn, along x in front of the table."""
        import pyvista

        largest = DRAWN_MOVEMENT * self._setting.frames[0].plan_m[0] / self._setting.factor
        length = _round_down(largest)
        start = corner + [0.0, 0.0, -0.05 * self._unit]
        end = start + [self._setting.factor * length, 0.0, 0.0]
        tick = np.array([0.0, 0.0, 0.012 * self._unit])
        points = np.array([start, end, start - tick, start + tick, end - tick, end + tick])
        lines = pyvista.PolyData(points, lines=[2, 0, 1, 2, 2, 3, 2, 4, 5])
        self._scene.add_mesh(lines, color=INK, line_width=2.5)
        style = {
            "shape": None,
            "show_points": False,
            "font_size": letters(self._scene, 15),
            "font_family": "arial",
            "bold": False,
        }
        style |= {"text_color": "black", "always_visible": True, "justification_vertical": "center"}
        words = f"{1e3 * length:g} mm displacement"
        self._scene.add_point_labels([end + [0.02 * self._unit, 0.0, 0.0]], [words], **style)

    def add_rest(self) -> None:
        """Add the outlines of the frames at rest."""
        for actor in self._actors:
            add_lines(self._scene, actor.shape, actor.shape.nodes + actor.place, ghost=True)

    def show(self, instant: Instant) -> None:
        """Move the frames to where they are at an instant, and show the contacts' forces."""
        setting = self._setting
        for actor, q in zip(self._actors, instant.coordinates, strict=True):
            actor.move(q)
        for actor, q in zip(self._actors, instant.behind, strict=False):
            actor.move_behind(q)
        words = [
            setting.title,
            f"t = {instant.time_s:6.3f} s, displacement enlarged {setting.factor:g} times",
        ]
        for place, arrows, force in zip(setting.contacts, self._arrows, instant.forces_n, strict=True):
            self._point(place, arrows, force)
            words.append(f"{place.words}: {_in_words(force)}" if force else "")
        self._caption.input = "\n".join(words)

    def _arrow(self, side: float) -> Any:
        """Add an arrow of length 1 m to the left (-1) or right (1), which no one sees yet."""
        import pyvista

        shape = pyvista.Arrow(direction=(side, 0.0, 0.0), **ARROW)
        arrow = self._scene.add_mesh(shape, color=RED, lighting=False)
        arrow.visibility = False
        return arrow

    def _point(self, place: Place, arrows: list[Any], force: float) -> None:
        """Let a contact's arrows point from both floors' edges; nothing where there is no force."""
        largest = max(self._setting.extreme.forces_n)
        pair = zip((-1.0, 1.0), arrows, self._actors[place.left : place.left + 2], strict=True)
        for (side, arrow, actor), floor in zip(pair, place.floors, strict=True):
            arrow.visibility = force > 0.0
            if force > 0.0:
                arrow.position = actor.edge(floor, -side, place.y_m)
                arrow.scale = self._unit * ARROW_M * (0.3 + 0.7 * force / largest)


class _Actor:
    """One frame in a scene."""

    def __init__(
        self, scene: Any, reduced: ReducedFrame, place: float, factor: float, stressed: bool
    ) -> None:
        self.reduced, self.factor = reduced, factor
        self.place = np.array([place, 0.0, 0.0])
        self.shape: Shape = shape_of(reduced)
        self._scene = scene
        self._stress: StressMap | None = stress_map(reduced) if stressed else None
        self._q: Real = np.zeros(reduced.size)
        self._behind: Any = None

    def values(self, q: Real) -> Real:
        """Return the stress [MPa] of the elements or, for sticks, the displacement [mm] of the nodes."""
        if self._stress is not None:
            return self._stress.von_mises(q) / 1e6
        return 1e3 * np.abs(self.shape.moved(q)[:, 0])

    def add(self, largest: float, *, with_bar: bool) -> None:
        self.surface = grid(self.shape)
        name = "displacement\n[mm]" if self._stress is None else "von Mises\n[MPa]"
        self._field = (self.surface.point_data if self._stress is None else self.surface.cell_data, name)
        self._field[0][name] = self.values(self._q)
        colours = MAP if self._stress is None else STRESS_MAP
        style = {"scalars": name, "cmap": colours, "clim": (0.0, largest), "show_scalar_bar": with_bar}
        add_surface(self._scene, self.surface, scalar_bar_args=bar(self._scene, name), **style)
        self._lines = add_lines(self._scene, self.shape, self.shape.nodes)

    def move(self, q: Real) -> None:
        self._q = q
        nodes = self.shape.nodes + self.place + self.factor * self.shape.moved(self._q)
        self.surface.points[:] = nodes
        self._lines.points[:] = nodes
        self.surface.Modified()
        self._lines.Modified()
        data, name = self._field
        data[name][:] = self.values(q)

    def move_behind(self, q: Real) -> None:
        """Move the lines of another run, which are added when they are first seen."""
        nodes = self.shape.nodes + self.place + self.factor * self.shape.moved(q)
        if self._behind is None:
            self._behind = add_lines(self._scene, self.shape, nodes, colour=BEHIND)
        self._behind.points[:] = nodes
        self._behind.Modified()

    def edge(self, floor: float, side: float, y_m: float = 0.0) -> Real:
        """Return where a place on a floor's left (-1) or right (1) edge is drawn (3,) [m]: for y = 0 its front corner."""
        reduced = self.reduced
        y = y_m or plan(reduced)[2]
        floors = self._q[reduced.floor_x]
        if reduced.turns:
            floors = floors - y * self._q[reduced.floor_rz]
        numbers = np.arange(reduced.storeys + 1)
        x = side * reduced.plan_m[0] / 2.0 + self.factor * float(np.interp(floor, numbers, [0.0, *floors]))
        return self.place + [x, y, float(np.interp(floor, numbers, [0.0, *reduced.heights_m]))]


def enlargement(motion: Motion) -> float:
    """Return a round factor under which the largest roof displacement is seen well."""
    largest = max(np.abs(_roof(frame)).max() for frame in motion.frames)
    length = motion.frames[0].reduced.plan_m[0]
    return max(1.0, _round_down(DRAWN_MOVEMENT * length / largest)) if largest > 0.0 else 1.0


def _round_down(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-9)) * power)


def _roof(frame: FrameMotion) -> Real:
    return frame.floor_displacement(frame.reduced.storeys)


def size_of(motion: Motion) -> tuple[int, int]:
    """Return width and height for a run [pixels], multiples of 16 as films want them."""
    frames = [frame.reduced for frame in motion.frames]
    slender = max(frame.heights_m[-1] / frame.plan_m[0] for frame in frames) / len(frames) > 2.0
    return (640, 800) if slender else (960, 800)


def _in_words(force_n: float) -> str:
    """Return a force in kN for models and in MN for buildings."""
    return f"{force_n / 1e3:.2f} kN" if force_n < 1e6 else f"{force_n / 1e6:.2f} MN"
