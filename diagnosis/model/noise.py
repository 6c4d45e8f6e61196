"""Noise estimated from the data: what a channel shows where no frame answers any more."""

from __future__ import annotations

import numpy as np
from scipy.signal import welch

QUIET_BAND = (0.6, 0.95)
"""Fractions of the Nyquist frequency between which a channel is taken to show its noise alone."""


AT_REST = 0.02
"""Share of its largest acceleration below which the table has not begun to move."""
REST_S = 0.5
"""Least time before the shaking [s] in which a channel's noise is looked for."""
MARGIN = 1.15
"""By how much a channel's noise may exceed what the quiet band shows: noise is not quite white."""


def largest_noise(series: np.ndarray, step_s: float, table: np.ndarray) -> float:
    """Return the largest standard deviation that a channel's noise can have, by what it shows where nothing moves it.

    That is above the modes, where what is seen is noise at most, and before the shaking; NaN for a channel without samples.

    Args:
        series: One channel, shape (samples,); NaN samples are left out.
        step_s: Sampling step [s].
        table: The table's acceleration, shape (samples,).
    """
    moving = np.flatnonzero(np.abs(table) > AT_REST * np.abs(table).max())
    rest = series[: int(moving[0]) if len(moving) else 0]
    rest = rest[np.isfinite(rest)]
    before = float(rest.std()) if len(rest) * step_s > REST_S else 0.0
    return max(MARGIN * spectral_floor(series, step_s), before)


def spectral_floor(series: np.ndarray, step_s: float) -> float:
    """Return the standard deviation of white noise with the density that the quiet band shows, in the series' unit.

    Args:
        series: One channel, shape (samples,); NaN samples are interpolated.
        step_s: Sampling step [s].
    """
    good = np.isfinite(series)
    if good.sum() < 64:
        return float("nan")
    index = np.arange(len(series))
    filled = np.interp(index, index[good], series[good])
    frequency, density = welch(filled, 1 / step_s, nperseg=min(512, len(filled)), detrend="linear")
    nyquist = 0.5 / step_s
    band = (frequency > QUIET_BAND[0] * nyquist) & (frequency < QUIET_BAND[1] * nyquist)
    # The median of a Welch average of many segments is close to its mean, and a line in the band does not move it.
    return float(np.sqrt(np.median(density[band]) * nyquist))
