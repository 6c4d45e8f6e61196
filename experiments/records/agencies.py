"""The text formats of the agencies: PEER AT2, CSMIP and COSMOS V2, K-NET ASCII."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.csv_table import NUMBER, is_finite, shown
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record
from pounding.experiments.records.units import to_metric
from pounding.experiments.text_file import is_ended

_COUNT = r"[0-9]{1,9}"
_END = r"(?=[\s,]|$)"
"""What may come after a number of a header: without it `1_000` would be read as 1."""
_AT2 = re.compile(rf"NPTS\s*=\s*({_COUNT})\s*,\s*DT\s*=\s*({NUMBER}){_END}", re.IGNORECASE)
_AT2_OLD = re.compile(rf"^\s*({_COUNT})\s+({NUMBER})\s+NPTS\s*,\s*DT", re.IGNORECASE)
_AT2_UNIT = re.compile(r"UNITS?\s+OF\s+(\S+)", re.IGNORECASE)
_CSMIP = re.compile(
    rf"^\s*({_COUNT})\s+points of accel data equally spaced at\s+({NUMBER})\s*sec,?\s*in\s+([^\s(]+?)\.?[,.]?\s*"
    r"(?:\(units\)\s*)?\(\s*[0-9]*[fFeE]([1-9][0-9]?)\.",
    re.IGNORECASE,
)
_COSMOS = re.compile(
    rf"^\s*({_COUNT})\s+acceleration\s+pts\s*,\s*approx\s+({NUMBER})\s*secs.*?"
    r"units\s*=\s*([^\s,(]+)\s*(?:\(\s*[0-9]+\s*\))?\s*,\s*Format\s*=\s*\(\s*[0-9]*[A-Z]+([1-9][0-9]?)\.",
    re.IGNORECASE,
)
_COSMOS_REALS = re.compile(
    rf"^\s*({_COUNT})\s+Real-header values follow.*?Format\s*=\s*\(\s*[0-9]*[A-Z]+([1-9][0-9]?)\.",
    re.IGNORECASE,
)
_WORD = re.compile(r"\S+")
_KNET_LAST_DIGIT_GAL = 0.001
"""NIED prints the largest acceleration to three decimals and leaves out zeros at their end."""
_COSMOS_STEP = 61
"""Place (from zero) of the sampling interval of the data [ms] among COSMOS' real-header values."""
_KNET_HEADER = {
    "Sampling Freq(Hz)": re.compile(rf"({NUMBER})\s*Hz", re.IGNORECASE),
    "Duration Time(s)": re.compile(f"({NUMBER})"),
    "Scale Factor": re.compile(rf"({NUMBER})\s*\(gal\)\s*/\s*({NUMBER})", re.IGNORECASE),
    "Max. Acc. (gal)": re.compile(f"({NUMBER})"),
}
"""Entries of the header that a record is read and checked by; every file of K-NET and KiK-net has them."""


def read_at2(path: Path, text: str) -> Record:
    """Read a PEER NGA file (.AT2): four header lines, the last with `NPTS=` and `DT=`, samples in g.

    The older header, `4000 0.0100 NPTS, DT`, is read as well.

    Raises:
        ExperimentError: No such header, a unit other than the header's known ones, or too few samples.
    """
    lines = text.splitlines()
    found = ((n, _AT2.search(line) or _AT2_OLD.match(line)) for n, line in enumerate(lines[:8]))
    number, match = next(((n, hit) for n, hit in found if hit), (0, None))
    if match is None:
        raise ExperimentError(f"{path}: no 'NPTS= ..., DT= ...' in the first lines; not a PEER AT2 file")
    unit = _AT2_UNIT.search("\n".join(lines[:number]))
    name = unit[1] if unit else "g"
    if not name.upper().startswith("G") and name.upper() not in ("CM/S/S", "CM/S2", "M/S2"):
        raise ExperimentError(f"{path}: holds '{name}', not acceleration; take the AT2 file, not VT2 or DT2")
    samples = _numbers(path, lines, number + 1, is_ended(text))
    _check_count(path, len(samples), int(match[1]), number + 1)
    factor = STANDARD_GRAVITY if name.upper() == "G" else to_metric(name, str(path))
    return Record(
        path.stem, samples * factor, float(match[2]), source=str(path), history=(f"read in {name}",)
    )


