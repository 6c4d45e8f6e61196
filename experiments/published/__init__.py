"""The tables of the thesis as data: one CSV file a table, as printed, its place in the thesis beside it.

A file `table_4_1.csv` begins with lines `# key: value`: `title`, `source` (thesis, table, page), `index` (the
columns that name a row), `levels` (what the parts of a column's name, separated by `/`, stand for), `unit`
(where all numbers have the same) and any number of `note`. Then follows a table with a header row. Numbers
are as printed, printed contradictions included; an empty cell is not printed.
"""

from __future__ import annotations

from importlib.resources import files

import pandas as pd

from pounding.experiments.errors import ExperimentError

_FOLDER = files(__name__)
_LISTS = ("index", "levels")


def tables() -> list[str]:
    """Return what can be asked of `table`: numbers of tables, and sections as `section 3.7`."""
    stems = sorted(entry.name[:-4] for entry in _FOLDER.iterdir() if entry.name.endswith(".csv"))
    return [_name(stem) for stem in stems]


def table(number: str) -> pd.DataFrame:
    """Return a table of the thesis as printed.

    Args:
        number: As printed, `4.1`, or `section 3.7` for numbers that stand in the text.

    Returns:
        One row a printed row, indexed by what names it; columns as printed, with several levels where the
        heading has them; numbers where all are numbers, text otherwise. `attrs` holds `title`, `source`,
        `unit` and `notes`.

    Raises:
        ExperimentError: A table that is not here, or whose file does not hold what its head says.
    """
    stem = _stem(number)
    entry = _FOLDER / f"{stem}.csv"
    if not entry.is_file():
        raise ExperimentError(f"table '{number}' of the thesis is not here; there are {', '.join(tables())}")
    return parse(entry.read_text(encoding="utf-8"), f"{stem}.csv")


def long(number: str) -> pd.Series:
    """Return a table with several heading levels as one column of numbers, indexed by rows and headings."""
    wide = table(number)
    levels = list(range(wide.columns.nlevels))
    stacked = pd.Series(wide.stack(levels, future_stack=True))
    return stacked.rename(wide.attrs.get("unit", "value")).dropna()


def parse(text: str, name: str) -> pd.DataFrame:
    """Return the table in the text of one file; see the module for the format.

    Raises:
        ExperimentError: No `title`, `source` or `index`, columns missing, or rows of uneven length.
    """
    head, body = _split(text)
    for key in ("title", "source", "index"):
        if key not in head:
            raise ExperimentError(f"{name}: the head has no line '# {key}: ...'")
    rows = [line.split(",") for line in body]
    short = next((number for number, row in enumerate(rows) if len(row) != len(rows[0])), None)
    if len(rows) < 2 or short is not None:
        raise ExperimentError(
            f"{name}: row {short or 1} has not the {len(rows[0]) if rows else 0} cells of the header"
        )
    frame = pd.DataFrame(rows[1:], columns=rows[0]).replace("", None)
    index = [part.strip() for part in head["index"].split(",")]
    missing = [column for column in index if column not in frame.columns]
    if missing:
        raise ExperimentError(f"{name}: the index names '{missing[0]}', which is no column")
    frame = frame.apply(_numbers).set_index(index)
    if "levels" in head:
        names = [part.strip() for part in head["levels"].split(",")]
        parts = [tuple(str(column).split("/")) for column in frame.columns]
        frame.columns = pd.MultiIndex.from_tuples(parts, names=names)
    frame.attrs = {key: value for key, value in head.items() if key not in _LISTS}
    return frame


def _numbers(column: pd.Series) -> pd.Series:
    """Return a column as numbers if all its cells are, except that frame names such as 10 stay text."""
    if column.name in ("frame", "left", "right"):
        return column.astype(str)
    converted = pd.to_numeric(column, errors="coerce")
    return converted if converted.notna().equals(column.notna()) else column


def _split(text: str) -> tuple[dict[str, str], list[str]]:
    head: dict[str, str] = {}
    notes = []
    lines = [line for line in text.splitlines() if line.strip()]
    for line in lines:
        if line.startswith("#"):
            key, _, value = line[1:].partition(":")
            if key.strip() == "note":
                notes.append(value.strip())
            else:
                head[key.strip()] = value.strip()
    return head | {"notes": "; ".join(notes)}, [line for line in lines if not line.startswith("#")]


def _stem(number: str) -> str:
    plain = number.strip().lower().replace("table", "").strip()
    prefix = "" if plain.startswith(("section", "equation")) else "table "
    return (prefix + plain).replace(" ", "_").replace(".", "_")


def _name(stem: str) -> str:
    kind, _, number = stem.partition("_")
    printed = number.replace("_", ".")
    return printed if kind == "table" else f"{kind} {printed}"
