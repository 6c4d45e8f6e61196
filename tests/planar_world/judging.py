"""Diagnosing the cases of a set from their files alone, and counting what is right: the only place that asks `diagnose`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HEAD = ("case", "frame", "hidden", "verdict", "named", "held out: before, after (floor) [%]")


@dataclass(frozen=True)
class Effect:
    """An effect and its place.

    Attributes:
        name: In the diagnosis' catalogue.
        storey, floor: Counted from 1; None where it is in no single one.
        channel: Of a sensor's fault.
    """

    name: str
    storey: int | None = None
    floor: int | None = None
    channel: str | None = None

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> Effect:
        """Return what an object of JSON says, of a truth or of a report."""
        return cls(entry["effect"], entry.get("storey"), entry.get("floor"), entry.get("channel"))

    def __str__(self) -> str:
        where = next((f":{place}" for place in (self.storey, self.floor, self.channel) if place), "")
        return f"{self.name}{where}"


@dataclass(frozen=True)
class Named:
    """An effect that a report names.

    Attributes:
        effect: What and where.
        size: Its first parameter, in words.
        alike: What the data cannot tell from it, the likeliest first, itself among them.
    """

    effect: Effect
    size: str
    alike: tuple[Effect, ...]

    @classmethod
    def of(cls, claim: Mapping[str, Any]) -> Named:
        """Return what a report's JSON says of an effect."""
        sizes = [_size(one) for one in claim["parameters"][:1]]
        return cls(Effect.of(claim), "".join(sizes), tuple(Effect.of(one) for one in claim["class"]))

    def __str__(self) -> str:
        alike = f", one of {len(self.alike)} alike" if len(self.alike) > 1 else ""
        return " ".join([f"`{self.effect}`", self.size]).rstrip() + alike


def _size(parameter: Mapping[str, Any]) -> str:
    name = parameter["name"].replace("_", " ")
    value, std = parameter["value"], parameter.get("std")
    if not isinstance(value, float | int):
        return f"{name} {value or 'unknown'}"
    unit = "" if parameter["unit"] in ("", "1", "-") else f" {parameter['unit']}"
    return f"{name} {value:.3g}" + ("" if std is None else f" ± {std:.2g}") + unit


@dataclass(frozen=True)
class Judged:
    """A case with its truth and what the diagnosis says of it.

    Attributes:
        case, frame: Names.
        hidden: The true effects; of those outside the catalogue the name is in words.
        outside: Whether what is hidden is in no catalogue.
        verdict: Of the report.
        named: Its effects; where the verdict names none, what comes nearest.
        misfit: Before, after, and what noise would leave, of the held-out run [-]; None where it is not known.
    """

    case: str
    frame: str
    hidden: tuple[Effect, ...]
    outside: bool
    verdict: str
    named: tuple[Named, ...]
    misfit: tuple[float | None, ...]

    @classmethod
    def of(cls, truth: Mapping[str, Any], report: Mapping[str, Any]) -> Judged:
        """Return a case from the objects of its truth and of its report."""
        held_out = report["misfit"]["held_out"] or {}
        return cls(
            truth["case"],
            truth["frame"],
            tuple(Effect.of(entry) for entry in truth["effects"]),
            truth["outside"],
            report["verdict"],
            tuple(Named.of(claim) for claim in report["effects"]),
            tuple(held_out.get(name) for name in ("before", "after", "noise_floor")),
        )

    @property
    def exact(self) -> bool:
        """Whether it is said what is hidden, each effect with its place, and nothing else."""
        named = {one.effect for one in self.named}
        return self.verdict == "effect_named" and named == set(self.hidden)

    @property
    def class_with_truth_first(self) -> bool:
        """Whether a class of one effect is said of which the first is what is hidden."""
        if self.verdict != "effect_class" or len(self.named) != 1:
            return False
        return self.named[0].alike[:1] == self.hidden

    def cells(self) -> list[str]:
        """Return the cells of its row."""
        before, after, floor = ("?" if one is None else f"{100 * one:.3g}" for one in self.misfit)
        hidden = ", ".join(f"`{effect}`" for effect in self.hidden) or "nothing"
        named = "; ".join(str(one) for one in self.named) or "-"
        named = f"(nearest: {named})" if self.named and self.verdict == "unknown_effect" else named
        verdict = self.verdict.replace("_", " ")
        return [self.case, self.frame, hidden, verdict, named, f"{before}, {after} ({floor})"]


def report_of(folder: Path, kept: Path) -> dict[str, Any]:
    """Return the report on a case as an object of JSON.

    Args:
        folder: Of the case.
        kept: File of the report; where it is there, the case is not diagnosed again.
    """
    if not kept.is_file():
        from pounding.diagnosis.workflow import diagnose

        text = diagnose(folder).json()
        kept.parent.mkdir(parents=True, exist_ok=True)
        part = kept.with_suffix(".part")
        part.write_text(text, encoding="utf-8")
        part.replace(kept)
    return dict(json.loads(kept.read_text(encoding="utf-8")))


def row(cells: Sequence[str]) -> str:
    """Return a row of a table of Markdown."""
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def summary(cases: Sequence[Judged]) -> list[str]:
    """Return lines that count what is right."""
    nulls = [one for one in cases if not one.hidden]
    outside = [one for one in cases if one.outside]
    singles = [one for one in cases if len(one.hidden) == 1 and not one.outside]
    doubles = [one for one in cases if len(one.hidden) == 2]
    counts = [
        ("false alarms among nulls", [one.verdict != "nothing_missing" for one in nulls]),
        ("singles detected", [one.verdict != "nothing_missing" for one in singles]),
        ("singles named exactly, type and place", [one.exact for one in singles]),
        ("singles as a class with the truth first", [one.class_with_truth_first for one in singles]),
        ("doubles exact", [one.exact for one in doubles]),
        ("outside the catalogue, unknown", [one.verdict == "unknown_effect" for one in outside]),
    ]
    return [f"{what}: {sum(found)} of {len(found)}" for what, found in counts]
