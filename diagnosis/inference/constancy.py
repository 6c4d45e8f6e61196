"""How constant an effect's parameters are over the windows of the runs: a law that is not quite the frame's has none.

A standard error from the curvature of the likelihood believes the law. Where the law is only near the truth, parts of the
record ask for different parameters, strong shaking for others than weak. What they differ by beyond chance is the variance
between studies of a meta-analysis (DerSimonian and Laird 1986), the windows being the studies; it is nothing where the law
holds.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from scipy.stats import chi2

from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.posterior import posterior_covariance

CHANCE = 0.05
"""Probability with which a parameter that is constant seems not to be."""
PERIODS = 5.0
"""Length of a window [periods of the lowest mode]: what rings in one is forgotten in the next but one."""


def between_windows(histories: Histories, theta: np.ndarray, gram: np.ndarray) -> np.ndarray:
    """Return the variance of each of the effects' coordinates between windows, beyond chance, shape (coordinates,).

    The nuisance parameters are the frame's, and the same in all windows.

    Args:
        histories: The runs, about the fit.
        theta: The fit in units of the priors, shape (parameters,), the effects' coordinates last.
        gram: Information of the data about the effects' coordinates, shape (coordinates, coordinates).
    """
    covariance = posterior_covariance(gram)
    # What a coordinate does beyond what the others can do: the others follow it.
    beyond = covariance / np.diag(covariance)
    each = np.array(list(_windows(histories, theta, beyond))).reshape(-1, 2, len(gram))
    scores, information = each.swapaxes(0, 1)
    return np.array(
        [_beyond_chance(scores[:, j], information[:, j], 1.0 / covariance[j, j]) for j in range(len(gram))]
    )


def _windows(histories: Histories, theta: np.ndarray, beyond: np.ndarray) -> Iterator[np.ndarray]:
    """Yield slope and information of each window about the effects' coordinates, shape (2, coordinates)."""
    model, runs = histories.model, histories.filtered.runs
    channels = len(model.observed.names)
    for run, (residual, _, own) in zip(runs, histories.columns(theta), strict=True):
        if not model.acts(run):
            continue
        data = model.observed.runs[run]
        periods = len(data.table) * data.step_s * model.structure.lowest_hz
        count = max(1, int(periods / PERIODS))
        for first, last in pairwise(channels * np.linspace(0, len(data.table), count + 1).astype(int)):
            signature = own[first:last].astype(float) @ beyond
            yield np.array([signature.T @ residual[first:last], (signature**2).sum(axis=0)])


def _beyond_chance(score: np.ndarray, information: np.ndarray, known: float) -> float:
    """Return the variance between windows by DerSimonian and Laird's moments, of which chance alone rarely gives any.

    Args:
        score, information: Slope and information of each window, shape (windows,).
        known: Information of all windows and the prior, in which each window has its share.
    """
    seen = information > 0.0
    score, information = score[seen], information[seen]
    if len(score) < 2:
        return 0.0
    whole = float(information.sum())
    spread = float((score**2 / information).sum()) - float(score.sum()) ** 2 / whole
    weight = known * (1.0 - float(((information / whole) ** 2).sum()))
    return max(spread - float(chi2.isf(CHANCE, len(score) - 1)), 0.0) / weight
