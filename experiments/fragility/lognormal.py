"""A lognormal fragility with its confidence band, fitted to intensities or to counts (Baker 2015)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize
from scipy.stats import binom, norm

from pounding.experiments.errors import ExperimentError

Real = NDArray[np.floating[Any]]

RESAMPLED = 500
"""How often the records are drawn anew for a confidence band."""


@dataclass(frozen=True)
class Lognormal:
    """Probability of passing a limit at an intensity x: Phi(ln(x / median) / beta).

    Attributes:
        median_g: Intensity of probability one half [g].
        beta: Standard deviation of the logarithm [-].
    """

    median_g: float
    beta: float

    def at(self, intensity_g: ArrayLike) -> Real:
        """Return the probability at intensities (m,) [-].

        Args:
            intensity_g: Intensities (m,) [g], above 0.
        """
        return np.asarray(norm.cdf(np.log(np.asarray(intensity_g) / self.median_g) / self.beta))


def fit_capacities(capacity_g: Real) -> Lognormal:
    """Return the fragility of intensities at which each record just reaches the limit: moments of their logarithms.

    Baker (2015), Earthquake Spectra 31(1), equations 4 and 5.

    Args:
        capacity_g: One intensity a record (n,) [g].

    Raises:
        ExperimentError: Fewer than two different intensities.
    """
    logarithms = np.log(capacity_g)
    spread = float(np.std(logarithms, ddof=1)) if len(logarithms) > 1 else 0.0
    if not spread > 0.0:
        raise ExperimentError("a fragility needs two records or more that differ; give more")
    return Lognormal(float(np.exp(logarithms.mean())), spread)


def fit_counts(levels_g: Real, passed: NDArray[np.bool_]) -> Lognormal:
    """Return the fragility of counts at levels of the intensity, by maximum likelihood.

    Baker (2015), equation 11: at each level so many of the records pass the limit, binomially distributed.

    Args:
        levels_g: Levels (m,) [g].
        passed: Whether each record passes the limit at each level (n, m).

    Raises:
        ExperimentError: At all levels but one none or all records pass: the levels do not say how steep the curve is.
    """
    counts, total = passed.sum(axis=0), len(passed)
    if np.sum((counts > 0) & (counts < total)) < 2:
        raise ExperimentError(
            f"of {total} records {', '.join(map(str, counts))} pass the limit at the levels; a fragility needs two or "
            "more levels at which some do and some do not: change the limit, or try more levels"
        )

    def surprise(parameters: Real) -> float:
        curve = Lognormal(float(np.exp(parameters[0])), float(np.exp(parameters[1])))
        return -float(binom.logpmf(counts, total, np.clip(curve.at(levels_g), 1e-12, 1 - 1e-12)).sum())

    middle = float(np.interp(0.5 * total, np.maximum.accumulate(counts), np.log(levels_g)))
    found = minimize(surprise, [middle, np.log(0.4)], method="Nelder-Mead")
    return Lognormal(*map(float, np.exp(found.x)))


def band(
    fit: Callable[[NDArray[np.int64]], Lognormal],
    records: int,
    intensity_g: Real,
    *,
    seed: int = 0,
    confidence: float = 0.9,
) -> tuple[Real, Real]:
    """Return the lower and the upper limit (m,) of a fragility's confidence band, by drawing the records anew.

    Args:
        fit: Returns the fragility of some of the records, by their numbers (n,); some may be there twice.
        records: Number of records.
        intensity_g: Where the band is asked for (m,) [g].
        seed: Seed of the draws.
        confidence: Share of the draws within the band.
    """
    generator = np.random.default_rng(seed)
    curves = []
    for _ in range(RESAMPLED):
        try:
            curves.append(fit(generator.integers(0, records, records)).at(intensity_g))
        except ExperimentError:
            continue  # a draw of too few different records says nothing of the curve
    low, high = np.quantile(curves, [(1 - confidence) / 2, (1 + confidence) / 2], axis=0)
    return low, high
