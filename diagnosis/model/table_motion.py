"""The table's acceleration between its samples: smooth, straight lines, or held as a digital drive holds it."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import firwin, resample_poly

SMOOTH, LINEAR, HELD = "smooth", "linear", "zoh"
FINER = 4
"""Samples of the smooth curve for each of the logger's: a cubic spline through these errs by less than 0.1 % at half the
logger's rate, and one through the logger's own by 2 % at a quarter of it and by half of the shaking near half of it."""
SHARP = firwin(2 * 32 * FINER + 1, 1.0 / FINER, window=("kaiser", 8.0))
"""Low pass that lets through what a logger can sample: 0.01 % of ripple up to nine tenths of half its rate."""


class TableMotion:
    """The table's acceleration as a function of time.

    A smooth one has nothing above half the logger's rate, as its filter leaves it: that says how it goes on between samples.

    Args:
        samples: Acceleration [m/s^2], shape (samples,).
        step_s: Sampling step [s].
        between: How it goes on between samples: `SMOOTH`, `LINEAR` or `HELD`.
        width_s: Time [s] over which a held acceleration is averaged: a substep of whoever asks. A delay that moves a
            jump within a substep would otherwise change nothing.
    """

    def __init__(self, samples: np.ndarray, step_s: float, between: str, width_s: float) -> None:
        self._times, self._samples = np.arange(len(samples)) * step_s, samples
        self._between, self._half_s = between, 0.5 * width_s
        fine = resample_poly(samples, FINER, 1, window=SHARP, padtype="antireflect")
        self._spline = CubicSpline(np.arange(len(fine)) * (step_s / FINER), fine)
        self._ends = np.arange(len(samples) + 1) * step_s
        self._rate = np.concatenate([[0.0], np.cumsum(samples) * step_s])

    def at(self, times_s: np.ndarray) -> np.ndarray:
        """Return the acceleration [m/s^2] at times from the first sample to the last [s], shape of `times_s`."""
        if self._between == LINEAR:
            return np.asarray(np.interp(times_s, self._times, self._samples))
        if self._between == HELD:
            first, last = np.maximum(times_s - self._half_s, 0.0), times_s + self._half_s
            gained = np.interp(last, self._ends, self._rate) - np.interp(first, self._ends, self._rate)
            return np.asarray(gained / (last - first))
        return np.asarray(self._spline(times_s))

    def slope(self, times_s: np.ndarray) -> np.ndarray:
        """Return the rate of change at times [m/s^3], shape of `times_s`, of a smooth curve whatever lies between."""
        return np.asarray(self._spline(times_s, 1))
