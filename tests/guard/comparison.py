"""What of a report is kept, and how another report differs from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

PLACE = ("effect", "frame", "storey", "floor", "channel", "contact", "left", "right")
SHARE = 0.1
"""A parameter may move by this share of its standard error."""

Kept = Mapping[str, Any]


def kept(report: Mapping[str, Any], cpu_s: float) -> dict[str, Any]:
    """Return of a report what is compared: verdict, effects with places and parameters; and its CPU time [s].

    The keys are the same in schema 1 and 2.
    """
    return {
        "verdict": report["verdict"],
        "effects": [
            {key: effect[key] for key in PLACE if effect.get(key) is not None}
            | {
                "parameters": {
                    one["name"]: {"value": one["value"], "std": one["std"], "unit": one["unit"]}
                    for one in effect["parameters"]
                }
            }
            for effect in report["effects"]
        ],
        "cpu_s": round(cpu_s, 1),
    }


def differences(expected: Kept, found: Kept) -> list[str]:
    """Return a sentence for each thing in which a case differs from what is expected; none where it is the same."""
    told = []
    if found["verdict"] != expected["verdict"]:
        told.append(f"verdict {found['verdict']}, was {expected['verdict']}")
    before, now = ({_place(one): one for one in kept["effects"]} for kept in (expected, found))
    told += [f"{place} is no longer there" for place in before if place not in now]
    told += [f"{place} is new" for place in now if place not in before]
    for place in before:
        if place in now:
            told += _moved(place, before[place]["parameters"], now[place]["parameters"])
    return told


def _place(effect: Mapping[str, Any]) -> str:
    return " ".join(
        f"{effect[key]}" if key == "effect" else f"{key} {effect[key]}" for key in PLACE if key in effect
    )


def _moved(place: str, before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    told = []
    if before.keys() != now.keys():
        told.append(f"{place} has the parameters {', '.join(now)}, had {', '.join(before)}")
    for name in before.keys() & now.keys():
        old, new = before[name], now[name]
        moved = abs(new["value"] - old["value"])
        # NaN, of an effect without a standard error, counts as moved unless the value is the very same.
        if old["unit"] != new["unit"] or (moved and not moved <= SHARE * old["std"]):
            told.append(
                f"{place}: {name} {new['value']:.6g} {new['unit']}, was {old['value']:.6g} +- {old['std']:.2g}"
                f" {old['unit']} ({moved / old['std'] if old['std'] else float('inf'):.2f} standard errors)"
            )
    return told
