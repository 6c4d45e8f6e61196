"""Write what docs/diagnosis/catalogue.md has from the effects themselves: its tables, and docs/_static/catalogue.png.

Run it with `python docs/diagnosis/sketches.py` after an effect was added or its description changed.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue_page import shown, tables
from pounding.diagnosis.effects.describing import Curves, Sketch, nothing, relation
from pounding.experiments.pictures.palette import GREY, ORANGE

COLUMNS = 5
PAGE = Path(__file__).parent / "catalogue.md"
PICTURE = Path(__file__).parents[1] / "_static" / "catalogue.png"


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


def contact_loops() -> Curves:
    """A contact's force over a deformation that comes and goes, with little damping and with more."""
    phase = np.linspace(0, np.pi, 200)
    deep, speed = np.sin(phase), np.cos(phase)
    return deep, np.maximum(deep + 0.15 * speed, 0.0), np.maximum(deep + 0.4 * speed, 0.0)


def deforming(true: Callable[[np.ndarray], np.ndarray]) -> Sketch:
    """A contact's force over its deformation."""
    deep = np.linspace(0, 1, 101)
    return Sketch("contact", "deformation", "force", lambda: (deep, deep, true(deep)))


def closing(gap: float) -> Callable[[np.ndarray], np.ndarray]:
    """A contact's force over how far the frames have come together."""
    return lambda x: 2 * np.maximum(x - gap, 0.0)


CONTACTS = (
    ("gap_offset", relation("contact", "closing", "force", closing(0.0), closing(0.3))),
    ("contact_stiffness", deforming(lambda x: 0.55 * x)),
    ("contact_damping", Sketch("contact", "deformation", "force", contact_loops)),
    ("contact_law", deforming(lambda x: x**1.5)),
    ("second_contact", relation("second", "closing", "force", nothing, closing(0.0))),
)
"""Effects between two frames, which are no candidates in a frame."""


def panels() -> list[tuple[str, Sketch]]:
    """Return name and sketch of every effect."""
    own = [(kind.name, kind.described.sketch) for kind in shown(kinds()) if kind.described is not None]
    return [*own, *CONTACTS]


def draw(axes: Axes, sketch: Sketch) -> None:
    """Draw what an effect does: dashed as in the baseline model, in colour as it is."""
    x, baseline, true = sketch.curves()
    axes.plot(x, baseline, "--", color=GREY, lw=1)
    axes.plot(x, true, color=ORANGE, lw=1.2)
    axes.set_xlabel(sketch.across, fontsize=7, labelpad=1)
    axes.set_ylabel(sketch.up, fontsize=7, labelpad=1)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


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


def picture() -> None:
    """Draw all panels."""
    every = panels()
    rows = -(-len(every) // COLUMNS)
    figure = Figure(figsize=(11.5, 1.95 * rows))
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        rows, COLUMNS, left=0.01, right=0.99, top=0.95, bottom=0.05, hspace=0.55, wspace=0.12
    )
    for number, (name, sketch) in enumerate(every):
        cell = grid[number // COLUMNS, number % COLUMNS].subgridspec(1, 2, width_ratios=(1, 1.3), wspace=0.22)
        left, right = figure.add_subplot(cell[0]), figure.add_subplot(cell[1])
        place(left, sketch.mark)
        draw(right, sketch)
        right.set_title(name, fontsize=9, loc="right", family="monospace")
    store = io.BytesIO()
    figure.savefig(store, format="png", dpi=90)
    # A drawing of a few colours needs no more than these.
    Image.open(store).convert("RGB").quantize(32).save(PICTURE, optimize=True)


def main() -> None:
    """Write the tables and the picture."""
    page = PAGE.read_text(encoding="utf-8")
    for heading, rows in tables(kinds()).items():
        pattern = rf"(## {re.escape(heading)}\n(?:(?!\||##).*\n)*)(?:\|.*\n)+"
        page, found = re.subn(pattern, lambda match, rows=rows: f"{match[1]}{rows}\n", page)
        if found != 1:
            raise SystemExit(f"{PAGE}: there is no table under the heading {heading!r}; add one")
    PAGE.write_text(page, encoding="utf-8")
    picture()


if __name__ == "__main__":
    main()
