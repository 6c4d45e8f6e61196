"""The sets by which a frozen program is judged, drawn with seeds that follow from its commit.

``python -m pounding.diagnosis.benchmark.proof COMMIT --out FOLDER`` judges them all, goes on where it was interrupted, and
prints every figure; nobody can choose the cases, because nobody can choose the hash.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console

from pounding.diagnosis.benchmark.drawing import Counts
from pounding.diagnosis.benchmark.run import run_benchmark
from pounding.diagnosis.benchmark.tables import tables
from pounding.diagnosis.errors import CaseError
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script


@dataclass(frozen=True)
class Proof:
    """One of the sets: its world, whether of pairs, its cases, and how many of each kind (by shares when None)."""

    engine: str
    pairs: bool
    count: int
    counts: Counts | None


Name = Literal["frames", "pairs", "own"]

SETS: dict[Name, Proof] = {
    "frames": Proof("opensees", False, 180, Counts(nulls=60, outsiders=20, doubles=20)),
    "pairs": Proof("opensees", True, 40, Counts(nulls=10, outsiders=4, doubles=4)),
    "own": Proof("own", False, 100, None),
}
"""Single frames and pairs of the second world, and single frames of the own one."""


def seed_of(commit: str, name: Name) -> int:
    """Return the seed of a set: the first 31 bits of the SHA-256 of the commit's hash and the set's name.

    Args:
        commit: The whole hash, 40 hexadecimal digits.
        name: The set.

    Raises:
        CaseError: That is no whole hash.
    """
    if not re.fullmatch(r"[0-9a-f]{40}", commit):
        raise CaseError(f"{commit!r} is no commit's whole hash; `git rev-parse HEAD` prints it, 40 digits")
    digest = hashlib.sha256(f"{commit} {name}".encode()).digest()
    return int.from_bytes(digest[:4], "big") >> 1


def prove(
    commit: str,
    out: Path,
    *,
    name: Name,
    first: int | None = None,
    workers: int | None = 2,
    console: Console | None = None,
) -> dict[str, Any]:
    """Judge one of the sets; what is finished in the folder is not done again.

    Args:
        commit: Hash of the frozen commit.
        out: Folder in which the set has its own.
        name: The set.
        first: Only so many of its cases, in its random order; all when None.
        workers: Processes; 0 runs in this one.
        console: Where progress is shown.

    Returns:
        What `run_benchmark` returns.

    Raises:
        CaseError: No whole hash, or what `run_benchmark` refuses.
    """
    one = SETS[name]
    return run_benchmark(
        one.count,
        seed_of(commit, name),
        pairs=one.pairs,
        engine=one.engine,
        counts=one.counts,
        out=out / name,
        workers=workers,
        console=console,
        first=None if first is None else min(first, one.count),
    )


def main(
    commit: str,
    /,
    *,
    out: Annotated[Path, Parameter(validator=options.writable_folder)],
    only: list[Name] | None = None,
    first: int | None = None,
    workers: int = 2,
) -> None:
    """Judge the frozen program on all sets and print their figures.

    Args:
        commit: Hash of the frozen commit, all 40 digits.
        out: Folder for the finished cases and benchmark.json of each set.
        only: Only some of the sets.
        first: Only so many cases of each, in its random order.
        workers: Processes.
    """
    console = Console()
    for name in only or SETS:
        console.print(f"{name}: seed {seed_of(commit, name)}")
        for item in tables(
            prove(commit, out, name=name, first=first, workers=workers, console=Console(stderr=True))
        ):
            console.print(item)


if __name__ == "__main__":
    run_script(main)
