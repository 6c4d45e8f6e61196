"""The CSV file of a run: read with a sentence for everything that can be wrong with it, and written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from pounding import bounds
from pounding.diagnosis.case.case import Channel, Run
from pounding.diagnosis.case.time_stamps import TIME, Grid, grid
from pounding.diagnosis.errors import CaseError
from pounding.experiments import csv_table
from pounding.experiments.measurements.quantities import BOUNDS
from pounding.experiments.text_file import is_ended, read_text
from pounding.frames.files import replacing
from pounding.spelling import did_you_mean, nearest

MIN_SAMPLES = 32
"""The filters that divide a misfit into bands need some twenty."""


def read_run(path: Path, channels: Sequence[Channel], *, role: str | None = None) -> tuple[Run, list[str]]:
    """Read one run.

    Args:
        path: The CSV file.
        channels: The channels of the case, in its order.
        role: The run's role, kept as it is.

    Returns:
        The run in SI and a sentence for each thing that is odd but can be read.

    Raises:
        CaseError: The file cannot be read.
    """
    header, cells, ended = cells_of(path)
    _check_header(path, header)
    found, values = _values(path, header, cells, channels)
    warnings = [_oddity(path, channel, values[:, i]) for i, channel in enumerate(channels)]
    warnings.append(_dropouts(path, channels, values))
    unused = [name for name in header[1:] if name not in {channel.name for channel in channels}]
    if unused:
        names = ", ".join(repr(name) for name in unused)
        several = ("s", "are") if len(unused) > 1 else ("", "is")
        no = "no [[channel]] of the case and not used"
        warnings.append(f"{path.name}: column{several[0]} {names} {several[1]} {no}")
    if not np.nan_to_num(values).any():
        warnings = [f"{path.name}: every channel is zero throughout; the run says nothing"]
    last, above = cells.rows[-1][-1], cells.rows[-2][-1]
    if not ended and len(last) < len(above):
        said = f"the last line has no end, and its last number, {last!r}, may be cut"
        warnings.append(f"{path.name}: {said}; get the file again if it is")
    lost = found.samples - len(values)
    if lost:
        several = ("s are", "their times") if lost > 1 else (" is", "its time")
        said = f"missing, as the times say; dropouts stand at {several[1]}"
        warnings.append(f"{path.name}: {lost} of {found.samples} row{several[0]} {said}")
    run = Run(path.name, role, found.times_s(), found.step_s, found.spread(values))
    return run, [warning for warning in warnings if warning]


def faults_of_run(path: Path, names: Sequence[str], channels: Sequence[Channel]) -> list[str]:
    """Return a sentence for each thing that keeps a run from being read; of a column the first fault only.

    Args:
        path: The CSV file.
        names: Names of the columns that it must have.
        channels: Channels whose quantity and unit are known, so that their values can be judged.
    """
    try:
        header, cells, _ = cells_of(path)
        _check_header(path, header)
    except CaseError as error:
        return [str(error)]
    tries: list[Callable[[], object]] = [partial(_column, path, header, name, names) for name in names]
    if len(header) < 2 or any(len(row) != len(header) for row in cells.rows):
        tries.append(partial(_values, path, header, cells, ()))
    else:
        tries += [_alone(path, header, cells, channels, index) for index in range(1, len(header))]
    found: dict[str, None] = {}
    for attempt in tries:
        try:
            attempt()
        except CaseError as error:
            found.setdefault(str(error))
    return list(found)


def _alone(
    path: Path, header: list[str], cells: csv_table.Cells, channels: Sequence[Channel], index: int
) -> Callable[[], object]:
    """Return the reading of one column beside the time, so that its fault hides none of another column."""
    part = csv_table.Cells(cells.lines, [[row[0], row[index]] for row in cells.rows])
    of_it = [channel for channel in channels if channel.name == header[index]]
    return partial(_values, path, [header[0], header[index]], part, of_it)


def _values(
    path: Path, header: list[str], cells: csv_table.Cells, channels: Sequence[Channel]
) -> tuple[Grid, np.ndarray]:
    """Return the grid of times and the channels' values in SI, shape (rows, channels)."""
    if len(cells.rows) < MIN_SAMPLES:
        raise CaseError(f"{path.name} has {len(cells.rows)} samples; a run needs at least {MIN_SAMPLES}")
    numbers = csv_table.numbers(header, cells, path.name, CaseError, column="channel")
    found = grid(path.name, cells.lines, numbers[:, 0], [row[0] for row in cells.rows])
    bounds.STEP.check(found.step_s, f"{path.name}: the step of {TIME}", CaseError)
    bounds.DURATION.check(found.step_s * (found.samples - 1), f"{path.name}: the run's length", CaseError)
    names = [channel.name for channel in channels]
    columns = [_column(path, header, name, names) for name in names]
    values = numbers[:, columns] * np.array([channel.to_si for channel in channels])
    _check_values(path, cells.lines, channels, values)
    return found, values


