"""Running a benchmark: hide, diagnose, open the truth; case by case in processes, resumable."""

from __future__ import annotations

import hashlib
import json
import math
import resource
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import to_builtins
from rich.console import Console

from pounding.diagnosis.benchmark.drawing import Counts, Drawn, draw_set
from pounding.diagnosis.benchmark.pictures import draw_benchmark
from pounding.diagnosis.benchmark.scoring import Judged, judge
from pounding.diagnosis.benchmark.summary import summarise
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.motions import available
from pounding.diagnosis.hidden.worlds import WORLDS, world_of
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.diagnosis.report.reading import report_from
from pounding.diagnosis.report.report import Report
from pounding.experiments.results.provenance import stamp
from pounding.experiments.sweeps.store import code_version
from pounding.experiments.sweeps.sweep import sweep
from pounding.extras import extra_module
from pounding.frames.files import scratch, write_whole

if TYPE_CHECKING:
    import xarray as xr

Method = Callable[[Path], Report]

METHODS = ("diagnosis", "refit", "sparse", "sparse-pysindy")
"""The workflow itself and what people would do instead (see `competitors`)."""


KINDS = ("nothing", "single", "double", "outside")
"""What a case hides: nothing, one effect of the catalogue, two, or one that is in no catalogue."""


def kind(drawn: Drawn) -> str:
    """Return what a drawn case hides: one of `KINDS`."""
    outside = {name for world in WORLDS.values() for name in world.outside}
    return "outside" if any(effect in outside for effect in drawn.effects) else KINDS[len(drawn.effects)]


def method(name: str) -> Method:
    """Return the function that makes a report of a case folder.

    Raises:
        CaseError: There is no such method.
    """
    if name == "diagnosis":
        from pounding.diagnosis.workflow import diagnose

        return diagnose
    if name in METHODS:
        if name == "sparse-pysindy":
            extra_module("pysindy.optimizers")
        from pounding.diagnosis.benchmark import competitors

        return competitors.COMPETITORS[name]
    raise CaseError(f"no method {name!r} to judge; use one of {', '.join(METHODS)}")


def one_case(
    index: int,
    count: int,
    seed: int,
    way: str,
    motions: str,
    pairs: bool,
    engine: str,
    counts: Sequence[int] | None = None,
) -> dict[str, Any]:
    """Hide, diagnose and only then open the truth of one case of a set.

    Args:
        index: Number of the case in the set.
        count: Number of cases in the set.
        seed: Of the set.
        way: One of `METHODS`.
        motions: ``records``, ``artificial`` or ``mixed``.
        pairs: Whether the set is one of pairs.
        engine: The world of the set: ``own`` or ``opensees``.
        counts: Its `Counts`; by the shares of `drawing` when None.

    Returns:
        ``truth`` and ``report`` as JSON texts, ``seconds`` [s] and ``memory_mb``, the largest so far [MB].
    """
    kinds = None if counts is None else Counts(*counts)
    drawn = draw_set(count, seed, pairs=pairs, engine=engine, counts=kinds)[index]
    hidden = hide(
        drawn.effects,
        drawn.frames,
        seed=drawn.seed,
        source=motions,
        title=f"case {index}",
        engine=engine,
        noise=drawn.noise,
    )
    with scratch() as folder:
        case = folder / "case"
        write_hidden(hidden, case)
        start = time.perf_counter()
        report = method(way)(case)
        seconds = time.perf_counter() - start
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {
        "truth": json.dumps(hidden.truth),
        "report": report.json(),
        "seconds": seconds,
        "memory_mb": memory_mb,
    }