def read_v2(path: Path, text: str) -> Record:
    """Read the first acceleration of a volume-2 file (.V2, .V2c), CSMIP's own or COSMOS V1.20.

    Samples stand in fixed columns, possibly without a blank between them, as the line before them states.

    Raises:
        ExperimentError: No acceleration in the file, an unknown unit, raw counts, or too few samples.
    """
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if match := _CSMIP.match(line):
            count, step, unit, width = int(match[1]), float(match[2]), match[3], int(match[4])
            break
        if match := _COSMOS.match(line):
            count, unit, width = int(match[1]), match[3], int(match[4])
            step = _cosmos_step(path, lines[:number])
            _check_seconds(path, count * step, float(match[2]), number + 1)
            break
    else:
        raise ExperimentError(
            f"{path}: no acceleration block of CSMIP or COSMOS V2 in this file; take a volume-2 file"
        )
    samples = _fixed(path, lines, number + 1, count, width)
    factor = to_metric(unit, f"{path}, line {number + 1}")
    return Record(path.stem, samples * factor, step, source=str(path), history=(f"read in {unit}",))


def _cosmos_step(path: Path, head: list[str]) -> float:
    for number, line in enumerate(head):
        if match := _COSMOS_REALS.match(line):
            values = _fixed(path, head, number + 1, int(match[1]), int(match[2]))
            if len(values) <= _COSMOS_STEP or values[_COSMOS_STEP] <= 0:
                raise ExperimentError(
                    f"{path}: no time step in real-header value {_COSMOS_STEP + 1}; get the file again"
                )
            return float(values[_COSMOS_STEP]) / 1000
    raise ExperimentError(f"{path}: no real-header values before the acceleration; not a whole COSMOS file")


def read_knet(path: Path, text: str) -> Record:
    """Read one component of K-NET or KiK-net in ASCII (.EW, .NS, .UD): counts after a line `Memo.`.

    Counts are multiplied by the scale factor [gal/count] and their mean is taken off, as NIED prescribes. The
    header states the duration and the largest acceleration of what is left, and the samples must agree.

    Args:
        path: The file, for messages and the record's name.
        text: Its text.

    Raises:
        ExperimentError: A header without one of the entries that are needed, samples that are no numbers, or
            samples that differ from the header in duration or largest acceleration.
    """
    lines = text.splitlines()
    start = next((n for n, line in enumerate(lines) if line.startswith("Memo")), None)
    if start is None:
        raise ExperimentError(f"{path}: not K-NET ASCII (no line 'Memo.'); get the file as NIED gives it")
    head = _knet_header(path, lines[:start])
    (rate,), (duration,) = head["Sampling Freq(Hz)"], head["Duration Time(s)"]
    gal, counts_of_it = map(float, head["Scale Factor"])
    if gal <= 0 or counts_of_it <= 0 or float(rate) <= 0:
        raise ExperimentError(
            f"{path}: scale factor {gal:g}(gal)/{counts_of_it:g} and {rate} Hz must be positive; get the file again"
        )
    counts = _numbers(path, lines, start + 1, is_ended(text))
    if not len(counts):
        raise ExperimentError(f"{path}: no samples after the line 'Memo.'; get the file again")
    samples = (counts - counts.mean()) * (gal / counts_of_it * 0.01)
    if abs(len(samples) - float(duration) * float(rate)) > 0.5:
        raise ExperimentError(
            f"{path}: the header states {duration} s, the file holds {len(samples)} samples at {rate} Hz, which are "
            f"{len(samples) / float(rate):.6g} s; lines are missing or doubled, so get the file again"
        )
    _check_peak(path, 100 * float(np.abs(samples).max()), head["Max. Acc. (gal)"][0])
    return Record(
        path.stem,
        samples,
        1 / float(rate),
        source=str(path),
        history=(f"read in counts of {gal / counts_of_it:.6g} gal", "mean removed"),
    )


