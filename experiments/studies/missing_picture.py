"""The picture of the study `missing-in-the-thesis`: held-out errors of all models as bars, their splits as dots."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.frames.files import replacing

KINDS = (
    ("#d5d8dc", "states of free vibration"),
    ("#56b4e9", "a state for each frame, fitted in each split"),
    (ORANGE, "two states chosen beforehand"),
)
"""Colour and label of the models by how their frames' states are chosen."""


def picture(rows: Sequence[dict[str, Any]], sap2000: float, path: Path) -> None:
    """Draw the error of each model on the two records of four that it was not fitted to.

    Args:
        rows: Rows of the study.
        sap2000: Mean error of SAP2000's printed peaks [-].
        path: The file.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(9.0, 7.2), layout="constrained")
    axes, y = figure.subplots(), np.arange(len(rows))
    third = len(rows) // len(KINDS)
    for kind, (colour, label) in enumerate(KINDS):
        part = slice(kind * third, (kind + 1) * third)
        heights = [100 * one["halves_58"] for one in rows[part]]
        axes.barh(y[part], heights, color=colour, edgecolor="#2c3e50", lw=0.5, label=label)
    for place, one in zip(y, rows, strict=True):
        dots = 100 * np.array(one["halves_by_split"])
        axes.plot(
            dots,
            np.full(len(dots), place),
            "o",
            ms=3,
            color="#2c3e50",
            label=None if place else "the six splits",
        )
    axes.axvline(100 * sap2000, color=BLUE, ls="--", lw=1.2, label="SAP2000, as printed (not held out)")
    names = [one["model"].split(" + ") for one in rows]
    axes.set_yticks(y, [_numbers(name) for name in names], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 27.0)
    axes.set_xlabel("mean |ours − measured| / measured under the two records not fitted [%]")
    axes.legend(fontsize=8, frameon=False, loc="upper right")
    axes.spines[["top", "right"]].set_visible(False)
    with replacing(path) as part_file:
        figure.savefig(part_file, format="png", dpi=90)


def _numbers(parts: Sequence[str]) -> str:
    """Return the fitted numbers of a model's name in short."""
    short = {
        "one damping ratio": "damping",
        "a factor on all frequencies": "f1 factor",
        "gain of the table": "gain",
    }
    return ", ".join(short[part] for part in parts if part in short) or "no number"
