"""A series as it was before a delay and a clock of another rate."""

from __future__ import annotations

import numpy as np
from scipy.fft import next_fast_len
from scipy.interpolate import CubicSpline

FINER = 4
"""Points in a sampling step between which a series is interpolated for another clock."""


def shift(series: np.ndarray, step_s: float, delay_s: float, clock: float = 0.0) -> np.ndarray:
    """Return a series as it was before a delay and a clock of another rate, shape (samples,); NaN samples stay NaN.

    At time t it is what the series shows at (t + delay) (1 + clock). The shift is a phase and nothing else: an
    interpolation between samples would average their noise away, and a likelihood would pay for that. For the clock
    the series is interpolated between samples FINER times as close, which leaves the noise as it is.

    Args:
        series: Samples, NaN where missing, shape (samples,).
        step_s: Sampling step [s].
        delay_s: The delay [s].
        clock: Relative change of the clock's rate [-].
    """
    good = np.isfinite(series)
    if good.sum() < 4:
        return series.copy()
    index = np.arange(len(series))
    filled = np.interp(index, index[good], series[good])
    pad = min(256, len(series) - 1)
    padded = np.concatenate(
        [2 * filled[0] - filled[pad:0:-1], filled, 2 * filled[-1] - filled[-2 : -pad - 2 : -1]]
    )
    length = next_fast_len(len(padded), real=True)
    ramp = np.linspace(padded[-1], padded[0], length - len(padded) + 2)[1:-1]
    frequency = np.fft.rfftfreq(length, step_s)
    spectrum = np.fft.rfft(np.concatenate([padded, ramp])) * np.exp(2j * np.pi * frequency * delay_s)
    if clock == 0.0:
        moved = np.fft.irfft(spectrum, length)[pad : pad + len(series)]
        moved[~good] = np.nan
        return moved
    # The delay is the phase's, in time of the channel's own clock.
    spectrum *= np.exp(2j * np.pi * frequency * delay_s * clock)
    finer = FINER * np.fft.irfft(spectrum, FINER * length)[FINER * pad : FINER * (pad + len(series))]
    at = FINER * index * (1 + clock)
    moved = np.asarray(CubicSpline(np.arange(len(finer)), finer)(np.clip(at, 0, len(finer) - 1)))
    moved[~good[np.clip(np.rint(at / FINER).astype(int), 0, len(series) - 1)]] = np.nan
    return moved
