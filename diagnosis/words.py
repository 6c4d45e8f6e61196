"""The report in sentences: the verdict, what would tell more, and what was assumed."""

from __future__ import annotations

from typing import Any

from diagnosis.case import Case
from diagnosis.search import Findings


def sentence(report: dict[str, Any]) -> str:
    """Return the verdict in one sentence."""
    gap = report["gap"]["held_out"] or report["gap"]["training"]
    run = f"on {gap['run']}, which was not used" if report["gap"]["held_out"] else "on the runs used"
    change = (
        f"the gap {run}, goes from {gap['before']:.2%} to {gap['after']:.2%} (noise {gap['noise_floor']:.2%})"
    )
    sure = f"{report['confidence']:.0%} sure"
    verdict = report["verdict"]
    if verdict == "nothing_missing":
        return (
            f"Nothing is missing that this data could show: the gap is {gap['before']:.2%}, "
            f"the noise {gap['noise_floor']:.2%} ({sure})."
        )
    if verdict == "unknown_effect":
        return (
            f"Something is missing, and nothing in the catalogue fits it: the gap {run}, is {gap['before']:.2%}, "
            f"the noise {gap['noise_floor']:.2%} ({sure})."
        )
    names = " and ".join(_named(effect) for effect in report["effects"])
    if verdict == "effect_class":
        others = len(report["effects"][0]["class"]) - 1
        return f"Missing is {names} or one of {others} other(s) that this data cannot tell from it; {change} ({sure})."
    return f"Missing is {names}; {change} ({sure})."


def _named(effect: dict[str, Any]) -> str:
    words = effect["effect"].replace("_", " ")
    for key in ("storey", "floor", "channel", "contact"):
        if effect[key] is not None:
            words += f" in {key} {effect[key]}" if key != "channel" else f" of {effect[key]}"
    if effect["frame"]:
        words += f" of {effect['frame']}"
    values = ", ".join(
        f"{p['name'].replace('_', ' ')} {p['value']:.4g} {p['unit']}" for p in effect["parameters"]
    )
    return f"{words} ({values})" if values else words


def advice(found: Findings, report: dict[str, Any]) -> list[str]:
    """Return what would tell more."""
    said = []
    if not found.held_out:
        said.append(
            "A second run would allow a judgement on data that was not used; there is no held-out run here."
        )
    if report["verdict"] == "effect_class":
        said.append(
            "Runs of other amplitude tell nonlinear from linear effects; an accelerometer on each floor beside the "
            "storey in question tells places apart; an added mass of known size tells stiffness from mass."
        )
    if report["verdict"] == "unknown_effect":
        said.append(
            "Look at the leftover force: which storey, and whether it follows drift, velocity or time."
        )
    return said


def assumptions(case: Case, found: Findings) -> list[str]:
    """Return what the verdict rests on."""
    prior = case.prior
    return [
        f"Ordinary parameters are free inside their priors (standard deviations: storey stiffness "
        f"{prior.storey_stiffness:.1%}, frame stiffness {prior.frame_stiffness:.1%}, floor mass {prior.floor_mass:.1%}, "
        f"first mode's damping {prior.damping_ratio:.0%}, table gain {prior.table_gain:.1%}, table delay "
        f"{prior.table_delay_ms:g} ms), none beyond three of them.",
        "A sensor's gain is known to 0.3 %, its delay against the others to 0.2 ms, damping of higher modes to 40 %.",
        "Noise is estimated from the data: its spectrum where no frame answers, then the innovations.",
        "The frames are at rest before the first sample of each run.",
        f"Gaps are medians over {len(found.believed.observed.names)} channels; evidence is against the calibrated model.",
    ]
