"""Tables of numbers in CSV files: cells with the lines they stand on, and what is wrong with a cell in one sentence."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pounding.errors import InputError

DROPOUTS = frozenset({"", "nan"})
"""Cells that stand for a sample that was lost, in lower case."""


@dataclass(frozen=True)
class Cells:
    """Rows of a text with cells, blank lines left out.

    Attributes:
        lines: Line of each row in the text, counted from 1.
        rows: Cells of each row, without the blanks around them.
    """

    lines: list[int]
    rows: list[list[str]]


def split(
    text: str, where: str, error: type[InputError], *, separator: str | None = ",", comment: str = ""
) -> Cells:
    """Return the cells of a text.

    Args:
        text: The text of the file.
        where: The file for the message.
        error: What is raised.
        separator: What stands between two cells; None for blanks.
        comment: What a line begins with that is left out; nothing for none.

    Raises:
        InputError: The text is not CSV.
    """
    lines = ["" if comment and line.lstrip().startswith(comment) else line for line in text.splitlines()]
    if separator is None:
        numbered = [(number, line.split()) for number, line in enumerate(lines, 1)]
    else:
        reader = csv.reader(lines, delimiter=separator)
        try:
            numbered = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
        except csv.Error as wrong:
            raise error(f"{where} line {reader.line_num}: {wrong}; export it as plain CSV") from None
    # A row of dropouts keeps its time, so a row without any cell is a blank line.
    filled = [(number, row) for number, row in numbered if any(row)]
    return Cells([number for number, _ in filled], [row for _, row in filled])


def numbers(
    header: list[str], cells: Cells, where: str, error: type[InputError], *, column: str = "column"
) -> NDArray[np.float64]:
    """Return the cells as numbers, NaN for a dropout, shape (rows, columns).

    Args:
        header: Name of each column.
        cells: The rows below the header.
        where: The file for the message.
        error: What is raised.
        column: What the message calls a column.

    Raises:
        InputError: A row with more or fewer cells than the header, or a cell that is no finite number.
    """
    for line, row in zip(cells.lines, cells.rows, strict=True):
        if len(row) != len(header):
            raise error(
                f"{where} line {line}: {len(row)} cells under {len(header)} columns; "
                "leave the cell of a dropout empty but keep its comma"
            )
    try:
        table = np.array([[cell or "nan" for cell in row] for row in cells.rows], dtype=float)
    except ValueError:
        table = np.full((len(cells.rows), len(header)), np.inf)
    if np.isinf(table).any():
        for line, row in zip(cells.lines, cells.rows, strict=True):
            for name, cell in zip(header, row, strict=True):
                if cell.lower() not in DROPOUTS and not is_finite(cell):
                    raise error(
                        f"{where} line {line}, {column} {name!r}: {cell!r} is no number; "
                        "write a number, or leave the cell of a dropout empty"
                    )
    return table.reshape(len(cells.rows), len(header))


def is_number(cell: str) -> bool:
    """Return whether a cell is a number, finite or not."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def is_finite(cell: str) -> bool:
    """Return whether a cell is a finite number."""
    return is_number(cell) and math.isfinite(float(cell))
