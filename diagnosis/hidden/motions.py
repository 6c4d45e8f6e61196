"""Table motions for hidden cases: the four records when they are there, and artificial ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, lfilter, sosfiltfilt
from scipy.signal.windows import tukey

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import RECORDS, find, records_folder
from pounding.scale import THESIS

SOURCES = ("records", "artificial", "mixed")
TABLE_BAND_HZ = (0.4, 60.0)
"""What the table can follow [Hz]."""


@dataclass(frozen=True)
class Motion:
    """A table acceleration [m/s^2] and what it came from."""

    source: str
    step_s: float
    acceleration: np.ndarray

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of the table [m/s], shape of the acceleration."""
        return _integral(self.acceleration, self.step_s)

    @property
    def displacement(self) -> np.ndarray:
        """Displacement of the table [m], shape of the acceleration."""
        return _integral(self.velocity, self.step_s)


def _integral(values: np.ndarray, step_s: float) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(0.5 * step_s * (values[1:] + values[:-1]))])


def available() -> list[str]:
    """Return which of the four records can be found.

    Raises:
        ExperimentError: POUNDING_RECORDS names a folder that is not there.
    """
    records_folder()
    found = []
    for name in RECORDS:
        try:
            find(name)
        except ExperimentError:
            continue
        found.append(name)
    return found


def draw(
    rng: np.random.Generator, count: int, duration_s: float, step_s: float, source: str = "mixed"
) -> list[Motion]:
    """Draw motions of different strength, the first the strongest.

    Args:
        rng: Source of chance.
        count: Number of motions.
        duration_s: Length of each [s].
        step_s: Time between samples [s].
        source: ``records``, ``artificial`` or ``mixed`` (each with even chance; artificial without records).
    """
    peaks_g = np.sort(rng.uniform(0.08, 0.35, count))[::-1]
    names = available() if source != "artificial" else []
    order = list(rng.permutation(names)) if names else []
    motions = []
    for peak_g in peaks_g:
        recorded = bool(order) and (source == "records" or rng.random() < 0.5)
        name = str(order.pop()) if recorded else "artificial"
        raw = _recorded(rng, name, duration_s, step_s) if recorded else _kanai_tajimi(rng, duration_s, step_s)
        motions.append(_on_the_table(name, raw, step_s, peak_g * STANDARD_GRAVITY))
    return motions


def _recorded(rng: np.random.Generator, name: str, duration_s: float, step_s: float) -> np.ndarray:
    """Return a record at model time, stretched by up to a tenth, from its beginning."""
    record = find(name).scaled(THESIS.time_factor)
    time = record.step_s * rng.uniform(0.9, 1.1) * np.arange(len(record.acceleration_m_s2))
    strong = time[np.flatnonzero(np.abs(record.acceleration_m_s2) > 0.1 * record.pga_m_s2)[0]]
    start = max(0.0, strong - 0.3)
    at = start + step_s * np.arange(round(duration_s / step_s))
    return np.where(
        at <= time[-1], CubicSpline(time, record.acceleration_m_s2)(np.minimum(at, time[-1])), 0.0
    )


def _kanai_tajimi(rng: np.random.Generator, duration_s: float, step_s: float) -> np.ndarray:
    """Return white noise through a soil layer (Kanai 1957, Tajimi 1960) under a trapezoidal envelope."""
    count = round(duration_s / step_s)
    soil, ratio = 2 * np.pi * rng.uniform(3.0, 14.0), rng.uniform(0.3, 0.8)
    # Bilinear transform of (2 z w s + w^2) / (s^2 + 2 z w s + w^2).
    k = 2.0 / step_s
    above = np.array([2 * ratio * soil * k + soil**2, 2 * soil**2, soil**2 - 2 * ratio * soil * k])
    below = np.array([k**2, -2 * k**2, k**2]) + above
    shaken = lfilter(above, below, rng.standard_normal(count))
    time = step_s * np.arange(count)
    rise, hold, fade = rng.uniform(0.2, 1.0), rng.uniform(2.0, 4.0), rng.uniform(0.8, 2.5)
    envelope = np.minimum(time / rise, 1.0) ** 2 * np.exp(-np.maximum(time - rise - hold, 0.0) / fade)
    return np.asarray(shaken * envelope)


def _on_the_table(source: str, raw: np.ndarray, step_s: float, peak: float) -> Motion:
    """Return what the table makes of a signal: within its band, from rest, of the wanted peak [m/s^2]."""
    low, high = TABLE_BAND_HZ
    sections = butter(2, [low, high], "bandpass", fs=1 / step_s, output="sos")
    lead = round(1.0 / step_s)
    kept = sosfiltfilt(sections, np.concatenate([np.zeros(lead), raw, np.zeros(lead)]))[lead:-lead]
    kept *= tukey(len(kept), 0.03)
    return Motion(source, step_s, kept * (peak / np.abs(kept).max()))
