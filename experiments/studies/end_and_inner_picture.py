"""The picture of the study `end-and-inner`: each building at an end and inside, against standing alone."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from pounding.experiments.pictures.palette import BLUE, VERMILION
from pounding.experiments.pictures.plots import STYLE
from pounding.frames.files import replacing

PLACES = {True: ("at an end", VERMILION, "o"), False: ("between two neighbours", BLUE, "s")}
TITLES = {"drift": "largest storey drift", "acceleration": "largest floor acceleration"}
TICKS = {"drift": (0.5, 0.7, 1.0, 1.4, 2.0), "acceleration": (0.7, 1, 2, 4, 7, 14)}
DRAWN = ("five nearly equal", "five unequal")


@matplotlib.rc_context(STYLE)
def picture(found: pd.DataFrame, path: Path) -> None:
    """Draw the ratios of both quantities over the first period, median and 16 to 84 %.

    Args:
        found: Summary by row, period and place.
        path: The file.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex="row")
    for name, line in zip(DRAWN, panels, strict=True):
        of_row = found.loc[name]
        periods = np.sort(of_row.index.get_level_values("period_s").unique())
        aside = 0.012 * (periods[-1] - periods[0])
        for (quantity, title), axes in zip(TITLES.items(), line, strict=True):
            for end, (label, colour, marker) in PLACES.items():
                some = of_row.xs(end, level="end").sort_index()
                middle = some[f"{quantity}_median"]
                spread = [middle - some[f"{quantity}_16"], some[f"{quantity}_84"] - middle]
                places = some.index + (-aside if end else aside)
                axes.errorbar(
                    places, middle, spread, fmt=marker, color=colour, ms=6, lw=1.4, capsize=3, label=label
                )
            axes.axhline(1.0, color="#7f8c8d", lw=1.0, ls="--")
            axes.set_yscale("log")
            axes.set_yticks(TICKS[quantity])
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.yaxis.set_minor_formatter(NullFormatter())
            axes.set_xticks(periods)
            axes.set_title(f"{name}: {title}", fontsize=10)
        line[0].set_ylabel("in the row / alone [-]")
    for axes in panels[-1]:
        axes.set_xlabel("first period of the building [s]")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    with replacing(path) as part:
        figure.savefig(part, format="png", dpi=100)
