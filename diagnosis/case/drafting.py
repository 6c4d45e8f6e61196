"""A first `case.toml` from the headers of a logger's CSV files: what a column measures is guessed from its name."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pounding import units
from pounding.contact import LinearViscoelastic, thesis_law
from pounding.diagnosis.case.csv import cells_of
from pounding.diagnosis.case.quantities import UNITS
from pounding.diagnosis.case.time_stamps import TIME
from pounding.diagnosis.errors import CaseError
from pounding.experiments import csv_table

GAP_MM = 10.0
"""What stands in a draft for a gap that nobody has stated yet [mm]."""
_TIME = re.compile(r"t|time|seconds|zeit", re.IGNORECASE)
_TABLE = re.compile(r"table|base|ground|shaker|platen|floor ?0|(?<![a-z])(?:tbl|gnd)(?![a-z])", re.IGNORECASE)
_FORCE = re.compile(r"force|load ?cell|contact", re.IGNORECASE)
_ABSOLUTE = re.compile(r"abs", re.IGNORECASE)
_WORDS = {
    "acceleration": re.compile(r"acc|(?<![a-z])a(?![a-z])", re.IGNORECASE),
    "displacement": re.compile(r"disp|lvdt|laser|(?<![a-z])[du](?![a-z])", re.IGNORECASE),
    "velocity": re.compile(r"vel|(?<![a-z])v(?![a-z])", re.IGNORECASE),
}
_KINDS = {
    "acceleration": units.ACCELERATION,
    "displacement": units.LENGTH,
    "velocity": units.VELOCITY,
    "force": units.FORCE,
}
_USUAL = {"acceleration": "m/s^2", "displacement": "mm", "velocity": "mm/s", "force": "N"}


@dataclass(frozen=True)
class Standing:
    """A frame on the table.

    Attributes:
        name: What the case calls it: the name of a shipped frame, or that in its file.
        storeys: Its storeys.
        file: Its file's path relative to the case; None for a shipped frame.
    """

    name: str
    storeys: int
    file: str | None = None


@dataclass(frozen=True)
class Column:
    """What a column of a CSV file seems to measure.

    Attributes:
        name: Its name in the header.
        quantity: One of `UNITS`; None where the name says nothing.
        unit: The unit it seems to be in.
        floor: The floor it seems to be on; None on the table.
        frame: The frame it seems to be on, of two; None where there is one.
        doubts: What the name does not say, by the key of `case.toml` that it concerns.
    """

    name: str
    quantity: str | None
    unit: str
    floor: int | None
    frame: str | None = None
    doubts: Mapping[str, str] = field(default_factory=dict)


def guess(name: str, frames: Sequence[Standing]) -> Column:
    """Return what a column seems to measure, by its name alone.

    Args:
        name: Its name in the header, such as ``acc floor 3 [g]``.
        frames: The frame, or two from left to right: a name without a number is taken to be of the roof, one without a
            frame's name (or left, right) of the left one.
    """
    words, unit = _parted(name)
    doubts: dict[str, str] = {}
    number, words = _of_frame(words, frames)
    frame = frames[number or 0]
    kind = next((kind for kind, known in _KINDS.items() if unit in known), None)
    if kind is None:
        kind = "force" if _FORCE.search(words) else _by_word(words)
        if kind is None and not _TABLE.search(words):
            return Column(name, None, "", None)
        kind = kind or "acceleration"
        unit = _USUAL[kind]
        doubts["unit"] = "the name has no unit"
    on_table = bool(_TABLE.search(words))
    quantity = _quantity(kind, on_table, bool(_ABSOLUTE.search(words)))
    if quantity == "relative_displacement" and not re.search("rel", words, re.IGNORECASE):
        doubts["quantity"] = "relative to the table, or absolute_displacement in the room"
    if unit not in UNITS[quantity]:
        unit = next(iter(UNITS[quantity]))
        doubts["unit"] = "the column's unit is not read: convert it"
    if on_table or kind == "force":
        return Column(name, quantity, unit, None, doubts=doubts)
    if number is None and len(frames) > 1:
        doubts["frame"] = "the name has none, so the left one is taken"
    numbers = [int(number) for number in re.findall(r"\d+", words)]
    floor = numbers[-1] if numbers else frame.storeys
    if not numbers:
        doubts["floor"] = "the name has none, so the roof is taken"
    elif not 1 <= floor <= frame.storeys:
        doubts["floor"] = f"the frame has the floors 1 to {frame.storeys}"
    return Column(name, quantity, unit, floor, frame.name if len(frames) > 1 else None, doubts)


def _of_frame(words: str, frames: Sequence[Standing]) -> tuple[int | None, str]:
    """Return the number of the frame that words name, from 0, and the words without its name, which may have digits."""
    for number, frame in enumerate(frames):
        # Of 15B and 5B the one is no end of the other.
        found = re.search(rf"(?<![a-z0-9]){re.escape(frame.name)}(?![a-z0-9])", words, re.IGNORECASE)
        if found:
            return number, words[: found.start()] + " " + words[found.end() :]
    for number, side in enumerate(("left", "right")[: len(frames)]):
        if re.search(rf"(?<![a-z]){side}(?![a-z])", words, re.IGNORECASE):
            return number, words
    return None, words


def _parted(name: str) -> tuple[str, str | None]:
    """Return the words of a name and the unit in it: in brackets, or the longest end after a blank or underscore."""
    inside = re.search(r"[\[(]([^\])]+)[\])]", name)
    if inside:
        return (name[: inside.start()] + name[inside.end() :]).replace("_", " "), units.named(inside[1])
    for place in (found.start() for found in re.finditer(r"[ _]", name)):
        unit = units.named(name[place + 1 :])
        if unit:
            return name[:place].replace("_", " "), unit
    return name.replace("_", " "), None


def _by_word(words: str) -> str | None:
    return next((kind for kind, pattern in _WORDS.items() if pattern.search(words)), None)


def _quantity(kind: str, on_table: bool, absolute: bool) -> str:
    if kind == "force":
        return "contact_force"
    if kind == "velocity":
        return "relative_velocity"
    if on_table:
        return f"table_{kind}"
    return f"{'absolute' if kind == 'acceleration' or absolute else 'relative'}_{kind}"


def header_of(path: Path) -> list[str]:
    """Return the names of the columns of a CSV file.

    Args:
        path: The file.

    Raises:
        CaseError: It cannot be read, or its first column is not the time.
    """
    if not path.is_file():
        raise CaseError(f"{path} is not there; name the CSV files of the runs")
    header, _, _ = cells_of(path)
    if all(csv_table.is_number(cell) for cell in header):
        raise CaseError(f"{path.name} line 1: there is no header; name the columns, the first one {TIME}")
    if time_unit(header[0]) is None:
        known = " or ".join(units.TIME)
        raise CaseError(
            f"{path.name} line 1: the first column is {header[0]!r}; it must be the time in {known}, such as {TIME!r}"
        )
    return header


def time_unit(name: str) -> str | None:
    """Return the unit of a column of times, seconds where its name has none; None where it is no such column.

    Args:
        name: Its name in the header.
    """
    words, unit = _parted(name)
    if unit is None and _TIME.fullmatch(name.strip()):
        return units.si(units.TIME)
    return unit if _TIME.fullmatch(words.strip()) and unit in units.TIME else None


def draft(frames: Sequence[Standing], files: Sequence[str], columns: Sequence[str]) -> str:
    """Return the text of a `case.toml`, with a comment at everything that is a guess.

    Args:
        frames: The frame, or two that may touch, from left to right.
        files: Names of the CSV files of the runs, in the folder of the case.
        columns: Names of their columns without the time.
    """
    lines = ["# A first draft from the headers of the CSV files. Check every line that says 'guess'.", ""]
    for frame in frames:
        key, value = ("name", frame.name) if frame.file is None else ("file", frame.file)
        lines += ["[[frame]]", f"{key} = {json.dumps(value)}", ""]
    for number, file in enumerate(files):
        lines += ["[[run]]", f"file = {json.dumps(file)}"]
        if number == len(files) - 1 and number:
            lines.append(
                '# role = "held_out"   # a run that is not fitted judges the result: this one, unless it is the largest'
            )
        lines.append("")
    for column in (guess(name, frames) for name in columns):
        lines += [*_channel(column, len(frames) > 1), ""]
    if len(frames) > 1:
        lines += [*_contact(*frames), ""]
    return "\n".join(lines)


def _channel(column: Column, pair: bool) -> list[str]:
    if column.quantity is None:
        said = f"# column {json.dumps(column.name)}: its name says nothing. A channel needs name, quantity and unit:"
        return [said, f"# {', '.join(UNITS)}"]
    values = {"quantity": json.dumps(column.quantity), "unit": json.dumps(column.unit)}
    if column.frame is not None:
        values["frame"] = json.dumps(column.frame)
    if column.floor is not None:
        values["floor"] = str(column.floor)
    lines = ["[[channel]]", f"name = {json.dumps(column.name, ensure_ascii=False)}"]
    lines += [f"{key} = {value}   # guess{_reason(column, key)}" for key, value in values.items()]
    if column.quantity == "contact_force" and pair:
        lines.append("contact = 1   # the [[contact]] below; compression is positive")
    elif column.quantity == "contact_force":
        lines = [f"# {line}" for line in lines]
        lines.insert(
            0, "# A force needs two frames and a [[contact]] between them (docs/diagnosis/case-format.md):"
        )
    return lines


def _contact(left: Standing, right: Standing) -> list[str]:
    """Return a contact between the roof of the lower frame and the floor beside it, by the laboratory's numbers."""
    law = thesis_law("linear_viscoelastic")
    assert isinstance(law, LinearViscoelastic)
    known = "of the laboratory's floors; yours by tests or by pounding pound, which estimates them"
    return [
        "[[contact]]",
        f"left = {json.dumps(left.name)}   # moves in +x towards the right one",
        f"right = {json.dumps(right.name)}",
        f"floor = {min(left.storeys, right.storeys)}   # guess: the roof of the lower frame",
        f"gap_mm = {GAP_MM:g}   # guess: measure it",
        f'law = "{law.name}"   # guess',
        f"stiffness_n_per_m = {law.stiffness:g}   # guess: {known}",
        f"damping_n_s_per_m = {law.damping:g}   # guess: the same",
    ]


def _reason(column: Column, key: str) -> str:
    return f": {column.doubts[key]}" if key in column.doubts else ", from the name"