def run_benchmark(
    count: int,
    seed: int = 0,
    *,
    way: str = "diagnosis",
    motions: str = "mixed",
    pairs: bool = False,
    out: Path | None = None,
    workers: int | None = None,
    console: Console | None = None,
    first: int | None = None,
    only: Sequence[str] = KINDS,
    engine: str = "own",
    counts: Counts | None = None,
) -> dict[str, Any]:
    """Judge a way of diagnosis on a drawn set.

    Args:
        count: Number of cases.
        seed: Of the set.
        way: One of `METHODS`.
        motions: Where the table's motions come from: ``records``, ``artificial`` or ``mixed``.
        pairs: Two frames side by side instead of one.
        out: Folder for `benchmark.json`, its picture and the finished cases, so that an interrupted benchmark goes on;
            None keeps nothing.
        workers: Processes; one a core when None, 0 runs in this process.
        console: Where progress is shown.
        first: Judge only so many cases of the set, in its random order; all when None.
        only: Judge only cases of these kinds, some of `KINDS`.
        engine: The world in which effects are hidden: ``own`` or ``opensees``.
        counts: How many cases of each kind; by the shares of `drawing` when None.

    Returns:
        The figures of `summarise`, and ``parameters``, ``method``, ``motion_records``, ``failures``,
        ``memory_mb`` and ``judged``: truth and verdict of each case in short.

    Raises:
        CaseError: An unknown method or engine, an engine that is not installed, a set without cases or without
            any of a kind, or not one that could be finished.
    """
    method(way)
    world_of(engine)
    if first is not None and not 1 <= first <= count:
        raise CaseError(f"the first {first} of {count} cases: give 1 to {count}")
    drawn = draw_set(count, seed, pairs=pairs, engine=engine, counts=counts)[:first]
    settings = {
        "count": count,
        "seed": seed,
        "way": way,
        "motions": motions,
        "pairs": pairs,
        "engine": engine,
        "counts": None if counts is None else [counts.nulls, counts.outsiders, counts.doubles],
    }
    done = sweep(
        one_case,
        [{"index": one.index} for one in _of_kinds(only, drawn)],
        settings=settings,
        folder=None if out is None else out / "cases",
        workers=workers,
        version=_version(),
        console=console,
    )
    result = {
        **stamp(settings | {"first": first or count, "only": list(only)}),
        "method": way,
        "motion_records": available() if motions != "artificial" else [],
        **_figures(done, f"a finished case in {out}"),
    }
    if out is not None:
        write_whole(out / "benchmark.json", json.dumps(_finite(result), indent=2).encode())
        draw_benchmark(result, out / "benchmark.png")
    return result


def _of_kinds(only: Sequence[str], drawn: Sequence[Drawn]) -> list[Drawn]:
    chosen = [one for one in drawn if kind(one) in only]
    if not chosen:
        raise CaseError(
            f"no case of the kind {' or '.join(only)} among the {len(drawn)} that are drawn; ask for more cases"
        )
    return chosen


def _version() -> str:
    """Return a hash of all source that a judged case depends on."""
    digest = hashlib.sha256(code_version(one_case).encode())
    root = Path(__file__).parents[1]
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _figures(done: xr.Dataset, source: str) -> dict[str, Any]:
    """Return what the finished cases say together and, in short, each by itself.

    Args:
        done: The sweep of `one_case`.
        source: Where a report is from, for the sentence on one that cannot be read.
    """
    if "truth" not in done:
        raise CaseError(f"no case of the benchmark was finished; the first: {done['failure'].values[0]}")
    texts = zip(done["truth"].values, done["report"].values, done["seconds"].values, strict=True)
    finished = [
        _Finished(json.loads(truth), report_from(report, source), float(seconds))
        for truth, report, seconds in texts
        if truth
    ]
    judged = [judge(*one) for one in finished]
    return {
        **summarise(judged),
        "failures": [str(reason) for reason in done["failure"].values if reason],
        "memory_mb": float(done["memory_mb"].max()),
        "judged": [one.in_short(case) for one, case in zip(finished, judged, strict=True)],
    }


class _Finished(NamedTuple):
    """A finished case: what was hidden, what was found, and the seconds that it took [s]."""

    truth: dict[str, Any]
    report: Report
    seconds: float

    def in_short(self, judged: Judged) -> dict[str, Any]:
        return vars(judged) | {
            "seed": self.truth["seed"],
            "hidden": self.truth["effects"],
            "found": to_builtins(self.report.effects),
        }


def _finite(value: Any) -> Any:
    """Return a result as JSON has it: null for NaN, lists for tuples."""
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
