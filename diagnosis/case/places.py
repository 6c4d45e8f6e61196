"""Where in `case.toml` a complaint belongs: the line of a table or key."""

from __future__ import annotations

import re
from pathlib import Path

from pounding.diagnosis.errors import CaseError

FILE = "case.toml"


class Places:
    """Where things stand in `case.toml`, to name the line in a message."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.lines = text.splitlines()

    def line(self, table: str, index: int = 0, key: str = "") -> int | None:
        """Return the line of the `index`-th ``[[table]]``, or of one of its keys, counted from 1.

        Args:
            table: Name of the table.
            index: Which of the tables of that name, from 0.
            key: Key in the table; the table itself when empty.
        """
        header = re.compile(rf"\s*\[\[?\s*{re.escape(table)}\s*\]\]?")
        starts = [number for number, line in enumerate(self.lines) if header.match(line)]
        if index >= len(starts):
            return None
        for number in range(starts[index] + 1, len(self.lines)):
            if self.lines[number].lstrip().startswith("["):
                break
            if key and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", self.lines[number]):
                return number + 1
        return starts[index] + 1

    def error(self, what: str, table: str = "", index: int = 0, key: str = "") -> CaseError:
        """Return a `CaseError` that begins with file and line.

        Args:
            what: What is wrong and what to do.
            table: Name of the table; the whole file when empty.
            index: Which of the tables of that name, from 0.
            key: Key in the table.
        """
        line = self.line(table, index, key) if table else None
        where = f"{FILE} line {line}" if line else FILE
        error = CaseError(f"{where}: {what}")
        error.table, error.index, error.key = table, index, key
        return error
