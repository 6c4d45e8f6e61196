"""Where a model and measurements disagree: by channel, run, window and band."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from msgspec import Struct
from scipy.signal import butter, sosfiltfilt

from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.misfit import differences
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.settings import SETTINGS


class Spot(Struct, frozen=True, kw_only=True):
    """A window and band of a channel in which a fit and the measurement disagree.

    Attributes:
        channel, run: Their names.
        window_s: First and last time of the window [s].
        band_hz: Edges of the band [Hz].
        misfit: rms of the difference in this window and band over the rms of the channel in the whole run.
    """

    channel: str
    run: str
    window_s: tuple[float, float]
    band_hz: tuple[float, float]
    misfit: float


def where(model: Model, filtered: Filtered, floor: np.ndarray, runs: Sequence[int]) -> list[Spot]:
    """Return the largest disagreements of a fit, largest first.

    Args:
        model: The baseline model.
        filtered: The fit that is compared with the measurements.
        floor: Noise floor of each channel as a share of its rms, shape (channels,).
        runs: The runs to look at.
    """
    edges = band_edges(filtered)
    found: list[Spot] = []
    for data, levelled in differences(model, filtered, runs):
        difference = np.nan_to_num(levelled)
        rms = root_mean_square(data.measured)
        nyquist = 0.5 / data.step_s
        # Bands beyond what the run can hold fall together.
        for low, high in pairwise(np.unique(np.minimum(edges, 0.95 * nyquist))):
            part = band(difference, low, high, data.step_s)
            for window in np.array_split(np.arange(len(part)), SETTINGS.misfit_map.windows):
                level = root_mean_square(part[window])
                noise = floor * np.sqrt((high - low) / nyquist)
                for channel in np.flatnonzero(level > SETTINGS.misfit_map.above * noise * rms):
                    found.append(
                        Spot(
                            channel=model.observed.names[channel],
                            run=data.name,
                            window_s=(float(data.time_s[window[0]]), float(data.time_s[window[-1]])),
                            band_hz=(float(low), float(high)),
                            misfit=float(level[channel] / rms[channel]),
                        )
                    )
    return sorted(found, key=lambda one: -one.misfit)[: SETTINGS.misfit_map.listed]


def band_edges(filtered: Filtered) -> np.ndarray:
    """Return the edges of the bands in which misfits are looked at [Hz], from 0 to beyond the fifth mode."""
    highest = 1.3 * float(np.sort(filtered.modes.omega)[min(4, len(filtered.modes.omega) - 1)]) / (2 * np.pi)
    lowest = 0.5 * float(filtered.modes.omega.min()) / (2 * np.pi)
    edges = np.geomspace(lowest, highest, SETTINGS.misfit_map.bands)
    return np.concatenate([[0.0], edges])


def band(series: np.ndarray, low: float, high: float, step_s: float) -> np.ndarray:
    """Return the part of series between two frequencies, shape (samples, channels).

    Args:
        series: The series, shape (samples, channels).
        low: Lower frequency [Hz]; at zero only the upper one cuts.
        high: Upper frequency [Hz], below half the sampling rate.
        step_s: Sampling step [s].
    """
    if low >= high:  # beyond what a run with this step can hold
        return np.zeros_like(series)
    kind, edge = ("lowpass", high) if low <= 0 else ("bandpass", (low, high))
    sections = butter(3, edge, kind, fs=1 / step_s, output="sos")
    return np.asarray(sosfiltfilt(sections, series, axis=0))
