"""How a verb shows its result: tables for a reader, or one JSON object and nothing else."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console, RenderableType
from rich.table import Table


class Printer(Console):
    """A console that leaves it to `exit_status.run` when the reader of its output (`head`, a pager) has seen enough."""

    def on_broken_pipe(self) -> None:
        """Raise what the pipe raised; rich would end the program with status 1."""
        raise


def printer() -> Printer:
    """Return the console for results: standard output, where units in [brackets] are no markup."""
    return Printer(highlight=False, markup=False)


def emit(
    result: Mapping[str, Any], *, as_json: bool, show: Callable[[], Iterable[RenderableType | str]]
) -> None:
    """Print a result.

    Args:
        result: The whole result, stamped (see `pounding.experiments.results.provenance.stamp`).
        as_json: Print it as one JSON object on standard output, and nothing else there.
        show: Makes the tables and sentences for a reader; called only when they are wanted.
    """
    if as_json:
        json.dump(plain(result), sys.stdout, indent=2, allow_nan=False)
        sys.stdout.write("\n")
        return
    console = printer()
    for item in show():
        console.print(item)


def written(path: Path | None) -> list[str]:
    """Return a line on a file that was written, none without one."""
    return [] if path is None else [f"written: {path}"]


def plain(value: Any) -> Any:
    """Return a value in the types of JSON: arrays as lists, NaN and infinity as null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | int | bool):
        return value
    return str(value)


SHORT = 16
"""Names of so many letters are not broken in the first column of a table."""


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> Table:
    """Return a table with right-aligned numbers; None is shown as a dash.

    Args:
        title: Words above the table.
        columns: Head of each column.
        rows: Cells, as many as columns in each row.
    """
    rows = [list(row) for row in rows]
    shown = Table(title=title, title_justify="left")
    for index, name in enumerate(columns):
        words = any(isinstance(row[index], str) for row in rows)
        # A name too long for a narrow terminal goes on in the next line rather than lose its end; a short one stays whole.
        whole = index == 0 and all(len(f"{row[0]}") <= SHORT for row in rows)
        shown.add_column(name, justify="left" if words else "right", overflow="fold", no_wrap=whole)
    for row in rows:
        shown.add_row(*("–" if cell is None else f"{cell}" for cell in row))
    return shown


def warn(sentence: str) -> None:
    """Print a warning on standard error, where it does not disturb a JSON result."""
    Console(stderr=True, highlight=False).print(f"warning: {sentence}", style="yellow", markup=False)


def progress_console() -> Console:
    """Return the console for progress bars: standard error, so that `--json` stays clean."""
    return Console(stderr=True)
