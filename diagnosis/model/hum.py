"""Hum of the mains in the cables: lines of 50 or 60 Hz and their multiples that no frame and no table makes."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.settings import SETTINGS

MAINS_HZ = (50.0, 60.0)
MULTIPLES = 5
NEAR = 0.002
"""[-] A mains frequency is so near to its nominal value."""
PARTS = 6
"""Parts of a run: hum is alike in all of them, an answer to shaking is not."""
BESIDE = (-7, -6, -5, -4, 4, 5, 6, 7)
"""Lines of the spectrum of a part that show what stands beside the hum."""


def hum_of(series: np.ndarray, step_s: float) -> tuple[np.ndarray, list[float]]:
    """Return the hum in a series, shape (samples,), and its frequencies [Hz]; zeros and none where there is none.

    Args:
        series: Samples, NaN where missing, shape (samples,).
        step_s: Sampling step [s].
    """
    found = np.zeros(len(series))
    frequencies: list[float] = []
    good = np.isfinite(series)
    if good.sum() < PARTS * 2 * (max(BESIDE) + 1):
        return found, frequencies
    left = np.where(good, series, 0.0) - np.where(good, np.mean(series[good]), 0.0)
    for mains in MAINS_HZ:
        for multiple in range(1, MULTIPLES + 1):
            if multiple * mains < 0.45 / step_s:
                line = _line(left, good, step_s, multiple * mains)
                if line is not None:
                    found += line[0]
                    left -= np.where(good, line[0], 0.0)
                    frequencies.append(line[1])
    return found, frequencies


def _line(
    series: np.ndarray, good: np.ndarray, step_s: float, hertz: float
) -> tuple[np.ndarray, float] | None:
    """Return the line at or near a frequency, shape (samples,), and its frequency [Hz], if it is alike in all parts."""
    duration = len(series) * step_s
    tried = hertz * (1 + np.linspace(-NEAR, NEAR, 2 * int(np.ceil(4 * NEAR * hertz * duration)) + 1))
    times = np.arange(len(series)) * step_s
    window = np.hanning(len(series))
    best = max(tried, key=lambda one: abs(np.sum(window * series * np.exp(-2j * np.pi * one * times))))
    parts = _parts(series, times, best)
    mean = parts.mean()
    bin_hz = PARTS / duration
    beside = np.array([_parts(series, times, best + k * bin_hz) for k in BESIDE])
    noise = float(np.sqrt(np.mean(np.abs(beside) ** 2)))
    ours = SETTINGS.screening
    if abs(mean) < ours.hum * noise or np.abs(parts - mean).max() > ours.hum_steady * abs(mean):
        return None
    waves = np.column_stack([np.cos(2 * np.pi * best * times), np.sin(2 * np.pi * best * times)])
    size, *_ = np.linalg.lstsq(waves[good], series[good], rcond=None)
    return waves @ size, float(best)


def _parts(series: np.ndarray, times: np.ndarray, hertz: float) -> np.ndarray:
    """Return the complex amplitude of a frequency in each part of a series, shape (parts,)."""
    turned = series * np.exp(-2j * np.pi * hertz * times)
    parts = np.array_split(turned, PARTS)
    return np.array([2.0 * np.average(part, weights=np.hanning(len(part) + 2)[1:-1]) for part in parts])
