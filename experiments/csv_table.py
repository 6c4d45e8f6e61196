"""Tables of numbers in CSV files: cells with the lines they stand on, and what is wrong with a cell in one sentence."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pounding.errors import InputError

DROPOUTS = frozenset({"", "nan"})
"""Cells that stand for a sample that was lost, in lower case."""

NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
"""A number as instruments write it; `float` would take `1_000` and the digits of every script as well."""

_NUMBER = re.compile(NUMBER)
_NOT_FINITE = re.compile(r"[-+]?(?:nan|inf|infinity)", re.IGNORECASE)


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
    # With their ends, so that a quoted cell that runs over lines can be told.
    lines = [
        "\n" if comment and line.lstrip().startswith(comment) else line for line in text.splitlines(True)
    ]
    if separator is None:
        numbered = [(number, line.split()) for number, line in enumerate(lines, 1)]
    else:
        numbered = _parsed(lines, where, error, separator)
    # A row of dropouts keeps its time, so a row without any cell is a blank line.
    filled = [(number, row) for number, row in numbered if any(row)]
    return Cells([number for number, _ in filled], [row for _, row in filled])


def _parsed(
    lines: list[str], where: str, error: type[InputError], separator: str
) -> list[tuple[int, list[str]]]:
    """Return each row with the number of its line; refuse a quotation mark that is never closed, or lines later."""
    # Strict, so that a quotation mark that is never closed does not take the rest of the file into one cell.
    reader = csv.reader(lines, delimiter=separator, strict=True)
    numbered: list[tuple[int, list[str]]] = []
    begun, said = 1, ""
    try:
        for row in reader:
            # A title may be written over lines; with a separator in it, it has taken the cells of other lines.
            if any(separator in cell and ("\n" in cell or "\r" in cell) for cell in row):
                said = "a cell runs over several lines"
                break
            numbered.append((reader.line_num, [cell.strip() for cell in row]))
            begun = reader.line_num + 1
    except csv.Error as wrong:
        said = str(wrong).replace("\n", " ")
    if said:
        raise error(
            f"{where} line {begun}: {said}; close or remove its quotation mark, and export it as plain CSV"
        )
    return numbered


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
    for line, row in zip(cells.lines, cells.rows, strict=True):
        for name, cell in zip(header, row, strict=True):
            if not is_finite(cell) and cell.lower() not in DROPOUTS:
                raise error(
                    f"{where} line {line}, {column} {name!r}: {shown(cell)} is no number; "
                    "write a number, or leave the cell of a dropout empty"
                )
    table = np.array([[cell or "nan" for cell in row] for row in cells.rows], dtype=float)
    return table.reshape(len(cells.rows), len(header))


def is_number(cell: str) -> bool:
    """Return whether a cell is a number, finite or not."""
    return bool(_NUMBER.fullmatch(cell) or _NOT_FINITE.fullmatch(cell))


def is_finite(cell: str) -> bool:
    """Return whether a cell is a finite number."""
    return bool(_NUMBER.fullmatch(cell)) and math.isfinite(float(cell))


def shown(cell: str) -> str:
    """Return a cell for a message: quoted, on one line, and its beginning only if it is long."""
    return repr(cell if len(cell) <= 40 else cell[:37] + "...")
