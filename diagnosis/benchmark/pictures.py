"""Pictures of a benchmark: what is found against its size, and stated confidence against the share that was right."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding.experiments.pictures.palette import BLUE, GREY, ORANGE
from pounding.frames.files import write_whole

DETECTED, EXACT, STATED = GREY, BLUE, ORANGE


def draw_benchmark(result: Mapping[str, Any], path: Path) -> None:
    """Write a PNG: detected and exactly named shares of single effects by size; stated confidence against hit rate.

    Args:
        result: Figures of `summarise`.
        path: Where the picture goes.
    """
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    _sizes(left, result["detection"])
    _reliability(right, result["reliability"])
    _write(figure, path)


def draw_reliability(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write a PNG of stated confidence against hit rate alone.

    Args:
        rows: As `summary.reliability` gives them.
        path: Where the picture goes.
    """
    figure = Figure(figsize=(4.8, 3.8), layout="constrained")
    _reliability(figure.subplots(), rows)
    _write(figure, path)


def _write(figure: Figure, path: Path) -> None:
    data = io.BytesIO()
    figure.savefig(data, dpi=110, format="png")
    write_whole(path, data.getvalue())


def _sizes(axes: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    known = [row for row in rows if row["detected"]["cases"]]
    names = [_bounds(*row["signal_to_noise"]) for row in known]
    for key, colour, shift in (("detected", DETECTED, -0.2), ("exact", EXACT, 0.2)):
        places = np.arange(len(known)) + shift
        shares = np.array([row[key]["share"] for row in known])
        axes.bar(places, shares, 0.38, color=colour, label=key)
        axes.errorbar(places, shares, _spread(known, key), fmt="none", ecolor="black", capsize=3, lw=0.8)
    cases = [row["detected"]["cases"] for row in known]
    axes.set_xticks(
        range(len(known)), [f"{name}\n{count} cases" for name, count in zip(names, cases, strict=True)]
    )
    axes.set_xlabel("signal-to-noise ratio [-]:\nlargest change of a channel over its noise")
    axes.set_ylabel("share of the single effects [-]")
    axes.set_ylim(0, 1.05)
    axes.legend(loc="upper left", frameon=False)


def _reliability(axes: Axes, rows: Sequence[Mapping[str, Any]]) -> None:
    known = [row for row in rows if row["stated"] is not None]
    axes.plot([0, 1], [0, 1], color="black", lw=0.8)
    axes.fill_between(
        [0, 1], [-0.1, 0.9], [0.1, 1.1], color="black", alpha=0.08, lw=0, label="within 10 points"
    )
    for key, colour, label, shift, marker in (
        ("right", DETECTED, "verdict right", -0.006, "s"),
        ("right_as_shown", STATED, "right as far as the data show", 0.006, "o"),
    ):
        # Side by side, so that neither interval hides the other.
        stated = [row["stated"] + shift for row in known]
        shares = [row[key]["share"] for row in known]
        style: Any = {"color": colour, "capsize": 3, "lw": 1.2, "label": label}
        axes.errorbar(stated, shares, _spread(known, key), fmt=marker, **style)
    above: Any = {"xycoords": ("data", "axes fraction"), "ha": "center", "fontsize": 9}
    for row in known:
        axes.annotate(f"{row['right']['cases']}", (row["stated"], 1.02), **above)
    axes.annotate("number of cases:", (0.0, 1.02), **above | {"ha": "left"})
    axes.set_xlabel("stated confidence [-]")
    axes.set_ylabel("share right [-]")
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1.05)
    axes.legend(loc="upper left", frameon=False, fontsize=9)


def _spread(rows: Sequence[Mapping[str, Any]], key: str) -> np.ndarray:
    """Return the lengths of the 95 % Wilson intervals below and above the shares, shape (2, rows)."""
    return np.array(
        [[row[key]["share"] - row[key]["low"], row[key]["high"] - row[key]["share"]] for row in rows]
    ).T.clip(0)


def _bounds(low: float, high: float | None) -> str:
    return f"above {low:g}" if high is None else f"{low:g} to {high:g}"
