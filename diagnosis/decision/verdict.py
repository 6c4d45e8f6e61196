"""From evidence to a verdict: nothing missing, an effect, a class of effects, or something that is none of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.decision.beside_latent_force import with_sizes
from pounding.diagnosis.decision.confidence import Features, features_of
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.false_alarms import plain
from pounding.diagnosis.decision.hidden_by_calibration import straightens
from pounding.diagnosis.decision.measures import (
    explained,
    explains,
    forces_from_motion,
    hidden_error,
    model_error,
    of_sensors,
    signal_to_noise,
    something_left,
    stands_out,
    told_from_none,
    within_model_error,
)
from pounding.diagnosis.decision.objections import against_the_model, another_frame, bends, itself_only_with
from pounding.diagnosis.decision.second_effect import acts, eases, explains_more
from pounding.diagnosis.decision.sizes import with_unbiased_sizes
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import allowed_error
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.settings import SETTINGS


def decide(found: Findings) -> Decision:
    """Return the verdict on findings; what speaks against the model is looked for here and nowhere else.

    To be called once for each set of findings: the decision is what everything after it is given.
    """
    judged = found.claimable()
    single = _heard(found, [one for one in judged if len(one.effects) == 1])
    if not single or not _detected(found, single[0]):
        if single and itself_only_with(found, single[0]):
            objections, said = against_the_model(found, single[0])
            if not objections:
                return _named(found, single[0], single, said)
        objections, said = against_the_model(found, found.null)
        if objections or (something_left(found, found.null) and not within_model_error(found)):
            return Decision("unknown_effect", single[0] if single else found.null, (), said, objections)
        return Decision("nothing_missing", found.null, (), said)
    chosen = first = _listed(found, single)
    doubles = [one for one in judged if len(one.effects) > 1]
    worth = bool(doubles) and explains_more(found, first, doubles[0])
    if worth or (doubles and eases(found, first, doubles[0])):
        chosen = _of_two(found, first, doubles[0])
    if worth and chosen is not first:
        chosen = _sized(found, first, chosen)
    objections, said = against_the_model(found, chosen)
    # Of what the calibration took its misfit says nothing: not whether it is larger than an error, nor what it explains.
    taken = len(chosen.effects) == 1 and _taken(found, chosen)
    held = _holds(found, chosen, objections) or (
        taken and not objections and within_model_error(found, chosen)
    )
    drowned = not taken and not stands_out(found, chosen)
    if not objections and not taken and _within_errors(found, chosen, drowned, held):
        return Decision("nothing_missing", found.null, (), said)
    if drowned or not held:
        return Decision("unknown_effect", chosen, (), said, objections)
    return _named(found, chosen, single, said)


def _named(found: Findings, chosen: Judged, single: list[Judged], said: tuple[str, ...]) -> Decision:
    """Return the verdict that names effects, as a class where this data cannot tell which they are."""
    alike = _alike(found, chosen, single)
    return Decision(
        "effect_class" if alike else "effect_named", with_unbiased_sizes(found, chosen), alike, said
    )


def _sized(found: Findings, single: Judged, double: Judged) -> Judged:
    """Return two effects with the sizes that they have whatever force acts, where the frame moves as measured with these.

    Such a force may take the part of an effect, and sizes with which the frame moves otherwise say nothing of it.
    """
    sized = with_sizes(found, single, double)
    return double if something_left(found, sized) and not something_left(found, double) else sized


def first_detected(found: Findings) -> bool:
    """Return whether the single effect that leads is there; where none can be claimed, as far as is known.

    Args:
        found: The findings.
    """
    single = _heard(found, [one for one in found.claimable() if len(one.effects) == 1])
    return not single or _detected(found, single[0])


def _detected(found: Findings, judged: Judged) -> bool:
    """Return whether a single effect is there: it is large enough and no chance, or what the calibration took.

    A sensor that is wrong in a part of a run only, as one that is stuck at first, has no constant fault, and is wrong.
    """
    large = plain(found, judged, signal_to_noise(found, judged))
    told = of_sensors(judged) or told_from_none(found, judged, judged.effects)
    return (large and told) or _taken(found, judged)


def _taken(found: Findings, judged: Judged) -> bool:
    """Return whether the calibration took a single effect."""
    # Beside an error of the frame that is in the model, how base, joints and weight soften it is one more.
    another = found.plain is not None and any(effect.common_beside for effect in judged.effects)
    return straightens(found, judged, another or bool(common(found, judged)))


def _heard(found: Findings, single: list[Judged]) -> list[Judged]:
    """Return single effects, best first, from the first one on that says something of what may be missing in a frame.

    A fault of a sensor that is too small to be named takes evidence from noise that is not white, and what every real frame
    has a little of from the errors of its model: that either leads says nothing of what comes after it.
    """

    def silent(one: Judged) -> bool:
        return bool(of_sensors(one) or common(found, one)) and not _detected(found, one)

    if found.pair is not None or not single or not silent(single[0]):
        return single
    return [one for one in single if not silent(one)] or single


def _within_errors(found: Findings, chosen: Judged, drowned: bool, held: bool) -> bool:
    """Return whether no model of a real frame is better, and nothing that stands out from its errors says why."""
    if found.pair is not None and of_sensors(chosen):
        # Frames that touch may be on two loggers, one of which is late: what sensors tell of that is no error of a model.
        return False
    shared = common(found, chosen) == chosen.effects
    error = shared and _as_an_error(found, found.null, chosen)
    unknown = not held and (something_left(found, chosen) or bends(found, chosen))
    # An error of the frame beside which an effect is judged is in the model, whose other errors are asked for.
    small = within_model_error(found, chosen.beside)
    if error and forces_from_motion(found):
        # What such forces leave is no error of a frame: beside that of the frame nothing may be left.
        small = not something_left(found, chosen)
    return small and (error or unknown or drowned)


def error_of_frame(found: Findings) -> Judged | None:
    """Return what the frame has a little of, as every real one has, where it leads or is second, or None.

    The model must leave less of its frame with it. Nothing is asked for with reference runs, nor where no cell measured what
    pushes the frames: such forces take the part of what either lacks, and of what remains with them no frame is the cause.
    """

    def in_model(without: Judged, judged: Judged) -> bool:
        where = _frame_of_more(without, judged)
        less = model_error(found, judged, where) < model_error(found, without, where)
        return less and _as_an_error(found, without, judged)

    single = [one for one in found.claimable() if len(one.effects) == 1]
    if forces_from_motion(found) or not single:
        return None
    if not plain(found, single[0], signal_to_noise(found, single[0])):
        return None
    alone = {one.effects[0]: one for one in single}
    if common(found, single[0]) and in_model(found.null, single[0]):
        return single[0]
    double = next((one for one in found.judged if len(one.effects) == 2), None)
    if double is None or not acts(found, single[0], double):
        return None
    for error, effect in (double.effects, double.effects[::-1]):
        known = error in alone and effect in alone and error in common(found, double)
        # Two of a kind share what one does: the one is no smaller without the other than the other without it.
        if known and error.name != effect.name and in_model(alone[effect], double):
            return alone[error]
    return None


def _alike(found: Findings, chosen: Judged, single: list[Judged]) -> tuple[Judged, ...]:
    """Return the other single effects that this data cannot part from the chosen one."""
    return tuple(
        other
        for other in single
        if len(chosen.effects) == 1
        and other is not chosen
        and other.beside is chosen.beside
        and not other.effects[0].rival
        and (other.ln_bayes > chosen.ln_bayes - SETTINGS.decision.alike or _one_motion(found, chosen, other))
    )


def _listed(found: Findings, single: list[Judged]) -> Judged:
    """Return the best single effect; one of the catalogue where no rival is likelier and explains clearly more."""
    catalogue = [one for one in single if not one.effects[0].rival]
    if not catalogue or catalogue[0] is single[0]:
        return single[0]
    near = catalogue[0].ln_bayes > single[0].ln_bayes - SETTINGS.decision.rival
    return single[0] if not near and _clearly_more(found, catalogue[0], single[0]) else catalogue[0]


def _clearly_more(found: Findings, judged: Judged, rival: Judged) -> bool:
    """Return whether what is outside the catalogue leaves so much less than what is in it that it is needed."""
    left = [1.0 - explained(found, one, 1.0, other) for one, other in ((judged, rival), (rival, judged))]
    return left[1] <= SETTINGS.decision.rival_left * left[0]


def _as_an_error(found: Findings, without: Judged, judged: Judged) -> bool:
    """Return whether what effects take out of the motion is as small as the errors that every model of a frame has.

    It is less than the case allows, and no more than a few times the frame's other errors: the discrepancy beside them and
    what they leave, or what the noise may hide of it. These say how large an error of this model may be, and none is right
    within less than a part of its motion.
    """
    if found.reference:
        return False
    where = _frame_of_more(without, judged)
    before, after = (model_error(found, one, where) for one in (without, judged))
    taken = np.sqrt(max(before**2 - after**2, 0.0))
    if taken > allowed_error(found.model):
        return False
    discrepancy = Sight.of(found, judged.fit.filtered).discrepancy(where)
    others = max(np.hypot(max(after, hidden_error(found, where)), discrepancy), SETTINGS.decision.least_error)
    return bool(taken <= SETTINGS.decision.errors_alike * others)


def _frame_of_more(without: Judged, judged: Judged) -> str | None:
    """Return the frame on which all effects are that others are judged without; None where they are on several, or none.

    What one of two frames lacks is no measure of the other's errors.
    """
    frames = {effect.frame for effect in judged.effects if effect not in without.effects}
    return frames.pop() if len(frames) == 1 else None


def _of_two(found: Findings, single: Judged, double: Judged) -> Judged:
    """Return two effects, or the one of them that is more than what is wrong with every model.

    What is outside the catalogue belongs to what remains, unless it explains clearly more. What all storeys share is an
    error where it is as small as one: where it is the likelier of both, the effect is judged beside it.
    """
    outside = any(effect.rival for effect in double.effects) and not single.effects[0].rival
    if outside and _holds(found, single, False):
        needed = _clearly_more(found, single, double) and not _as_an_error(found, single, double)
        return double if needed else single
    alone = {one.effects[0]: one for one in found.judged if len(one.effects) == 1}
    for error, effect in (double.effects, double.effects[::-1]):
        if (
            error not in common(found, double)
            or effect not in alone
            or not _as_an_error(found, alone[effect], double)
        ):
            continue
        if alone[effect] is single:
            return single
        if error in alone and error.name != effect.name:
            return replace(double, ln_bayes=double.ln_bayes - alone[error].ln_bayes, beside=alone[error])
    return double


def common(found: Findings, judged: Judged) -> tuple[Effect, ...]:
    """Return those of the effects that every real frame has a little of, alone or beside another.

    Args:
        found: What the search found.
        judged: The fit of the effects.
    """
    each = zip(judged.fit.effects, judged.fit.values, strict=True)
    several = len(judged.effects) > 1
    return tuple(
        effect
        for effect, values in each
        if effect in judged.effects
        and (effect.is_common(values, found.sizes) or (several and effect.common_beside))
    )


def _holds(found: Findings, judged: Judged, objections: bool) -> bool:
    """Return whether effects are what is missing, whatever remains beside them.

    They must explain the larger part of what can be explained where they act, and more where something else is known to
    act as well. What is wrong with a sensor is no error of the frame's model, so it need not explain what remains where
    that is no more than such an error.
    """
    if any(effect.rival for effect in judged.effects) or another_frame(found, judged):
        return False
    if _spread(judged):
        return False
    apart = of_sensors(judged) and within_model_error(found, judged)
    if not objections and (apart or not something_left(found, judged)):
        return True
    needed = SETTINGS.decision.explained if objections else SETTINGS.decision.larger_part
    return explains(found, judged, needed)


def _spread(judged: Judged) -> bool:
    """Return whether one law seems to act in two storeys that meet: one thing across both, which is no such law."""
    if len(judged.effects) != 2:
        return False
    one, other = judged.effects
    if one.storey is None or other.storey is None:
        return False
    return one.name == other.name and one.frame == other.frame and abs(one.storey - other.storey) == 1


def _one_motion(found: Findings, one: Judged, other: Judged) -> bool:
    """Return whether two single effects move a shaken frame alike whatever their size; contact forces would part them."""
    return found.pair is None and same_motion(one.effects[0]) == other.effects[0]


def features(found: Findings, decision: Decision) -> Features:
    """Return what the confidence in a verdict rests on."""
    shown = decision.judged
    if decision.verdict == "nothing_missing" and found.judged:
        shown = found.judged[0]
    return features_of(found, decision, signal_to_noise(found, shown), explained(found, shown))
