"""Faults that are told from the data before any effect is looked for: of sensors, such as clipped and dead channels and hum,
and of runs, such as one that is given twice, begins in motion or is noise alone.

A channel of the wrong gain, polarity or time is an effect of the catalogue and is left to the search.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.hum import hum_of
from pounding.diagnosis.model.noise import spectral_floor
from pounding.diagnosis.model.observations import Observations, RunData, root_mean_square
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.settings import SETTINGS

FIRST_SAMPLES = 3
"""Samples at the beginning of a run by which a frame is at rest or not."""


def screened(observed: Observations) -> Observations:
    """Return the observations without samples that a sensor did not measure, and with a warning for each fault.

    Raises:
        CaseError: No run is left in which the table moves and something else is measured, or one is there twice.
    """
    runs = []
    for recorded in observed.runs:
        run = _ended(recorded)
        if run is not recorded:
            observed.warnings.append(
                f"{run.name}: every channel repeats one value after {run.time_s[-1]:g} s "
                f"({len(recorded.time_s) - len(run.time_s)} samples); left out"
            )
        run = _without_hum(run, observed)
        measured = run.measured.copy()
        for channel, name in enumerate(observed.names):
            series = measured[:, channel]
            for fault, told in (("dead", _dead), ("clipped", _clipped)):
                bad = told(series, run)
                if bad.any():
                    series[bad] = np.nan
                    observed.warnings.append(_sentence(observed, run, channel, name, fault, bad))
        runs.append(replace(run, measured=measured))
        observed.warnings.extend(_moving_from_the_start(observed, runs[-1]))
    if not any(_shaken(observed, run) for run in runs):
        still = [_still(run) for run in runs if _moved(run)] or [
            f"{', '.join(run.name for run in runs)}: nothing moves in any run, or no more than noise; check that the files "
            "hold the shaking, and which channel is which"
        ]
        raise CaseError(still[0])
    _check_each_once(observed.runs)
    return replace(observed, runs=tuple(runs))


def _check_each_once(runs: Sequence[RunData]) -> None:
    """Raise CaseError where two runs have the same samples: no two shakings do, and one would judge the fit to itself."""
    for one, other in combinations(runs, 2):
        if np.array_equal(one.table, other.table) and np.array_equal(
            one.measured, other.measured, equal_nan=True
        ):
            raise CaseError(
                f"{other.name}: has the same samples as {one.name}; leave one of the two out, or give the file of the other "
                "shaking"
            )


def usable(observed: Observations, runs: Sequence[int]) -> list[int]:
    """Return the runs in which the table moves and something is measured; the others get a warning."""
    found = [number for number in runs if _shaken(observed, observed.runs[number])]
    for number in set(runs) - set(found):
        run = observed.runs[number]
        said = _still(run) if _moved(run) else f"{run.name}: nothing moves in this run, or no more than noise"
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


def _without_hum(run: RunData, observed: Observations) -> RunData:
    """Return a run without hum of the mains, with a warning; a table that is shaken at a mains frequency is no hum."""
    of_table, lines = hum_of(run.table, run.step_s)
    if lines and of_table.std() > SETTINGS.screening.hum_of_table * run.table.std():
        observed.warnings.append(
            f"{run.name}: the table swings steadily at {lines[0]:.4g} Hz, as the mains do, and hardly otherwise; that was "
            "taken for its motion"
        )
        return run
    measured, names = run.measured.copy(), ["the table"] if lines else []
    for channel, name in enumerate(observed.names):
        series, found = hum_of(measured[:, channel], run.step_s)
        if found:
            measured[:, channel] -= series
            lines, names = [*lines, *found], [*names, name]
    if not names:
        return run
    hertz = ", ".join(f"{one:g}" for one in sorted({float(round(line)) for line in lines}))
    observed.warnings.append(f"{run.name}: hum of the mains ({hertz} Hz) in {', '.join(names)}; subtracted")
    return replace(run, table=run.table - of_table, measured=measured)


def _shaken(observed: Observations, run: RunData) -> bool:
    return float(np.ptp(run.table)) > 0 and _moved(run) and not _still_beside_floors(observed, run)


def _still_beside_floors(observed: Observations, run: RunData) -> bool:
    """Return whether a table reads next to nothing while floors move."""
    floors = observed.rms(run)[observed.quantity == ACCELERATION]
    known = floors[np.isfinite(floors)]
    table = float(np.std(run.table))
    return len(known) > 0 and table < SETTINGS.screening.still * float(known.max())


def _moved(run: RunData) -> bool:
    return bool(np.any(root_mean_square(run.measured) > 0)) and not _noise_alone(run)


def _noise_alone(run: RunData) -> bool:
    """Return whether every channel shows as much above the modes as all over: noise, and nothing that moves."""
    each = [column for column in run.measured.T if np.isfinite(column).any() and np.nanstd(column) > 0]
    both = ((spectral_floor(column, run.step_s), float(np.nanstd(column))) for column in each)
    known = [floor / size for floor, size in both if np.isfinite(floor)]
    return bool(known) and min(known) > SETTINGS.screening.noise_alone


def _still(run: RunData) -> str:
    """Return what is wrong with a run in which something is measured and the table reads one value or next to nothing."""
    reads = f"{run.table[0]:g} m/s^2 throughout"
    if np.ptp(run.table) > 0:
        reads = f"{np.std(run.table):.2g} m/s^2 (rms)"
    return (
        f"{run.name}: the table's channel reads {reads} while floors move: its sensor is dead, or "
        "the table was at rest; give its motion by another channel, or a run in which it shakes"
    )


def _moving_from_the_start(observed: Observations, run: RunData) -> list[str]:
    """Return a sentence where most floors have an acceleration in the first samples already, as a frame at rest has not."""
    ours, moving, known = SETTINGS.screening, 0, 0
    for column in run.measured.T[observed.quantity == ACCELERATION]:
        first = column[:FIRST_SAMPLES]
        noise = spectral_floor(column, run.step_s)
        if not (np.isfinite(first).all() and np.isfinite(noise)):
            continue
        known += 1
        away, size = abs(float(first.mean()) - float(np.nanmean(column))), float(np.nanstd(column))
        moving += away > max(ours.moving * size, ours.moving_noise * noise)
    if 2 * moving <= known:
        return []
    return [
        f"{run.name}: {moving} of {known} floors are moving at the first sample already, and the model starts at rest; give "
        "the recording from before the shaking begins"
    ]


def _sentence(
    observed: Observations, run: RunData, channel: int, name: str, fault: str, bad: np.ndarray
) -> str:
    place = f"{run.name}: channel {name}"
    if fault == "dead":
        first, last = run.time_s[np.flatnonzero(bad)[[0, -1]]]
        return f"{place} repeats one value between {first:g} and {last:g} s ({bad.sum()} samples); left out"
    largest = float(np.nanmax(np.abs(run.measured[:, channel]))) / float(observed.to_si[channel])
    return f"{place} is clipped at {largest:g} in its own unit ({bad.sum()} samples); those were left out"


def _dead(series: np.ndarray, run: RunData) -> np.ndarray:
    """Return where a channel repeats a value for long; at the ends of a run only if the table moves there."""
    bad = np.zeros(len(series), bool)
    good = np.isfinite(series)
    if not good.any() or np.nanmin(series) == np.nanmax(series):
        return np.asarray(good)
    ours = SETTINGS.screening
    least = max(ours.dead_samples, int(ours.dead_s / run.step_s))
    moving = ours.woken * float(np.std(run.table))
    edges = np.flatnonzero(np.diff(series) != 0) + 1
    for start, stop in zip(np.r_[0, edges], np.r_[edges, len(series)], strict=True):
        if stop - start < least or not np.isfinite(series[start]):
            continue
        # At an end the frame may be at rest.
        if (start > 0 and stop < len(series)) or float(np.std(run.table[start:stop])) > moving:
            bad[start:stop] = True
    return bad


def _clipped(series: np.ndarray, run: RunData) -> np.ndarray:
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
