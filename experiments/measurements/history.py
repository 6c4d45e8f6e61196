"""A user's own measured history, read from CSV so that it can be laid over a run.

The file has a header, a first column ``time_s`` and a column a channel. What a column is follows from
``[[channel]]`` entries (name, quantity, frame, floor, unit) in a file ``case.toml`` beside it, or else from
its name: ``15B_relative_displacement_floor10_mm``, ``table_acceleration_g``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate, correlation_lags

from pounding import bounds
from pounding.experiments import csv_table
from pounding.experiments.errors import ExperimentError
from pounding.experiments.measurements.quantities import BOUNDS, UNITS
from pounding.experiments.text_file import read_text
from pounding.toml_text import plainly, tree_of
from pounding.units import named

Real = NDArray[np.floating[Any]]

NAME = re.compile(
    rf"(?:(?P<frame>.+)_)?(?P<quantity>{'|'.join(UNITS)})(?:_floor(?P<floor>\d+))?_(?P<unit>\w+)"
)


@dataclass(frozen=True)
class Channel:
    """A measured history.

    Attributes:
        name: Column of the file.
        quantity: One of `UNITS`.
        frame: Frame it was measured on, or None.
        floor: Floor, or None; 0 is the table.
        time_s: Times (m,) [s].
        values: Values (m,) in SI; NaN where the cell is empty.
    """

    name: str
    quantity: str
    frame: str | None
    floor: int | None
    time_s: Real
    values: Real


def read(path: str | Path) -> list[Channel]:
    """Return the channels of a measured file.

    Raises:
        ExperimentError: The file cannot be read, a cell is not a number, or no column is a known channel; the
            sentence names file, line and column.
    """
    path = Path(path)
    header, lines, table = _table(path)
    described = _described(path.parent / "case.toml")
    found = []
    for place, column in enumerate(header[1:], start=1):
        what = described.get(column) or _by_name(column)
        if what is None:
            continue
        quantity, unit = what.quantity, what.unit
        factors = UNITS[quantity]
        if unit not in factors:
            raise ExperimentError(
                f"{path}: column {column!r}: unit {unit!r}; {quantity} takes {', '.join(factors)}"
            )
        values = table[:, place] * factors[unit]
        row = BOUNDS[quantity].beyond(values)
        if row is not None:
            BOUNDS[quantity].check(
                values[row], f"{path} line {lines[row]}, column {column!r} in SI", ExperimentError
            )
        found.append(Channel(column, quantity, what.frame, what.floor, table[:, 0], values))
    if not found:
        raise ExperimentError(
            f"{path}: none of its columns ({', '.join(header[1:]) or 'none'}) is a channel; describe them as "
            "[[channel]] in a case.toml beside it, or call them like 15B_relative_displacement_floor10_mm"
        )
    return found


def _table(path: Path) -> tuple[list[str], list[int], Real]:
    try:
        text = read_text(path, str(path), ExperimentError)
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be read ({error.strerror})") from error
    cells = csv_table.split(text, str(path), ExperimentError)
    header = cells.rows[0] if cells.rows else []
    if not header or header[0] != "time_s" or len(cells.rows) < 3:
        raise ExperimentError(
            f"{path}: needs a header whose first column is time_s, and two rows or more below"
        )
    below = csv_table.Cells(cells.lines[1:], cells.rows[1:])
    table = csv_table.numbers(header, below, str(path), ExperimentError)
    time = table[:, 0]
    for row in np.flatnonzero(~(np.abs(time) <= bounds.CLOCK.high)):
        bounds.CLOCK.check(time[row], f"{path} line {below.lines[row]}: time_s", ExperimentError)
    wrong = np.flatnonzero(np.diff(time) <= 0.0)
    if wrong.size:
        line = below.lines[wrong[0] + 1]
        raise ExperimentError(f"{path} line {line}: time_s does not increase; remove or sort the row")
    bounds.DURATION.check(time[-1] - time[0], f"{path}: the history's length", ExperimentError)
    return header, below.lines, table


class _Column(msgspec.Struct):
    """What a column of the file is."""

    name: str
    quantity: str
    unit: str
    frame: str | None = None
    floor: int | None = None


class _Named(msgspec.Struct):
    """A frame of a case."""

    name: str


class _Described(msgspec.Struct):
    """A `case.toml` as far as it describes columns."""

    frame: list[_Named] = []
    channel: list[_Column] = []

    def columns(self) -> list[_Column]:
        """Return the channels; the frame may be left out where the case has one."""
        if len(self.frame) != 1:
            return self.channel
        only = self.frame[0].name
        return [
            msgspec.structs.replace(one, frame=only) if one.floor and one.frame is None else one
            for one in self.channel
        ]


def _described(path: Path) -> dict[str, _Column]:
    if not path.is_file():
        return {}
    try:
        tree = tree_of(path.read_bytes(), str(path), ExperimentError)
    except OSError as error:
        raise ExperimentError(f"{path}: {error}") from error
    try:
        entries = msgspec.convert(tree, _Described).columns()
    except (msgspec.ValidationError, OverflowError) as error:
        raise ExperimentError(f"{path}: {plainly(error)}; correct the value") from error
    return {entry.name: entry for entry in entries if entry.quantity in UNITS}


def _by_name(column: str) -> _Column | None:
    match = NAME.fullmatch(column)
    if match is None:
        return None
    unit = named(match["unit"]) or match["unit"]
    floor = None if match["floor"] is None else int(match["floor"])
    return _Column(column, match["quantity"], unit, match["frame"], floor)


def aligned(channels: list[Channel], times_s: Real, table_m_s2: Real) -> tuple[list[Channel], float]:
    """Return channels on a run's clock, and by how much their time was shifted [s].

    With a channel of the table's acceleration the shift is where its correlation with the run's table is
    largest; without one the file's clock is taken as the run's.

    Args:
        channels: Measured channels.
        times_s: Times of the run (m,), evenly spaced [s].
        table_m_s2: The run's table acceleration (m,) [m/s^2].
    """
    table = next((channel for channel in channels if channel.quantity == "table_acceleration"), None)
    if table is None:
        return channels, 0.0
    step = float(times_s[1] - times_s[0])
    grid = np.arange(table.time_s[0], table.time_s[-1], step)
    known = np.isfinite(table.values)
    values = np.interp(grid, table.time_s[known], table.values[known])
    match = correlate(table_m_s2, values, method="fft")
    lags = correlation_lags(len(table_m_s2), len(values))
    shift = float(lags[match.argmax()] * step - grid[0] + times_s[0])
    return [replace(channel, time_s=channel.time_s + shift) for channel in channels], shift


def misfit(channel: Channel, times_s: Real, values: Real) -> dict[str, Any]:
    """Return how a computed history compares with a measured one where both are known.

    Args:
        channel: The measured history.
        times_s: Times of the run (m,) [s].
        values: Its history of the same quantity (m,) in SI [m, m/s, m/s^2 or N].

    Returns:
        ``channel``, ``quantity``, ``frame``, ``floor``, the largest magnitudes ``measured_peak`` and
        ``computed_peak`` (SI) and ``rms_error_ratio``: rms of the difference over rms of the measured.
    """
    inside = np.isfinite(channel.values) & (channel.time_s >= times_s[0]) & (channel.time_s <= times_s[-1])
    measured = channel.values[inside]
    computed = np.interp(channel.time_s[inside], times_s, values)
    size = float(np.sqrt(np.mean(measured**2))) if measured.size else 0.0
    ratio = float(np.sqrt(np.mean((computed - measured) ** 2))) / size if size > 0.0 else None
    return {
        "channel": channel.name,
        "quantity": channel.quantity,
        "frame": channel.frame,
        "floor": channel.floor,
        "measured_peak": float(np.abs(measured).max(initial=0.0)),
        "computed_peak": float(np.abs(computed).max(initial=0.0)),
        "rms_error_ratio": ratio,
    }
