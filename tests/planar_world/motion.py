"""How the table moves: records at model time, or noise of a band, as smooth functions of time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from pounding.experiments.records import records_folder
from tests.planar_world.baseline import Real
from tests.planar_world.integration import DURATION_S

SOURCES = ("elcentro", "hachinohe", "northridge", "kobe", "noise", "noise")
"""Of which three runs are drawn, so that one may be of noise twice but of no record."""
NOISE = "noise"
TIME_SCALE = 30
"""Lengths of the model over those of the building: times are divided by its square root."""
GRID_S, TABLE_HZ, LEAST_PEAK, RISE_S = 2.5e-4, 45.0, 2.0, 0.04
LEAD, TAIL = 4000, 8000
"""Samples of rest before and after a motion when the table filters it."""


def motion(source: str, rng: np.random.Generator, peak: float) -> CubicSpline:
    """Return the table's acceleration [m/s^2] over time [s].

    Args:
        source: A record of the folder that POUNDING_RECORDS names, or `NOISE`.
        rng: Source of chance.
        peak: Largest acceleration [m/s^2].
    """
    count = int(DURATION_S / GRID_S) + 1
    time: Real = np.arange(count, dtype=np.float64) * GRID_S
    values = _noise(time, rng) if source == NOISE else _recorded(source, time, rng)
    padded = np.concatenate([np.zeros(LEAD), values, np.zeros(TAIL)])
    frequency = np.fft.rfftfreq(len(padded), GRID_S)
    followed = np.fft.irfft(np.fft.rfft(padded) / np.sqrt(1 + (frequency / TABLE_HZ) ** 12), len(padded))
    values = followed[LEAD : LEAD + count]
    values *= np.clip(time / RISE_S, 0, 1) ** 2
    return CubicSpline(time, values * peak / np.abs(values).max())


def missing_records() -> str:
    """Return what to do for the records of a set that are not there, empty if all are."""
    missing = [name for name in dict.fromkeys(SOURCES) if name != NOISE and not _file(name).is_file()]
    return f"no record {missing[0]}.csv; set POUNDING_RECORDS to the folder that holds it" if missing else ""


def _file(name: str) -> Path:
    return (records_folder() or Path()) / f"{name}.csv"


def _noise(time: Real, rng: np.random.Generator) -> Real:
    """Return noise of a band under an envelope (times,), of any size."""
    low, high = rng.uniform(0.7, 1.5), rng.uniform(18, 32)
    # Made twice as long: what an inverse transform makes is periodic.
    frequency = np.fft.rfftfreq(2 * len(time), GRID_S)
    band = (frequency / low) ** 2 / (1 + (frequency / low) ** 2) / (1 + (frequency / high) ** 6)
    white = rng.normal(size=len(frequency)) + 1j * rng.normal(size=len(frequency))
    values: Real = np.fft.irfft(band * white, 2 * len(time))[: len(time)]
    return values * (np.clip(time / 0.8, 0, 1) * np.where(time > 5.5, np.exp(-(time - 5.5) / 1.2), 1.0))


def _recorded(name: str, time: Real, rng: np.random.Generator) -> Real:
    """Return a record at model time (times,), which begins after a little rest."""
    record = np.loadtxt(_file(name), delimiter=",", skiprows=1)
    at = record[:, 0] / np.sqrt(TIME_SCALE) + rng.uniform(0.05, 0.3)
    return np.interp(time, at, record[:, 1], left=0, right=0)
