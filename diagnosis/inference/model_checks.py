"""What speaks against a model however well it fits: nuisance parameters at their ends, a tone that nothing in it makes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter
from scipy.stats import chi2

from pounding.diagnosis.inference.filtering import Filtered, whitened
from pounding.diagnosis.model.model import Model

STRUCTURE = ("frame_stiffness", "storey_stiffness", "base_stiffness", "joint_stiffness", "floor_mass")
"""Nuisance parameters that say which frame this is."""
BENT, STRAINED = 1e-4, 1e-8
"""Probability by the priors that a frame is as far from the believed one: below the first a calibration may be stuck
where it imitates something, below the second it is another frame."""
TONE = 200.0
"""Power of a line in the innovations over the median beside it from which it is a tone; noise alone reaches some 40."""
BESIDE = 41
"""Bins of the spectrum about a line."""
OWN = 0.02
"""Relative distance from a natural frequency within which a line may be a mode that is not quite right."""
MAINS_HZ, HUM_HZ = (50.0, 60.0), 0.3
"""Mains frequencies, and how near to a multiple of them a line is hum of the cables and no motion."""


def model_checks(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence for each thing that a fitted model cannot have right, nothing if it may be right."""
    return [*_strained(model, filtered), *_tones(model, filtered)]


def strain(model: Model, filtered: Filtered) -> tuple[float, int]:
    """Return the sum of squares of the frames' nuisance parameters over their priors, and how many they are."""
    ours = np.array([parameter.kind in STRUCTURE for parameter in model.parameters])
    return float(np.sum((filtered.values / model.std)[ours] ** 2)), int(ours.sum())


def bent(model: Model, filtered: Filtered) -> bool:
    """Return whether the frames' nuisance parameters are so far from the baseline model that one should start anew."""
    return bool(chi2.sf(*strain(model, filtered)) < BENT)


def _strained(model: Model, filtered: Filtered) -> list[str]:
    squares, count = strain(model, filtered)
    if chi2.sf(squares, count) > STRAINED:
        return []
    return [
        f"stiffness and mass must go further from the baseline frame than its priors allow (sum of squares {squares:.0f} "
        f"in standard deviations, some {count} at most are to be expected): is this the frame that case.toml names?"
    ]


def _tones(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence for each frequency at which several channels show a line that is nobody's."""
    own = filtered.modes.omega / (2.0 * np.pi)
    found: dict[float, str] = {}
    for series, steady, number in zip(
        filtered.prediction.innovations, filtered.filters, filtered.runs, strict=True
    ):
        run = model.observed.runs[number]
        good = np.isfinite(run.measured)
        for frequency in tones(whitened(series, steady, good), run.step_s):
            mode = np.abs(frequency / own - 1.0).min() < OWN
            if not mode and not _hum(frequency) and not any(abs(frequency - f) < 0.5 for f in found):
                found[frequency] = run.name
    return [
        f"{name}: a tone of {frequency:.1f} Hz in several channels, which neither the table nor a mode makes; "
        "is it a machine, or a part that sways by itself?"
        for frequency, name in found.items()
    ]


def _hum(frequency: float) -> bool:
    return any(frequency > HUM_HZ and abs(frequency - round(frequency / f) * f) < HUM_HZ for f in MAINS_HZ)


def tones(series: np.ndarray, step_s: float) -> Sequence[float]:
    """Return the frequencies [Hz] of lines that stand out of two channels at least, or of the only one.

    Args:
        series: Whitened innovations (samples, channels).
        step_s: Sampling step [s].
    """
    samples, channels = series.shape
    if samples < 4 * BESIDE:
        return []
    power = np.abs(np.fft.rfft(series * np.hanning(samples)[:, None], axis=0)) ** 2
    beside = median_filter(power, size=(2 * BESIDE + 1, 1), mode="reflect")
    out = power > TONE * np.maximum(beside, np.finfo(float).tiny)
    out[:3] = False
    # A window spreads a line over its neighbours.
    near = out | np.roll(out, 1, axis=0) | np.roll(out, -1, axis=0)
    several = near.sum(axis=1) >= min(2, channels)
    starts = np.flatnonzero(several & ~np.roll(several, 1))
    ends = np.flatnonzero(several & ~np.roll(several, -1))
    total = power.sum(axis=1)
    peaks = [start + int(total[start : end + 1].argmax()) for start, end in zip(starts, ends, strict=True)]
    return [float(peak / (samples * step_s)) for peak in peaks]
