"""`case.toml`: its keys as structs, and the line that a complaint is about."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from pounding.diagnosis.case.case import Case, Prior
from pounding.diagnosis.case.checks import check, check_what_is_measured, suggest
from pounding.diagnosis.case.number_tables import ModalTable, PeakTable
from pounding.diagnosis.case.places import FILE, Places
from pounding.diagnosis.case.tables import ChannelTable, ContactTable, Description, FrameTable, RunTable
from pounding.diagnosis.errors import CaseError
from pounding.frames.definition import PlateFrame, StickFrame
from pounding.toml_text import in_words, tree_of

TABLES: dict[str, type[msgspec.Struct]] = {
    "frame": FrameTable,
    "run": RunTable,
    "channel": ChannelTable,
    "contact": ContactTable,
    "modal": ModalTable,
    "peak": PeakTable,
    "prior": Prior,
}


def read_description(folder: Path) -> tuple[Case, list[tuple[str, str | None]]]:
    """Read `case.toml`.

    Args:
        folder: The folder that holds it.

    Returns:
        The case without its runs, and the file and role of each run.

    Raises:
        CaseError: The file cannot be read or contradicts itself.
    """
    path = folder / FILE
    if not folder.is_dir():
        raise CaseError(f"{folder} is not a folder; a case is a folder with {FILE} and its CSV files")
    if not path.is_file():
        raise CaseError(f"{folder} holds no {FILE}; a case is a folder with {FILE} and its CSV files")
    content = path.read_bytes()
    raw = tree_of(content, str(path), CaseError)
    return described_by(raw, folder, Places(path, content.decode("utf-8-sig")))


def described_by(
    raw: dict[str, Any], folder: Path, places: Places
) -> tuple[Case, list[tuple[str, str | None]]]:
    """Return what `read_description` does, of the tree of a `case.toml`.

    Args:
        raw: The tree.
        folder: Folder of the case.
        places: Where things stand in the file.

    Raises:
        CaseError: The tree contradicts itself, or is none of a case.
    """
    for error in missing_tables(raw, places):
        raise error
    case, files = described_in_part(raw, folder, places)
    if files and not case.peaks:
        check_what_is_measured(case.channels, places)
    return case, files


def missing_tables(raw: Mapping[str, Any], places: Places) -> list[CaseError]:
    """Return an error for each table that a case needs and that is not there.

    Args:
        raw: The tree of a `case.toml`.
        places: Where things stand in the file.
    """
    # Modal data need no shaking: a case may hold nothing else.
    needed = ("frame",) if raw.get("modal") else ("frame", "run", "channel")
    return [
        places.error(f"there is no [[{table}]]; a case needs at least one")
        for table in needed
        if not raw.get(table)
    ]


def described_in_part(
    raw: dict[str, Any], folder: Path, places: Places
) -> tuple[Case, list[tuple[str, str | None]]]:
    """Return what `described_by` does, of a tree in which runs and channels may be missing.

    Args:
        raw: The tree, with a frame at least.
        folder: Folder of the case.
        places: Where things stand in the file.

    Raises:
        CaseError: What is in the tree contradicts itself, or is not of a case.
    """
    return check(_convert(raw, places), folder, places)


def _convert(raw: dict[str, Any], places: Places) -> Description:
    """Return the structs, or an error in which msgspec's path has become a line and a suggestion."""
    try:
        return msgspec.convert(raw, Description)
    except (msgspec.ValidationError, OverflowError) as error:
        message, _, path = str(error).partition(" - at `$")
        steps = re.match(r"\.?(\w+)?(?:\[(\d+)\])?(?:\.(\w+))?", path.rstrip("`"))
        found = steps.groups() if steps else ()
        table, number, key = (found[0] or "", int(found[1] or 0), found[2] or "") if found else ("", 0, "")
        if table and not key and table not in TABLES:
            # A key of the whole file.
            table, key = "", table
        unknown = re.search(r"unknown field `(.+?)`", message)
        missing = re.search(r"missing required field `(.+?)`", message)
        name = _name(raw, table, number)
        if unknown:
            known = list(TABLES.get(table, Description).__struct_fields__)
            meant = _of_a_frame_file(unknown[1]) if table == "frame" else ""
            what = f"{name}unknown key {unknown[1]!r}{meant or suggest(unknown[1], known)}"
            raise places.error(what, table, number, unknown[1]) from None
        if missing:
            what = f"{name}the key {missing[1]!r} is missing; add it"
            raise places.error(what, table, number) from None
        named = f"`{key}`: " if key else ""
        said = in_words(message)
        what = f"{name}{named}{said[0].lower()}{said[1:]}; correct the value"
        raise places.error(what, table, number, key) from None


def _of_a_frame_file(key: str) -> str:
    """Return the end of a sentence for a key that belongs into a frame file, else nothing."""
    if not any(key in definition.__struct_fields__ for definition in (StickFrame, PlateFrame)):
        return ""
    return "; it belongs into a frame file: write the frame there, and name the file by the key 'file' here"


def _name(raw: dict[str, Any], table: str, index: int) -> str:
    items = raw.get(table)
    item = items[index] if isinstance(items, list) and index < len(items) else {}
    name = item.get("name") or item.get("file") if isinstance(item, dict) else None
    return f"{table} {name!r}: " if name else (f"[{table}]: " if table == "prior" else "")
