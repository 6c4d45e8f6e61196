"""All configurations one after the other: a sweep that goes on where it was, and says at its end what failed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from pounding.experiments.configurations import folder as folders
from pounding.experiments.configurations.definition import AnyExperiment
from pounding.experiments.configurations.library import find
from pounding.experiments.configurations.measured import Row
from pounding.experiments.configurations.running import Conditions, run
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import find as find_record
from pounding.experiments.rig.states import FREE_VIBRATION, State
from pounding.experiments.sweeps.store import StoreError, case_key, code_version
from pounding.experiments.sweeps.sweep import sweep
from pounding.frames.errors import FrameError
from pounding.frames.files import clear_stale

FINISHED = ".finished"
"""Folder of the finished cases, in that of all configurations."""


@dataclass(frozen=True)
class Finished:
    """What a sweep over configurations gave.

    Attributes:
        rows: Rows of each configuration that did not fail, by its name.
        failures: Why the others failed, by their names.
        warnings: Sentences of each configuration that has any.
    """

    rows: dict[str, list[Row]]
    failures: dict[str, str]
    warnings: dict[str, list[str]]


def run_all(
    experiments: Iterable[AnyExperiment],
    out: Path,
    *,
    records: str | None = None,
    state: State | None = None,
    workers: int | None = None,
    console: Console | None = None,
) -> Finished:
    """Run configurations in processes, each into the folder of its name; those that are finished are not run again.

    Args:
        experiments: The configurations.
        out: Folder for all of them.
        records: Folder with ground motions; None for the default.
        state: State of the frames; None for free vibration.
        workers: Processes; one a core when None.
        console: Where progress is shown; standard error when None.

    Raises:
        ExperimentError: The folder cannot be written, or the disk is full; what is finished is kept.
        KeyboardInterrupt: Ctrl-C; what is finished is kept.
    """
    chosen = list(experiments)
    cases = [{"name": one.name, "entry": _hash(one), "motion": motion_hash(one, records)} for one in chosen]
    settings = {"out": str(out), "records": records or "", "state": state or FREE_VIBRATION}
    _forget_lost(cases, settings, out)
    try:
        data = sweep(
            run_case, cases, settings=settings, folder=out / FINISHED, workers=workers, retry_failed=True,
            console=console,
        )  # fmt: skip
    finally:
        if out.is_dir():
            clear_stale(out)  # what workers that were stopped had begun
    texts = {name: str(text) for name, text in zip(data["name"].values, _column(data, "rows"), strict=True)}
    told = {
        name: str(text) for name, text in zip(data["name"].values, _column(data, "warnings"), strict=True)
    }
    failures = dict(zip(map(str, data["name"].values), map(str, data["failure"].values), strict=True))
    return Finished(
        {str(name): [Row(**row) for row in json.loads(text)] for name, text in texts.items() if text},
        {name: reason.partition(": ")[2] or reason for name, reason in failures.items() if reason},
        {str(name): found for name, text in told.items() if text and (found := json.loads(text))},
    )


def run_case(name: str, *, entry: str, motion: str, out: str, records: str, state: State) -> dict[str, Any]:
    """Run one configuration and write its folder, for `sweep`.

    Args:
        name: Its name.
        entry: Hash of its entry, so that a changed entry is run again.
        motion: Hash of its ground motion, for the same reason.
        out: Folder for all configurations.
        records: Folder with ground motions; empty for the default.
        state: State of the frames.

    Returns:
        `rows` and `warnings` as JSON text.

    Raises:
        StoreError: The disk is full or the folder cannot be written: the others could not be kept either.
    """
    outcome = run(find(name), Conditions(records or None, state=state))
    try:
        kept = folders.keep(outcome, Path(out))
    except FrameError as error:
        if _of_the_disk(error):
            raise StoreError(
                f"{error}; what is finished is kept: make room and start again to go on"
            ) from None
        raise
    return {
        "rows": json.dumps([asdict(row) for row in outcome.rows]),
        "warnings": json.dumps([*outcome.warnings, *kept.notes]),
    }


def _of_the_disk(error: BaseException | None) -> bool:
    """Return whether an error comes from a disk that is full or cannot be written."""
    while error is not None and not isinstance(error, OSError):
        error = error.__cause__
    return error is not None


def _column(data: Any, name: str) -> list[str]:
    """Return a result of all cases; empty texts where none has it, because all failed."""
    return list(data[name].values) if name in data else [""] * data.sizes["case"]


def _hash(experiment: AnyExperiment) -> str:
    return hashlib.sha256(msgspec.json.encode(experiment)).hexdigest()[:16]


def motion_hash(experiment: AnyExperiment, records: str | None) -> str:
    """Return the hash of a configuration's ground motion; empty where there is none, and where it is missing."""
    if experiment.motion is None:
        return ""
    try:
        return find_record(experiment.motion, records).sha256
    except ExperimentError:
        return ""


def _forget_lost(cases: list[dict[str, Any]], settings: dict[str, Any], out: Path) -> None:
    """Forget the finished cases whose folder somebody has removed or that is not whole, so that they run again."""
    version = code_version(run_case)
    for case in cases:
        if not (out / case["name"] / folders.RESULT).is_file():
            key = case_key(run_case, case, settings, version)
            (out / FINISHED / f"{key}.json").unlink(missing_ok=True)
