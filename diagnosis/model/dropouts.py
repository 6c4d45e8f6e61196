"""Samples of the table's motion that dropped out, as those around them say they were."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve
from scipy.signal import correlate

NEIGHBOURS = 40
"""Samples to each side of a gap by which it is filled."""
LONGEST = 400
"""Samples of a gap from which on its ends are joined by a line: its inside has nothing to do with either."""
RIDGE = 1e-5
"""Least noise of a sample, a share of the series' variance, which keeps the equations well conditioned."""


def filled(series: np.ndarray) -> np.ndarray:
    """Return a series with its gaps filled by the best linear prediction from the samples around them, shape (samples,).

    The prediction uses the autocovariance of the whole series, so that it follows a motion of any spectrum up to its
    noise; a line from sample to sample would lose what is fast, and a polynomial would take noise for slopes.

    Args:
        series: Samples, NaN where missing, shape (samples,).
    """
    missing = ~np.isfinite(series)
    if not missing.any() or missing.all():
        return np.array(series, float)
    index = np.arange(len(series))
    found = np.asarray(np.interp(index, index[~missing], series[~missing]))
    mean = float(found.mean())
    covariance = _autocovariance(found - mean)
    if covariance[0] <= 0.0:
        return found
    for first, last in _groups(missing):
        if last - first < LONGEST:
            here = np.arange(max(0, first - NEIGHBOURS), min(len(series), last + 1 + NEIGHBOURS))
            gap, known = here[missing[here]], here[~missing[here]]
            among = covariance[np.abs(known[:, None] - known)] + RIDGE * covariance[0] * np.eye(len(known))
            across = covariance[np.abs(gap[:, None] - known)]
            values = mean + across @ solve(among, series[known] - mean, assume_a="pos")
            inside = (gap >= first) & (gap <= last)
            found[gap[inside]] = values[inside]
    return found


def _groups(missing: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and last sample of each gap."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]]).astype(int)))
    return [(int(first), int(end) - 1) for first, end in edges.reshape(-1, 2)]


def _autocovariance(series: np.ndarray) -> np.ndarray:
    """Return the covariance of samples at each lag that is asked for; divided by all samples it is positive definite."""
    lags = 2 * NEIGHBOURS + LONGEST
    middle = len(series) - 1
    last = min(middle, lags)
    found = np.zeros(lags + 1)
    found[: last + 1] = correlate(series, series, method="fft")[middle : middle + last + 1] / len(series)
    return found
