"""What speaks against a model however well it fits: nuisance parameters at their ends, a tone that nothing in it makes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import binary_dilation, find_objects, label, median_filter
from scipy.stats import chi2

from pounding.diagnosis.inference.filtering import Filtered, whitened_runs
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS

STRUCTURE = ("frame_stiffness", "storey_stiffness", "base_stiffness", "joint_stiffness", "floor_mass")
"""Nuisance parameters that say which frame this is."""
MAINS_HZ = (50.0, 60.0)
"""Mains frequencies."""


def model_checks(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence for each thing that a fitted model cannot have right, nothing if it may be right."""
    return [*strained(model, filtered), *_tones(model, filtered)]


def strain(model: Model, filtered: Filtered) -> tuple[float, int]:
    """Return the sum of squares of the frames' nuisance parameters over their priors, and how many they are."""
    ours = np.array([parameter.kind in STRUCTURE for parameter in model.parameters])
    return float(np.sum((filtered.values / model.std)[ours] ** 2)), int(ours.sum())


def bent(model: Model, filtered: Filtered) -> bool:
    """Return whether the frames' nuisance parameters are so far from the baseline model that one should start anew."""
    return bool(chi2.sf(*strain(model, filtered)) < SETTINGS.checks.bent)


def strained(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence if stiffness and mass of a fitted model are those of another frame, nothing if not."""
    squares, count = strain(model, filtered)
    if chi2.sf(squares, count) > SETTINGS.checks.strained:
        return []
    return [
        f"stiffness and mass must go further from the baseline frame than its priors allow (sum of squares {squares:.0f} "
        f"in standard deviations, some {count} at most are to be expected): is this the frame that case.toml names?"
    ]


def _tones(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence for each frequency at which several channels show a line that is nobody's."""
    own = filtered.modes.omega / (2.0 * np.pi)
    found: dict[float, str] = {}
    white = whitened_runs(model, filtered.prediction.innovations, filtered.filters, filtered.runs)
    for series, number in zip(white, filtered.runs, strict=True):
        run = model.observed.runs[number]
        for frequency in tones(series, run.step_s):
            mode = np.abs(frequency / own - 1.0).min() < SETTINGS.checks.own
            if (
                not mode
                and not _hum(frequency)
                and not any(abs(frequency - f) < SETTINGS.checks.same_tone_hz for f in found)
            ):
                found[frequency] = run.name
    return [
        f"{name}: a tone of {frequency:.1f} Hz in several channels, which neither the table nor a mode makes; "
        "is it a machine, or a part that sways by itself?"
        for frequency, name in found.items()
    ]


def _hum(frequency: float) -> bool:
    near = SETTINGS.checks.hum_hz
    return any(frequency > near and abs(frequency - round(frequency / f) * f) < near for f in MAINS_HZ)


def tones(series: np.ndarray, step_s: float) -> Sequence[float]:
    """Return the frequencies [Hz] of lines that stand out of two channels at least, or of the only one.

    Args:
        series: Whitened innovations (samples, channels).
        step_s: Sampling step [s].
    """
    samples, channels = series.shape
    if samples < 4 * SETTINGS.checks.beside:
        return []
    power = np.abs(np.fft.rfft(series * np.hanning(samples)[:, None], axis=0)) ** 2
    beside = median_filter(power, size=(2 * SETTINGS.checks.beside + 1, 1), mode="reflect")
    out = power > SETTINGS.checks.tone * np.maximum(beside, np.finfo(float).tiny)
    out[:3] = False
    # A window spreads a line over its neighbours.
    near = binary_dilation(out, np.ones((3, 1), bool))
    several = near.sum(axis=1) >= min(2, channels)
    total = power.sum(axis=1)
    peaks = [line.start + int(total[line].argmax()) for (line,) in find_objects(label(several)[0])]
    return [float(peak / (samples * step_s)) for peak in peaks]
