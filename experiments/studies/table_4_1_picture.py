"""Pictures of Table 4.1: measured peaks, SAP2000's and ours; and how near single changes come."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from pounding.frames.files import replacing

STYLE: dict[Any, Any] = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
MEASURED, OURS, SAP2000, FITTED = "#222222", "#c0392b", "#2e86c1", "#1e8449"


HATCH = "////"
"""Of peaks of which the thesis contradicts itself."""


@matplotlib.rc_context(STYLE)
def picture(data: xr.Dataset, path: Path) -> None:
    """Draw the peaks of a comparison (`table_4_1.compare`) into a file; its first variant is ours, beside strong motion.

    Bars reach from the measured minimum to the measured maximum; contested peaks are hatched.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(9.0, 6.4), layout="constrained")
    for axis, record in zip(figure.subplots(2, 2, sharex=True).ravel(), data.record.values, strict=True):
        _panel(axis, data.sel(record=record))
        axis.set_title(str(record), loc="left")
    handles, _ = figure.axes[0].get_legend_handles_labels()
    contested = Patch(
        facecolor="white", edgecolor=MEASURED, lw=0.7, hatch=HATCH, label="measured, contested (see text)"
    )
    # Below the panels: the bars take whatever room there is inside.
    figure.legend(
        handles=[*handles, contested], loc="outside lower center", ncols=3, fontsize=8, frameon=False
    )
    figure.supylabel("peak displacement relative to the table [mm]", fontsize=9)
    with replacing(path) as part:
        figure.savefig(part, dpi=90)


def _panel(axis: Axes, data: xr.Dataset) -> None:
    x = np.arange(data.sizes["place"])
    high, low = data.measured.sel(side="max").values, data.measured.sel(side="min").values
    for index in x:
        sure = bool(data.trusted.values[index])
        axis.bar(
            index,
            high[index] + low[index],
            bottom=-low[index],
            width=0.7,
            color="#d5d8dc" if sure else "white",
            edgecolor=MEASURED,
            lw=0.7,
            hatch=None if sure else HATCH,
            label="measured" if index == 0 else None,
        )
    for values, colour, mark, shift, label in (
        (data.sap2000, SAP2000, "s", -0.22, "SAP2000, as printed"),
        (data.computed[0], OURS, "o", 0.0, "ours, fixed beforehand"),
        (data.strong_motion, FITTED, "^", 0.22, "strong motion, fitted to these peaks"),
    ):
        for side, sign in (("max", 1), ("min", -1)):
            named = label if sign > 0 else None
            axis.plot(x + shift, sign * values.sel(side=side), mark, ms=4.5, color=colour, label=named)
    axis.use_sticky_edges = False  # the bars would end at the edge of the panel, and marks there be cut
    axis.axhline(0, color=MEASURED, lw=0.6)
    names = [
        f"{frame}\nfl. {floor}" for frame, floor in zip(data.frame.values, data.floor.values, strict=True)
    ]
    axis.set_xticks(x, names, fontsize=8)


@matplotlib.rc_context(STYLE)
def verdict_picture(found: pd.DataFrame, sap2000: float, path: Path) -> None:
    """Draw the errors of all single changes on held-out records (`table_4_1_missing.verdicts`) into a file.

    Args:
        found: A row for each change, the nearest first.
        sap2000: Mean error of SAP2000's printed peaks [-].
        path: The file.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(8.0, 0.8 + 0.24 * len(found)), layout="constrained")
    axis, y = figure.subplots(), np.arange(len(found))
    axis.barh(y, 100 * found.held_out, color="#d5d8dc", edgecolor=MEASURED, lw=0.6, label="one value for all")
    axis.plot(
        100 * found.all_four, y, "|", ms=10, color=MEASURED, label="the same, fitted to all four records"
    )
    axis.plot(100 * found.held_out_each, y, "o", ms=4.5, color=OURS, label="one value a frame, held out")
    for value, colour, name in ((found.neutral.iloc[0], OURS, "baseline"), (sap2000, SAP2000, "SAP2000")):
        axis.axvline(100 * value, color=colour, lw=1.0, ls="--", label=name)
    axis.set_yticks(y, found.index)
    axis.invert_yaxis()
    axis.set_xlim(0.0, 45.0)
    axis.set_xlabel("mean error of the peaks under the two records not fitted [%]")
    axis.legend(loc="upper right", fontsize=8, frameon=False)
    with replacing(path) as part:
        figure.savefig(part, dpi=90)
