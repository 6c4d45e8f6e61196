"""What a verdict is worth against the truth: one case at a time, no averages here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding.diagnosis.hidden.places import EFFECTS

NOTHING, UNKNOWN, OUTSIDE = "nothing_missing", "unknown_effect", "outside"

PLACES = {
    "storey": ("frame", "storey"),
    "floor": ("frame", "floor"),
    "frame": ("frame",),
    "table": (),
    "channel": ("channel",),
    "contact": ("contact",),
    "between": ("left", "right", "floor"),
}
"""The keys that say where, by kind of place."""

EXPLAINABLE = 1.1
"""A gap counts as explainable when it exceeds the noise floor by this factor."""


@dataclass(frozen=True)
class Judged:
    """One case, judged.

    Attributes:
        kind: ``nothing``, ``single``, ``double``, ``several`` or ``outside``, of the truth.
        effects: Names of what is hidden.
        called: What the verdict says: an effect's name, ``nothing_missing`` or ``unknown_effect``.
        frames: Frames on the table.
        visibility: Of the least visible hidden effect; NaN without one.
        detected: Something was found missing.
        exact: Type and place of every hidden effect are right and nothing else is claimed; for nothing
            hidden that nothing was found, for an outsider that it was called unknown.
        in_class: Every hidden effect is in one of the stated classes (exact verdicts are too).
        confidence: The stated one.
        gap_closed: Share of the explainable held-out gap that was closed; NaN where nothing was explainable.
        parameter_errors: Relative error of each parameter of the effects that were exact; from the
            nearest where a parameter has more than one definition in use.
        seconds: What the diagnosis took [s].
    """

    kind: str
    effects: tuple[str, ...]
    called: str
    frames: tuple[str, ...]
    visibility: float
    detected: bool
    exact: bool
    in_class: bool
    confidence: float
    gap_closed: float
    parameter_errors: tuple[float, ...]
    seconds: float


def judge(truth: Mapping[str, Any], report: Mapping[str, Any], seconds: float = np.nan) -> Judged:
    """Judge a report by the truth.

    Args:
        truth: What was hidden (see `pounding.diagnosis.hidden.hide`).
        report: What was found, with the keys of docs/diagnosis/case-format.md.
        seconds: What it took [s].
    """
    hidden, verdict = truth["effects"], report["verdict"]
    claims = report["effects"] if verdict not in (NOTHING, UNKNOWN) else []
    detected = verdict != NOTHING
    if truth["kind"] == "nothing":
        exact = in_class = not detected
    elif truth["kind"] == OUTSIDE:
        exact = in_class = verdict == UNKNOWN
    else:
        exact = len(claims) == len(hidden) and all(_named(effect, claims) for effect in hidden)
        in_class = exact or (bool(claims) and all(_classed(effect, claims) for effect in hidden))
    return Judged(
        truth["kind"],
        tuple(effect["effect"] for effect in hidden),
        claims[0]["effect"] if claims else verdict,
        tuple(truth["frames"]),
        min((effect["visibility"] for effect in hidden), default=np.nan),
        detected,
        exact,
        in_class,
        np.nan if report.get("confidence") is None else float(report["confidence"]),
        _closed(report),
        _parameter_errors(hidden, claims),
        seconds,
    )


def same(truth: Mapping[str, Any], claim: Mapping[str, Any]) -> bool:
    """Return whether type and place agree."""
    if truth["effect"] != claim["effect"]:
        return False
    return all(truth.get(key) == claim.get(key) for key in PLACES[EFFECTS[truth["effect"]].place])


def _named(truth: Mapping[str, Any], claims: Sequence[Mapping[str, Any]]) -> Mapping[str, Any] | None:
    return next((claim for claim in claims if same(truth, claim)), None)


def _classed(truth: Mapping[str, Any], claims: Sequence[Mapping[str, Any]]) -> bool:
    return any(same(truth, member) for claim in claims for member in (claim, *(claim.get("class") or ())))


def _closed(report: Mapping[str, Any]) -> float:
    """Return the share of the held-out gap above the noise floor that the effects closed.

    What is named of a contact alone is judged by the gap of the impacts: forces are known inputs to the frames' motion.
    """
    gaps = report.get("gap") or {}
    if report["effects"] and all(
        EFFECTS[one["effect"]].place in ("contact", "between") for one in report["effects"]
    ):
        gap = (gaps.get("contact") or {"before": np.nan, "after": np.nan}) | {"noise_floor": 1.0}
    else:
        gap = gaps.get("held_out")
    if not gap or not gap["before"] >= EXPLAINABLE * gap["noise_floor"]:
        return np.nan
    return float((gap["before"] - gap["after"]) / (gap["before"] - gap["noise_floor"]))


def _parameter_errors(
    hidden: Sequence[Mapping[str, Any]], claims: Sequence[Mapping[str, Any]]
) -> tuple[float, ...]:
    errors = []
    for effect in hidden:
        claim = _named(effect, claims)
        if claim is None:
            continue
        found = {parameter["name"]: parameter["value"] for parameter in claim["parameters"]}
        for parameter in effect["parameters"]:
            value = found.get(parameter["name"])
            if isinstance(value, int | float) and isinstance(parameter["value"], int | float):
                stated = [parameter["value"], *parameter.get("also", ())]
                errors.append(min(abs(value / one - 1) for one in stated))
    return tuple(errors)
