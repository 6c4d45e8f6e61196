"""The trade-off between measures: what each leaves of drifts, accelerations and forces."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding.experiments.mitigation.response import Response
from pounding.experiments.mitigation.search import Answer
from pounding.experiments.pictures.palette import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from pounding.experiments.pictures.plots import STYLE

MARKS = {
    "none": ("*", BLACK),
    "wider-gap": ("o", BLUE),
    "bumpers": ("s", VERMILION),
    "hard-links": ("D", PURPLE),
    "links": ("^", GREEN),
    "dampers": ("v", SKY),
    "damping": ("P", ORANGE),
    "walls": ("X", GREY),
    "collision-walls": ("p", "#8c6d1f"),
}
"""Mark and colour of each measure."""


@matplotlib.rc_context(STYLE)
def trade_offs(answers: Sequence[Answer]) -> Figure:
    """Return a figure of drift against acceleration and against force: small marks are settings tried, large ones the best.

    Args:
        answers: What each measure can do.
    """
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    first, second = figure.subplots(1, 2, sharex=True)
    _panel(first, answers, lambda found: found.acceleration_g, "largest acceleration of a floor [g]")
    _panel(
        second,
        answers,
        lambda found: max(found.peak_force_n, found.link_force_n) / 1e3,
        "largest force of contacts and links [kN]",
    )
    # Without contact or link there is no force, which a logarithm cannot show.
    second.set_yscale("symlog", linthresh=_threshold(answers))
    handles = dict(zip(*reversed(first.get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _panel(axes: Axes, answers: Sequence[Answer], measure: Callable[[Response], float], label: str) -> None:
    for answer in answers:
        mark, colour = MARKS[answer.measure.name]
        drifts = [100.0 * one.response.drift for one in answer.tried]
        values = [measure(one.response) for one in answer.tried]
        axes.scatter(drifts, values, marker=mark, s=14, color=colour, alpha=0.35, linewidths=0)
    for answer in answers:
        mark, colour = MARKS[answer.measure.name]
        best = answer.best.response
        axes.scatter(
            100.0 * best.drift,
            measure(best),
            marker=mark,
            s=130,
            color=colour,
            edgecolors="white",
            label=answer.measure.name,
            zorder=3,
        )
    axes.set_xlabel("largest storey drift [% of its height]")
    axes.set_ylabel(label)


def _threshold(answers: Sequence[Answer]) -> float:
    forces = [
        max(one.response.peak_force_n, one.response.link_force_n) / 1e3
        for answer in answers
        for one in answer.tried
    ]
    above = [force for force in forces if force > 0.0]
    return max(1e-3 * max(above), min(above)) if above else 1.0
