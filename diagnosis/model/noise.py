"""Noise estimated from the data: what a channel shows where no frame answers any more."""

from __future__ import annotations

import numpy as np
from scipy.signal import welch

QUIET_BAND = (0.6, 0.95)
"""Fractions of the Nyquist frequency between which a channel is taken to show its noise alone."""


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
