"""The report in sentences: the verdict, what would tell more, and what was assumed."""

from __future__ import annotations

from typing import Any

from diagnosis.case import Case
from diagnosis.search import Findings


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
    names = " and ".join(named(effect) for effect in report["effects"])
    change = f"the gap {run} falls from {before} to {after}, where noise alone leaves {noise}"
    if verdict == "effect_class":
        alike = report["effects"][0]["class"][1:]
        others = "one other" if len(alike) == 1 else f"{len(alike)} others"
        return (
            f"Missing is {names}, or one of {others} that this data cannot tell from it; {change} ({sure})."
        )
    return f"Missing is {names}; {change} ({sure})."


def percent(share: float | None) -> str:
    """Return a share in per cent with three significant digits."""
    return "–" if share is None else f"{100 * share:.3g} %"


def named(effect: dict[str, Any]) -> str:
    """Return an effect in words: what, where, and how large with its standard error."""
    values = ", ".join(_value(parameter) for parameter in effect["parameters"])
    return f"{kind_and_place(effect)} ({values})" if values else kind_and_place(effect)


def kind_and_place(entry: dict[str, Any]) -> str:
    """Return what and where, in words."""
    words = str(entry["effect"]).replace("_", " ")
    if entry.get("channel") is not None:
        return f"{words} of channel {entry['channel']}"
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


def advice(found: Findings, report: dict[str, Any]) -> list[str]:
    """Return what would tell more, beside the tests that part what looks alike."""
    said = []
    if not found.held_out:
        said.append(
            "A second run would allow a judgement on data that was not used; there is no held-out run here."
        )
    if report["verdict"] == "unknown_effect":
        said += [
            "Look at the leftover force: which storey it is in, and whether it follows drift, drift rate or time.",
            "Shake again at half the amplitude: what keeps its share is linear (a mass or a spring that nobody listed), "
            "what does not is a contact, friction or yielding.",
            "Listen and look while it is shaken: loose parts, cables, tools left on a floor, a fan.",
            "Is this the frame that case.toml names? Compare its first frequencies with a hammer test.",
        ]
    return said


def assumptions(case: Case, found: Findings) -> list[str]:
    """Return what the verdict rests on."""
    prior = case.prior
    channels = len(found.believed.observed.names)
    return [
        f"Ordinary parameters are free inside their priors (standard deviations: storey stiffness "
        f"{prior.storey_stiffness:.1%}, frame stiffness {prior.frame_stiffness:.1%}, floor mass {prior.floor_mass:.1%}, "
        f"first mode's damping {prior.damping_ratio:.0%}, table gain {prior.table_gain:.1%}, table delay "
        f"{prior.table_delay_ms:g} ms), none beyond three of them.",
        "A sensor's gain is known to 0.3 %, its delay against the others to 0.2 ms, damping of higher modes to 40 %.",
        "Noise is estimated from the data: its spectrum where no frame answers, then the innovations.",
        "The frames are at rest before the first sample of each run.",
        f"Gaps are medians over {channels} channel{'s' * (channels != 1)}; evidence is against the calibrated model.",
    ]
