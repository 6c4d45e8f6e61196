"""Pictures of gaps: histories, rules beside simulation, maps over periods and records, regressions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pounding.experiments.pictures.palette import BLUE, GREEN, ORANGE
from pounding.experiments.pictures.plots import OURS, PUBLISHED, STYLE, THEIRS, end_of_motion
from pounding.experiments.separation.chapter_7.regression import Fit
from pounding.experiments.separation.gaps.maps import GapMap
from pounding.extras import extra_module
from pounding.frames.files import replacing

Real = NDArray[np.floating[Any]]
GREY = "#888888"


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), layout="constrained")


@matplotlib.rc_context(STYLE)
def gap_history(times_s: Real, left_m: Real, right_m: Real, result: Mapping[str, Any]) -> Figure:
    """Return the motions of both floors and their closing motion, its largest value marked.

    Args:
        times_s: Instants (m,) [s].
        left_m: Displacement of the left floor (m,) [m].
        right_m: Displacement of the right floor (m,) [m].
        result: The fields of a `pounding.experiments.separation.gaps.answer.GapAnswer`.
    """
    figure = _figure(9.0, 5.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(times_s, 1e3 * left_m, color=OURS, label=f"{result['left']}, {_place(result)}")
    upper.plot(times_s, 1e3 * right_m, color=THEIRS, label=f"{result['right']}, {_place(result)}")
    upper.set_ylabel("relative to the table [mm]")
    upper.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    lower.plot(times_s, 1e3 * (left_m - right_m), color="#444444")
    required = result["required_gap_mm"]
    lower.axhline(required, color=PUBLISHED, ls="--", label=f"required gap {required:.1f} mm")
    lower.axhline(-result["reversed_mm"], color=GREY, ls=":", label=f"opening {result['reversed_mm']:.1f} mm")
    lower.plot(result["time_s"], required, "o", color=PUBLISHED, ms=5)
    lower.set_ylabel("closing motion [mm]")
    lower.set_xlabel("time on the model's clock [s]")
    lower.set_xlim(0.0, end_of_motion(times_s, (left_m, right_m)))
    lower.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    upper.set_title(f"{result['left']} beside {result['right']} under {result['record']}", loc="left")
    return figure


def _place(result: Mapping[str, Any]) -> str:
    """Return where two frames may meet, in words."""
    floor = f"floor {result['floor']}"
    if result.get("on_columns"):
        return f"at {floor}"
    return floor + (f", y {result['y_m']:g} m" if result.get("y_m") else "")


@matplotlib.rc_context(STYLE)
def design_bars(result: Mapping[str, Any]) -> Figure:
    """Return the gap of every rule that gives one; those out of range are pale."""
    shown = [rule for rule in result["rules"] if rule["gap_mm"] is not None][::-1]
    figure = _figure(9.0, 1.2 + 0.34 * max(len(shown), 1))
    axis = figure.subplots()
    colours = [OURS if rule["in_range"] else "#c9d3de" for rule in shown]
    axis.barh([rule["name"] for rule in shown], [rule["gap_mm"] for rule in shown], color=colours)
    for row, rule in enumerate(shown):
        axis.annotate(
            f" {rule['gap_mm']:.4g}{'' if rule['in_range'] else ' (does not apply)'}",
            (rule["gap_mm"], row),
            va="center",
            fontsize=9,
        )
    axis.margins(x=0.15)
    axis.grid(axis="y", visible=False)
    axis.set_xlabel("gap at full scale [mm]")
    axis.set_title(f"{result['pga_g']:g} g, class {result['pga_class'] or 'none'}", loc="left")
    return figure


@matplotlib.rc_context(STYLE)
def rules_against_simulation(ratios: pd.DataFrame) -> Figure:
    """Return each rule's gap over the required one, one mark a pair and record, on a logarithmic axis.

    Args:
        ratios: One row a pair and record, one column a rule [-].
    """
    figure = _figure(9.0, 1.3 + 0.42 * ratios.shape[1])
    axis = figure.subplots()
    rng = np.random.default_rng(3)
    for row, rule in enumerate(ratios.columns[::-1]):
        values = ratios[rule].dropna().to_numpy(float)
        values = values[values > 0.0]
        unsafe = values < 1.0
        height = row + rng.uniform(-0.18, 0.18, len(values))
        axis.scatter(values[~unsafe], height[~unsafe], s=16, color=OURS, alpha=0.75, lw=0)
        axis.scatter(values[unsafe], height[unsafe], s=16, color=PUBLISHED, alpha=0.75, lw=0)
        axis.plot(np.exp(np.mean(np.log(values))), row, "|", color="black", ms=15, mew=2)
    axis.axvline(1.0, color="black", lw=1.0)
    axis.set_yticks(range(ratios.shape[1]), list(ratios.columns[::-1]))
    axis.set_xscale("log")
    axis.set_xticks([0.1, 0.2, 0.5, 1, 2, 5, 10], ["0.1", "0.2", "0.5", "1", "2", "5", "10"])
    axis.minorticks_off()
    axis.set_xlabel("gap by the rule over required gap; left of 1, in red, the rule is unsafe")
    axis.grid(axis="y", visible=False)
    return figure


@matplotlib.rc_context(STYLE)
def gap_maps(maps: Mapping[str, GapMap]) -> Figure:
    """Return the required gap over the SRSS of both peaks, one panel a record: red where SRSS is unsafe.

    Args:
        maps: By the name of the record.
    """
    columns = 4
    rows = -(-len(maps) // columns)
    figure = _figure(11.0, 0.8 + 2.6 * rows)
    axes = np.atleast_1d(figure.subplots(rows, columns, sharex=True, sharey=True)).ravel()
    # From moving together, through SRSS, to the sum of two equal peaks.
    scale = TwoSlopeNorm(1.0, 0.0, 2.0**0.5)
    image = None
    for axis, (name, found) in zip(axes, maps.items(), strict=False):
        image = axis.pcolormesh(
            found.ratio,
            found.tall_period_s,
            found.over_srss,
            norm=scale,
            cmap="RdBu_r",
            shading="nearest",
        )
        axis.set_yscale("log")
        axis.set_yticks([0.15, 0.3, 0.6], ["0.15", "0.3", "0.6"])
        axis.minorticks_off()
        axis.set_title(name, fontsize=9, loc="left")
        axis.grid(visible=False)
    for axis in axes[len(maps) :]:
        axis.set_axis_off()
    figure.supxlabel("period of the stiffer frame over that of the softer one", fontsize=10)
    figure.supylabel("period of the softer frame [s], model time", fontsize=10)
    if image is not None:
        figure.colorbar(
            image, ax=list(axes), label="required gap over SRSS", shrink=0.8, ticks=[0, 0.5, 1, 1.2, 1.4]
        )
    return figure


@matplotlib.rc_context(STYLE)
def regression_diagnostics(cases: pd.DataFrame, fits: Mapping[str, Fit], target: str = "gap_mm") -> Figure:
    """Return predicted against computed gaps, residuals by record, and residuals against normal quantiles.

    Args:
        cases: The study, with ``level`` and ``record``.
        fits: By level.
        target: Column that was explained.
    """
    figure = _figure(11.0, 3.0 * len(fits) + 0.4)
    axes = np.atleast_2d(figure.subplots(len(fits), 3))
    for row, (level, fitted) in zip(axes, fits.items(), strict=True):
        chosen = cases[cases["level"] == level]
        predicted = fitted.predict(chosen)
        residual = chosen[target].to_numpy(float) - predicted
        _predicted_panel(row[0], chosen, predicted, target)
        _by_record_panel(row[1], chosen, residual)
        extra_module("statsmodels.api").qqplot(
            residual / residual.std(), line=None, ax=row[2], ms=3, markerfacecolor=BLUE, markeredgecolor=BLUE
        )
        limits = np.array([-3.5, 3.5])
        row[2].plot(limits, limits, color="black", lw=0.8)
        row[2].set(xlabel="normal quantile", ylabel="residual over its deviation")
        row[0].set_title(f"{level} class", loc="left")
    return figure


def _predicted_panel(axis: Axes, chosen: pd.DataFrame, predicted: Real, target: str) -> None:
    palette = (BLUE, ORANGE, GREEN)
    for colour, (record, group) in zip(palette, chosen.groupby("record", sort=False), strict=False):
        inside = (chosen["record"] == record).to_numpy()
        axis.scatter(predicted[inside], group[target], s=6, alpha=0.5, lw=0, color=colour, rasterized=True)
        axis.plot([], [], "o", color=colour, label=str(record))  # the points are pale, the legend is not
    top = float(chosen[target].max())
    axis.plot([0.0, top], [0.0, top], color="black", lw=0.8)
    axis.set(xlabel="predicted gap [mm]", ylabel="computed gap [mm]")
    axis.legend(fontsize=7, loc="lower right", handletextpad=0.2, borderpad=0.1, borderaxespad=0.1)


def _by_record_panel(axis: Axes, chosen: pd.DataFrame, residual: Real) -> None:
    groups = [residual[(chosen["record"] == record).to_numpy()] for record in chosen["record"].unique()]
    axis.boxplot(groups, showfliers=False, medianprops={"color": PUBLISHED})
    labels = [str(name).replace("-", "\n", 1) for name in chosen["record"].unique()]
    axis.set_xticks(range(1, len(groups) + 1), labels, fontsize=8)
    axis.axhline(0.0, color="black", lw=0.8)
    axis.set_ylabel("residual [mm]")


@matplotlib.rc_context(STYLE)
def held_out(comparison: pd.DataFrame) -> Figure:
    """Return the mean relative error of each formula: on its own cases, and on events and pairs held out.

    Args:
        comparison: One row a formula, columns ``seen``, ``pair`` and ``event`` [-].
    """
    figure = _figure(9.0, 1.2 + 0.62 * len(comparison))
    axis = figure.subplots()
    width = 0.26
    colours = {"seen": "#9db4cc", "pair": OURS, "event": PUBLISHED}
    labels = {"seen": "own cases", "pair": "pair held out", "event": "earthquake held out"}
    rows = np.arange(len(comparison))[::-1]
    for shift, (column, colour) in zip((1, 0, -1), colours.items(), strict=True):
        values = 100.0 * comparison[column].to_numpy(float)
        axis.barh(rows + shift * width, values, width, color=colour, label=labels[column])
        for row, value in zip(rows, values, strict=True):
            if np.isfinite(value):
                axis.annotate(f" {value:.0f}", (value, row + shift * width), va="center", fontsize=8)
    axis.set_yticks(rows, comparison.index)
    axis.grid(axis="y", visible=False)
    axis.set_xlabel("mean of |predicted - computed| / computed [%]")
    axis.legend(loc="lower right")
    return figure


def save(figure: Figure, path: Any, *, dpi: int = 100) -> None:
    """Write a figure whole or not at all.

    Args:
        figure: The figure.
        path: File to write.
        dpi: Resolution [dots per inch].
    """
    with replacing(path) as part:
        figure.savefig(part, dpi=dpi)
