"""Sensor faults that are told from the data before any effect is looked for: clipped, dead, swapped channels.

A channel of the wrong gain, polarity or time is an effect of the catalogue and is left to the search.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.observations import Observations, RunData, root_mean_square
from pounding.diagnosis.settings import SETTINGS


def screened(observed: Observations) -> Observations:
    """Return the observations without samples that a sensor did not measure, and with a warning for each fault.

    Raises:
        CaseError: No run is left in which the table moves and something else is measured.
    """
    runs = []
    for recorded in observed.runs:
        run = _ended(recorded)
        if run is not recorded:
            observed.warnings.append(
                f"{run.name}: every channel repeats one value after {run.time_s[-1]:g} s "
                f"({len(recorded.time_s) - len(run.time_s)} samples); left out"
            )
        measured = run.measured.copy()
        for channel, name in enumerate(observed.names):
            series = measured[:, channel]
            for fault, bad in (("dead", _dead(series, run.step_s)), ("clipped", _clipped(series))):
                if bad.any():
                    series[bad] = np.nan
                    observed.warnings.append(_sentence(observed, run, channel, name, fault, bad))
        runs.append(replace(run, measured=measured))
    if not any(_shaken(run) for run in runs):
        still = [_still(run) for run in runs if _moved(run)] or [
            f"{', '.join(run.name for run in runs)}: nothing moves in any run; check that the files hold the measurements"
        ]
        raise CaseError(still[0])
    return replace(observed, runs=tuple(runs))


def usable(observed: Observations, runs: Sequence[int]) -> list[int]:
    """Return the runs in which the table moves and something is measured; the others get a warning."""
    found = [number for number in runs if _shaken(observed.runs[number])]
    for number in set(runs) - set(found):
        run = observed.runs[number]
        said = _still(run) if _moved(run) else f"{run.name}: nothing moves in this run"
        observed.warnings.append(f"{said}; it was left out")
    return found


def _ended(run: RunData) -> RunData:
    """Return a run without an end at which nothing is recorded any more: every channel repeats its last value."""
    series = np.column_stack([run.table, run.measured])
    same = np.all((series == series[-1]) | (np.isnan(series) & np.isnan(series[-1])), axis=1)
    kept = len(same) - int(np.argmin(same[::-1]))
    if same.all() or (len(same) - kept) * run.step_s < SETTINGS.screening.dead_s:
        return run
    parts = {name: getattr(run, name)[:kept] for name in ("time_s", "table", "measured", "contact")}
    return replace(run, **parts)


def _shaken(run: RunData) -> bool:
    return float(np.ptp(run.table)) > 0 and _moved(run)


def _moved(run: RunData) -> bool:
    return bool(np.any(root_mean_square(run.measured) > 0))


def _still(run: RunData) -> str:
    """Return what is wrong with a run in which something is measured and the table reads one value."""
    return (
        f"{run.name}: the table's channel reads {run.table[0]:g} m/s^2 throughout while floors move: its sensor is dead, "
        "or the table was at rest; give its motion by another channel, or a run in which it shakes"
    )


def _sentence(
    observed: Observations, run: RunData, channel: int, name: str, fault: str, bad: np.ndarray
) -> str:
    place = f"{run.name}: channel {name}"
    if fault == "dead":
        first, last = run.time_s[np.flatnonzero(bad)[[0, -1]]]
        return f"{place} repeats one value between {first:g} and {last:g} s ({bad.sum()} samples); left out"
    largest = float(np.nanmax(np.abs(run.measured[:, channel]))) / float(observed.to_si[channel])
    return f"{place} is clipped at {largest:g} in its own unit ({bad.sum()} samples); those were left out"


def _dead(series: np.ndarray, step_s: float) -> np.ndarray:
    """Return where a channel repeats a value for long, but at the ends of a run, where the frame may be at rest."""
    bad = np.zeros(len(series), bool)
    good = np.isfinite(series)
    if not good.any() or np.nanmax(np.abs(series)) == 0:
        return np.asarray(good)
    least = max(SETTINGS.screening.dead_samples, int(SETTINGS.screening.dead_s / step_s))
    edges = np.flatnonzero(np.diff(series) != 0) + 1
    for start, stop in zip(np.r_[0, edges], np.r_[edges, len(series)], strict=True):
        if stop - start >= least and start > 0 and stop < len(series) and np.isfinite(series[start]):
            bad[start:stop] = True
    return bad


def _clipped(series: np.ndarray) -> np.ndarray:
    """Return where a channel sits at its largest or smallest value, if it does so too often to be chance."""
    least = SETTINGS.screening.clipped_samples
    return np.asarray(at_its_top(series, least) | at_its_top(-series, least))


def at_its_top(series: np.ndarray, least: int) -> np.ndarray:
    """Return where a series sits at its largest value, shape (samples,), if it does so too often to be chance.

    Args:
        series: Readings, NaN where there is none, shape (samples,).
        least: Number of samples at the largest value below which it may be chance.
    """
    ours, nowhere = SETTINGS.screening, np.zeros(len(series), bool)
    if not np.isfinite(series).any():
        return nowhere
    top = np.nanmax(series)
    at, near = series == top, series >= ours.clipped_from * top
    often = at.sum() >= least and at.sum() > ours.clipped_share * near.sum()
    return np.asarray(at) if top > 0 and often else nowhere
