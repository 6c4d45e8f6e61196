"""What was found of a contact and of its force cell, put beside what was found of the frames."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.impacts import DAMPED
from pounding.diagnosis.contact_force.pair import ContactFindings, Foretold
from pounding.diagnosis.decision.confidence import CONTACT, Features, basis, confidence
from pounding.diagnosis.decision.verdict import CLASS_NATS
from pounding.diagnosis.inference.findings import BLIND_FACTOR
from pounding.diagnosis.model.pair import Pair

NAMED = ("effect_named", "effect_class")
CLAIM_NATS = 8.0
CLAIM_BESIDE_NATS = 16.0
UNHEARD_FACTOR = 2.0
FORETOLD, FORETOLD_MOST, FORETOLD_LEAST = 0.25, 10.0, 3.0
BLIND_LEFT = 2.0
"""Evidence that an effect of the contact needs alone, and beside an effect of a frame, whose law is never quite right; how
many times as much where no cell measured the force and no held-out impacts are heard; the share of its evidence that as
many held-out impacts have to say for it, so many nats at most and so many less that a few may lack by chance; and times the
noise left from which forces that no cell measured are said to be poor."""


def claims_of(
    case: Case,
    pair: Pair,
    contact_findings: ContactFindings,
    report: dict[str, Any],
    foretold: Foretold | None = None,
) -> list[dict[str, Any]]:
    """Return what is claimed of the contact, of a second one and of the force cell beside a report on the frames."""
    claims = [*_cell(case, pair), *_second(case, pair, contact_findings)]
    found = candidates(case, contact_findings)
    needed = CLAIM_BESIDE_NATS if report["verdict"] in NAMED or claims else CLAIM_NATS
    if pair.cell is None:
        needed *= BLIND_FACTOR
    if (
        found
        and found[0]["log_evidence"] > needed
        and _holds(pair, found[0], needed, contact_findings, foretold)
    ):
        best = found[0]
        alike = [one for one in found[1:] if one["log_evidence"] > best["log_evidence"] - CLASS_NATS]
        claims.append(best | {"class": [place(one) for one in (best, *alike)]})
    return claims


def joined(
    case: Case,
    pair: Pair,
    contact_findings: ContactFindings,
    report: dict[str, Any],
    foretold: Foretold | None = None,
    objections: bool = False,
) -> dict[str, Any]:
    """Return a report on the frames with what the contact and its force cell add to it.

    Args:
        case: The case.
        pair: Its frames and contacts. touched: What the impacts say.
        report: The report on the frames.
        foretold: How well held-out impacts are foretold.
        doubted: Whether the frames' own parameters, or a tone, speak against the model.
    """
    found = candidates(case, contact_findings)
    second = _second(case, pair, contact_findings)
    unknown = report["verdict"] == "unknown_effect"
    # The force of a contact that nobody listed is what the motion asks for: it may leave more than noise.
    poor = unknown and bool(second) and not objections
    claims = [] if unknown else claims_of(case, pair, contact_findings, report, foretold)
    if poor:
        claims = second
    shown = [
        place(one) | {"log_evidence": one["log_evidence"]} for one in (*_cell(case, pair), *second, *found)
    ]
    warnings = [*pair.warnings, *_odd(case, contact_findings), *([] if poor else _two_loggers(report))]
    report = report | {
        "candidates": sorted([*report["candidates"], *shown], key=lambda one: -one["log_evidence"]),
        "warnings": [*report["warnings"], *warnings, *_blind(pair, report)],
    }
    if foretold is not None:
        claimed = any(one["contact"] is not None for one in claims)
        report["gap"] = report["gap"] | {"contact": _contact_gap(foretold, claimed)}
    return _with_claims(report, claims, found) if claims else report


def _with_claims(
    report: dict[str, Any], claims: list[dict[str, Any]], found: list[dict[str, Any]]
) -> dict[str, Any]:
    """Return a report with claims beside what it says of the frames, its verdict and confidence being of both."""
    verdict = report["verdict"]
    frames_named = verdict in NAMED
    effects = [*(report["effects"] if frames_named else []), *claims]
    alone = len(effects) == 1 and len(claims[0]["class"]) > 1
    given = _features(claims, found)
    return report | {
        "effects": sorted(effects, key=lambda one: -one["log_evidence"]),
        "verdict": "effect_class" if alone or verdict == "effect_class" else "effect_named",
        "confidence": confidence(given) * (report["confidence"] if frames_named else 1.0),
        "confidence_basis": report.get("confidence_basis", basis(given)) | {"contact": asdict(given)},
    }


def _features(claims: list[dict[str, Any]], found: list[dict[str, Any]]) -> Features:
    """Return what the confidence in claims on a contact and its cell rests on: the weakest, and what comes next to it."""
    weakest = min(claims, key=lambda one: one["log_evidence"])
    ln_bayes = weakest["log_evidence"]
    behind = [one["log_evidence"] for one in found if one["effect"] != weakest["effect"]]
    margin = ln_bayes - max([0.0, *behind]) if weakest["contact"] is not None else ln_bayes
    return Features(CONTACT, ln_bayes, margin, 1.0, 1.0, len(claims))


def _holds(
    pair: Pair,
    best: dict[str, Any],
    needed: float,
    contact_findings: ContactFindings,
    foretold: Foretold | None,
) -> bool:
    """Return whether the held-out impacts like an effect too that was fitted to the others.

    Without any of them a force cell's word is taken, and that of forces which the motion asks for if it says much more than
    is needed.
    """
    if not contact_findings.ranked or best["effect"] != contact_findings.ranked[0][1].hypothesis.effect:
        return True
    ln_bayes = float(best["log_evidence"])
    if foretold is None:
        return pair.cell is not None or ln_bayes > UNHEARD_FACTOR * needed
    asked = FORETOLD * ln_bayes * foretold.impacts / contact_findings.impacts
    return foretold.gained > min(asked, FORETOLD_MOST) - FORETOLD_LEAST


def _contact_gap(foretold: Foretold, claimed: bool) -> dict[str, Any]:
    """Return what held-out impacts are left with before and after [standard deviations]; after only what is claimed."""
    after = foretold.likeliest if claimed else foretold.model
    return {"impacts": foretold.impacts, "before": foretold.model, "after": after}


def place(entry: dict[str, Any]) -> dict[str, Any]:
    """Return effect and place of an entry."""
    keys = ("effect", "frame", "storey", "floor", "channel", "contact", "left", "right")
    return {key: entry.get(key) for key in keys}


def _entry(effect: str, parameters: list[dict[str, Any]], ln_bayes: float, **where: Any) -> dict[str, Any]:
    entry = place({"effect": effect, **where})
    return entry | {"parameters": parameters, "log_evidence": ln_bayes, "class": [entry]}


def _parameter(name: str, value: float | str, std: float | None, unit: str) -> dict[str, Any]:
    return {"name": name, "value": value, "std": std, "unit": unit}


def candidates(case: Case, contact_findings: ContactFindings) -> list[dict[str, Any]]:
    """Return the contact's effects with parameters and nats, best first, the law once."""
    found: list[dict[str, Any]] = []
    for ln_bayes, fit in contact_findings.ranked:
        if fit.hypothesis.effect == "contact_law" and any(one["effect"] == "contact_law" for one in found):
            continue
        found.append(_entry(fit.hypothesis.effect, _parameters(case, fit), float(ln_bayes), contact=1))
    contact = case.contacts[0]
    beyond = (
        (contact_findings.nearest_m - contact.gap_m) / contact_findings.spread_m
        if contact_findings.null is None
        else 0.0
    )
    if beyond > 0:
        ln_bayes = float(0.5 * beyond**2 - 3.0)
        offset = 1e3 * (contact_findings.nearest_m - contact.gap_m)
        parameters = [_parameter("offset", offset, 1e3 * contact_findings.spread_m, "mm")]
        found.append(_entry("gap_offset", parameters, ln_bayes, contact=1))
    return found


