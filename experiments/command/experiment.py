"""`pounding experiment`: a configuration of the thesis by its name, or all of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pounding.experiments.configurations.library import experiments, find
from pounding.experiments.console import options
from pounding.experiments.console.output import emit, progress_console, table, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.states import FREE_VIBRATION, FrameState, State

if TYPE_CHECKING:
    from pounding.experiments.configurations.every import Finished
    from pounding.experiments.configurations.running import Conditions

LIST = "list"

All = Annotated[
    bool,
    Parameter(
        name="--all",
        negative=(),
        help="Run every experiment into --out; started again, only what is missing is run.",
    ),
]
Record = Annotated[
    str | None,
    Parameter(help="Another ground motion than the experiment's, by name or file; nothing is compared then."),
]
Out = Annotated[
    Path | None,
    Parameter(
        help="Folder in which each experiment gets a folder of its name; created if missing.",
        validator=options.writable_folder,
    ),
]


def experiment(
    name: str | None = None,
    *,
    every: All = False,
    record: Record = None,
    state: options.State = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    out: Out = None,
    workers: options.Workers = None,
    json: options.Json = False,
) -> None:
    """Run a configuration of the thesis by name, beside what was measured; `list` shows the names.

    With `--out` each experiment writes its results, a still picture, a VTK series for ParaView, its histories
    and `measured.csv`.

    Args:
        name: Name of an experiment, or list.
    """
    if every == (name is not None):
        raise ExperimentError(
            "name one experiment, or `list`, or give --all (see pounding experiment --help)"
        )
    if every:
        if record is not None or record_unit is not None:
            raise ExperimentError(
                "--record and --record-unit belong to one experiment; --all takes the ground motions of the thesis"
            )
        _run_all(out, state, records, workers, json)
    elif name == LIST:
        emit(stamp({}) | {"experiments": inventory()}, as_json=json, show=_listed)
    else:
        from pounding.experiments.configurations.running import Conditions

        conditions = Conditions(None if records is None else str(records), record, state, unit=record_unit)
        _run_one(str(name), conditions, out, json)


def inventory() -> list[dict[str, Any]]:
    """Return every experiment: name, kind, chapters, title, where it was measured, and figures of the thesis."""
    return [
        {
            "name": one.name,
            "kind": one.kind,
            "chapters": list(one.chapters),
            "title": one.title,
            "measured": [str(printed) for printed in one.measured],
            "figures": list(one.figures),
        }
        for one in experiments().values()
    ]


def _listed() -> Iterable[Any]:
    kinds: dict[str, list[list[str]]] = {}
    for one in inventory():
        kinds.setdefault(one["kind"], []).append([one["name"], _places(one), ", ".join(one["figures"])])
    for kind, rows in kinds.items():
        shown = table(kind.replace("-", " "), ["name", "measured in", "figures"], rows)
        shown.columns[0].no_wrap = True  # to be copied into the next command
        yield shown
    yield f"{len(experiments())} experiments: pounding experiment NAME --out DIR"


def _places(entry: dict[str, Any]) -> str:
    """Return the tables and sections of an entry, each once."""
    return ", ".join(dict.fromkeys(place.partition(",")[0] for place in entry["measured"]))


def _run_one(name: str, conditions: Conditions, out: Path | None, json: bool) -> None:
    chosen = find(name)
    from rich.progress import Progress

    from pounding.experiments.configurations import folder as folders
    from pounding.experiments.configurations.running import run

    if out is not None:
        folders.prepare(out, name)
    console = progress_console()
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        bar = progress.add_task(name, total=1.0)

        def told(what: str, share: float) -> None:
            progress.update(bar, description=f"{name}: {what}", completed=share)

        outcome = run(chosen, replace(conditions, progress=told))
        result = folders.result_of(outcome)
        if out is not None:
            kept = folders.keep(outcome, out)
            result |= {"files": kept.files, "warnings": [*outcome.warnings, *kept.notes]}
    for sentence in result["warnings"]:
        warn(sentence)
    emit(result, as_json=json, show=lambda: _shown(result, outcome.states, out))


def _shown(result: dict[str, Any], states: Iterable[FrameState], out: Path | None) -> Iterable[Any]:
    yield _table(f"{result['experiment']}: {result['title']}", result["measured"])
    yield from map(str, states)
    if out is not None:
        yield f"written to {out / result['experiment']}: {', '.join(result['files'])}"


def _table(title: str, rows: list[dict[str, Any]]) -> Any:
    heads = ["quantity", "unit", "measured", "SAP2000", "ours", "error %", "measured in"]
    return table(title, heads, [_cells(row) for row in rows])


def _cells(row: dict[str, Any]) -> list[Any]:
    numbers = [None if row[key] is None else f"{row[key]:.4g}" for key in ("measured", "sap2000", "ours")]
    error = None
    if row["measured"] and row["ours"] is not None and row["unit"]:
        error = f"{100 * (row['ours'] / row['measured'] - 1):+.1f}"
    return [row["quantity"], row["unit"], *numbers, error, row["source"]]


def _run_all(
    out: Path | None,
    state: State | None,
    records: Path | None,
    workers: int | None,
    json: bool,
) -> None:
    if out is None:
        raise ExperimentError("--all needs a folder for its results: --out DIR")
    from pounding.experiments.configurations.every import run_all
    from pounding.experiments.configurations.measured import write_many
    from pounding.experiments.console import estimates
    from pounding.experiments.records import records_folder

    records_folder(records)  # a folder that is not there is said before the first experiment

    known = experiments()
    if state == "strong-motion":
        known = {name: one for name, one in known.items() if one.motion is not None}
        warn(f"{len(known)} experiments with a ground motion are run; the others have no strong-motion state")
    estimates.announce(estimates.of_experiments(len(known)))
    found = run_all(
        known.values(), out, records=None if records is None else str(records), state=state, workers=workers
    )
    write_many(found.rows, out / "measured.csv")
    result = stamp({"all": True, "state": state or FREE_VIBRATION}) | {
        "finished": list(found.rows),
        "failures": found.failures,
        "warnings": found.warnings,
    }
    for sentence in _failures(found):
        warn(sentence)
    emit(result, as_json=json, show=lambda: [_summary(found, out)])
    if found.failures:
        raise ExperimentError(
            f"{len(found.failures)} of {len(known)} experiments failed, the others are in {out}; the same command "
            "runs those again"
        )


def _failures(found: Finished) -> Iterable[str]:
    """Say for each reason which experiments failed."""
    reasons: dict[str, list[str]] = {}
    for name, reason in found.failures.items():
        reasons.setdefault(reason, []).append(name)
    for reason, names in reasons.items():
        yield f"{', '.join(names)}: {reason}"


def _summary(found: Finished, out: Path) -> str:
    warned = f", {len(found.warnings)} with warnings in their experiment.json" if found.warnings else ""
    return f"{len(found.rows)} experiments are in {out}{warned}; what was measured, beside ours: {out / 'measured.csv'}"
