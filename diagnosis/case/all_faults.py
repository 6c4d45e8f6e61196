"""Everything that is wrong with a measured case at once: what is found is set aside, and the rest is read again."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.csv import read_run
from pounding.diagnosis.case.places import FILE, Places
from pounding.diagnosis.case.toml import described_by, read_description
from pounding.diagnosis.errors import CaseError
from pounding.toml_text import tree_of

NEEDED = ("frame",)
"""Tables that others refer to: without one of them nothing more can be said of those."""


class _Remaining(Places):
    """The places of tables of which some are set aside; lines are those of the whole file."""

    def __init__(self, path: Path, text: str, tree: Mapping[str, Any]) -> None:
        super().__init__(path, text)
        self._kept = {
            name: list(range(len(items))) for name, items in tree.items() if isinstance(items, list)
        }

    def line(self, table: str, index: int = 0, key: str = "") -> int | None:
        kept = self._kept.get(table, [])
        return super().line(table, kept[index] if index < len(kept) else index, key)

    def set_aside(self, table: str, index: int) -> None:
        del self._kept[table][index]


def all_faults(folder: Path | str) -> list[str]:
    """Return a sentence for each thing that keeps a case from being read; none where it can be read.

    Args:
        folder: The folder that holds `case.toml`.
    """
    folder = Path(folder)
    try:
        read_description(folder)
    except CaseError as error:
        if not (folder / FILE).is_file():
            return [str(error)]
    found, case, files = _of_description(folder)
    if case is not None:
        found += [fault for file, role in files for fault in _of_run(case, file, role)]
    return found


def _of_description(folder: Path) -> tuple[list[str], Case | None, list[tuple[str, str | None]]]:
    content = (folder / FILE).read_bytes()
    try:
        tree = tree_of(content, str(folder / FILE), CaseError)
    except CaseError as error:
        return [str(error)], None, []
    places, found = _Remaining(folder / FILE, content.decode("utf-8-sig"), tree), list[str]()
    while True:
        try:
            case, files = described_by(tree, folder, places)
        except CaseError as error:
            # With a table set aside, what is said of the whole file may be said of the gap it left.
            if error.table or not found:
                found.append(str(error))
            if not _without(tree, error, places):
                return found, None, []
        else:
            return found, case, files


def _without(tree: dict[str, Any], error: CaseError, places: _Remaining) -> bool:
    """Take out of a tree what an error is about: an unknown key alone, else its table; return whether that is possible."""
    items = tree.get(error.table)
    if error.table in NEEDED or not items:
        return False
    if isinstance(items, dict):
        return items.pop(error.key, None) is not None
    if error.index >= len(items):
        return False
    if "unknown key" in str(error):
        del items[error.index][error.key]
    else:
        del items[error.index]
        places.set_aside(error.table, error.index)
    return True


def _of_run(case: Case, file: str, role: str | None) -> list[str]:
    """Return what is wrong with a run's file: each channel is read alone, so that one fault hides no other."""
    found: dict[str, None] = {}
    for channel in case.channels:
        try:
            read_run(case.folder / file, [channel], role=role)
        except CaseError as error:
            found.setdefault(str(error))
    return list(found)
