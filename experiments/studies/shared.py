"""What several studies do alike with their tables."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from cyclopts import Parameter

from pounding.frames.files import write_whole

Kept = Annotated[
    Path | None, Parameter(help="Folder for finished cases; an interrupted study goes on from it.")
]
Workers = Annotated[int | None, Parameter(help="Processes; default: one a core.")]


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
