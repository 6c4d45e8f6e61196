"""Two-column text: time and acceleration, the units named in the header or by the caller."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from pounding.experiments.csv_table import is_finite, is_number, shown, split
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record
from pounding.experiments.records.units import to_metric
from pounding.experiments.text_file import is_ended
from pounding.units import ACCELERATION, TIME, named

UNIFORMITY = 1e-3
"""Largest departure of a sample's time from a uniform grid, as a fraction of the step."""

_HEADER = re.compile(r"^\s*(?P<quantity>[a-z]+)[\s_]*[\[(]?\s*(?P<unit>.*?)\s*[\])]?\s*$", re.IGNORECASE)
_OTHER_QUANTITY = re.compile(r"disp|vel|pos|force|strain|stress|press|jerk|drift|angle|temp", re.IGNORECASE)
"""What the name of a column that is no acceleration begins with, in any of its words."""


def read_columns(path: Path, text: str, unit: str | None = None) -> Record:
    """Read a CSV of time and acceleration.

    The header names the columns and their units: `time_s,acceleration_m_s2`, `time_s,acceleration_g`,
    `time (s), acc (gal)`. Without a header, or without a unit in it, `unit` has to say it; what both say
    has to be the same. Commas,
    semicolons, tabs and blanks separate; lines that begin with `#` are left out. Time may start anywhere.

    Args:
        path: The file, for messages and the record's name.
        text: Its text.
        unit: Unit of acceleration, if the header does not say it.

    A file whose last line has no end may have been cut there; the record's history says so.

    Raises:
        ExperimentError: A line that is not two numbers, a third column, a column of another quantity, no or an
            unknown unit, another one than the header's, or time that is not uniform.
    """
    cells = split(text, str(path), ExperimentError, separator=_separator(text), comment="#")
    rows = list(zip(cells.lines, map(_without_empty_end, cells.rows), strict=True))
    if not rows:
        raise ExperimentError(
            f"{path}: no data in this file; it needs a line of time and acceleration a sample"
        )
    time_factor, asked = 1.0, unit
    if not is_number(rows[0][1][0]):
        number, header = rows.pop(0)
        time_factor, said = _header(path, number, header)
        unit = _agreed(f"{path}, line {number}", unit, said)
    if not unit:
        raise ExperimentError(
            f"{path}: no unit of acceleration; give it with --record-unit g or --record-unit m/s2, or make"
            " 'time_s,acceleration_g' or 'time_s,acceleration_m_s2' its first line"
        )
    factor = to_metric(unit, str(path), "" if asked else "; if the first line names none, give --record-unit")
    values = np.array([_pair(path, number, cells) for number, cells in rows]).reshape(-1, 2)
    step = uniform_step(values[:, 0] * time_factor, str(path), [number for number, _ in rows])
    history = [f"read in {unit}"]
    if not is_ended(text):
        history.append("the last line of the file has no end, so its number may be cut")
    return Record(path.stem, values[:, 1] * factor, step, source=str(path), history=tuple(history))


def _agreed(where: str, given: str | None, said: str | None) -> str | None:
    """Return the unit of acceleration that a header says, or the one given where it says none.

    Args:
        where: File and line for the message.
        given: As the caller names it.
        said: What stands in the header where a unit may stand; another word of the column's name, often.

    Raises:
        ExperimentError: Both are units, and not the same.
    """
    if given and said and named(said) in ACCELERATION and named(given) != named(said):
        raise ExperimentError(
            f"{where}: the acceleration is in {shown(said)}, and the unit given beside the file is {shown(given)}; leave the"
            " latter out, or correct the line"
        )
    return given or said


