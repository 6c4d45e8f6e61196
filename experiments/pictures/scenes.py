"""Pictures of a run: frames on their table, coloured by stress, with a scale bar and the time.

Displacements are relative to the table. They and the gaps are enlarged by one factor, so that frames that
touch in the picture touch in the run.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

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
    grid,
    letters,
    look,
    plotter,
    save,
)
from pounding.frames.drawing.shapes import RIM, THICKNESS, Shape, plan, shape_of
from pounding.frames.response.stress import StressMap, stress_map

if TYPE_CHECKING:
    from pounding.experiments.rig.motion import FrameMotion, Motion

Real = NDArray[np.floating[Any]]

DRAWN_MOVEMENT = 0.25
"""The largest displacement is drawn as about this share of a frame's length along x."""

ARROW_M = 0.28
"""Length at which the largest contact force is drawn [m]."""

ARROW = {"shaft_radius": 0.03, "tip_radius": 0.08}

RED = "#b3262e"

LINGER_S = 0.12
"""A contact force is shown so long after its impact [s]: the impact itself is over within one image."""


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
    path: str | Path,
    *,
    time_s: float | None = None,
    title: str = "",
    size: tuple[int, int] | None = None,
) -> None:
    """Draw the deformed frames on their table at one moment, at rest as outline.

    Args:
        motion: The run.
        path: Image file to write.
        time_s: The moment [s]; that of `largest_moment` when None.
        title: First line of the caption.
        size: Width and height [pixels].

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    moment = largest_moment(motion) if time_s is None else time_s
    with plotter(size or size_of(motion)) as scene:
        stage = Stage(scene, motion, title=title)
        stage.add_rest()
        stage.show(moment)
        save(scene, path)


class Stage:
    """Frames on a table in a plotter, moved from moment to moment.

    Args:
        scene: The plotter.
        motion: The run.
        title: First line of the caption.
    """

    def __init__(self, scene: Any, motion: Motion, *, title: str = "") -> None:
        self._scene, self._motion = scene, motion
        self._title = title or " and ".join(f"frame {name}" for name in labels(motion))
        self.factor = enlargement(motion)
        shift = places(motion, factor=self.factor)
        stressed = all(frame.reduced.is_mesh for frame in motion.frames)
        moment = largest_moment(motion)
        self._actors = [
            _Actor(scene, frame, place, self.factor, stressed)
            for frame, place in zip(motion.frames, shift, strict=True)
        ]
        largest = max(actor.values(moment).max() for actor in self._actors)
        for number, actor in enumerate(self._actors):
            actor.add(largest or 1.0, with_bar=number == 0)
        self._forces = [contact.sampled() for contact in motion.contacts]
        self._largest_force = max((force.max(initial=0.0) for _, force in self._forces), default=0.0)
        self._dress(shift)
        self._caption = caption(scene, "")

    def _dress(self, shift: list[float]) -> None:
        frames = [frame.reduced for frame in self._motion.frames]
        plans = [np.array(plan(frame)) + [x, x, 0.0, 0.0] for frame, x in zip(frames, shift, strict=True)]
        left, right = min(p[0] for p in plans), max(p[1] for p in plans)
        front, back = min(p[2] for p in plans), max(p[3] for p in plans)
        add_table(self._scene, (left, right, front, back))
        reach = max(RIM, DRAWN_MOVEMENT * frames[0].plan_m[0])
        low = np.array([left - reach, front - RIM, -THICKNESS])
        high = np.array([right + reach, back + RIM, max(frame.heights_m[-1] for frame in frames)])
        self._scale_bar(np.array([left, front - RIM, -THICKNESS]))
        look(self._scene, low, high, margins=Margins(left=0.05, right=0.17, top=0.13, bottom=0.1))

    def _scale_bar(self, corner: Real) -> None:
        """Draw how long a round displacement is drawn, along x in front of the table."""
        import pyvista

        largest = DRAWN_MOVEMENT * self._motion.frames[0].reduced.plan_m[0] / self.factor
        length = _round_down(largest)
        start = corner + [0.0, 0.0, -0.05]
        end = start + [self.factor * length, 0.0, 0.0]
        tick = np.array([0.0, 0.0, 0.012])
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
        self._scene.add_point_labels([end + [0.02, 0.0, 0.0]], [words], **style)

    def add_rest(self) -> None:
        """Add the outlines of the frames at rest."""
        for actor in self._actors:
            add_lines(self._scene, actor.shape, actor.shape.nodes + actor.place, ghost=True)

    def show(self, time_s: float) -> None:
        """Move the frames to where they are at a time [s], and show the contact forces around it."""
        for actor in self._actors:
            actor.move(time_s)
        words = [self._title, f"t = {time_s:6.3f} s, displacement enlarged {self.factor:g} times"]
        for number, (contact, history) in enumerate(zip(self._motion.contacts, self._forces, strict=True)):
            force = _shown_force(history, time_s)
            self._arrows(number, force)
            words.append(f"contact at floor {contact.floor}: {force / 1e3:.2f} kN" if force else "")
        self._caption.input = "\n".join(words)

    def _arrows(self, number: int, force: float) -> None:
        """Draw a contact's force on both floors; nothing where there is none."""
        import pyvista

        contact = self._motion.contacts[number]
        names = [frame.name for frame in self._motion.frames]
        pair = list(pairwise(names)).index((contact.left, contact.right))
        for side, actor in ((-1.0, self._actors[pair]), (1.0, self._actors[pair + 1])):
            name = f"force {number} {side}"
            if not force:
                self._scene.remove_actor(name)
                continue
            length = ARROW_M * (0.3 + 0.7 * force / self._largest_force)
            edge = actor.edge(contact.floor, -side)
            arrow = pyvista.Arrow(start=edge, direction=(side, 0.0, 0.0), scale=length, **ARROW)
            self._scene.add_mesh(arrow, color=RED, name=name, lighting=False)


