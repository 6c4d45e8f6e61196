"""`pounding diagnose`: what is missing from the model of a measured case."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group, Parameter
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from pounding import bounds
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, progress_console, warn
from pounding.experiments.pictures import films
from pounding.extras import extra_module
from pounding.frames import load

if TYPE_CHECKING:
    from pounding.diagnosis.case.case import Case
    from pounding.diagnosis.report.report import Report

OF_BENCHMARK = Group("Judging the diagnosis instead (docs/diagnosis/benchmark.md)", sort_key=1)


def diagnose(
    case: Annotated[Path | None, Parameter(help="Folder with case.toml and its runs.")] = None,
    *,
    out: Annotated[
        Path | None,
        Parameter(
            help="Folder for report.html, report.json and the pictures, made if it is not there; "
            "without it the findings are only printed. With --benchmark: for benchmark.json and finished cases.",
            validator=options.writable_folder,
        ),
    ] = None,
    candidates: Annotated[
        Path | None,
        Parameter(
            help="Python file with candidates of your own (docs/diagnosis/own-candidates.md). It is executed: "
            "on a terminal you are asked first, elsewhere --trust must say so."
        ),
    ] = None,
    trust: Annotated[
        bool, Parameter(negative=(), help="Execute the file of --candidates without being asked.")
    ] = False,
    calibrate: Annotated[
        bool,
        Parameter(
            negative=(),
            help="Simulate this very rig for the confidence: up to 15 minutes, goes on where it was interrupted.",
        ),
    ] = False,
    export_model: Annotated[
        Path | None,
        Parameter(
            help="Write the corrected model to this frame file (FILE.toml), for shake, pound and gap; beside it how the "
            "table moved in each run.",
            validator=options.writable_file,
        ),
    ] = None,
    film: Annotated[
        bool,
        Parameter(negative=(), help="Write a film of the run before and after over each other to --out."),
    ] = False,
    false_alarms: Annotated[
        float | None,
        Parameter(
            help="Share of frames without an effect for which one may be named or something may be said "
            "to remain; default: 0.05.",
            validator=options.bounded(bounds.FALSE_ALARMS),
        ),
    ] = None,
    json: options.Json = False,
    benchmark: Annotated[
        int | None,
        Parameter(
            group=OF_BENCHMARK,
            help="Hide, diagnose and judge so many cases; an interrupted one goes on.",
            validator=options.bounded(bounds.CASES),
        ),
    ] = None,
    seed: Annotated[
        int | None,
        Parameter(
            group=OF_BENCHMARK,
            help="Seed of the cases that are drawn; default: 0.",
            validator=options.bounded(bounds.SEED),
        ),
    ] = None,
    first: Annotated[
        int | None,
        Parameter(
            group=OF_BENCHMARK, help="Judge only so many of the cases that are drawn, in their random order."
        ),
    ] = None,
    only: Annotated[
        list[Literal["nothing", "single", "double", "outside"]] | None,
        Parameter(
            group=OF_BENCHMARK,
            negative=(),
            help="Judge only cases that hide this: nothing, one effect, two, one of no catalogue; may be repeated.",
        ),
    ] = None,
    pairs: Annotated[
        bool,
        Parameter(
            group=OF_BENCHMARK, negative=(), help="Pairs of frames that pound instead of single frames."
        ),
    ] = False,
    engine: Annotated[
        Literal["own", "opensees"] | None,
        Parameter(
            group=OF_BENCHMARK,
            help="World of the cases: our own simulator (default), or OpenSees, for development "
            "(docs/diagnosis/hidden-cases.md).",
        ),
    ] = None,
    way: Annotated[
        Literal["diagnosis", "refit", "sparse", "sparse-pysindy"] | None,
        Parameter(
            group=OF_BENCHMARK, help="What is judged: this diagnosis (default) or what one would do instead."
        ),
    ] = None,
) -> None:
    """Find where measurements and the baseline model disagree, name what is missing, and show how much that explains.

    The exit status is 0 whatever the verdict, and 2 with one sentence for a case that cannot be read.
    How to make a case: docs/diagnosis/how-to.md and docs/diagnosis/case-format.md.
    """
    judging = _Judging(seed, first, only, pairs, way, engine)
    if benchmark is not None:
        given = case is not None or candidates is not None or false_alarms is not None
        if given or calibrate or trust or film or export_model is not None:
            raise CaseError(
                "--benchmark draws its own cases; leave out the case, --candidates, --trust, --calibrate, --film, "
                "--export-model and --false-alarms"
            )
        _benchmark(benchmark, judging, out, json)
        return
    judging.refuse()
    if case is None:
        raise CaseError("no case was given; name the folder that holds case.toml, or ask for --benchmark N")
    _refuse(candidates, trust, export_model)
    if film and out is None:
        warn("--film needs a folder: nothing is written without --out")
    _require(film=film and out is not None, calibrate=calibrate, candidates=candidates is not None)
    from msgspec import to_builtins

    from pounding.diagnosis import workflow
    from pounding.diagnosis.case.reading import read_case
    from pounding.diagnosis.report.tables import tables

    read = read_case(case)
    if candidates is not None and not trust:
        _ask_to_execute(candidates)
    estimates.announce(*_works(read, calibrate))
    with _bar() as told:
        report = workflow.diagnose(
            read,
            out,
            told,
            candidates_file=candidates,
            calibrate=calibrate,
            film=film,
            false_alarms=SETTINGS.decision.false_alarms if false_alarms is None else false_alarms,
            export_model=export_model,
        )
    emit(
        to_builtins(report), as_json=json, show=lambda: [*tables(report), *_exported(report), *_written(out)]
    )
    if report.model and report.model.refused is not None:
        raise CaseError(f"no corrected model was written to {export_model}: {report.model.refused}")


@dataclass(frozen=True)
class _Judging:
    """The options that belong to --benchmark, as they were given."""

    seed: int | None
    first: int | None
    only: Sequence[str] | None
    pairs: bool
    way: str | None
    engine: str | None

    def refuse(self) -> None:
        """Raise CaseError if one was given, as there is no benchmark."""
        given = {
            "--seed": self.seed,
            "--first": self.first,
            "--only": self.only,
            "--pairs": self.pairs or None,
            "--engine": self.engine,
            "--way": self.way,
        }
        for name, value in given.items():
            if value is not None:
                raise CaseError(f"{name} belongs to --benchmark; leave it out or say how many cases to judge")


def _benchmark(cases: int, judging: _Judging, out: Path | None, json: bool) -> None:
    estimates.announce(estimates.of_benchmark(judging.first or cases))
    from pounding.diagnosis.benchmark.run import KINDS, run_benchmark
    from pounding.diagnosis.benchmark.tables import tables

    result = run_benchmark(
        cases,
        seed=judging.seed or 0,
        pairs=judging.pairs,
        way=judging.way or "diagnosis",
        engine=judging.engine or "own",
        out=out,
        console=progress_console(),
        first=judging.first,
        only=judging.only or KINDS,
    )
    emit(result, as_json=json, show=lambda: tables(result))


def _refuse(candidates: Path | None, trust: bool, export_model: Path | None) -> None:
    if trust and candidates is None:
        raise CaseError("--trust belongs to --candidates; leave it out or name the file that you trust")
    if export_model is not None and export_model.suffix != ".toml":
        raise CaseError(f"--export-model {export_model}: a frame file ends in .toml; name it so")


def _require(*, film: bool, calibrate: bool, candidates: bool) -> None:
    """See that the libraries are there, before the diagnosis, which takes minutes."""
    if film:
        films.require()
    if calibrate:
        extra_module("joblib")
    if candidates:
        extra_module("pint")


def _ask_to_execute(candidates: Path) -> None:
    """Ask whether a file of candidates may be executed; refuse where nobody can be asked."""
    if not candidates.is_file():
        raise CaseError(f"{candidates}: there is no such file of candidates; give --candidates a Python file")
    what = f"--candidates executes the Python code in {candidates} with all your rights"
    if sys.stdin is None or sys.stdin.closed or not sys.stdin.isatty():
        raise CaseError(f"{what}; read it, and add --trust if you trust it")
    console = progress_console()
    console.print(f"{what}. Do you trust this file? [y/N]", markup=False, end=" ")
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise CaseError(f"{candidates} was not executed; leave --candidates out, or trust the file")


def _works(case: Case, calibrate: bool) -> list[estimates.Work]:
    from pounding.diagnosis.model.slowing import samples_looked_at

    samples = samples_looked_at(case)
    built = [load(frame.file or frame.name) for frame in case.frames if frame.kind != "modal"]
    floors = sum(frame.storeys for frame in case.frames)
    works = [estimates.of_diagnosis(samples, floors, bool(case.contacts)), *map(estimates.of_frame, built)]
    if calibrate and case.runs:
        works.append(estimates.of_calibration(SETTINGS.calibration.minutes))
    return works


class _bar:
    """A progress bar on standard error, shown where that is a terminal."""

    def __enter__(self) -> Callable[[str, float], None]:
        console = progress_console()
        self.progress = Progress(
            TextColumn("{task.description:<44}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self.progress.start()
        self.task = self.progress.add_task("reading the case", total=1.0)
        return lambda what, share: self.progress.update(self.task, description=what, completed=share)

    def __exit__(self, *error: object) -> None:
        self.progress.stop()


def _exported(report: Report) -> list[str]:
    if not report.model or report.model.refused is not None:
        return []
    frames = [file for file in report.model.files if file not in report.model.motions]
    kind = "corrected" if report.named else "calibrated"
    said = [f"the {kind} model is {' and '.join(frames)}, the table's motion in each run beside it"]
    if report.model.beside:
        said.append(
            f"not in it, because it is not on a frame or no file can state it: {'; '.join(report.model.beside)}"
        )
    if report.model.case is not None:
        said.append(f"the measurements without that are the case {report.model.case}")
    return said


def _written(out: Path | None) -> list[str]:
    if out is None:
        return ["nothing was written; --out DIR keeps the report with its pictures"]
    return [f"the report is {out / 'report.html'}"]
