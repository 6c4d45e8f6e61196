"""Plots of contacts: force histories of several laws, force over deformation, maps of the peak force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np
from numpy.typing import NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures.palette import BLUE, GREEN, ORANGE, PURPLE, VERMILION
from pounding.experiments.pictures.panels import figure_of, keep, panels
from pounding.experiments.pictures.plots import STYLE
from pounding.experiments.rig.impacts import impacts
from pounding.units import force_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pounding.experiments.rig.contact_history import ContactHistory
    from pounding.experiments.rig.pounding import Pounding

Real = NDArray[np.floating[Any]]

COLOURS = {
    "linear_spring": BLUE,
    "linear_viscoelastic": ORANGE,
    "hertz": GREEN,
    "nonlinear_viscoelastic": VERMILION,
    "hertz_damp": PURPLE,
}
OTHER = "#555555"
PALETTE = tuple(COLOURS.values())

DPI = 100

CLOSE_S = 0.0025
"""Shortest close view of an impact [s]: a contact event of two frames of the thesis."""


@matplotlib.rc_context(STYLE)
def force_histories(
    runs: Sequence[Pounding],
    path: str | Path | None = None,
    *,
    labels: Sequence[str] | None = None,
    window_s: float | None = None,
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Plot the force of several runs over each other: the whole run, and the first impact of each, aligned.

    Args:
        runs: Runs that differ in their law; of several contacts the one that is hit hardest is shown.
        path: File to write, its suffix says the format; none when None.
        labels: Of the runs; the names of their laws when None.
        window_s: Length of the close view [s]; that of the longest first contact event, and at least `CLOSE_S`, when None.
        axes: Two axes to draw into; a new figure when None.

    Returns:
        The axes: the whole run, the first impact.

    Raises:
        ExperimentError: In no run the floors touched, or not two axes were given.
    """
    _require_touch(runs)
    new = axes is None
    whole, close = axes = panels(axes, 1, (9.0, 3.8), columns=2, width_ratios=(3, 2))
    shown = hit_hardest(runs)
    window_s = _first_event_s(shown) if window_s is None else window_s
    starts = [[impact.time_s for impact in impacts(history)] for history in shown]
    unit, newtons = _unit(shown)
    for index, history in enumerate(shown):
        name = labels[index] if labels else _label(history)
        colour = PALETTE[index % len(PALETTE)] if labels else COLOURS.get(history.law.name, OTHER)
        times, force = history.sampled()
        whole.plot(times, force / newtons, color=colour, label=name, linewidth=0.9)
        if starts[index]:
            start = starts[index][0]
            near = np.linspace(start - 0.1 * window_s, start + window_s, 1500)
            close.plot(1e3 * (near - start), history.at(near)[2] / newtons, color=colour)
    touches = [time for each in starts for time in each]
    margin = 0.03 + 0.1 * (max(touches) - min(touches))
    whole.set_xlim(max(0.0, min(touches) - margin), max(touches) + margin)
    gap = f"gap {1e3 * shown[0].gap_m:g} mm"
    if len(runs[0].motion.contacts) > 1:
        gap += f" at floor {shown[0].floor}"
    whole.set_title(f"{shown[0].left} beside {shown[0].right}, {runs[0].record.name}, {gap}", fontsize=10)
    whole.set(xlabel="time [s]", ylabel=f"contact force [{unit}]")
    # Below the axes of a figure of ours: the peaks take whatever room there is inside.
    named = whole.get_legend_handles_labels()
    if new:
        figure_of(whole).legend(*named, fontsize=8, loc="outside lower center", ncols=3)
    else:
        close.legend(*named, fontsize=8)
    close.set(xlabel="time after contact begins [ms]")
    close.set_title("first impact", fontsize=10)
    keep(whole, path, dpi=DPI)
    return axes


def hit_hardest(runs: Sequence[Pounding]) -> list[ContactHistory]:
    """Return the same contact of each run: the one with the largest force in any of them.

    Args:
        runs: Runs of the same frames with the same contacts.
    """
    peaks = [[contact.sampled()[1].max(initial=0.0) for contact in run.motion.contacts] for run in runs]
    place = int(np.max(peaks, axis=0).argmax())
    return [run.motion.contacts[place] for run in runs]


