"""What speaks against a model however well it fits: nuisance parameters at their ends, a tone that nothing in it makes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import binary_dilation, find_objects, label, median_filter
from scipy.stats import chi2

from pounding.diagnosis.inference.filtering import Filtered, tangents_of, whitened_runs
from pounding.diagnosis.model.hum import MAINS_HZ
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import MODAL_DAMPING, MODAL_STIFFNESS
from pounding.diagnosis.settings import SETTINGS

STRUCTURE = ("frame_stiffness", "storey_stiffness", "base_stiffness", "joint_stiffness", "floor_mass")
"""Nuisance parameters that say which frame this is."""
DAMPING = ("frame_damping", "damping_power", "mode_damping", MODAL_DAMPING)
"""Nuisance parameters that say how it is damped."""


def strain(model: Model, values: np.ndarray, kinds: Sequence[str] = STRUCTURE) -> tuple[float, int]:
    """Return the sum of squares of the frames' nuisance parameters over their priors, and how many they are.

    Args:
        model: The baseline model.
        values: Nuisance parameters in their own units, shape (nuisance,).
        kinds: Which parameters count.
    """
    ours = np.array([parameter.kind in kinds for parameter in model.parameters])
    return float(np.sum((values / model.std)[ours] ** 2)), int(ours.sum())


def bent(model: Model, filtered: Filtered) -> bool:
    """Return whether the frames' nuisance parameters are so far from the baseline model that one should start anew."""
    return bool(chi2.sf(*strain(model, filtered.values)) < SETTINGS.checks.bent)


def beyond_priors(model: Model, values: np.ndarray, kinds: Sequence[str] = STRUCTURE) -> bool:
    """Return whether the frames' nuisance parameters are further from the baseline model than their priors allow.

    Args:
        model: The baseline model.
        values: Nuisance parameters in their own units, shape (nuisance,).
        kinds: Which parameters count.
    """
    return bool(chi2.sf(*strain(model, values, kinds)) < SETTINGS.checks.strained)


def log_prior_ratio(model: Model, before: Filtered, after: Filtered) -> float:
    """Return the logarithm of how much likelier by their priors stiffness and mass of the frames are after than before.

    The model discrepancy counts as well, as it takes what no storey can, at the scale that it had before.

    Args:
        model: The baseline model.
        before, after: The filtered models.
    """
    kinds, scale = (*STRUCTURE, MODAL_STIFFNESS), model.spread(before.discrepancy) / model.std
    squares = [strain(model, one.values / scale, kinds)[0] for one in (before, after)]
    return 0.5 * (squares[0] - squares[1])


def strained(model: Model, values: np.ndarray) -> list[str]:
    """Return a sentence if stiffness and mass are those of another frame, nothing if not.

    Args:
        model: The baseline model.
        values: Nuisance parameters in their own units, shape (nuisance,).
    """
    if not beyond_priors(model, values):
        return []
    squares, count = strain(model, values)
    return [
        f"stiffness and mass must go further from the baseline frame than its priors allow (sum of squares {squares:.0f} "
        f"in standard deviations, some {count} at most are to be expected): is this the frame that case.toml names?"
    ]


def stray_tones(model: Model, filtered: Filtered) -> list[str]:
    """Return a sentence for each frequency at which several channels show a line that is nobody's."""
    found: dict[float, str] = {}
    white = whitened_runs(model, filtered.prediction.innovations, filtered.filters, filtered.runs)
    for each, (series, number) in enumerate(zip(white, filtered.runs, strict=True)):
        run = model.observed.runs[number]
        slowest, fastest = _swings(model, filtered, each)
        shaken = table_lines(run.table, run.step_s)
        for frequency in tones(series, run.step_s):
            near = SETTINGS.checks.own * frequency
            mode = np.any((slowest < frequency + near) & (frequency - near < fastest))
            if (
                not mode
                and not _hum(frequency)
                and not _harmonic(frequency, shaken, 1 / (len(run.table) * run.step_s))
                and not any(abs(frequency - f) < SETTINGS.checks.same_tone_hz for f in found)
            ):
                found[frequency] = run.name
    where = "several channels" if len(model.observed.names) > 1 else "the only channel"
    return [
        f"{name}: a tone of {frequency:.1f} Hz in {where}, which neither the table nor a mode makes; "
        "is it a machine, or a part that sways by itself?"
        for frequency, name in found.items()
    ]