def uniform_step(time_s: np.ndarray, where: str, lines: list[int] | None = None) -> float:
    """Return the step of a uniform time column [s].

    Args:
        time_s: Times (m,) [s].
        where: File for the message.
        lines: Line of each sample in the file, for the message.

    Raises:
        ExperimentError: Fewer than two samples, time that stands still or runs back, or uneven steps; the
            message names the first line that is out.
    """
    if len(time_s) < 2:
        raise ExperimentError(f"{where}: {len(time_s)} sample(s); a motion needs at least two")
    if not np.isfinite(time_s).all():
        raise ExperimentError(f"{where}: the time column has a value that is not a number; repair the file")
    stands = np.flatnonzero(time_s[1:] <= time_s[:-1])
    if stands.size:
        index = int(stands[0]) + 1
        how = "the same time as" if time_s[index] == time_s[index - 1] else "an earlier time than"
        raise ExperimentError(
            f"{where}: time does not go on: {_place(index, lines)} has {how} the one before it"
            f" ({time_s[index]:.9g} s); remove rows that are doubled, and sort the others by time"
        )
    step = float((time_s[-1] - time_s[0]) / (len(time_s) - 1))
    off = np.abs(time_s - (time_s[0] + step * np.arange(len(time_s))))
    # Times are often printed with few digits: what rounding of the last digit can do is no jitter.
    allowed = max(UNIFORMITY * abs(step), _rounding(time_s))
    if off.max() > allowed:
        steps = np.diff(time_s)
        index = int(np.argmax(np.abs(steps - np.median(steps)))) + 1
        raise ExperimentError(
            f"{where}: time is not uniform: {_place(index, lines)} comes {time_s[index] - time_s[index - 1]:.6g} s after the"
            f" one before it, where most steps are {np.median(steps):.6g} s; resample the motion first"
        )
    # A mean step such as 0.01999999999 is 0.02 printed: keep the number that was meant.
    return float(f"{step:.9g}")


def _place(index: int, lines: list[int] | None) -> str:
    return f"line {lines[index]}" if lines else f"sample {index + 1}"


def _rounding(time_s: np.ndarray) -> float:
    """Return by how much printed digits may move a time: three quarters of the last decimal in use [s]."""
    for digits in range(1, 7):
        if np.abs(time_s - np.round(time_s, digits)).max() < 1e-9:
            last = 10.0**-digits
            return 0.75 * last if np.diff(time_s).min() > 2.5 * last else 0.0
    return 0.0


def _separator(text: str) -> str | None:
    """Return what separates the cells of the second line that holds data; None for blanks."""
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    return (
        next((mark for mark in (";", "\t", ",") if mark in lines[min(1, len(lines) - 1)]), None)
        if lines
        else None
    )


def _header(path: Path, number: int, cells: list[str]) -> tuple[float, str | None]:
    """Return the factor from the time column to seconds and the unit of acceleration, if it is named."""
    if len(cells) != 2:
        names = shown(", ".join(cells))
        raise ExperimentError(
            f"{path}, line {number}: the columns are {names}; a record has two, time and acceleration, so keep these"
        )
    units = [match["unit"] if (match := _HEADER.match(cell)) else "" for cell in cells[:2]]
    if "time" not in cells[0].lower() and cells[0].strip().lower() not in ("t", "t_s", "t (s)"):
        raise ExperimentError(
            f"{path}, line {number}: the first column is {shown(cells[0])}, not time; call it time_s"
        )
    if any(_OTHER_QUANTITY.match(word) for word in re.split(r"[\W_]+", cells[1])):
        raise ExperimentError(
            f"{path}, line {number}: the second column is {shown(cells[1])}, not acceleration; take the column of"
            " acceleration, or correct its name"
        )
    time = named(units[0] or "s")
    if time not in TIME:
        raise ExperimentError(f"{path}, line {number}: time in {shown(units[0])}; use seconds (time_s)")
    return TIME[time], units[1] or None


def _pair(path: Path, number: int, cells: list[str]) -> tuple[float, float]:
    said = f"{path}, line {number}: {shown(','.join(cells))}"
    if len(cells) > 2:
        raise ExperimentError(f"{said} has {len(cells)} cells; keep the two columns time and acceleration")
    if any("," in cell for cell in cells):
        where = f"{path}, line {number}: {shown(';'.join(cells))}"
        raise ExperimentError(f"{where} has decimal commas; write numbers with points, such as 0.005")
    if len(cells) < 2 or not all(map(is_number, cells)):
        raise ExperimentError(f"{said} is not a time and an acceleration; write two numbers")
    if not all(map(is_finite, cells)):
        raise ExperimentError(f"{said} is not finite; repair the record")
    return float(cells[0]), float(cells[1])


def _without_empty_end(cells: list[str]) -> list[str]:
    """Return a row without the empty cells that commas at the end of a line make."""
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells
