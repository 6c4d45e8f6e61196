"""`case.toml`: its keys as structs, and the line that a complaint is about."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import msgspec

from diagnosis.case import Case, Prior
from diagnosis.case_checks import check, suggest
from diagnosis.case_numbers import ModalTable, PeakTable
from diagnosis.errors import CaseError

FILE = "case.toml"


class FrameTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[frame]]``."""

    name: str = ""
    file: str | None = None
    storeys: int | None = None
    storey_height_m: float | None = None
    floor_mass_kg: list[float] | None = None
    frequency_hz: list[float] | None = None
    damping_ratio: list[float] | None = None
    joints: str | None = None
    p_delta: bool | None = None


class RunTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[run]]``."""

    file: str
    role: str | None = None


class ChannelTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[channel]]``."""

    name: str
    quantity: str
    unit: str
    frame: str | None = None
    floor: int | None = None
    contact: int | None = None


class ContactTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[contact]]``."""

    left: str
    right: str
    floor: int
    gap_mm: float
    law: str
    stiffness_n_per_m: float
    damping_n_s_per_m: float | None = None
    restitution: float | None = None


class Description(msgspec.Struct, forbid_unknown_fields=True):
    """The whole of `case.toml`."""

    frame: list[FrameTable]
    run: list[RunTable] = []
    channel: list[ChannelTable] = []
    title: str = ""
    modal: list[ModalTable] = []
    peak: list[PeakTable] = []
    contact: list[ContactTable] = []
    prior: Prior = Prior()


TABLES: dict[str, type[msgspec.Struct]] = {
    "frame": FrameTable,
    "run": RunTable,
    "channel": ChannelTable,
    "contact": ContactTable,
    "modal": ModalTable,
    "peak": PeakTable,
    "prior": Prior,
}


class Places:
    """Where things stand in `case.toml`, to name the line in a message."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.lines = text.splitlines()

    def line(self, table: str, index: int = 0, key: str = "") -> int | None:
        """Return the line of the `index`-th ``[[table]]``, or of one of its keys, counted from 1."""
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
        """Return a `CaseError` that begins with file and line."""
        line = self.line(table, index, key) if table else None
        where = f"{FILE} line {line}" if line else FILE
        return CaseError(f"{where}: {what}")


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
    try:
        text = path.read_text(encoding="utf-8-sig")
        raw = tomllib.loads(text)
    except UnicodeDecodeError:
        raise CaseError(f"{path} is not a text file in UTF-8; save it as such") from None
    except tomllib.TOMLDecodeError as error:
        raise CaseError(f"{path} is not valid TOML: {error}; correct the file there") from None
    places = Places(path, text)
    described = _convert(raw, places)
    return check(described, folder, places)


def _convert(raw: dict[str, Any], places: Places) -> Description:
    """Return the structs, or an error in which msgspec's path has become a line and a suggestion."""
    # Modal data need no shaking: a case may hold nothing else.
    for table in ("frame",) if raw.get("modal") else ("frame", "run", "channel"):
        if not raw.get(table):
            raise places.error(f"there is no [[{table}]]; a case needs at least one")
    try:
        return msgspec.convert(raw, Description)
    except msgspec.ValidationError as error:
        message, _, path = str(error).partition(" - at `$")
        steps = re.match(r"\.?(\w+)?(?:\[(\d+)\])?(?:\.(\w+))?", path.rstrip("`"))
        found = steps.groups() if steps else ()
        table, number, key = (found[0] or "", int(found[1] or 0), found[2] or "") if found else ("", 0, "")
        unknown = re.search(r"unknown field `(.+?)`", message)
        missing = re.search(r"missing required field `(.+?)`", message)
        name = _name(raw, table, number)
        if unknown:
            known = list(TABLES.get(table, Description).__struct_fields__)
            what = f"{name}unknown key {unknown[1]!r}{suggest(unknown[1], known)}"
            raise places.error(what, table, number, unknown[1]) from None
        if missing:
            what = f"{name}the key {missing[1]!r} is missing; add it"
            raise places.error(what, table, number) from None
        named = f"`{key}`: " if key else ""
        what = f"{name}{named}{message[0].lower()}{message[1:]}; correct the value"
        raise places.error(what, table, number, key) from None


def _name(raw: dict[str, Any], table: str, index: int) -> str:
    items = raw.get(table)
    item = items[index] if isinstance(items, list) and index < len(items) else {}
    name = item.get("name") or item.get("file") if isinstance(item, dict) else None
    return f"{table} {name!r}: " if name else (f"[{table}]: " if table == "prior" else "")
