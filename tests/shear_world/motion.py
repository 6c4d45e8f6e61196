"""How the table moves: filtered noise under an envelope, and chirps, as smooth functions of time."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, chirp, sosfilt

from tests.shear_world.building import Real

DURATION_S, BAND_HZ, GRID_HZ = 8.0, (0.8, 20.0), 2000
NOISE_PEAKS, CHIRP_PEAKS = (1.5, 3.0), (0.25, 0.5)
"""Least and largest peaks [m/s^2]. A chirp lingers near every mode, so it needs less."""
RISE_S = 0.5


def motions(rng: np.random.Generator) -> list[CubicSpline]:
    """Return the table's acceleration [m/s^2] over time [s] in three runs: noise, a chirp, noise."""
    time = np.arange(round(DURATION_S * GRID_HZ) + 1) / GRID_HZ
    runs = [
        (_noise(time, rng), NOISE_PEAKS),
        (_chirp(time, rng), CHIRP_PEAKS),
        (_noise(time, rng), NOISE_PEAKS),
    ]
    return [
        CubicSpline(time, values * rng.uniform(*peaks) / np.abs(values).max(), bc_type="natural")
        for values, peaks in runs
    ]


def _noise(time: Real, rng: np.random.Generator) -> Real:
    white = rng.standard_normal(len(time))
    filtered: Real = sosfilt(butter(6, BAND_HZ, "bandpass", fs=GRID_HZ, output="sos"), white)
    return _envelope(time) * filtered


def _chirp(time: Real, rng: np.random.Generator) -> Real:
    low, high = BAND_HZ if rng.random() < 0.5 else BAND_HZ[::-1]
    phase = rng.uniform(0, 360)
    swept: Real = chirp(time, low, time[-1], high, method="logarithmic", phi=phase)
    return _envelope(time) * swept


def _envelope(time: Real) -> Real:
    """Return a factor (times,) [-] that rises from zero at both ends of a run."""
    to_an_end = np.minimum(time, time[-1] - time)
    rise: Real = np.sin(0.5 * np.pi * np.minimum(to_an_end / RISE_S, 1.0))
    return rise**2