def _parameters(case: Case, fit: Fitted) -> list[dict[str, Any]]:
    law = fit.law
    unit = "N/m" if law.name.startswith("linear") else "N/m^1.5"
    if fit.hypothesis.effect == "gap_offset":
        offset = 1e3 * (law.gap_m - case.contacts[0].gap_m)
        return [_parameter("offset", offset, 1e3 * fit.std[0], "mm")]
    stiffness = _parameter("stiffness", law.stiffness, law.stiffness * fit.std[1], unit)
    if fit.hypothesis.effect == "contact_stiffness":
        return [stiffness]
    if fit.hypothesis.effect == "contact_damping":
        if np.isnan(law.damping):
            return [_parameter("restitution", law.restitution, fit.std[2], "-")]
        return [_parameter("damping", law.damping, law.damping * fit.std[2], "N s/m")]
    shown = [_parameter("law", law.name, None, "-"), stiffness]
    if law.name in DAMPED:
        shown.append(_parameter("restitution", law.restitution, fit.std[2], "-"))
    return shown


def _cell(case: Case, pair: Pair) -> list[dict[str, Any]]:
    if pair.cell is None:
        return []
    channel = case.channels[case.channel_index(pair.cell.channel)]
    told = {
        "sensor_gain": ("relative_change", 1.0, "1"),
        "sensor_delay": ("delay", 1e3, "ms"),
        "sensor_offset": ("offset", 1 / channel.to_si, channel.unit),
    }
    shown = []
    for effect, value, std, ln_bayes in pair.cell.faults:
        name, factor, unit = told[effect]
        parameters = [_parameter(name, value * factor, std * factor, unit)]
        shown.append(_entry(effect, parameters, ln_bayes, channel=channel.name))
    return shown


