"""Damage as files meet it: cut, lines lost, doubled or swapped, words replaced, other encodings, NUL bytes.

A test applies it to a true file, and a reader has to refuse in one sentence or to read what the file says.
"""

from __future__ import annotations

import re
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from hypothesis import strategies as st

from pounding.errors import InputError

NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
WORDS = (
    *(
        "nan",
        "inf",
        "-",
        "",
        "1e300",
        "-1e300",
        "1e999",
        "1_000",
        "١٢",
        "１２",
        "²",
        "0x10",
        "1e",
        "1,5",
        "1.2.3",
    ),
    *(
        '"',
        '"0.5',
        '"0.5"',
        "'0.5'",
        '"a',
        "0.5;0.5",
        "\u2028",
        "\x0c",
        "\x85",
        "0" * 5000,
        "1" * 5000,
        "−0.5",
        "garbage",
    ),
)
ENCODINGS = ("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "utf-7", "cp500")
SECONDS, MEGABYTES = 5.0, 400.0
Result = TypeVar("Result")


@dataclass(frozen=True)
class Damage:
    """One thing done to a file: what, where (shares of the file), and the word that is put in."""

    kind: str
    at: float
    other: float
    word: str

    def __call__(self, data: bytes) -> bytes:
        """Return the damaged bytes."""
        if self.kind == "cut":
            return data[: int(self.at * len(data))]
        if self.kind == "nul":
            place = int(self.at * len(data))
            return data[:place] + b"\0" * (1 + int(3 * self.other)) + data[place:]
        text = data.decode("latin-1") if self.kind != "encode" else data.decode("utf-8", "replace")
        if self.kind == "encode":
            return text.encode(ENCODINGS[int(self.at * len(ENCODINGS))], "replace")
        lines = text.splitlines(keepends=True)
        if not lines:
            return data
        # The first lines are the headers: they are met as often as all others together.
        one, two = (int(min(2 * share, 1) * min(len(lines), 20)) if share < 0.5 else int((2 * share - 1) * len(lines))
                    for share in (self.at, self.other))  # fmt: skip
        one, two = min(one, len(lines) - 1), min(two, len(lines) - 1)
        if self.kind == "drop":
            del lines[one]
        elif self.kind == "double":
            lines.insert(one, lines[one])
        elif self.kind == "swap":
            lines[one], lines[two] = lines[two], lines[one]
        elif self.kind == "replace":
            words = list(re.finditer(r"[^\s,]+", lines[one]))
            if words:
                word = words[int(self.other * len(words))]
                put = self.word.encode("utf-8").decode("latin-1")
                lines[one] = lines[one][: word.start()] + put + lines[one][word.end() :]
        return "".join(lines).encode("latin-1")


_share = st.floats(0, 1, exclude_max=True, width=32)
_kinds = st.sampled_from(("cut", "drop", "double", "swap", "replace", "replace", "replace", "encode", "nul"))
damages = st.lists(st.builds(Damage, _kinds, _share, _share, st.sampled_from(WORDS)), min_size=1, max_size=3)


def decoded(data: bytes) -> str:
    """Return the text of damaged bytes as a reader may see it."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def plain_numbers(words: list[str]) -> list[float]:
    """Return words as numbers; all of them must be plain ones."""
    assert all(NUMBER.fullmatch(word) for word in words), "a reader took for a number what is none"
    return [float(word) for word in words]


def read_or_refused(read: Callable[[Path], Result], path: Path) -> Result | None:
    """Return what a reader makes of a file, or None if it refuses in one sentence; it must leave nothing behind."""
    before = sorted(path.parent.iterdir()), path.read_bytes()
    started = time.perf_counter()
    result = None
    try:
        result = read(path)
    except InputError as refused:
        said = str(refused)
        assert path.name in said
        assert said.isprintable(), repr(said)
        assert len(said) < 700
    assert time.perf_counter() - started < SECONDS
    assert (sorted(path.parent.iterdir()), path.read_bytes()) == before
    return result


@contextmanager
def little_memory() -> Iterator[None]:
    """Refuse that the process grows by more than MEGABYTES."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    yield
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert grown < MEGABYTES, f"{grown:.0f} MB more than before"


def same(found: np.ndarray, expected: list[float] | np.ndarray) -> bool:
    """Return whether samples are the expected ones but for the rounding of a unit's factor."""
    return len(found) == len(expected) and np.allclose(
        found, expected, rtol=1e-12, atol=1e-15, equal_nan=True
    )
