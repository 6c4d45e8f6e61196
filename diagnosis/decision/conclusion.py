"""What is concluded of a case: the verdict with its confidence, what is claimed, and everything that was tried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from msgspec import UNSET, Struct

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import (
    Candidate,
    Claim,
    Parameter,
    Place,
    candidate,
    claim,
    parameter,
    place_of,
    places_of,
)
from pounding.diagnosis.decision.confidence import Basis, basis, confidence
from pounding.diagnosis.decision.decision import Decision, Verdict
from pounding.diagnosis.decision.sizes import likeliest_sizes, stated_sizes
from pounding.diagnosis.decision.verdict import features
from pounding.diagnosis.effects.catalogue import CHANNEL_UNIT, Effect
from pounding.diagnosis.inference.findings import Findings, Judged


class ContactMisfit(Struct, frozen=True, kw_only=True):
    """How well held-out impacts are predicted, one by one from the measured motion before each.

    Attributes:
        impacts: How many they are.
        before: Root mean square error of their forces with the contact of the baseline model [standard deviations of these].
        after: The same with the contact that is claimed.
    """

    impacts: int
    before: float | None
    after: float | None


@dataclass(frozen=True)
class Conclusion:
    """What is concluded.

    Attributes:
        verdict: The verdict on everything in the case.
        confidence: Probability that it is right.
        basis: What stands behind that figure.
        effects: What is claimed, the likeliest first; the best that was tried for an unknown effect.
        candidates: Every effect that was tried, the likeliest first.
        warnings: Sentences.
        contact_misfit: How well held-out impacts are predicted; None without any.
    """

    verdict: Verdict
    confidence: float
    basis: Basis
    effects: tuple[Claim, ...]
    candidates: tuple[Candidate, ...]
    warnings: tuple[str, ...] = ()
    contact_misfit: ContactMisfit | None = None


def of_frames(case: Case, found: Findings, decision: Decision) -> Conclusion:
    """Return what a decision on frames concludes, without what is between them.

    Args:
        case: The case.
        found: What the search found.
        decision: The decision.
    """
    given = features(found, decision)
    return Conclusion(
        verdict=decision.verdict,
        confidence=confidence(given),
        basis=basis(given),
        effects=_claims(case, found, decision),
        candidates=_candidates(case, found, decision),
        warnings=(
            *case.warnings,
            *found.model.observed.warnings,
            *decision.model_checks,
            *_errors_of_the_frame(case, found, decision),
            *_likeliest_size(case, found, decision),
        ),
    )


def _errors_of_the_frame(case: Case, found: Findings, decision: Decision) -> list[str]:
    """Return a sentence on the error of a frame that is in the model beside an effect, with its size, or nothing."""
    error = decision.judged.beside
    if error is None:
        return []
    each = zip(error.fit.effects, stated_sizes(found, error), strict=True)
    errors = " and a little ".join(
        f"{effect.label()} ({', '.join(one.words() for one in parameters(case, found, effect, *sizes))})"
        for effect, sizes in each
    )
    return [
        f"the model also has a little {errors}: no larger than an error of the model may be, and no effect"
    ]


def _likeliest_size(case: Case, found: Findings, decision: Decision) -> list[str]:
    """Return a sentence where the likeliest size is more than a standard error from the one that is stated."""
    stated = decision.judged
    likeliest = likeliest_sizes(found, stated)
    if likeliest is None:
        return []
    each = zip(
        likeliest.fit.effects, stated_sizes(found, likeliest), stated_sizes(found, stated), strict=True
    )
    other = [
        parameters(case, found, effect, values, std)[0].words()
        for effect, (values, std), (ours, error) in each
        if effect in likeliest.effects and abs(values[0] - ours[0]) > error[0]
    ]
    if not other:
        return []
    return [
        f"errors of the model bias the likeliest size ({' and '.join(other)}); the size that is stated holds with the error "
        "that this model may have"
    ]


def _claims(case: Case, found: Findings, decision: Decision) -> tuple[Claim, ...]:
    if decision.verdict == "nothing_missing":
        return ()
    judged = decision.judged
    shown = []
    sizes_of = stated_sizes(found, judged)
    for effect, (values, std) in zip(judged.fit.effects, sizes_of, strict=True):
        if effect.rival or effect not in judged.effects:
            continue
        for place in places_of(effect):
            members = [place, *(place_of(other.effects[0]) for other in decision.alike)]
            sizes = parameters(case, found, effect, values, std)
            shown.append(claim(place, sizes, judged.ln_bayes, members))
    return tuple(shown)


def parameters(
    case: Case, found: Findings, effect: Effect, values: np.ndarray, std: np.ndarray
) -> list[Parameter]:
    """Return an effect's parameters as reported.

    Args:
        case: The case, for the units of its channels.
        found: What was found, for what the baseline model has.
        effect: The effect.
        values, std: Its parameters and their standard errors in SI, shape (parameters,).
    """
    shown = []
    for quantity, value, spread in zip(effect.quantities, values, std, strict=True):
        if not quantity.reported:
            continue
        unit, factor = quantity.unit, quantity.per_si
        if unit == CHANNEL_UNIT:
            channel = case.channels[case.channel_index(str(effect.channel))]
            unit, factor = channel.unit, 1 / channel.to_si
        if effect.name == "joint_flexibility":
            factor = found.model.structure.frames[effect.index].joint_stiffness
        shown.append(parameter(quantity.name, float(value) * factor, float(spread) * factor, unit))
    return shown


def _candidates(case: Case, found: Findings, decision: Decision) -> tuple[Candidate, ...]:
    """Return every single effect of the catalogue that has a finite evidence, the likeliest first, each place once.

    A sensor's delay and that of its logger have one name and one place. What was refined there counts, and no score; what is
    named has one size.
    """
    known_of = (*found.judged, *found.claimable(), decision.judged)
    refined = {one.effects[0]: one for one in known_of if len(one.effects) == 1}
    known = {place_of(effect) for effect in refined}
    evidence = {effect: judged.ln_bayes for effect, judged in refined.items()}
    evidence |= {one.effect: one.ln_bayes for one in found.scores.ranked if place_of(one.effect) not in known}
    best: dict[Place, Effect] = {}
    for effect, value in sorted(evidence.items(), key=lambda item: -item[1]):
        if not effect.rival and np.isfinite(value):
            best.setdefault(place_of(effect), effect)
    return tuple(
        candidate(
            place,
            evidence[effect],
            _sizes(case, found, refined[effect], effect) if effect in refined else UNSET,
        )
        for place, effect in best.items()
    )


def _sizes(case: Case, found: Findings, judged: Judged, effect: Effect) -> tuple[Parameter, ...]:
    """Return the parameters of a single effect that was judged, alone or beside an error of the frame."""
    sizes = stated_sizes(found, judged)
    return tuple(parameters(case, found, effect, *sizes[judged.fit.effects.index(effect)]))
