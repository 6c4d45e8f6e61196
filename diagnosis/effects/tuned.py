"""What is tuned: an oscillator driven by the frame, and the frequencies at which one is tried."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.signal import cont2discrete, lfilter

TRIED_DAMPING = 0.04
"""Damping ratio with which an oscillator is scored: it answers in a band of twice this share of its frequency."""


def bandwidths(lowest: float, highest: float) -> np.ndarray:
    """Return frequencies a bandwidth apart, of any unit: between two of them nothing tuned is overlooked, (frequencies,).

    Args:
        lowest: The first one.
        highest: None is beyond it.
    """
    return np.asarray(np.exp(np.arange(np.log(lowest), np.log(highest), 2 * TRIED_DAMPING)))


def oscillator(driving: np.ndarray, omega: float, step_s: float) -> np.ndarray:
    """Return x of x'' + 2 TRIED_DAMPING omega x' + omega^2 x = driving, at rest before, shape (samples,).

    Args:
        driving: Acceleration that drives it [m/s^2], linear between samples, shape (samples,).
        omega: Angular frequency [rad/s].
        step_s: Sampling step [s].
    """
    numerator, denominator = _filter_of(omega, step_s)
    return np.asarray(lfilter(numerator, denominator, driving))


@lru_cache(maxsize=1024)
def _filter_of(omega: float, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and denominator, (3,) each, of an oscillator of an angular frequency [rad/s] that is sampled [s].

    They are kept: each of some tens of frequencies is asked for in each run, and again by each search.
    """
    numerator, denominator, _ = cont2discrete(
        ([1.0], [1.0, 2 * TRIED_DAMPING * omega, omega**2]), step_s, method="foh"
    )
    return numerator.ravel(), denominator
