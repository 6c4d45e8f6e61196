"""`pounding diagnose`: what is missing from the model of a measured case."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from diagnosis.errors import CaseError
from experiments.command import options
from experiments.command.output import emit, progress_console


def diagnose(
    case: Annotated[Path | None, Parameter(help="Folder with case.toml and its runs.")] = None,
    *,
    out: options.Out = None,
    candidates: Annotated[
        Path | None, Parameter(help="Python file with candidates of your own (docs/diagnosis/own-candidates.md).")
    ] = None,
    benchmark: Annotated[
        int | None, Parameter(help="Judge the diagnosis on so many hidden cases instead of reading one.")
    ] = None,
    seed: Annotated[int, Parameter(help="Seed of the benchmark.")] = 0,
    json: options.Json = False,
) -> None:
    """Find where measurements and the believed model disagree, name what is missing, and show the gap close."""
    if benchmark is not None:
        _benchmark(benchmark, seed, out, json)
        return
    if case is None:
        raise CaseError("no case was given; name the folder that holds case.toml, or ask for --benchmark N")
    from diagnosis.diagnose import diagnose_case
    from diagnosis.report import tables

    with _bar() as told:
        report = diagnose_case(case, out, told, candidates_file=candidates)
    emit(report, as_json=json, show=lambda: tables(report))


def _benchmark(cases: int, seed: int, out: Path | None, json: bool) -> None:
    from diagnosis.benchmark.run import run_benchmark, tables

    result = run_benchmark(cases, seed=seed, out=out)
    emit(result, as_json=json, show=lambda: tables(result))


class _bar:
    """A progress bar on standard error."""

    def __enter__(self) -> Callable[[str, float], None]:
        self.progress = Progress(
            TextColumn("{task.description:<44}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=progress_console(),
            transient=True,
        )
        self.progress.start()
        self.task = self.progress.add_task("reading the case", total=1.0)
        return lambda what, share: self.progress.update(self.task, description=what, completed=share)

    def __exit__(self, *error: object) -> None:
        self.progress.stop()
