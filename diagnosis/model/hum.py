"""Hum of the mains in the cables: lines of 50 or 60 Hz and their multiples that no frame and no table makes."""

from __future__ import annotations

import numpy as np
from scipy.fft import next_fast_len

from pounding.diagnosis.settings import SETTINGS

MAINS_HZ = (50.0, 60.0)
MULTIPLES = 5
RECTIFIED = 2
"""A rectifier doubles the frequency: the lowest multiple in the hum is this one at most."""
NEAR = 0.002
"""[-] A mains frequency is so near to its nominal value."""
FINER = 4
"""Points of the spectrum in a line's width."""
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
    length = next_fast_len(FINER * len(left), real=True)
    spectrum = np.abs(np.fft.rfft(left * np.hanning(len(left)), length))
    bin_hz = 1.0 / (length * step_s)
    for mains in MAINS_HZ:
        lowest = True
        for multiple in range(1, MULTIPLES + 1):
            # Mains that are bent or rectified have higher multiples beside a lower one, never alone.
            if multiple * mains < 0.45 / step_s and (multiple <= RECTIFIED or not lowest):
                hertz = _peak_hz(spectrum, bin_hz, multiple * mains)
                line = None if hertz is None else _line(left, good, step_s, hertz)
                if hertz is not None and line is not None:
                    found += line
                    lowest = False
                    frequencies.append(hertz)
    return found, frequencies


def _peak_hz(spectrum: np.ndarray, bin_hz: float, hertz: float) -> float | None:
    """Return where the spectrum, (bins,), is largest near a frequency [Hz]; None where it is no larger than beside it."""
    first, last = (round(hertz * (1 + off) / bin_hz) for off in (-NEAR, NEAR))
    top = first + int(spectrum[first : last + 1].argmax())
    about = spectrum[max(0, top - 30 * FINER) : top + 30 * FINER]
    if top + 1 >= len(spectrum) or spectrum[top] <= SETTINGS.screening.hum * np.median(about):
        return None
    # The peak of the parabola through the three largest.
    low, high, after = np.log(np.maximum(spectrum[top - 1 : top + 2], np.finfo(float).tiny))
    curved = low - 2 * high + after
    return float((top + (0.5 * (low - after) / curved if curved < 0.0 else 0.0)) * bin_hz)


def _line(series: np.ndarray, good: np.ndarray, step_s: float, best: float) -> np.ndarray | None:
    """Return the line of a frequency [Hz], shape (samples,), if it is alike in all parts."""
    times = np.arange(len(series)) * step_s
    parts = _parts(series, times, best)
    mean = parts.mean()
    part_hz = PARTS / (len(series) * step_s)
    beside = np.array([_parts(series, times, best + k * part_hz) for k in BESIDE])
    noise = float(np.sqrt(np.mean(np.abs(beside) ** 2)))
    ours = SETTINGS.screening
    if abs(mean) < ours.hum * noise or np.abs(parts - mean).max() > ours.hum_steady * abs(mean):
        return None
    waves = np.column_stack([np.cos(2 * np.pi * best * times), np.sin(2 * np.pi * best * times)])
    size, *_ = np.linalg.lstsq(waves[good], series[good], rcond=None)
    return np.asarray(waves @ size)


def _parts(series: np.ndarray, times: np.ndarray, hertz: float) -> np.ndarray:
    """Return the complex amplitude of a frequency in each part of a series, shape (parts,)."""
    turned = series * np.exp(-2j * np.pi * hertz * times)
    parts = np.array_split(turned, PARTS)
    return np.array([2.0 * np.average(part, weights=np.hanning(len(part) + 2)[1:-1]) for part in parts])