class _Actor:
    """One frame in a scene."""

    def __init__(self, scene: Any, frame: FrameMotion, place: float, factor: float, stressed: bool) -> None:
        self.frame, self.factor = frame, factor
        self.place = np.array([place, 0.0, 0.0])
        self.shape: Shape = shape_of(frame.reduced)
        self._scene = scene
        self._stress: StressMap | None = stress_map(frame.reduced) if stressed else None
        self._q = np.zeros(len(frame.reduced.mass))

    def values(self, time_s: float) -> Real:
        """Return the stress [MPa] of the elements or, for sticks, the displacement [mm] of the nodes."""
        q = self.frame.sampled([time_s])[0][0]
        if self._stress is not None:
            return self._stress.von_mises(q) / 1e6
        return 1e3 * np.abs(self.shape.moved(q)[:, 0])

    def add(self, largest: float, *, with_bar: bool) -> None:
        self.surface = grid(self.shape)
        name = "displacement\n[mm]" if self._stress is None else "von Mises\n[MPa]"
        self._field = (self.surface.point_data if self._stress is None else self.surface.cell_data, name)
        self._field[0][name] = self.values(0.0)
        colours = MAP if self._stress is None else STRESS_MAP
        style = {"scalars": name, "cmap": colours, "clim": (0.0, largest), "show_scalar_bar": with_bar}
        add_surface(self._scene, self.surface, scalar_bar_args=bar(self._scene, name), **style)
        self._lines = add_lines(self._scene, self.shape, self.shape.nodes)

    def move(self, time_s: float) -> None:
        self._q = self.frame.sampled([time_s])[0][0]
        nodes = self.shape.nodes + self.place + self.factor * self.shape.moved(self._q)
        self.surface.points[:] = nodes
        self._lines.points[:] = nodes
        self.surface.Modified()
        self._lines.Modified()
        data, name = self._field
        data[name][:] = self.values(time_s)

    def edge(self, floor: int, side: float) -> Real:
        """Return where the front corner of a floor's left (-1) or right (1) edge is drawn (3,) [m]."""
        reduced = self.frame.reduced
        x = side * reduced.plan_m[0] / 2.0 + self.factor * float(self._q[self.frame.floor(floor)])
        return self.place + [x, plan(reduced)[2], float(reduced.heights_m[floor - 1])]


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


def _shown_force(history: tuple[Real, Real], time_s: float) -> float:
    times, force = history
    recent = (times <= time_s + 1e-9) & (times > time_s - LINGER_S)
    return float(force[recent].max(initial=0.0))


def size_of(motion: Motion) -> tuple[int, int]:
    """Return width and height for a run [pixels], multiples of 16 as films want them."""
    frames = [frame.reduced for frame in motion.frames]
    slender = max(frame.heights_m[-1] / frame.plan_m[0] for frame in frames) / len(frames) > 2.0
    return (640, 800) if slender else (960, 800)
