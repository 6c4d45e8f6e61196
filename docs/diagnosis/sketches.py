"""Draw docs/_static/catalogue.png: where each effect of the catalogue sits, and what it does.

Run it with `python docs/diagnosis/sketches.py`. Forces are those of `pounding.diagnosis.model.predictor.law`.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from pounding.diagnosis.inference.storey_force import along
from pounding.diagnosis.model.predictor import BUMPER, CUBIC, DAMPER, FRICTION, HYSTERESIS
from pounding.diagnosis.report.palette import GREY, ORANGE

TIME = np.linspace(0.0, 1.0, 800)
DRIFT = np.sin(2 * np.pi * 2 * TIME) * (0.55 + 0.45 * TIME)
RATE = np.gradient(DRIFT, TIME)
SLOPE = 1.0
COLUMNS = 6


def storey(axes: Axes, kind: int, *numbers: float) -> None:
    """Force against drift: the storey's own spring dashed, with the effect in colour."""
    parameters = np.zeros(5)
    parameters[: len(numbers)] = numbers
    own = SLOPE * DRIFT
    axes.plot(DRIFT, own, "--", color=GREY, lw=1)
    axes.plot(DRIFT, own + along(kind, parameters, DRIFT, RATE, TIME), color=ORANGE, lw=1.2)
    axes.set_xlabel("drift", fontsize=7, labelpad=1)
    axes.set_ylabel("force", fontsize=7, labelpad=1)


def lines(x: np.ndarray, model: np.ndarray, true: np.ndarray, across: str, up: str) -> Callable[[Axes], None]:
    """A relation as believed, dashed, and as it is."""

    def draw(axes: Axes) -> None:
        axes.plot(x, model, "--", color=GREY, lw=1)
        axes.plot(x, true, color=ORANGE, lw=1.2)
        axes.set_xlabel(across, fontsize=7, labelpad=1)
        axes.set_ylabel(up, fontsize=7, labelpad=1)

    return draw


def law(kind: int, *numbers: float) -> Callable[[Axes], None]:
    """The law of an effect in a storey."""
    return lambda axes: storey(axes, kind, *numbers)


def building(axes: Axes, mark: str, at: float = 0.0) -> None:
    """A frame of three storeys on a table with what is marked in colour."""
    lean = 0.18 if mark == "rock" else 0.0
    pair = mark == "contact"
    for left in (at, at + 1.55) if pair else (at,):
        for floor in range(4):
            x0, x1 = left + lean * floor, left + 1 + lean * floor
            colour = ORANGE if (mark == "floor" and floor == 2) or (mark == "floors" and floor) else "black"
            width = 4 if colour == ORANGE and mark == "floor" else 2
            axes.plot([x0, x1], [floor, floor], color=colour, lw=width, solid_capstyle="butt")
            if floor < 3:
                inside = mark == "storey" and floor == 1
                whole = mark in ("frame", "rock")
                colour = ORANGE if inside or whole else "black"
                for x in (x0, x1):
                    axes.plot([x, x + lean], [floor, floor + 1], color=colour, lw=1.6 if inside else 1)
    if mark == "joints":
        for floor in range(1, 4):
            axes.plot([at, at + 1], [floor, floor], "o", ms=4, color=ORANGE)
    if mark == "sensor":
        axes.plot([at + 1.15], [2], "s", ms=6, color=ORANGE)
    if pair:
        axes.annotate(
            "", (at + 1.55, 2), (at + 1, 2), arrowprops={"arrowstyle": "<->", "color": ORANGE, "lw": 1.6}
        )
    colour = ORANGE if mark in ("table", "tilt") else GREY
    rise = 0.22 if mark == "tilt" else 0.0
    axes.plot([at - 0.4, at + 1.4 + 1.55 * pair], [-0.22 - rise, -0.22 + rise], color=colour, lw=4)
    axes.set_xlim(-0.6, 3.1 if pair else 1.8)
    axes.set_ylim(-0.7, 3.3)
    axes.set_aspect("equal")
    axes.axis("off")