def _second(case: Case, pair: Pair, contact_findings: ContactFindings) -> list[dict[str, Any]]:
    if pair.second is None:
        return []
    floor, ln_bayes, _ = pair.second
    contact, parameters = case.contacts[0], []
    if contact_findings.second is not None:
        gap = _parameter(
            "gap", 1e3 * contact_findings.second.law.gap_m, 1e3 * contact_findings.second.std[0], "mm"
        )
        parameters = [gap]
    where = {"left": contact.left, "right": contact.right, "floor": floor}
    return [_entry("second_contact", parameters, ln_bayes, **where)]


def _odd(case: Case, contact_findings: ContactFindings) -> list[str]:
    if contact_findings.impacts:
        return []
    left = 1e3 * (case.contacts[0].gap_m - contact_findings.nearest_m)
    return [
        f"contact 1 never closes in these runs: by the believed gap the floors stay {left:.2f} mm apart; "
        "stiffness, loss and law cannot be judged"
    ]


def _blind(pair: Pair, report: dict[str, Any]) -> list[str]:
    """Return a warning where forces that no cell measured leave much of the motion unexplained."""
    training = report.get("gap", {}).get("training")
    if not pair.blind or training is None or training["after"] < BLIND_LEFT * training["noise_floor"]:
        return []
    times = training["after"] / training["noise_floor"]
    return [
        f"the contact forces were found from the motion and leave {times:.1f} times the noise in the runs used: what is "
        "said of the frames is worth less than with a force cell"
    ]


def _two_loggers(report: dict[str, Any]) -> list[str]:
    """Return a warning where a delay fits best of what fits not enough: a late frame is late against the force too."""
    first = max(report["candidates"], key=lambda one: one["log_evidence"], default=None)
    if report["verdict"] != "unknown_effect" or first is None or first["effect"] != "sensor_delay":
        return []
    return [
        f"a delay of {first['channel']} explains most of what is left, not all: if the two frames or the force cell were "
        "recorded by different loggers, put them on one time base by a signal that both recorded, and diagnose again"
    ]
