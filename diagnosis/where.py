"""Where a model and measurements disagree: by channel, run, window and band, and as a leftover force in each storey."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt

from diagnosis.baseline import starting_noise
from diagnosis.believed import Believed
from diagnosis.calibrate import Baseline, run_baseline
from diagnosis.gap import levelled, simulate
from diagnosis.observations import root_mean_square

WINDOWS = 6
BANDS = 6
SHOWN = 8
ABOVE = 1.5
"""Windows of a run, bands up to beyond the modes, entries told, and how far above the noise one must be."""
FORCE_LEVEL = 0.03
"""Share of a storey's shear that a leftover force is allowed in its estimate."""


@dataclass(frozen=True)
class Leftover:
    """The force that a storey has beyond the calibrated model's, in one run.

    Attributes:
        run: Name of the run. time_s: Times (samples,). force: (samples, storeys) [N]. std: (storeys,) [N].
        drift, drift_rate: (samples, storeys) [m], [m/s].
    """

    run: str
    time_s: np.ndarray
    force: np.ndarray
    std: np.ndarray
    drift: np.ndarray
    drift_rate: np.ndarray


def where(
    believed: Believed, baseline: Baseline, floor: np.ndarray, runs: Sequence[int]
) -> list[dict[str, Any]]:
    """Return the largest disagreements of a fit, largest first, as the report lists them.

    `gap` is the rms of the difference in a window and band over the rms of the channel in the whole run.

    Args:
        believed: The believed model.
        baseline: The fit that is compared with the measurements.
        floor: Noise floor of each channel as a share of its rms, shape (channels,).
        runs: The runs to look at.
    """
    highest = 1.3 * float(np.sort(baseline.modes.omega)[min(4, len(baseline.modes.omega) - 1)]) / (2 * np.pi)
    edges = np.geomspace(0.5 * float(baseline.modes.omega.min()) / (2 * np.pi), highest, BANDS)
    edges = np.concatenate([[0.0], edges])
    found: list[dict[str, Any]] = []
    for run, output in zip(runs, simulate(believed, baseline.values, baseline.effects, runs), strict=True):
        data = believed.observed.runs[run]
        difference = np.nan_to_num(levelled(believed, output - data.measured))
        rms = root_mean_square(data.measured)
        nyquist = 0.5 / data.step_s
        for low, high in zip(edges[:-1], np.minimum(edges[1:], 0.95 * nyquist), strict=True):
            part = _band(difference, low, high, data.step_s)
            for window in np.array_split(np.arange(len(part)), WINDOWS):
                level = root_mean_square(part[window])
                noise = floor * np.sqrt((high - low) / nyquist)
                for channel in np.flatnonzero(level > ABOVE * noise * rms):
                    found.append(
                        {
                            "channel": believed.observed.names[channel],
                            "run": data.name,
                            "window_s": [float(data.time_s[window[0]]), float(data.time_s[window[-1]])],
                            "band_hz": [float(low), float(high)],
                            "gap": float(level[channel] / rms[channel]),
                        }
                    )
    return sorted(found, key=lambda one: -one["gap"])[:SHOWN]


def _band(series: np.ndarray, low: float, high: float, step_s: float) -> np.ndarray:
    kind, edge = ("lowpass", high) if low <= 0 else ("bandpass", (low, high))
    sections = butter(3, edge, kind, fs=1 / step_s, output="sos")
    return np.asarray(sosfiltfilt(sections, series, axis=0))


def leftover_forces(believed: Believed, baseline: Baseline, runs: Sequence[int]) -> list[Leftover]:
    """Return the leftover force of every storey, as the filter sees it with room for a force in each."""
    noise = starting_noise(believed, runs, FORCE_LEVEL)
    found = run_baseline(believed, baseline.values, noise, runs, baseline.effects)
    modes = len(found.modes.omega)
    storeys = believed.structure.floors
    rows = believed.structure.drift @ found.modes.floors
    result = []
    for number, run in enumerate(runs):
        states = found.prediction.after[number]
        data = believed.observed.runs[run]
        result.append(
            Leftover(
                run=data.name,
                time_s=data.time_s,
                # A latent force pushes along the drift; what a storey has beyond the model opposes it.
                force=-states[:, 2 * modes : 2 * modes + storeys],
                std=found.filters[number].spread[2 * modes : 2 * modes + storeys],
                drift=states[:, :modes] @ rows.T,
                drift_rate=states[:, modes : 2 * modes] @ rows.T,
            )
        )
    return result
