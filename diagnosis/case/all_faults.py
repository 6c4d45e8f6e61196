"""Everything that is wrong with a measured case at once: what is found is set aside, and the rest is read again."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pounding import bounds
from pounding.diagnosis.case.case import Case, Channel
from pounding.diagnosis.case.checks import check_what_is_measured
from pounding.diagnosis.case.csv import faults_of_run
from pounding.diagnosis.case.places import FILE, Places
from pounding.diagnosis.case.quantities import UNITS
from pounding.diagnosis.case.tables import Description
from pounding.diagnosis.case.time_stamps import TIME
from pounding.diagnosis.case.toml import TABLES, described_in_part, missing_tables, read_description
from pounding.diagnosis.errors import CaseError
from pounding.toml_text import tree_of

OPTIONAL = ("role", "interpolation")
"""Keys that a table can do without: they are set aside alone."""

OF_A_FRAME = ("frame", "floor", "mode")
"""Keys that mean something only beside a frame that could be read."""


class _Remaining(Places):
    """The places of tables of which some are set aside; lines are those of the whole file."""

    def __init__(self, path: Path, text: str, tree: Mapping[str, Any]) -> None:
        super().__init__(path, text)
        self.shortened: set[str] = set()
        self._kept = {
            name: list(range(len(items))) for name, items in tree.items() if isinstance(items, list)
        }

    def line(self, table: str, index: int = 0, key: str = "") -> int | None:
        kept = self._kept.get(table, [])
        return super().line(table, kept[index] if index < len(kept) else index, key)

    def set_aside(self, table: str, index: int) -> None:
        self.shortened.add(table)
        del self._kept[table][index]


class _Faults:
    """A tree from which each fault is taken as it is found, until the rest can be read.

    Attributes:
        found: A sentence for each fault, in the order in which they were found.
    """

    def __init__(self, tree: dict[str, Any], folder: Path, text: str) -> None:
        self.found: dict[str, None] = {}
        self._tree, self._folder = tree, folder
        self._places = _Remaining(folder / FILE, text, tree)
        self._stand_ins: list[dict[str, Any]] = []
        self._repaired: set[str] = set()

    def channels(self) -> list[Channel]:
        """Find the faults of the tree; return the channels whose quantity and unit are without fault."""
        for missing in missing_tables(self._tree, self._places):
            self.found.setdefault(str(missing))
        if not self._tree.get("frame"):
            self._tree["frame"] = [self._stand_in({})]
        incomplete = bool(self.found)
        while True:
            try:
                case, files = described_in_part(self._tree, self._folder, self._places)
            except CaseError as error:
                if not self._only_follows(error):
                    self.found.setdefault(str(error))
                if not self._without(error):
                    return []
            else:
                if files and not incomplete:
                    self._judge_what_is_measured(case)
                return [channel for channel in case.channels if channel.name not in self._repaired]

    def _judge_what_is_measured(self, case: Case) -> None:
        # A channel that was set aside may be the one that seems to be missing.
        if case.peaks or self._places.shortened & {"channel", "peak"}:
            return
        try:
            check_what_is_measured(case.channels, self._places)
        except CaseError as error:
            self.found.setdefault(str(error))

    def _only_follows(self, error: CaseError) -> bool:
        """Return whether an error may be there only because something it refers to was set aside."""
        item = _item(self._tree.get(error.table), error.index)
        if error.table == "peak" and error.key == "run":
            return "run" in self._places.shortened
        if not self._stand_ins or error.key not in OF_A_FRAME or error.table == "frame":
            return False
        sound = [frame.get("name") for frame in self._tree["frame"] if frame not in self._stand_ins]
        return item.get("frame") not in sound

    def _without(self, error: CaseError) -> bool:
        """Take out of the tree what an error is about, as little as possible; return whether there was something."""
        table, key = error.table, error.key
        if not table:
            return self._tree.pop(key, None) is not None
        items = self._tree.get(table)
        item = _item(items, error.index)
        unknown = key not in TABLES.get(table, Description).__struct_fields__
        if key in item and (unknown or key in OPTIONAL or table == "prior"):
            del item[key]
        elif table == "frame":
            return self._without_frame(error.index)
        elif table == "channel" and key == "unit" and (units := _units(item)):
            item["unit"] = units[0]
            self._repaired.add(item["name"])
        elif isinstance(items, list) and error.index < len(items):
            self._set_aside(table, error.index)
        else:
            self._places.shortened.add(table)
            return self._tree.pop(table, None) is not None
        return True

    def _set_aside(self, table: str, index: int) -> None:
        del self._tree[table][index]
        self._places.set_aside(table, index)
        if table == "contact":
            self._without_forces()

    def _without_frame(self, index: int) -> bool:
        """Put another frame in the place of one, so that what does not depend on it can be read."""
        frames = self._tree["frame"]
        if not isinstance(frames, list):
            self._tree["frame"] = [self._stand_in({})]
        elif not isinstance(frames[index], dict) or frames[index] in self._stand_ins:
            frames[index] = self._stand_in({"name": f"frame {len(self._stand_ins)}"})
        else:
            frames[index] = self._stand_in(frames[index])
        # Whether two floors are level, only the frame itself could tell.
        self._tree.pop("contact", None)
        self._without_forces()
        return True

    def _without_forces(self) -> None:
        channels = self._tree.get("channel")
        for index in reversed(range(len(channels) if isinstance(channels, list) else 0)):
            if "contact" in _item(channels, index):
                self._set_aside("channel", index)

    def _stand_in(self, frame: Mapping[str, Any]) -> dict[str, Any]:
        storeys, name = int(bounds.STOREYS.high), frame.get("name")
        stand_in = {
            "name": name if isinstance(name, str) and name else f"frame {len(self._stand_ins)}",
            "storeys": storeys,
            "storey_height_m": 1.0,
            "floor_mass_kg": [1000.0] * storeys,
            "frequency_hz": [1.0],
            "damping_ratio": [0.01],
        }
        self._stand_ins.append(stand_in)
        return stand_in


def all_faults(folder: Path | str) -> list[str]:
    """Return a sentence for each thing that keeps a case from being read; none where it can be read.

    Of one table of `case.toml`, and of one column of a CSV file, a second fault may show only when the first is mended.

    Args:
        folder: The folder that holds `case.toml`.
    """
    folder = Path(folder)
    try:
        read_description(folder)
    except CaseError as error:
        if not (folder / FILE).is_file():
            return [str(error)]
    content = (folder / FILE).read_bytes()
    try:
        tree = tree_of(content, str(folder / FILE), CaseError)
    except CaseError as error:
        return [str(error)]
    files, names = _texts(tree, "run", "file"), _texts(tree, "channel", "name")
    faults = _Faults(tree, folder, content.decode("utf-8-sig"))
    channels = faults.channels()
    of_runs = [fault for file in files for fault in faults_of_run(folder / file, names, channels)]
    return list(dict.fromkeys([*faults.found, *of_runs]))


def _texts(tree: Mapping[str, Any], table: str, key: str) -> list[str]:
    """Return what the tables of a name say under a key, each once, without what is a fault itself."""
    items = tree.get(table)
    said = [_item(items, index).get(key) for index in range(len(items) if isinstance(items, list) else 0)]
    return list(
        dict.fromkeys(t for t in said if isinstance(t, str) and t.isprintable() and t not in ("", TIME))
    )


def _units(channel: Mapping[str, Any]) -> list[str]:
    """Return the units of a channel that is whole but for its unit; none of another one."""
    texts = all(isinstance(channel.get(key), str) for key in ("name", "quantity", "unit"))
    return list(UNITS.get(channel["quantity"], ())) if texts else []


def _item(items: Any, index: int) -> dict[str, Any]:
    """Return a table of a tree; an empty one where there is none."""
    if isinstance(items, list):
        items = items[index] if index < len(items) else None
    return items if isinstance(items, dict) else {}
