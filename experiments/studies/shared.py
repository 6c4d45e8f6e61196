"""What several studies do alike with their tables."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from cyclopts import Parameter

from pounding.experiments.campaign.engine_check import check_in_engine
from pounding.experiments.console import options
from pounding.experiments.rig.rig import Solver
from pounding.frames.files import write_whole

Kept = Annotated[
    Path | None,
    Parameter(
        help="Folder for finished cases; an interrupted study goes on from it.",
        validator=options.writable_folder,
    ),
]
Workers = options.Workers


def engine_check(
    cases: Sequence[dict[str, Any]],
    runs: pd.DataFrame,
    solver: Solver,
    folder: Path | str | None,
    kept: Path | None,
    workers: int | None,
) -> dict[str, Any] | None:
    """Return what exudyn says of a sample of a campaign's runs; None where exudyn ran them all.

    Args:
        cases: Arguments of the campaign's runs.
        runs: Their results, a row each.
        solver: What ran them.
        folder: Folder with ground motions; None for the default.
        kept: Folder for finished cases.
        workers: Processes.
    """
    if solver == "exudyn":
        return None
    check = check_in_engine(cases, runs, folder=folder, kept=kept, workers=workers)
    return check.as_dict() | {"sentence": check.sentence}


def said(check: dict[str, Any] | None) -> list[str]:
    """Return the sentence of `engine_check` for a reader, or none."""
    return [] if check is None else [check["sentence"]]


def write_tables(tables: dict[str, pd.DataFrame], folder: Path) -> None:
    """Write each table as a CSV file of its name into a folder, made if it is not there."""
    for name, frame in tables.items():
        write_whole(folder / f"{name}.csv", frame.to_csv().encode())


def keyed(frame: pd.DataFrame) -> list[dict[str, Any]]:
    """Return a table as a list of rows for JSON, NaN as null."""
    rows: list[dict[str, Any]] = json.loads(frame.reset_index().to_json(orient="records"))
    return rows


def cell(value: Any) -> str:
    """Return a table's cell in words: four figures of a number."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)
