"""The text formats of the agencies: PEER AT2, CSMIP and COSMOS V2, K-NET ASCII."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record
from pounding.experiments.records.units import to_metric

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_AT2 = re.compile(rf"NPTS\s*=\s*(\d+)\s*,\s*DT\s*=\s*({_NUMBER})", re.IGNORECASE)
_AT2_OLD = re.compile(rf"^\s*(\d+)\s+({_NUMBER})\s+NPTS\s*,\s*DT", re.IGNORECASE)
_AT2_UNIT = re.compile(r"UNITS?\s+OF\s+(\S+)", re.IGNORECASE)
_CSMIP = re.compile(
    rf"^\s*(\d+)\s+points of accel data equally spaced at\s+({_NUMBER})\s*sec,?\s*in\s+([^\s(]+?)\.?[,.]?\s*"
    r"(?:\(units\)\s*)?\(\s*\d*[fFeE](\d+)",
    re.IGNORECASE,
)
_COSMOS = re.compile(
    r"^\s*(\d+)\s+acceleration\s+pts.*?units\s*=\s*([^\s,(]+)\s*(?:\(\s*\d+\s*\))?\s*,\s*Format\s*=\s*"
    r"\(\s*\d*[A-Z]+(\d+)",
    re.IGNORECASE,
)
_COSMOS_REALS = re.compile(
    r"^\s*(\d+)\s+Real-header values follow.*?Format\s*=\s*\(\s*\d*[A-Z]+(\d+)", re.IGNORECASE
)
_COSMOS_STEP = 61
"""Place (from zero) of the sampling interval of the data [ms] among COSMOS' real-header values."""
_KNET_SCALE = re.compile(
    rf"^Scale Factor\s+({_NUMBER})\s*\(gal\)\s*/\s*({_NUMBER})", re.IGNORECASE | re.MULTILINE
)
_KNET_RATE = re.compile(rf"^Sampling Freq\S*\s+({_NUMBER})\s*Hz", re.IGNORECASE | re.MULTILINE)


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
    samples = _numbers(path, lines[number + 1 :], number + 2, int(match[1]))
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
            count, unit, width = int(match[1]), match[2], int(match[3])
            step = _cosmos_step(path, lines[:number])
            break
    else:
        raise ExperimentError(f"{path}: no acceleration block of CSMIP or COSMOS V2 in this file")
    samples = _fixed(path, lines[number + 1 :], number + 2, count, width)
    factor = to_metric(unit, f"{path}, line {number + 1}")
    return Record(path.stem, samples * factor, step, source=str(path), history=(f"read in {unit}",))


def _cosmos_step(path: Path, head: list[str]) -> float:
    for number, line in enumerate(head):
        if match := _COSMOS_REALS.match(line):
            values = _fixed(path, head[number + 1 :], number + 2, int(match[1]), int(match[2]))
            if len(values) <= _COSMOS_STEP or values[_COSMOS_STEP] <= 0:
                raise ExperimentError(f"{path}: no time step in real-header value {_COSMOS_STEP + 1}")
            return float(values[_COSMOS_STEP]) / 1000
    raise ExperimentError(f"{path}: no real-header values before the acceleration; not a whole COSMOS file")


def read_knet(path: Path, text: str) -> Record:
    """Read one component of K-NET or KiK-net in ASCII (.EW, .NS, .UD): counts after a line `Memo.`.

    Counts are multiplied by the scale factor [gal/count] and their mean is taken off, as NIED prescribes.

    Raises:
        ExperimentError: A header without scale factor or sampling frequency, or samples that are no numbers.
    """
    scale, rate = _KNET_SCALE.search(text), _KNET_RATE.search(text)
    lines = text.splitlines()
    start = next((n for n, line in enumerate(lines) if line.startswith("Memo")), None)
    if not scale or not rate or start is None or float(scale[2]) == 0 or float(rate[1]) <= 0:
        raise ExperimentError(f"{path}: not K-NET ASCII (no 'Scale Factor', 'Sampling Freq' or 'Memo.')")
    counts = _numbers(path, lines[start + 1 :], start + 2, None)
    samples = counts * (float(scale[1]) / float(scale[2]) * 0.01)
    if not len(samples):
        raise ExperimentError(f"{path}: no samples after the line 'Memo.'")
    return Record(
        path.stem,
        samples - samples.mean(),
        1 / float(rate[1]),
        source=str(path),
        history=(f"read in counts of {float(scale[1]) / float(scale[2]):.6g} gal", "mean removed"),
    )


def _numbers(path: Path, lines: list[str], first: int, count: int | None) -> np.ndarray:
    """Return numbers separated by blanks, `count` of them if that is stated."""
    values: list[float] = []
    for number, line in enumerate(lines, first):
        try:
            values.extend(map(float, line.split()))
        except ValueError:
            raise ExperimentError(f"{path}, line {number}: '{line.strip()[:40]}' are no numbers") from None
    return _exactly(path, values, count)


def _fixed(path: Path, lines: list[str], first: int, count: int, width: int) -> np.ndarray:
    """Return `count` numbers from columns `width` characters wide."""
    values: list[float] = []
    for number, line in enumerate(lines, first):
        if len(values) >= count:
            break
        line = line.rstrip()
        cells = [line[at : at + width] for at in range(0, len(line), width)]
        try:
            values.extend(map(float, cells))
        except ValueError:
            raise ExperimentError(
                f"{path}, line {number}: '{line.strip()[:40]}' are no numbers {width} characters wide"
            ) from None
    return _exactly(path, values, count)


def _exactly(path: Path, values: list[float], count: int | None) -> np.ndarray:
    if count is not None and len(values) != count:
        raise ExperimentError(f"{path}: the header states {count} samples, the file holds {len(values)}")
    return np.array(values)
