"""Sheets of four panels, one a ground motion, as the thesis prints its figures (a) to (d).

Each function draws into the axes that it is given and returns nothing; `four_panels` makes them and `save` writes the file.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pounding.experiments.pictures.contact_plots import COLOURS
from pounding.experiments.pictures.plots import OURS, PUBLISHED, STYLE, THEIRS, end_of_motion
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pounding.experiments.rig.contact_history import ContactHistory

Real = NDArray[np.floating[Any]]

GREY = "#888888"
REST = 0.5
"""A motion is drawn until it stays below this share of its largest value: the part in which peaks are decided."""
AROUND_S = 0.05
"""Time that is drawn before the first and after the last impact [s]."""


class Line(NamedTuple):
    """A history to draw.

    Attributes:
        label: In the legend.
        time_s: Instants (m,) [s].
        values: What is drawn (m,), in the unit of the axis.
    """

    label: str
    time_s: Real
    values: Real


class Level(NamedTuple):
    """A published value to mark across a panel: its label, its values in the unit of the axis, its colour and dashes."""

    label: str
    values: tuple[float, ...]
    colour: str = PUBLISHED
    dashes: str = "--"


@matplotlib.rc_context(STYLE | {"font.size": 9})
def four_panels(names: Sequence[str], title: str, *, x: str, y: str) -> tuple[Figure, list[Axes]]:
    """Return a figure with a panel for each name, two beside each other.

    Args:
        names: Above the panels.
        title: Above the figure.
        x: Label of the horizontal axes, with its unit.
        y: Label of the vertical axes, with its unit.
    """
    figure = Figure(figsize=(9.6, 5.4), layout="constrained")
    grid = figure.subplots(2, 2, squeeze=False)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    for axis, name in zip(grid.flat, names, strict=True):
        axis.set_title(name, loc="left", fontsize=9)
    for axis in grid[-1]:
        axis.set_xlabel(x)
    for axis in grid[:, 0]:
        axis.set_ylabel(y)
    return figure, list(grid.flat)


def motion(axis: Axes, lines: Sequence[Line], levels: Iterable[Level] = ()) -> None:
    """Draw histories and published values into a panel, until the motion has died away.

    Args:
        axis: The panel.
        lines: Histories, the most important one first; at most two.
        levels: Published values.
    """
    for line, colour in zip(lines, (OURS, THEIRS), strict=False):
        axis.plot(line.time_s, line.values, color=colour, lw=0.8, label=line.label)
    for level in levels:
        for place, value in enumerate(level.values):
            label = level.label if place == 0 else None
            axis.axhline(value, color=level.colour, lw=1.2, ls=level.dashes, label=label)
    axis.set_xlim(0.0, max(end_of_motion(line.time_s, [line.values], rest=REST) for line in lines))


def forces(axis: Axes, contacts: Mapping[str, ContactHistory]) -> None:
    """Draw contact forces, from the first impact of any law to the last one.

    Args:
        axis: The panel.
        contacts: Contact by the name of its law.
    """
    touching = [pulse for contact in contacts.values() for pulse in contact.pulses]
    if not touching:
        axis.annotate("the floors do not touch", (0.5, 0.5), xycoords="axes fraction", ha="center")
        axis.set(xticks=[], yticks=[])
        return
    for name, contact in contacts.items():
        time, force = contact.sampled()
        axis.plot(time, force, color=COLOURS.get(name, GREY), lw=0.8, label=name.replace("_", " "))
    first, last = min(pulse[0] for pulse in touching), max(pulse[1] for pulse in touching)
    axis.set_xlim(first - AROUND_S, last + AROUND_S)


def legend(figure: Figure, axes: Iterable[Axes]) -> None:
    """Put one legend of all labels of the panels below them."""
    found: dict[str, Any] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    if found:
        figure.legend(
            found.values(), found.keys(), loc="outside lower center", ncols=min(len(found), 5), fontsize=8
        )


@matplotlib.rc_context(STYLE | {"font.size": 9})
def force_and_sum(lines: Sequence[Line], dissimilarities_n: Mapping[str, float], title: str) -> Figure:
    """Return one interval of several laws: the forces above, and their sums over the samples below.

    Args:
        lines: Force of each law in the interval [N], by the name of the law.
        dissimilarities_n: Largest difference of the sums from the first law's [N], for the legend.
        title: Above the figure.
    """
    figure = Figure(figsize=(9.6, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    for line in lines:
        colour, since = COLOURS.get(line.label, GREY), 1e3 * (line.time_s - line.time_s[0])
        left.plot(since, line.values, color=colour, lw=1.0)
        words = f"{line.label.replace('_', ' ')}, {dissimilarities_n[line.label]:.0f} N"
        right.plot(since, np.cumsum(line.values) / 1e3, color=colour, lw=1.0, label=words)
    left.set(xlabel="time in the interval [ms]", ylabel="contact force [N]")
    left.set_title("(a) one interval", loc="left", fontsize=9)
    right.set(xlabel="time in the interval [ms]", ylabel="sum of the samples [kN]")
    right.set_title(
        f"(b) its sums, and how far they are from {lines[0].label.replace('_', ' ')}", loc="left", fontsize=9
    )
    right.legend(fontsize=8)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    return figure


@matplotlib.rc_context(STYLE | {"font.size": 9})
def errors_by_choice(errors_percent: Mapping[str, Mapping[str, Sequence[float]]], title: str) -> Figure:
    """Return a panel with a column of points for each choice, one point a test, coloured by the record.

    Args:
        errors_percent: For each choice, the errors [%] by the record.
        title: Above the figure.
    """
    figure = Figure(figsize=(9.6, 4.0), layout="constrained")
    axis = figure.subplots()
    palette = dict(zip(next(iter(errors_percent.values())), COLOURS.values(), strict=False))
    for place, by_record in enumerate(errors_percent.values()):
        for offset, (record, values) in enumerate(by_record.items()):
            across = place + 0.16 * (offset - 1.5) + np.linspace(-0.05, 0.05, len(values))
            label = record if place == 0 else None
            axis.plot(across, values, "o", ms=4, color=palette[record], label=label)
        every = np.concatenate([np.asarray(values) for values in by_record.values()])
        axis.hlines(
            every.mean(),
            place - 0.4,
            place + 0.4,
            color="#333333",
            lw=1.2,
            label="mean" if place == 0 else "_nolegend_",
        )
    axis.axhline(0.0, color=GREY, lw=0.8)
    axis.set_xticks(range(len(errors_percent)), list(errors_percent))
    axis.grid(axis="x", visible=False)
    axis.set_ylabel("difference of the first peak force [%]")
    axis.set_title(title, loc="left", fontsize=11)
    axis.legend(fontsize=8, loc="lower right")
    return figure


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a file; nothing half-written is left.

    Raises:
        FrameError: The file cannot be written.
    """
    with replacing(path) as part:
        figure.savefig(part, dpi=85)