def _swings(model: Model, filtered: Filtered, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest and the highest frequency [Hz] of each mode in a run, each (modes,).

    A frame with a joint that sticks and slips swings faster while it sticks. What is stiff for a short part of the run, as a
    stop that is knocked against, makes no line.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
    """
    laws, linear = tangents_of(model, filtered, number), np.diag(filtered.run_modes[number].omega ** 2)
    if laws is None:
        hz = np.sqrt(np.diag(linear)) / (2.0 * np.pi)
        return hz, hz
    slopes, least = laws.at_sample[:, :, 0], SETTINGS.checks.as_stiff
    squares = (
        np.linalg.eigvalsh(linear + laws.rows.T * stiffness @ laws.rows)
        for stiffness in np.quantile(slopes, (least, 1.0 - least), axis=0)
    )
    low, high = (np.sqrt(np.maximum(each, 0.0)) / (2.0 * np.pi) for each in squares)
    return low, high


def _hum(frequency: float) -> bool:
    near = SETTINGS.checks.hum_hz
    return any(frequency > near and abs(frequency - round(frequency / f) * f) < near for f in MAINS_HZ)


def table_lines(table: np.ndarray, step_s: float) -> np.ndarray:
    """Return the frequencies [Hz] of strong lines of the table's own motion, shape (lines,), to a tenth of a bin.

    Args:
        table: Its acceleration, shape (samples,).
        step_s: Sampling step [s].
    """
    power = _power(table - table.mean())
    if len(table) < 4 * SETTINGS.checks.beside or not power.any():
        return np.zeros(0)
    out = power > np.maximum(
        SETTINGS.checks.tone * _beside(power[:, None])[:, 0], SETTINGS.checks.table_line * power.max()
    )
    peaks = [line.start + int(power[line].argmax()) for (line,) in find_objects(label(out)[0])]
    bins = np.arange(len(power))
    centres = [
        np.average(bins[peak - 1 : peak + 2], weights=power[peak - 1 : peak + 2]) for peak in peaks if peak
    ]
    return np.array(centres) / (len(table) * step_s)


def _harmonic(frequency: float, lines: np.ndarray, bin_hz: float) -> bool:
    """Return whether a frequency [Hz] is one of these lines or a multiple of one, as a law that is not linear makes them."""
    order = np.maximum(np.rint(frequency / lines), 1.0)
    return bool(np.any(np.abs(frequency - order * lines) < (2 + 0.1 * order) * bin_hz))


def _power(series: np.ndarray) -> np.ndarray:
    """Return the power of a series, (samples, ...), in each bin of its spectrum, a window being used."""
    window = np.hanning(len(series)).reshape(-1, *[1] * (series.ndim - 1))
    return np.asarray(np.abs(np.fft.rfft(series * window, axis=0)) ** 2)


def _beside(power: np.ndarray) -> np.ndarray:
    """Return the median of a spectrum (bins, channels) beside each bin."""
    return np.asarray(median_filter(power, size=(2 * SETTINGS.checks.beside + 1, 1), mode="reflect"))


def tones(series: np.ndarray, step_s: float) -> Sequence[float]:
    """Return the frequencies [Hz] of lines that stand out of two channels at least, or of the only one.

    Args:
        series: Whitened innovations (samples, channels).
        step_s: Sampling step [s].
    """
    samples, channels = series.shape
    if samples < 4 * SETTINGS.checks.beside:
        return []
    power = _power(series)
    # Whitened noise has unit variance, and a Hann window keeps three eighths of it.
    quiet = SETTINGS.checks.tone_quiet * 0.375 * samples
    out = power > SETTINGS.checks.tone * np.maximum(_beside(power), quiet)
    out[:3] = False
    # A window spreads a line over its neighbours.
    near = binary_dilation(out, np.ones((3, 1), bool))
    several = near.sum(axis=1) >= min(2, channels)
    total = power.sum(axis=1)
    peaks = [line.start + int(total[line].argmax()) for (line,) in find_objects(label(several)[0])]
    return [float(peak / (samples * step_s)) for peak in peaks]
