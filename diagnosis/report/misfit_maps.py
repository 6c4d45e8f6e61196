"""Misfits of a fit over whole runs: by channel and band, and by channel and run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.misfit import differences
from pounding.diagnosis.inference.misfit_map import band, band_edges
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import root_mean_square


@dataclass(frozen=True)
class MisfitMaps:
    """Misfits of a fit by channel and band, and by channel and run, as shares of each channel's rms.

    Attributes:
        edges_hz: Edges of the bands. runs: Names of the runs.
        by_band, by_run: Misfits, shape (channels, bands) and (channels, runs).
        band_noise, run_noise: What noise alone would leave there, the same shapes.
    """

    edges_hz: np.ndarray
    runs: tuple[str, ...]
    by_band: np.ndarray
    by_run: np.ndarray
    band_noise: np.ndarray
    run_noise: np.ndarray


def misfit_maps(model: Model, filtered: Filtered, floor: np.ndarray, runs: Sequence[int]) -> MisfitMaps:
    """Return where a fit and the measurements disagree, over all the time of the runs.

    Args:
        model: The baseline model.
        filtered: The fit that is compared with the measurements.
        floor: Noise floor of each channel as a share of its rms, shape (channels,).
        runs: The runs to look at.
    """
    edges = band_edges(filtered)
    bands, each, total, samples = [], [], 0.0, 0
    nyquist = np.inf
    for data, difference in differences(model, filtered, runs):
        square = np.nan_to_num(root_mean_square(data.measured)) ** 2
        each.append(
            np.nan_to_num(root_mean_square(difference)) / np.sqrt(np.where(square > 0, square, np.nan))
        )
        nyquist = min(nyquist, 0.5 / data.step_s)
        filled = np.nan_to_num(difference)
        inside = [
            root_mean_square(band(filled, low, min(high, 0.9 / (2 * data.step_s)), data.step_s)) ** 2
            for low, high in pairwise(edges)
        ]
        bands.append(len(filled) * np.array(inside).T)
        total = total + len(filled) * square
        samples += len(filled)
    known = np.where(np.asarray(total) > 0, total, np.nan)[:, None]
    width = np.sqrt(np.diff(edges) / nyquist)
    return MisfitMaps(
        edges_hz=edges,
        runs=tuple(model.observed.runs[run].name for run in runs),
        by_band=np.sqrt(np.sum(bands, axis=0) / known),
        by_run=np.array(each).T,
        band_noise=floor[:, None] * width,
        run_noise=np.repeat(floor[:, None], len(runs), axis=1),
    )
