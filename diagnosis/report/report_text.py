"""The report in sentences: the verdict, what would tell more, and what was assumed."""

from __future__ import annotations

from typing import Any

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.quantities import UNITS
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.model.nuisance import (
    BASE_STIFFNESS,
    CHANNEL_DELAY_S,
    CHANNEL_GAIN,
    JOINT_STIFFNESS,
    STRUCK_DAMPING,
)

HIDDEN = 3.0
"""Gap of the worst channel over the median of all from which the worst is told too."""
_STRUCK = (
    f"Frames that collide show their higher modes, whose damping is known {STRUCK_DAMPING:g} times less well."
)
LIKE = 0.03
"""Relative difference below which a sensor's gain is taken for another unit or the wrong polarity."""


def sentence(report: dict[str, Any]) -> str:
    """Return the verdict in one sentence."""
    held_out = report["gap"]["held_out"]
    gap = held_out or report["gap"]["training"]
    run = f"on {held_out['run']}, which was not used," if held_out else "on the runs used"
    before, after, noise = (percent(gap[key]) for key in ("before", "after", "noise_floor"))
    confidence = report["confidence"]
    sure = "more than 99 % sure" if confidence > 0.99 else f"{100 * confidence:.0f} % sure"
    verdict = report["verdict"]
    if verdict == "nothing_missing":
        return f"Nothing is missing that this data could show: the gap {run} is {before}, the noise {noise} ({sure})."
    if verdict == "unknown_effect":
        return (
            f"Something is missing, and nothing in the catalogue fits it: the gap {run} is {before}, "
            f"the noise {noise} ({sure})."
        )
    names = " and ".join(named(effect) for effect in together(report["effects"]))
    change = f"the gap {run} {_moves(before, after)}, where noise alone leaves {noise}{_worst(report)}"
    if verdict == "effect_class":
        alike = report["effects"][0]["class"][1:]
        others = (
            f"{kind_and_place(alike[0])}, which this data cannot tell from it"
            if len(alike) == 1
            else f"one of {len(alike)} others that this data cannot tell from it"
        )
        return f"Missing is {names}, or {others}; {change} ({sure})."
    return f"Missing is {names}; {change} ({sure})."


def _moves(before: str, after: str) -> str:
    return f"stays at {before}" if before == after else f"goes from {before} to {after}"


def _worst(report: dict[str, Any]) -> str:
    """Return what became of the worst channel where the median of all channels does not show it."""
    known = [one for one in report.get("channels", ()) if one["before"] is not None]
    worst = max(known, key=lambda one: one["before"], default=None)
    gap = report["gap"]["held_out"] or report["gap"]["training"]
    if worst is None or worst["before"] < HIDDEN * gap["before"]:
        return ""
    return f", and that of channel {worst['channel']} from {percent(worst['before'])} to {percent(worst['after'])}"


def percent(share: float | None) -> str:
    """Return a share in per cent with three significant digits."""
    return "–" if share is None else f"{100 * share:.3g} %"