def cells_of(path: Path) -> tuple[list[str], csv_table.Cells, bool]:
    """Return the header, the rows below it, and whether the last of them has an end.

    Args:
        path: The CSV file.

    Raises:
        CaseError: It cannot be read, or its columns are not separated by commas.
    """
    if path.exists() and not path.is_file():
        raise CaseError(f"{path} is not a file; correct `file` of the [[run]]")
    try:
        text = read_text(path, path.name, CaseError)
    except FileNotFoundError:
        raise CaseError(f"{path} is not there; correct `file` of the [[run]] or add the file") from None
    except OSError as error:
        raise CaseError(f"{path} cannot be read ({error.strerror}); make it a readable CSV file") from None
    except ValueError:  # a zero byte in the name
        raise CaseError(f"{path} is not a text file; export the run as CSV in UTF-8") from None
    bounds.SAMPLES.check(text.count("\n"), f"{path.name}: the number of lines", CaseError)
    cells = csv_table.split(text, path.name, CaseError)
    if not cells.rows:
        raise CaseError(f"{path.name} is empty; it needs a header row and one row a sample")
    if len(cells.rows[0]) == 1 and any(mark in cells.rows[0][0] for mark in ";\t"):
        what = "the columns are not separated by commas; export with commas between columns, and with points in numbers"
        raise CaseError(f"{path.name} line 1: {what}")
    return cells.rows[0], csv_table.Cells(cells.lines[1:], cells.rows[1:]), is_ended(text)


def _check_header(path: Path, header: list[str]) -> None:
    if header[0] != TIME:
        first = csv_table.shown(header[0])
        raise CaseError(f"{path.name} line 1: the first column is {first}; it must be {TIME!r} [s]")
    for index, name in enumerate(header):
        if name in header[:index]:
            raise CaseError(f"{path.name} line 1: column {name!r} stands there twice; rename or remove one")


def _check_values(path: Path, lines: list[int], channels: Sequence[Channel], values: np.ndarray) -> None:
    """Refuse what no sensor can read."""
    for channel, series in zip(channels, values.T, strict=True):
        bound = BOUNDS[channel.quantity]
        row = bound.beyond(series)
        if row is not None:
            where = f"{path.name} line {lines[row]}, channel {channel.name!r}: the cell"
            bound.check(series[row] / channel.to_si, where, CaseError, per=channel.to_si, unit=channel.unit)


def _column(path: Path, header: list[str], name: str, names: Sequence[str]) -> int:
    """Return the number of a channel's column; where it is not there, one that is no other channel's may have been meant."""
    if name in header[1:]:
        return header.index(name)
    question = did_you_mean(nearest(name, [one for one in header[1:] if one not in names]), repr)
    hint = f"{question} " if question else ""
    raise CaseError(
        f"{path.name} line 1: no column for channel {name!r}; {hint}add the column (with empty cells "
        "if it was not recorded in this run) or remove the [[channel]]"
    )


def _oddity(path: Path, channel: Channel, values: np.ndarray) -> str:
    here = f"{path.name}, channel {channel.name!r}"
    seen = values[~np.isnan(values)]
    if not seen.size:
        return f"{here}: no sample was recorded"
    if not seen.any() and channel.quantity == "contact_force":
        return f"{here}: reads 0 throughout; the contact never closed, or the sensor is dead"
    if np.ptp(seen) == 0:
        return f"{here}: reads {seen[0] / channel.to_si:g} {channel.unit} throughout; the sensor may be dead"
    return ""


def _dropouts(path: Path, channels: Sequence[Channel], values: np.ndarray) -> str:
    """Return one sentence on all samples of a run that dropped out, whatever the number of channels."""
    lost = np.isnan(values).sum(axis=0)
    counts = {
        channel.name: count for channel, count in zip(channels, lost, strict=True) if 0 < count < len(values)
    }
    each = ", ".join(f"{count} of {name!r}" for name, count in counts.items())
    return f"{path.name}: of each channel's {len(values)} samples these dropped out: {each}" if counts else ""


def write_run(path: Path, run: Run, channels: Sequence[Channel]) -> None:
    """Write one run in the channels' own units, dropouts as empty cells; the whole file or nothing.

    Args:
        path: The CSV file.
        run: The run, in SI.
        channels: Channels in the order of the run's columns.
    """
    values = run.values / np.array([channel.to_si for channel in channels])
    row = ",".join(["%.7g"] * len(channels))
    with replacing(path) as part, part.open("w", encoding="utf-8") as file:
        file.write(",".join([TIME, *(channel.name for channel in channels)]) + "\n")
        for time, sample in zip(run.time_s.tolist(), values.tolist(), strict=True):
            cells = row % tuple(sample)
            file.write(f"{time:.9g},{cells.replace('nan', '')}\n")
