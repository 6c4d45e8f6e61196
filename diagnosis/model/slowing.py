"""Runs low-passed without delay and sampled less often: all channels and forces alike, which linear frames do not notice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.signal import fftconvolve, firwin, resample_poly

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.model.free_memory import keep_no_holes
from pounding.diagnosis.model.observations import Observations, RunData
from pounding.diagnosis.model.shifting import shift
from pounding.diagnosis.model.storeys import Structure, solve_modes
from pounding.diagnosis.model.table_motion import HELD, SMOOTH
from pounding.diagnosis.settings import SETTINGS


def slowed(observed: Observations, rate_hz: float) -> Observations:
    """Return the observations low-passed without delay and sampled at a rate or a little more.

    Args:
        observed: What was measured.
        rate_hz: Least sampling rate [Hz].
    """
    slower = min(_every(run, rate_hz) for run in observed.runs)
    runs = tuple(_slowed(run, _every(run, rate_hz)) for run in observed.runs)
    return replace(observed, runs=runs, slower=slower)


def slowed_if_long(observed: Observations, structure: Structure) -> Observations:
    """Return long runs of frames that stand alone at the rate that their modes need, with a warning; others as they are.

    Args:
        observed: What was measured.
        structure: The frames.
    """
    ours = SETTINGS.screening
    size = sum(run.measured.size for run in observed.runs)
    rate_hz = max(ours.long_rate_hz, ours.long_rate_modes * _highest_hz(structure))
    if size <= ours.long_samples or max(_every(run, rate_hz) for run in observed.runs) < 2:
        return observed
    keep_no_holes()
    slow = slowed(observed, rate_hz)
    fewest = min(1.0 / run.step_s for run in slow.runs)
    observed.warnings.append(
        f"the runs hold {size:.2g} samples, more than the diagnosis looks at: they were low-passed and sampled at "
        f"{fewest:.4g} Hz or more, which keeps every mode of the frame; misfit and noise are those below half that rate"
    )
    return slow


def samples_looked_at(case: Case) -> int:
    """Return about how many samples of all runs of a case the diagnosis looks at."""
    ours = SETTINGS.screening
    rate_hz = SETTINGS.forces.rate_hz if case.contacts else ours.long_rate_hz
    if not case.contacts and sum(run.values.size for run in case.runs) <= ours.long_samples:
        rate_hz = np.inf
    return sum(int(len(run.time_s) * min(1.0, rate_hz * run.step_s)) for run in case.runs)


def _highest_hz(structure: Structure) -> float:
    """Return the highest natural frequency of all frames [Hz]."""
    return max(float(solve_modes(frame.mass, frame.stiffness)[0].max()) for frame in structure.frames) / (
        2 * np.pi
    )


def _every(run: RunData, rate_hz: float) -> int:
    return max(1, int(1.0 / (run.step_s * rate_hz) + 1e-6))


def _slowed(run: RunData, every: int) -> RunData:
    if every < 2:
        return run

    def fewer(series: np.ndarray) -> np.ndarray:
        good = np.isfinite(series)
        if not good.any():
            return series[::every]
        index = np.arange(len(series))
        filled = np.interp(index, index[good], series[good])
        slow = resample_poly(filled, 1, every, padtype="line")
        # What leans on a missing sample is missing too.
        missing = np.convolve(~good, np.ones(2 * every + 1), "same")[::every] > 0
        return np.where(missing[: len(slow)], np.nan, slow)

    def columns(values: np.ndarray) -> np.ndarray:
        slow = [fewer(column) for column in values.T]
        return np.ascontiguousarray(np.stack(slow, axis=1)) if slow else values[::every]

    # The filter of `resample_poly` without leaving samples out.
    taps = firwin(20 * every + 1, 1.0 / every, window=("kaiser", 5.0))
    smooth = [fftconvolve(force, taps, "same") for force in run.contact.T]
    return replace(
        run,
        fine_contact=np.stack(smooth, axis=1) if smooth else None,
        fine_step_s=run.step_s,
        step_s=run.step_s * every,
        time_s=run.time_s[::every],
        table=fewer(_smooth(run)),
        table_between=SMOOTH,
        measured=columns(run.measured),
        contact=columns(run.contact),
    )


def _smooth(run: RunData) -> np.ndarray:
    """Return the table's acceleration as samples of a smooth curve: held samples act half a step later."""
    return shift(run.table, run.step_s, -0.5 * run.step_s) if run.table_between == HELD else run.table