def together(effects: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return effects with those of one size on several channels as one, as when a logger is late."""
    found: dict[str, dict[str, Any]] = {}
    for effect in effects:
        key = (
            f"{effect['effect']} {effect['parameters']}" if effect["channel"] is not None else f"{len(found)}"
        )
        if key in found:
            effect = effect | {"channel": f"{found[key]['channel']}, {effect['channel']}"}
        found[key] = effect
    return list(found.values())


def named(effect: dict[str, Any]) -> str:
    """Return an effect in words: what, where, and how large with its standard error."""
    values = ", ".join(_value(parameter) for parameter in effect["parameters"])
    return f"{kind_and_place(effect)} ({values})" if values else kind_and_place(effect)


def kind_and_place(entry: dict[str, Any]) -> str:
    """Return what and where, in words."""
    words = str(entry["effect"]).replace("_", " ")
    if entry.get("channel") is not None:
        several = "s" if ", " in entry["channel"] else ""
        return f"{words} of channel{several} {entry['channel']}"
    for key in ("storey", "floor", "contact"):
        if entry.get(key) is not None:
            words += f" {'on' if key == 'floor' else 'in'} {key} {entry[key]}"
    if entry.get("left"):
        return f"{words} between {entry['left']} and {entry['right']}"
    return f"{words} of {entry['frame']}" if entry.get("frame") else words


def _value(parameter: dict[str, Any]) -> str:
    name, value, std = parameter["name"].replace("_", " "), parameter["value"], parameter.get("std")
    unit = "" if parameter["unit"] in ("", "1", "-", None) else f" {parameter['unit']}"
    if isinstance(value, str):
        return f"{name} {value}"
    return f"{name} {value:.3g}{unit}" if std is None else f"{name} {value:.3g} ± {std:.2g}{unit}"


def advice(case: Case, found: Findings, report: dict[str, Any]) -> list[str]:
    """Return what would tell more, beside the tests that part what looks alike."""
    said = list(report.get("advice", ()))
    if not found.held_out:
        said.append(
            "A second run would allow a judgement on data that was not used; there is no held-out run here."
        )
    said += [known for known in (misread(case, effect) for effect in report["effects"]) if known]
    if report["verdict"] == "unknown_effect":
        said += [
            "Look at the leftover force: which storey it is in, and whether it follows drift, drift rate or time.",
            "Shake again at half the amplitude: what keeps its share is linear (a mass or a spring that nobody listed), "
            "what does not is a contact, friction or yielding.",
            "Listen and look while it is shaken: loose parts, cables, tools left on a floor, a fan.",
            "Is this the frame that case.toml names? Compare its first frequencies with a hammer test.",
        ]
    return said


def misread(case: Case, effect: dict[str, Any]) -> str | None:
    """Return what a sensor's gain looks like: another unit than the case says, or the wrong polarity."""
    if effect["effect"] != "sensor_gain" or effect["channel"] is None:
        return None
    channel = case.channels[case.channel_index(effect["channel"])]
    reads = 1 + float(effect["parameters"][0]["value"])
    if abs(reads + 1) < LIKE:
        return f"Channel {channel.name} reads minus the truth: its polarity is wrong."
    for unit, factor in UNITS[channel.quantity].items():
        if unit != channel.unit and abs(reads * factor / channel.to_si - 1) < LIKE:
            return f"Channel {channel.name} reads as if it were in {unit}; case.toml says {channel.unit}."
    return None


def assumptions(case: Case, found: Findings) -> list[str]:
    """Return what the verdict rests on."""
    prior = case.prior
    channels = len(found.model.observed.names)
    return [
        f"Nuisance parameters are free inside their priors (standard deviations: storey stiffness "
        f"{prior.storey_stiffness:.1%}, frame stiffness {prior.frame_stiffness:.1%}, floor mass {prior.floor_mass:.1%}, "
        f"each mode's damping {prior.damping_ratio:.0%}, table gain {prior.table_gain:.1%}, table delay "
        f"{prior.table_delay_ms:g} ms), none beyond three of them.",
        f"A sensor's gain is known to {CHANNEL_GAIN:.1%}, its delay against the others to {CHANNEL_DELAY_S * 1e3:g} ms; "
        f"how rigid a plate frame's base is to {BASE_STIFFNESS:.0%} of its first storey's stiffness, its joints to "
        f"{JOINT_STIFFNESS:.0%}.",
        *([_STRUCK] if case.contacts else []),
        "Standard errors are those of the noise alone; a law that is not quite the catalogue's adds its own error.",
        "Noise is estimated from the data: its spectrum where no frame answers, then the innovations.",
        "The frames are at rest before the first sample of each run.",
        f"Gaps are medians over {channels} channel{'s' * (channels != 1)}; evidence is against the calibrated model.",
    ]
