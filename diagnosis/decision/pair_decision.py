"""What was found of a contact and of its force cell, put beside what was found of the frames."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np

from pounding.contact.laws import DAMPED
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.held_out import HeldOutImpacts
from pounding.diagnosis.contact_force.pair import ContactFindings
from pounding.diagnosis.decision.claims import Claim, Parameter, Place, candidate, claim, finite, parameter
from pounding.diagnosis.decision.conclusion import Conclusion, ContactMisfit
from pounding.diagnosis.decision.confidence import CONTACT, Features, confidence
from pounding.diagnosis.decision.decision import NAMED, Verdict
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.settings import SETTINGS


def claims_of(
    case: Case,
    pair: Pair,
    contact_findings: ContactFindings,
    frames: Verdict,
    held_out: HeldOutImpacts | None = None,
) -> list[Claim]:
    """Return what is claimed of the contact, of a second one and of the force cell.

    Args:
        case: The case.
        pair: Its frames and contacts.
        contact_findings: What the impacts say.
        frames: The verdict on the frames.
        held_out: How well held-out impacts are predicted.
    """
    claims = [*_cell(case, pair), *_second(case, pair, contact_findings)]
    found = contact_claims(case, contact_findings)
    needed = SETTINGS.pair_decision.contact_evidence
    if frames in NAMED or claims:
        needed *= SETTINGS.pair_decision.second_factor
    if pair.cell is None:
        needed *= SETTINGS.pair_decision.unmeasured_factor
    if (
        found
        and found[0].log_evidence > needed
        and _holds(pair, found[0], needed, contact_findings, held_out)
    ):
        best = found[0]
        alike = [one for one in found[1:] if one.log_evidence > best.log_evidence - SETTINGS.decision.alike]
        members = tuple(one.place for one in (best, *alike))
        claims.append(msgspec.structs.replace(best, members=members))
    return claims


def joined(
    case: Case,
    pair: Pair,
    contact_findings: ContactFindings,
    frames: Conclusion,
    held_out: HeldOutImpacts | None = None,
    objections: bool = False,
) -> Conclusion:
    """Return what is concluded of the frames with what the contact and its force cell add to it.

    Args:
        case: The case.
        pair: Its frames and contacts.
        contact_findings: What the impacts say.
        frames: What is concluded of the frames.
        held_out: How well held-out impacts are predicted.
        objections: Whether the frames' own parameters, or a tone, speak against the model.
    """
    found = contact_claims(case, contact_findings)
    second = _second(case, pair, contact_findings)
    unknown = frames.verdict == "unknown_effect"
    # The force of a contact that nobody listed is what the motion asks for: it may leave more than noise.
    poor = unknown and bool(second) and not objections
    claims = [] if unknown else claims_of(case, pair, contact_findings, frames.verdict, held_out)
    if poor:
        claims = second
    tried = [
        *frames.candidates,
        *(
            candidate(one.place, one.log_evidence, one.parameters)
            for one in (*_cell(case, pair), *second, *found)
        ),
    ]
    warnings = [*pair.warnings, *_odd(case, contact_findings), *([] if poor else _two_loggers(frames))]
    whole = replace(
        frames,
        candidates=tuple(sorted(tried, key=lambda one: -one.log_evidence)),
        warnings=(*frames.warnings, *warnings),
        contact_misfit=None if held_out is None else _contact_misfit(held_out, claims),
    )
    return _with_claims(whole, claims, found) if claims else whole


def _with_claims(frames: Conclusion, claims: list[Claim], found: list[Claim]) -> Conclusion:
    """Return a conclusion with claims beside what it says of the frames, its verdict and confidence being of both."""
    named = frames.verdict in NAMED
    effects = [*(frames.effects if named else ()), *claims]
    alone = len(effects) == 1 and len(claims[0].members) > 1
    given = _features(claims, found)
    return replace(
        frames,
        effects=tuple(sorted(effects, key=lambda one: -one.log_evidence)),
        verdict="effect_class" if alone or frames.verdict == "effect_class" else "effect_named",
        confidence=confidence(given) * (frames.confidence if named else 1.0),
        basis=msgspec.structs.replace(frames.basis, contact=given),
    )


def _features(claims: list[Claim], found: list[Claim]) -> Features:
    """Return what the confidence in claims on a contact and its cell rests on: the weakest, and what comes next to it."""
    weakest = min(claims, key=lambda one: one.log_evidence)
    ln_bayes = weakest.log_evidence
    behind = [one.log_evidence for one in found if one.effect != weakest.effect]
    margin = ln_bayes - max([0.0, *behind]) if weakest.contact is not None else ln_bayes
    return Features(CONTACT, ln_bayes, margin, 1.0, 1.0, len(claims))


def _holds(
    pair: Pair,
    best: Claim,
    needed: float,
    contact_findings: ContactFindings,
    held_out: HeldOutImpacts | None,
) -> bool:
    """Return whether the held-out impacts like an effect too that was fitted to the others.

    Without any of them a force cell's word is taken, and that of forces which the motion asks for if it says much more than
    is needed.
    """
    if not contact_findings.ranked or best.effect != contact_findings.ranked[0][1].hypothesis.effect:
        return True
    if held_out is None:
        return pair.cell is not None or best.log_evidence > SETTINGS.pair_decision.unmeasured_factor * needed
    return held_out.supports


def _contact_misfit(held_out: HeldOutImpacts, claims: list[Claim]) -> ContactMisfit:
    """Return what held-out impacts are left with before and after; after only what is claimed."""
    claimed = any(one.contact is not None for one in claims)
    after = held_out.likeliest if claimed else held_out.model
    return ContactMisfit(impacts=held_out.impacts, before=finite(held_out.model), after=finite(after))


def contact_claims(case: Case, contact_findings: ContactFindings) -> list[Claim]:
    """Return the contact's effects with parameters and evidence, the likeliest first, the law once."""
    found: list[Claim] = []
    for ln_bayes, fit in contact_findings.ranked:
        effect = fit.hypothesis.effect
        if effect == "contact_law" and any(one.effect == "contact_law" for one in found):
            continue
        found.append(claim(Place(effect=effect, contact=1), _parameters(case, fit), ln_bayes))
    contact = case.contacts[0]
    beyond = (
        (contact_findings.nearest_m - contact.gap_m) / contact_findings.spread_m
        if contact_findings.null is None
        else 0.0
    )
    if beyond > 0:
        ln_bayes = float(0.5 * beyond**2 - SETTINGS.pair_decision.parameter_cost)
        offset = 1e3 * (contact_findings.nearest_m - contact.gap_m)
        sizes = [parameter("offset", offset, 1e3 * contact_findings.spread_m, "mm")]
        found.append(claim(Place(effect="gap_offset", contact=1), sizes, ln_bayes))
    return found