def panels() -> list[tuple[str, str, Callable[[Axes], None]]]:
    """Return name, what is marked, and what is drawn beside it, in the order of the catalogue."""
    x = np.linspace(-1, 1, 101)
    t, deep = TIME, np.linspace(0, 1, 101)
    motion = np.sin(2 * np.pi * 2 * t)
    event = np.maximum(x, 0.0)
    return [
        ("stiffness_change", "storey", lines(x, x, 0.6 * x, "drift", "force")),
        ("joint_flexibility", "joints", lines(x, x, 0.6 * x, "joint's turn", "moment")),
        ("base_rocking", "rock", lines(x, 0 * x, 0.7 * x, "base moment", "base's turn")),
        ("p_delta", "frame", lines(x, x, 0.75 * x, "drift", "force")),
        ("added_mass", "floor", lines(x, x, 1.4 * x, "acceleration", "inertia")),
        ("damping_change", "storey", law(DAMPER, 0.035)),
        ("coulomb_friction", "storey", law(FRICTION, 0.3, 30.0, 0.0)),
        ("air_drag", "floors", lines(x, 0 * x, x * abs(x), "floor velocity", "force")),
        ("cubic_stiffness", "storey", law(CUBIC, 0.8)),
        ("hysteresis", "storey", law(HYSTERESIS, 0.25, 0.6, 8.0)),
        ("loosening", "storey", lines(t, 1 + 0 * t, 1 - 0.5 * t, "time in the run", "stiffness")),
        ("bumper", "storey", law(BUMPER, 0.5, 2.0)),
        (
            "torsional_eccentricity",
            "plan",
            lines(t, motion, motion + 0.4 * np.sin(5 * np.pi * t), "time", "floor's edge"),
        ),
        ("table_gain", "table", lines(t, motion, 1.3 * motion, "time", "table")),
        ("table_delay", "table", lines(t, motion, np.sin(2 * np.pi * 2 * (t - 0.06)), "time", "table")),
        ("table_tilt", "tilt", lines(x, 0 * x, 0.7 * x, "table accel.", "pitch")),
        ("sensor_gain", "sensor", lines(x, x, 1.4 * x, "truth", "reading")),
        ("sensor_delay", "sensor", lines(t, motion, np.sin(2 * np.pi * 2 * (t - 0.06)), "time", "reading")),
        ("sensor_offset", "sensor", lines(t, motion, motion + 0.5, "time", "reading")),
        ("gap_offset", "contact", lines(x, 2 * event, 2 * np.maximum(x - 0.3, 0), "closing", "force")),
        ("contact_stiffness", "contact", lines(deep, deep, 0.55 * deep, "deformation", "force")),
        ("contact_damping", "contact", _loops(0.15, 0.4)),
        ("contact_law", "contact", lines(deep, deep, deep**1.5, "deformation", "force")),
        ("second_contact", "second", lines(x, 0 * x, 2 * event, "closing", "force")),
    ]


def _loops(model: float, true: float) -> Callable[[Axes], None]:
    phase = np.linspace(0, np.pi, 200)
    deep, speed = np.sin(phase), np.cos(phase)

    def draw(axes: Axes) -> None:
        for share, style, colour in ((model, "--", GREY), (true, "-", ORANGE)):
            axes.plot(deep, np.maximum(deep + share * speed, 0.0), style, color=colour, lw=1.1)
        axes.set_xlabel("deformation", fontsize=7, labelpad=1)
        axes.set_ylabel("force", fontsize=7, labelpad=1)

    return draw


def place(axes: Axes, mark: str) -> None:
    """Draw where the effect sits."""
    if mark == "plan":
        axes.plot([0, 1, 1, 0, 0], [1, 1, 2, 2, 1], color="black", lw=2)
        axes.plot([0.5], [1.5], "o", ms=5, color="black")
        axes.plot([0.8], [1.5], "o", ms=5, color=ORANGE)
        axes.text(0.5, 0.62, "plan", ha="center", fontsize=7)
        axes.set_xlim(-0.6, 1.8)
        axes.set_ylim(-0.7, 3.3)
        axes.set_aspect("equal")
        axes.axis("off")
    elif mark == "second":
        building(axes, "contact")
        axes.annotate("", (1.55, 3), (1, 3), arrowprops={"arrowstyle": "<->", "color": GREY, "lw": 1.2})
    else:
        building(axes, mark)


def main() -> None:
    """Draw all panels and write the picture."""
    shown = panels()
    rows = -(-len(shown) // COLUMNS)
    figure = Figure(figsize=(13.5, 1.95 * rows))
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        rows, COLUMNS, left=0.01, right=0.99, top=0.95, bottom=0.05, hspace=0.55, wspace=0.12
    )
    for number, (name, mark, draw) in enumerate(shown):
        cell = grid[number // COLUMNS, number % COLUMNS].subgridspec(1, 2, width_ratios=(1, 1.3), wspace=0.22)
        left, right = figure.add_subplot(cell[0]), figure.add_subplot(cell[1])
        place(left, mark)
        draw(right)
        right.set_xticks([])
        right.set_yticks([])
        for side in ("top", "right"):
            right.spines[side].set_visible(False)
        right.set_title(name, fontsize=9, loc="right", family="monospace")
    path = Path(__file__).parents[1] / "_static" / "catalogue.png"
    store = io.BytesIO()
    figure.savefig(store, format="png", dpi=90)
    # A drawing of a few colours needs no more than these.
    Image.open(store).convert("RGB").quantize(32).save(path, optimize=True)


if __name__ == "__main__":
    main()
