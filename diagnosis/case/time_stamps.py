"""The time stamps of a run as a uniform grid: loggers round them, their clocks jitter a little, and rows get lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.errors import CaseError

TIME = "time_s"
JITTER = 0.1
"""[samples] A stamp may be so far from the grid beyond its rounding: what a logger's clock jitters."""
LONGEST_GAP_S = 0.02
"""[s] Rows that are missing for longer are no dropout: in 0.02 s the table is filled in to 5 % of its motion, in 0.05 s to
20 to 50 % (`tests/diagnosis/model/test_dropouts.py`)."""
SHORTEST_GAP = 3
"""[samples] So many rows in a row may be missing in any case."""
MOST_MISSING = 0.2
"""[share of the rows] With more missing the stamps say another rate rather than lost rows."""


@dataclass(frozen=True)
class Grid:
    """Uniform times through the stamps of a file.

    Attributes:
        start_s: First time [s].
        step_s: Step [s].
        places: Number of each of the file's rows on the grid, rising from 0, shape (rows,).
    """

    start_s: float
    step_s: float
    places: np.ndarray

    @property
    def samples(self) -> int:
        """Samples of the grid, with those whose rows are missing."""
        return int(self.places[-1]) + 1

    def times_s(self) -> np.ndarray:
        """Return the times of all samples [s], shape (samples,)."""
        return self.start_s + self.step_s * np.arange(self.samples)

    def spread(self, values: np.ndarray) -> np.ndarray:
        """Return rows of a file, shape (rows, columns), on the grid, NaN where a row is missing: (samples, columns)."""
        if self.samples == len(values):
            return values
        spread = np.full((self.samples, values.shape[1]), np.nan)
        spread[self.places] = values
        return spread


REPEATED = 0.1
"""Share of rows with the stamp of the row before from which on stamps lack digits; fewer are rows that stand twice."""


def grid(name: str, lines: list[int], time: np.ndarray, words: list[str]) -> Grid:
    """Return the grid on which the stamps of a file lie, up to their rounding and a clock's jitter.

    Args:
        name: The file, for messages.
        lines: Line of each row.
        time: Stamps as numbers [s], NaN where a cell is empty, shape (rows,).
        words: Stamps as they are written.

    Raises:
        CaseError: A stamp is missing, time does not go on, steps are not uniform, or rows are missing for long.
    """
    missing = np.flatnonzero(np.isnan(time))
    if missing.size:
        raise CaseError(f"{name} line {lines[missing[0]]}: {TIME} is empty; every row needs its time")
    backwards = np.flatnonzero(np.diff(time) <= 0)
    if backwards.size:
        line = lines[backwards[0] + 1]
        if np.mean(np.diff(time) == 0) > REPEATED:
            raise CaseError(
                f"{name} line {line}: {TIME} {time[backwards[0] + 1]:g} s stands in more than one row; write it with as "
                "many digits as the sampling rate needs"
            )
        raise CaseError(
            f"{name} line {line}: time does not go on ({time[backwards[0] + 1]:g} s); sort or mend it"
        )
    found = _fitted(time)
    _check_uniform(name, lines, time, found, rounding(time, words))
    _check_gaps(name, lines, found)
    return found


def _fitted(time: np.ndarray) -> Grid:
    """Return the grid that fits all stamps best, each at its nearest place."""
    intervals = np.diff(time)
    # Rounded to few digits, single intervals say little, but their mean does; those over lost rows are left out.
    step = float(intervals[intervals < 1.5 * np.median(intervals)].mean())
    places = np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(intervals / step), 1.0))])
    for _ in range(8):
        centre, about = places.mean(), time.mean()
        step = float((places - centre) @ (time - about) / ((places - centre) @ (places - centre)))
        start = float(about - step * centre)
        nearest = np.rint((time - start) / step)
        nearest -= nearest[0]
        if np.array_equal(nearest, places):
            break
        places = nearest
    # To a nanosecond, or a start at 0 is one at -7e-16.
    return Grid(round(start, 9) + 0.0, step, places.astype(int))


def rounding(time: np.ndarray, words: list[str]) -> np.ndarray:
    """Return the last printed digit of each stamp [s], shape (rows,).

    A number of significant digits leaves the fewer decimals the larger the stamp, and zeros at the end may be left out:
    a stamp has as many decimals as any stamp of its power of ten or of a higher one.

    Args:
        time: Stamps as numbers [s], shape (rows,).
        words: Stamps as they are written.
    """
    decimals = np.array([_decimals(word) for word in words])
    power = np.floor(np.log10(np.maximum(np.abs(time), 1e-9)))
    seen = np.full(len(time), 0.0)
    for one in np.unique(power):
        seen[power == one] = decimals[power >= one].max()
    return np.asarray(10.0**-seen)


def _decimals(word: str) -> int:
    mantissa, _, exponent = word.strip().lower().partition("e")
    return len(mantissa.partition(".")[2]) - int(exponent or 0)


def _check_uniform(name: str, lines: list[int], time: np.ndarray, found: Grid, digit: np.ndarray) -> None:
    """Refuse stamps that are further from the grid than rounding and jitter take them."""
    step = found.step_s
    off = np.abs(time - found.start_s - step * found.places)
    allowed = 0.505 * digit + JITTER * step
    collide = np.diff(found.places) < 1
    lost = int(found.samples - len(time))
    if np.all(off <= allowed) and not collide.any() and lost <= MOST_MISSING * found.samples:
        return
    intervals = np.diff(time)
    typical = float(np.median(intervals))
    odd = np.abs(intervals - typical) > digit[1:] + JITTER * typical
    if odd.any():
        first = int(np.argmax(odd))
        raise CaseError(
            f"{name} line {lines[first + 1]}: time steps by {intervals[first]:.6g} s where others step "
            f"by {typical:.6g} s; resample to uniform time, or fill lost samples with rows of empty cells"
        )
    worst = int(np.argmax(off - allowed))
    raise CaseError(
        f"{name} line {lines[worst]}: time is {off[worst]:.3g} s from uniform steps of {step:.6g} s; "
        "resample to uniform time"
    )


def _check_gaps(name: str, lines: list[int], found: Grid) -> None:
    """Refuse rows that are missing for long."""
    lost = np.diff(found.places) - 1
    longest = int(np.argmax(lost))
    if lost[longest] <= max(SHORTEST_GAP, LONGEST_GAP_S / found.step_s):
        return
    raise CaseError(
        f"{name} line {lines[longest + 1]}: {lost[longest]} rows are missing before it "
        f"({lost[longest] * found.step_s:.3g} s), and what shook the frame then is not known; "
        "keep the part before or after as the run, if the frame is at rest where it begins"
    )
