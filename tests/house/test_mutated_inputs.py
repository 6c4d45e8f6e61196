"""Damaged files of every kind end in a result or in one sentence, soon, in little memory, and leave nothing behind.

`POUNDING_MUTATION_SEED` chooses other damages; the same seed gives the same ones.
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

from pounding import frames
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.effects.candidate_file import read_candidates
from pounding.errors import InputError
from pounding.experiments.measurements import history
from pounding.frames import PlateFrame
from pounding.frames.fe.mesh import node_count
from pounding.frames.loading import parse
from tests.diagnosis.case.test_bad_input import case_of
from tests.diagnosis.effects.test_own_candidates import FILE as CANDIDATES
from tests.diagnosis.models import measured
from tests.frames.test_definition import PLATE

SEED = int(os.environ.get("POUNDING_MUTATION_SEED", "0"))
LONGEST_S = 10.0
"""Of the processor; the first of a kind imports and compiles."""
MOST_MB = 400.0
"""Above the process before, for all damages of one kind together."""

STICK = """
kind = "stick"
name = "mine"
storeys = 3
storey_height_m = [3.0, 3.0, 3.0]
floor_mass_kg = [5.0, 5.0, 4.0]
damping_ratio = [0.01, 0.02]
frequency_hz = [2.0]
plan_m = [0.4, 0.3]
"""
DEEP = 5000
VALUES = [
    "nan", "inf", "-inf", "1e300", "-1e300", "1e-300", "1e-12", "0", "-1", "1e999", "1" + "0" * 400, "9" * 5000, "true",
    '""', '"text"', '"\\u0000"', '"a\\u0000b"', '"' + "x" * 10000 + '"', "[]", "[[]]", "{}", '["a", "b"]', "[1, 2]",
    "[nan, nan, nan]", "[1e300, 1e300, 1e300]", "{ a = 1 }", "[{ a = 1 }]", "1979-05-27", "07:32:00", "/dev/zero",
    "[" * DEEP + "]" * DEEP, "{a=" * DEEP + "1" + "}" * DEEP, '"', "'''", "(", "",
]  # fmt: skip
LINES = [
    "[[frame]]", "[[run]]", "[[channel]]", "[prior]", "[a.b.c.d]", "[published]", "x = 1", "=", "\0", "é", "\ud800", '"',
    "def",
]  # fmt: skip
SIGNS = ["=", ",", ":", "(", "*"]
CELLS = [
    "nan",
    "inf",
    "1e300",
    "-1e300",
    "1e-300",
    "",
    '"',
    "\0",
    "x",
    "1e9",
    "0x10",
    "1_000",
    " ",
    "'",
    "٣",
    "1,2",
]

place = st.integers(0, 10**6)
mutation = st.one_of(
    st.tuples(st.just("drop"), place, st.none()),
    st.tuples(st.just("double"), place, st.none()),
    st.tuples(st.just("value"), place, st.sampled_from(VALUES)),
    st.tuples(st.just("value"), place, st.sampled_from(VALUES)),
    st.tuples(st.just("cell"), place, st.sampled_from(CELLS)),
    st.tuples(st.just("line"), place, st.sampled_from(LINES)),
    st.tuples(st.just("cut"), place, st.none()),
    st.tuples(st.just("bytes"), place, st.binary(min_size=1, max_size=20)),
)
mutations = st.lists(mutation, min_size=1, max_size=3)


def damaged(text: str, wanted: list[tuple[str, int, Any]]) -> bytes:
    """Return the text with damages, in order."""
    content = text.encode()
    for kind, where, what in wanted:
        content = _damaged(content, kind, where, what)
    return content


def _damaged(content: bytes, kind: str, where: int, what: Any) -> bytes:
    if kind in ("cut", "bytes"):
        at = where % (len(content) + 1)
        return content[:at] + ((what + content[at:]) if kind == "bytes" else b"")
    lines = content.decode("utf-8", "replace").split("\n")
    number = where % len(lines)
    line = lines[number]
    if kind == "drop":
        del lines[number]
    elif kind == "double":
        lines.insert(number, line)
    elif kind == "line":
        lines.insert(number, what)
    elif kind == "cell":
        cells = line.split(",")
        cells[where % len(cells)] = what
        lines[number] = ",".join(cells)
    else:
        sign = next((sign for sign in SIGNS if sign in line), "=")
        lines[number] = f"{line.partition(sign)[0]}{sign} {what}"
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def held(read: Callable[[], object], folder: Path | None = None) -> None:
    """Assert that a reader gives a result or a sentence, soon, and leaves its folder as it was."""
    before = sorted(folder.rglob("*")) if folder else []
    started, sentence = time.process_time(), "a result"
    try:
        read()
    except InputError as error:
        sentence = str(error)
    assert sentence.strip()
    assert "\n" not in sentence
    assert len(sentence) < 20_000
    assert time.process_time() - started < LONGEST_S
    assert before == (sorted(folder.rglob("*")) if folder else [])


def read_frame(content: bytes) -> None:
    frame = parse(content, "mine.toml")
    if isinstance(frame, PlateFrame):
        node_count(frame)
    else:
        frames.build(frame)


def memory_mb() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return used / (1e6 if sys.platform == "darwin" else 1e3)


@pytest.fixture(scope="module")
def case() -> dict[str, str]:
    with tempfile.TemporaryDirectory() as folder:
        write_case(case_of(measured(samples=40, runs=2).observed), folder)
        return {path.name: path.read_text(encoding="utf-8") for path in Path(folder).iterdir()}


def tried(check: Callable[[Any], None], inputs: st.SearchStrategy[Any], count: int) -> None:
    """Try a check on so many inputs, the same for the same seed."""
    chosen = settings(
        max_examples=count, deadline=None, database=None, suppress_health_check=list(HealthCheck)
    )
    before, done = memory_mb(), 0

    def counted(drawn: Any) -> None:
        nonlocal done
        done += 1
        check(drawn)

    seed(SEED)(chosen(given(inputs)(counted)))()
    assert done >= count
    assert memory_mb() - before < MOST_MB


def frame_files(count: int) -> None:
    inputs = st.tuples(st.sampled_from([PLATE, STICK]), mutations)
    tried(lambda drawn: held(lambda: read_frame(damaged(*drawn))), inputs, count)


def case_files(count: int, case: dict[str, str]) -> None:
    def check(drawn: tuple[str, list[tuple[str, int, Any]]]) -> None:
        name, wanted = drawn
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            for one, text in case.items():
                (folder / one).write_bytes(damaged(text, wanted) if one == name else text.encode())
            held(lambda: read_case(folder), folder)
            held(lambda: history.read(folder / "run1.csv"), folder)

    tried(check, st.tuples(st.sampled_from(["case.toml", "case.toml", "run1.csv"]), mutations), count)


def candidate_files(count: int) -> None:
    def check(wanted: list[tuple[str, int, Any]]) -> None:
        with tempfile.TemporaryDirectory() as place:
            path = Path(place) / "mine.py"
            path.write_bytes(damaged(CANDIDATES, wanted))
            held(lambda: read_candidates(path), Path(place))

    tried(check, mutations, count)


def test_a_few_damaged_files_of_each_kind(case: dict[str, str]) -> None:
    frame_files(12)
    case_files(12, case)
    candidate_files(6)


@pytest.mark.slow
def test_damaged_frame_files() -> None:
    frame_files(600)


@pytest.mark.slow
def test_damaged_case_files(case: dict[str, str]) -> None:
    case_files(400, case)


@pytest.mark.slow
def test_damaged_candidate_files() -> None:
    candidate_files(80)
