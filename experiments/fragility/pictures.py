"""Fragility curves with their bands, and the probability of pounding over gap and intensity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pounding.experiments.fragility.lognormal import Lognormal, band, fit_capacities
from pounding.experiments.pictures.palette import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from pounding.experiments.pictures.plots import STYLE

Real = NDArray[np.floating[Any]]

LEVELS = (0.05, 0.16, 0.5, 0.84, 0.95)
LEVEL_COLOURS = ("#440154", "#3b528b", "#21918c", "#3f9b4f", "#8a7a00")
"""Lines of equal probability, from dark blue to olive, all readable on white."""

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)
"""Of the curves, in their order."""


@dataclass(frozen=True)
class Sample:
    """What records say of one limit.

    Attributes:
        label: What is passed.
        fit: Returns the fragility of some of the records, by their numbers.
        seen_g: Intensities of the data (k,) [g].
        seen: Share of the records that pass the limit there (k,).
    """

    label: str
    fit: Callable[[NDArray[np.int64]], Lognormal]
    seen_g: Real
    seen: Real


@dataclass(frozen=True)
class Curve:
    """A fragility to draw.

    Attributes:
        label: What it is the probability of.
        fit: The fitted curve.
        low, high: Its confidence band where it is drawn (m,).
        seen_g: Intensities of the data (k,) [g].
        seen: Share of the records that pass the limit there (k,).
    """

    label: str
    fit: Lognormal
    low: Real
    high: Real
    seen_g: Real
    seen: Real


def drawn(samples: Sequence[Sample], records: int, seed: int) -> tuple[Real, list[Curve]]:
    """Return where fragilities are drawn (m,) [g], from nearly 0 to where all are nearly 1, and the curves with their bands.

    Args:
        samples: What the records say.
        records: Number of records.
        seed: Seed of the bands.
    """
    fits = [sample.fit(np.arange(records)) for sample in samples]
    axis = np.linspace(0.0, max(fit.median_g * np.exp(2.0 * fit.beta) for fit in fits), 200)
    axis[0] = 1e-6 * axis[1]
    return axis, [
        Curve(sample.label, fit, *band(sample.fit, records, axis, seed=seed), sample.seen_g, sample.seen)
        for sample, fit in zip(samples, fits, strict=True)
    ]


@matplotlib.rc_context(STYLE)
def fragilities(
    curves: Sequence[Curve], intensity_g: Real, words: str, touching: Sequence[tuple[float, float]]
) -> Figure:
    """Return a figure: the curves with data and bands on the left, the probability of pounding over the gap on the right.

    Args:
        curves: The fragilities.
        intensity_g: Where they are drawn (m,) [g].
        words: What the intensity is, with its unit.
        touching: For each record the gap [mm] and the intensity [g] at which its floors just touch; the intensity is in
            proportion to the gap.
    """
    figure = Figure(figsize=(9.6, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for curve, colour in zip(curves, cycle(COLOURS), strict=False):
        left.fill_between(intensity_g, curve.low, curve.high, color=colour, alpha=0.18, linewidth=0)
        left.plot(intensity_g, curve.fit.at(intensity_g), color=colour, label=curve.label, linewidth=1.8)
        inside = curve.seen_g <= intensity_g[-1]
        left.plot(curve.seen_g[inside], curve.seen[inside], "o", color=colour, markersize=3.5)
    left.set(xlabel=words, ylabel="probability", ylim=(0.0, 1.0), xlim=(0.0, intensity_g[-1]))
    gap_mm, per_mm = touching[0][0], np.array([intensity / gap for gap, intensity in touching])
    gaps = np.linspace(0.02, 3.0, 120) * gap_mm
    per_gap = fit_capacities(per_mm)
    probability = np.array([per_gap.at(intensity_g[1:] / gap) for gap in gaps])
    lines = right.contour(gaps, intensity_g[1:], probability.T, levels=LEVELS, colors=LEVEL_COLOURS)
    right.clabel(lines, fmt=lambda value: f"{100 * value:.0f} %", fontsize=8)
    right.axvline(gap_mm, color="#888888", linestyle=":")
    right.set(xlabel="gap [mm]", ylabel=words)
    right.set_title("probability that the floors touch", fontsize=10)
    handles, names = left.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=min(4, len(curves)), fontsize=9)
    return figure