def _unit(shown: Sequence[ContactHistory]) -> tuple[str, float]:
    """Return the unit of the forces of contacts, and what it is in N."""
    return force_unit(max(float(history.sampled()[1].max(initial=0.0)) for history in shown))


def _first_event_s(shown: Sequence[ContactHistory]) -> float:
    """Return how long the longest first contact event lasts [s], at least `CLOSE_S`."""
    first = [history.pulses[0] for history in shown if history.pulses]
    return max([CLOSE_S, *(last - begin for begin, last in first)])


@matplotlib.rc_context(STYLE)
def loops(
    runs: Sequence[Pounding],
    path: str | Path | None = None,
    *,
    labels: Sequence[str] | None = None,
    axes: Axes | None = None,
) -> Axes:
    """Plot force over deformation of the hardest contact event of each run; the area of a loop is the energy lost.

    Args:
        runs: Runs; of several contacts the one that is hit hardest is shown.
        path: File to write, its suffix says the format; none when None.
        labels: Of the runs; the names of their laws when None.
        axes: Axes to draw into; a new figure when None.

    Returns:
        The axes.

    Raises:
        ExperimentError: In no run the floors touched.
    """
    _require_touch(runs)
    (axes,) = panels(axes, 1, (5.4, 3.8))
    shown = hit_hardest(runs)
    unit, newtons = _unit(shown)
    for index, history in enumerate(shown):
        if history.pulses:
            colour = PALETTE[index % len(PALETTE)] if labels else COLOURS.get(history.law.name, OTHER)
            _loop(axes, history, labels[index] if labels else _label(history), colour, newtons)
    axes.set(xlabel="deformation [mm]", ylabel=f"contact force [{unit}]")
    axes.set_title("hardest contact event", fontsize=10)
    axes.legend(fontsize=8)
    keep(axes, path, dpi=DPI)
    return axes


@matplotlib.rc_context(STYLE)
def peak_map(
    peaks_n: Mapping[str, Mapping[str, float]],
    path: str | Path | None = None,
    *,
    title: str = "",
    axes: Axes | None = None,
) -> Axes:
    """Plot a map of the peak force: one row a record, one column a gap.

    Args:
        peaks_n: For each record, the peak force [N] by the label of its gap, widest first.
        path: File to write, its suffix says the format; none when None.
        title: Above the map.
        axes: Axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    rows, columns = len(peaks_n), max(len(row) for row in peaks_n.values())
    values = np.full((rows, columns), np.nan)
    for index, row in enumerate(peaks_n.values()):
        values[index, : len(row)] = list(row.values())
    (axes,) = panels(axes, 1, (1.3 * columns + 2.2, 0.72 * rows + 1.2))
    axes.grid(False)
    image = axes.imshow(values, cmap="YlOrRd", vmin=0.0, aspect="auto")
    for (i, record), j in ((pair, j) for pair in enumerate(peaks_n) for j in range(len(peaks_n[pair[1]]))):
        gap = list(peaks_n[record])[j]
        dark = values[i, j] > 0.6 * np.nanmax(values)
        axes.text(
            j, i, f"{gap} mm\n{values[i, j]:.0f} N", ha="center", va="center", fontsize=8,
            color="white" if dark else "black",
        )  # fmt: skip
    axes.set_yticks(range(rows), list(peaks_n))
    axes.set_xticks([])
    axes.set_xlabel("gap, widest to narrowest")
    axes.set_title(title, fontsize=10)
    figure_of(axes).colorbar(image, ax=axes, label="peak force [N]")
    keep(axes, path, dpi=DPI)
    return axes


def _loop(axes: Axes, history: ContactHistory, name: str, colour: str, newtons: float) -> None:
    pulses = [history.pulse(*pulse) for pulse in history.pulses]
    _, deformation, _, force = max(pulses, key=lambda pulse: float(pulse[3].max()))
    axes.plot(1e3 * deformation, force / newtons, color=colour, label=name, linewidth=1.3)


def _label(history: ContactHistory) -> str:
    return history.law.name.replace("_", " ")


def _require_touch(runs: Sequence[Pounding]) -> None:
    if not any(contact.pulses for run in runs for contact in run.motion.contacts):
        raise ExperimentError("nothing to plot: the floors did not touch; narrow the gap")