def _knet_header(path: Path, lines: list[str]) -> dict[str, tuple[str, ...]]:
    """Return the numbers of the entries that a record is read by, as they are written."""
    found: dict[str, tuple[str, ...]] = {}
    for number, line in enumerate(lines, 1):
        for key, pattern in _KNET_HEADER.items():
            if line.startswith(key):
                value = line[len(key) :].strip()
                match = pattern.fullmatch(value)
                if match is None or not all(map(is_finite, match.groups())):
                    raise ExperimentError(
                        f"{path}, line {number}: {key} is {shown(value)}, no number as K-NET writes it; "
                        "get the file again"
                    )
                found[key] = match.groups()
    for key in _KNET_HEADER:
        if key not in found:
            raise ExperimentError(f"{path}: not K-NET ASCII (no '{key}'); get the file as NIED gives it")
    return found


def _check_peak(path: Path, found_gal: float, stated: str) -> None:
    """Refuse samples whose largest acceleration is not the one stated, up to its last printed digit."""
    if abs(found_gal - float(stated)) > _KNET_LAST_DIGIT_GAL:
        raise ExperimentError(
            f"{path}: the header states a largest acceleration of {stated} gal, the samples reach {found_gal:.3f} gal; "
            "samples or scale factor are not the original ones, so get the file again"
        )


def _check_seconds(path: Path, found_s: float, stated_s: float, line: int) -> None:
    """Refuse a duration that is not the one stated in whole seconds."""
    if abs(found_s - stated_s) > 1:
        raise ExperimentError(
            f"{path}, line {line}: the block states {stated_s:g} s, its samples and time step make {found_s:.6g} s; "
            "the headers are not the original ones, so get the file again"
        )


def _check_count(path: Path, found: int, stated: int, line: int) -> None:
    if found != stated:
        raise ExperimentError(
            f"{path}, line {line}: the header states {stated} samples, the file holds {found}; get the file again"
        )


def _numbers(path: Path, lines: list[str], start: int, ended: bool) -> np.ndarray:
    """Return the numbers separated by blanks in the lines from `start` on.

    A file that breaks off may end inside a number: `.24E-02` becomes `.24`. The last number is known to be
    whole if an end of line follows and, where all numbers stand in columns, if it ends in one of them.
    """
    values: list[float] = []
    ends: list[tuple[int, ...]] = []
    number = start
    for number, line in enumerate(lines[start:], start + 1):
        words = line.split()
        if not all(map(is_finite, words)):
            raise ExperimentError(
                f"{path}, line {number}: {shown(line.strip())} are no numbers; get the file again"
            )
        values.extend(map(float, words))
        if words:
            ends.append(tuple(match.end() for match in _WORD.finditer(line)))
    if ends:
        *above, last = ends
        columns = above[0] if above else ()
        in_columns = bool(above) and all(row == columns[: len(row)] for row in above)
        if last != columns[: len(last)] if in_columns else not ended:
            raise ExperimentError(
                f"{path}, line {number}: the file breaks off inside or after its last number "
                f"{shown(lines[number - 1].split()[-1])}; get the file again"
            )
    return np.array(values)


def _fixed(path: Path, lines: list[str], start: int, count: int, width: int) -> np.ndarray:
    """Return the block of `count` numbers in columns `width` characters wide in the lines from `start` on."""
    values: list[float] = []
    for number, line in enumerate(lines[start:], start + 1):
        line = line.rstrip()
        cells = [line[at : at + width] for at in range(0, len(line), width)]
        whole = all(len(cell) == width and is_finite(cell.strip()) for cell in cells)
        if len(values) >= count:
            if line and whole:
                raise ExperimentError(
                    f"{path}, line {number}: the block above states {count} numbers and goes on after them; "
                    "lines are doubled, so get the file again"
                )
            break
        if not whole:
            raise ExperimentError(
                f"{path}, line {number}: {shown(line.strip())} are no numbers {width} characters wide; "
                "get the file again"
            )
        values.extend(map(float, cells))
    _check_count(path, len(values), count, start)
    return np.array(values)