def _parameters(case: Case, fit: Fitted) -> list[Parameter]:
    law = fit.law
    unit = "N/m" if law.name.startswith("linear") else "N/m^1.5"
    if fit.hypothesis.effect == "gap_offset":
        offset = 1e3 * (law.gap_m - case.contacts[0].gap_m)
        return [parameter("offset", offset, 1e3 * fit.std[0], "mm")]
    stiffness = parameter("stiffness", law.stiffness, law.stiffness * fit.std[1], unit)
    if fit.hypothesis.effect == "contact_stiffness":
        return [stiffness]
    if fit.hypothesis.effect == "contact_damping":
        if np.isnan(law.damping):
            return [parameter("restitution", law.restitution, fit.std[2], "-")]
        return [parameter("damping", law.damping, law.damping * fit.std[2], "N s/m")]
    shown = [parameter("law", law.name, None, "-"), stiffness]
    if law.name in DAMPED:
        shown.append(parameter("restitution", law.restitution, fit.std[2], "-"))
    return shown


def _cell(case: Case, pair: Pair) -> list[Claim]:
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
        if ln_bayes <= SETTINGS.pair_decision.contact_evidence:
            # It was put right beside something else, and says too little by itself.
            continue
        name, factor, unit = told[effect]
        sizes = [parameter(name, value * factor, std * factor, unit)]
        shown.append(claim(Place(effect=effect, channel=channel.name), sizes, ln_bayes))
    return shown


def _second(case: Case, pair: Pair, contact_findings: ContactFindings) -> list[Claim]:
    if pair.second is None:
        return []
    floor, ln_bayes, _ = pair.second
    contact, second, sizes = case.contacts[0], contact_findings.second, []
    if second is not None:
        sizes = [parameter("gap", 1e3 * second.law.gap_m, 1e3 * second.std[0], "mm")]
    where = Place(effect="second_contact", left=contact.left, right=contact.right, floor=floor)
    return [claim(where, sizes, ln_bayes)]


def _odd(case: Case, contact_findings: ContactFindings) -> list[str]:
    if contact_findings.impacts:
        return []
    left = 1e3 * (case.contacts[0].gap_m - contact_findings.nearest_m)
    return [
        f"contact 1 never closes in these runs: with the gap of the baseline model the floors stay {left:.2f} mm apart; "
        "stiffness, loss and law cannot be judged"
    ]


def _two_loggers(frames: Conclusion) -> list[str]:
    """Return a warning where a delay fits best of what fits not enough: a late frame is late against the force too."""
    first = max(frames.candidates, key=lambda one: one.log_evidence, default=None)
    if frames.verdict != "unknown_effect" or first is None or first.effect != "sensor_delay":
        return []
    return [
        f"a delay of {first.channel} explains most of the remaining misfit, not all: if the two frames or the force cell "
        "were recorded by different loggers, put them on one time base by a signal that both recorded, and diagnose again"
    ]
