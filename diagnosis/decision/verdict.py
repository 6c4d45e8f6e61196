"""From evidence to a verdict: nothing missing, an effect, a class of effects, or something that is none of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.decision.confidence import Features, features_of
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.false_alarms import plain, remains, thresholds
from pounding.diagnosis.decision.impulses import impulses
from pounding.diagnosis.effects.every_storey import EVERY
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.findings import Findings, Judged, fit_misfits
from pounding.diagnosis.inference.misfit import by_frame, floors, over_floor
from pounding.diagnosis.inference.model_checks import strained, stray_tones
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.settings import SETTINGS


def decide(found: Findings) -> Decision:
    """Return the verdict on findings; what speaks against the model is looked for here and nowhere else.

    To be called once for each set of findings: the decision is what everything after it is given.
    """
    judged = found.claimable()
    single = [one for one in judged if len(one.effects) == 1]
    if not single or not plain(found, single[0], signal_to_noise(found, single[0])):
        objections, said = _model_checks(found, found.null)
        if objections or (_something_left(found, found.null) and not within_model_error(found)):
            return Decision("unknown_effect", single[0] if single else found.null, (), said)
        return Decision("nothing_missing", found.null, (), said)
    chosen = _listed(found, single)
    doubles = [one for one in judged if len(one.effects) > 1]
    if doubles and (_worth(found, chosen, doubles[0]) or _eases(found, chosen, doubles[0])):
        chosen = _of_two(found, chosen, doubles[0])
    objections, said = _model_checks(found, chosen)
    held = _holds(found, chosen, objections)
    error = _common(chosen) and _as_an_error(found, found.null, chosen)
    unknown = not held and (_something_left(found, chosen) or _bends(found, chosen))
    if not objections and within_model_error(found) and (error or unknown):
        # No model of a real frame is better, and nothing with a place of its own, or that stands out, says why.
        return Decision("nothing_missing", found.null, (), said)
    if not held:
        return Decision("unknown_effect", chosen, (), said)
    alike = tuple(
        other
        for other in single
        if len(chosen.effects) == 1
        and other is not chosen
        and other.beside is chosen.beside
        and not other.effects[0].rival
        and (other.ln_bayes > chosen.ln_bayes - SETTINGS.decision.alike or _one_motion(found, chosen, other))
    )
    return Decision(
        "effect_class" if alike else "effect_named", chosen, alike, (*said, *_beside(found, chosen))
    )


def _beside(found: Findings, judged: Judged) -> tuple[str, ...]:
    """Return a sentence on the error of a frame that is in the model beside an effect, nothing without one."""
    if found.pair is not None or judged.beside is None:
        return ()
    error = judged.beside.label()
    return (f"the model also has a little {error}, which is as small as its other errors and no effect",)


def _listed(found: Findings, single: list[Judged]) -> Judged:
    """Return the best single effect; one of the catalogue where no rival is likelier and explains clearly more."""
    catalogue = [one for one in single if not one.effects[0].rival]
    if not catalogue or catalogue[0] is single[0]:
        return single[0]
    near = catalogue[0].ln_bayes > single[0].ln_bayes - SETTINGS.decision.rival
    return single[0] if not near and _clearly_more(found, catalogue[0], single[0]) else catalogue[0]


def _clearly_more(found: Findings, judged: Judged, rival: Judged) -> bool:
    """Return whether what is outside the catalogue leaves so much less than what is in it that it is needed."""
    left = [1.0 - explained(found, one, 1.0) for one in (judged, rival)]
    return left[1] <= SETTINGS.decision.rival_left * left[0]


def _model_checks(found: Findings, judged: Judged) -> tuple[bool, tuple[str, ...]]:
    """Return whether something speaks against effects however well they fit, and a sentence for each thing seen.

    A part of a real frame that sways by itself makes a tone too: one that is within the model's error is only said.
    """
    # What speaks against the model in a reference run was there before, and is no answer to what changed since.
    filtered = judged.fit.filtered.since(found.model)
    against = [] if _bends(found, judged) else strained(found.model, filtered)
    # A contact's push that was missed is no blow.
    pushed = None if _blind(found) else impulses(found.model, filtered)
    if pushed is not None:
        against.append(pushed.sentence())
    stray = stray_tones(found.model, filtered)
    objections = bool(against) or (bool(stray) and not within_model_error(found, judged))
    return objections, (*against, *stray)


def _bends(found: Findings, judged: Judged) -> bool:
    """Return whether effects alone make another frame of one that is itself, within its model's error, without them."""
    if not judged.effects or not within_model_error(found):
        return False
    another, itself = (bool(strained(found.model, one.fit.filtered)) for one in (judged, found.null))
    return another and not itself


def _something_left(found: Findings, judged: Judged) -> bool:
    """Return whether something remains that was not there before: more misfit than in the reference runs."""
    return remains(found, remaining(found, judged) / max(1.0, before(found, judged)))


def before(found: Findings, judged: Judged) -> float:
    """Return the misfit over the noise floor of the reference runs, as `remaining` does of the others; 1 without any."""
    if not found.reference:
        return 1.0
    filtered = judged.fit.filtered
    misfits = fit_misfits(found.model, filtered, found.reference)
    over = over_floor(found.model, misfits, floors(found.model, filtered, found.reference))
    return _of_frame_with_most(found, over[np.newaxis], 1.0)


def within_model_error(found: Findings, judged: Judged | None = None) -> bool:
    """Return whether effects, or the calibrated baseline model alone, leave no more than any real frame's model may leave.

    Where runs of the frame as it was before are there, the frame at hand is known, and nothing may be left. Frames that
    touch have thresholds of their own, and what their forces leave is no error of a frame.
    """
    if found.reference or found.pair is not None:
        return False
    return model_error(found, judged) <= found.model.prior.model_error


def model_error(found: Findings, judged: Judged | None = None) -> float:
    """Return what effects, or the calibrated baseline model alone, leave beyond the noise over the motion.

    It is that of the frame where it is most: median over its channels, mean over the runs.
    """
    misfit, floor = np.asarray((judged or found.null).channel_misfit), np.asarray(found.floor)
    return _of_frame_with_most(found, np.sqrt(np.maximum(misfit**2 - floor**2, 0.0)), 0.0)


def _as_an_error(found: Findings, without: Judged, judged: Judged) -> bool:
    """Return whether what effects take out of the motion is as small as the errors that every model of a frame has.

    It is less than the case allows, and no more than a few times the frame's other errors, which are the discrepancy beside
    them and what they leave: these say how large an error of this model is.
    """
    if found.reference or found.pair is not None:
        return False
    before, after = model_error(found, without), model_error(found, judged)
    taken = np.sqrt(max(before**2 - after**2, 0.0))
    if taken > found.model.prior.model_error:
        return False
    others = np.hypot(after, Sight.of(found, judged.fit.filtered).discrepancy())
    return bool(taken <= SETTINGS.decision.errors_alike * others)


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
        if not error.common or effect not in alone or not _as_an_error(found, alone[effect], double):
            continue
        if alone[effect] is single:
            return single
        if error in alone:
            return replace(double, ln_bayes=double.ln_bayes - alone[error].ln_bayes, beside=alone[error])
    return double


def _common(judged: Judged) -> bool:
    """Return whether effects are only such as every real frame has a little of."""
    return all(effect.common for effect in judged.effects)


def _blind(found: Findings) -> bool:
    return found.pair is not None and found.pair.blind


def _holds(found: Findings, judged: Judged, objections: bool) -> bool:
    """Return whether effects are what is missing, whatever remains beside them.

    They must explain the larger part of what can be explained on runs that they were not fitted to, and more where
    something else is known to act as well.
    """
    if any(effect.rival for effect in judged.effects) or strained(found.model, judged.fit.filtered):
        return False
    if _spread(judged):
        return False
    if not objections and not _something_left(found, judged):
        return True
    if objections:
        return explained(found, judged, 1.0) >= SETTINGS.decision.explained
    part = SETTINGS.decision.larger_part
    return explained(found, judged, 1.0) >= part or explained_beyond_errors(found, judged) >= part


def _spread(judged: Judged) -> bool:
    """Return whether one law seems to act in two storeys that meet: one thing across both, which is no such law."""
    if len(judged.effects) != 2:
        return False
    one, other = judged.effects
    if one.storey is None or other.storey is None:
        return False
    return one.name == other.name and one.frame == other.frame and abs(one.storey - other.storey) == 1


def remaining(found: Findings, judged: Judged) -> float:
    """Return the misfit over the noise floor of the frame that has most: median over its channels, mean over the runs.

    Training and held-out runs count alike. Where a pair's forces are those that the motion asks for, only the held-out
    floor knows how uncertain they are.
    """
    over_floors = _over(found, judged)
    if _blind(found) and np.isfinite(over_floors[1]).any():
        over_floors = over_floors[1:]
    return _of_frame_with_most(found, over_floors, 1.0)


def _of_frame_with_most(found: Findings, measures: np.ndarray, unknown: float) -> float:
    """Return a measure of channels (runs, channels) for the frame that has most: median over channels, mean over runs.

    `unknown` is returned where no channel has it.
    """
    each = by_frame(found.model, measures)
    known = np.isfinite(each).any(axis=0)
    return float(np.nanmean(each[:, known], axis=0).max()) if known.any() else unknown


def _over(found: Findings, judged: Judged) -> np.ndarray:
    """Return misfits over the noise floor of each channel, training and held-out runs, (2, channels)."""
    return over_floor(found.model, judged.channel_misfit, found.floor)


def signal_to_noise(found: Findings, judged: Judged, without: Judged | None = None) -> float:
    """Return how much effects take out of the channel where they show most, in units of that channel's noise.

    Contact forces being known, what acts on one frame moves that one alone: what else takes out of the channels of the
    other, such as another optimum of its parameters, does not count.

    Args:
        found: The findings.
        judged: The effects.
        without: What they are compared with; when None what they are judged beside, or the null model.
    """
    before, after = _over(found, without or judged.beside or found.null), _over(found, judged)
    taken = np.sqrt(np.maximum(before**2 - after**2, 0.0))[:, _moved(found, judged)]
    known = taken[:, np.isfinite(taken).any(axis=0)]
    return float(np.nanmean(known, axis=0).max(initial=0.0))


def _moved(found: Findings, judged: Judged) -> np.ndarray:
    """Return which channels effects can change, shape (channels,).

    Those of sensors change their own, others all of their frames, and what acts on no frame all.
    """
    model, frames = found.model, {effect.frame for effect in judged.effects}
    own = [effect.channel for effect in judged.effects if effect.channel is not None]
    if len(own) == len(judged.effects):
        return np.isin(model.observed.names, own)
    if None in frames:
        return np.ones(len(model.observed.names), bool)
    return np.asarray(np.any([model.at_frame(model.structure.index(str(frame))) for frame in frames], axis=0))


def explained(found: Findings, judged: Judged, nothing: float = SETTINGS.decision.confident_left) -> float:
    """Return the share of the explainable misfit that effects explain, on the held-out runs if there are any.

    Args:
        found: The findings.
        judged: The effects.
        nothing: Misfit over noise floor of a channel that counts as wholly explained.
    """
    which = 1 if found.held_out else 0
    before, after = _over(found, found.null)[which], _over(found, judged)[which]
    # Over all channels together, by power: a channel that never saw the effect should not decide.
    explainable = np.nansum(np.maximum(before**2 - 1, 0.0))
    left = np.nansum(np.maximum(after**2 - nothing**2, 0.0))
    return float(1 - np.sqrt(left / explainable)) if explainable > 0 else 1.0


def explained_beyond_errors(found: Findings, judged: Judged) -> float:
    """Return the share that effects explain of what is more than noise and the error that a model may have.

    It is nothing where they take less out of every channel than such an error could. No effect has to explain the errors of
    a model as well, which may be larger in all channels together than a fault of one sensor.
    """
    if found.reference or found.pair is not None:
        return 0.0
    which = 1 if found.held_out else 0
    errors = found.model.prior.model_error / np.asarray(found.floor)[which]
    before, after = (_over(found, one)[which] ** 2 for one in (found.null, judged))
    known = _moved(found, judged) & (before - 1.0 > errors**2)
    if not np.any((before - after > errors**2)[known]):
        return 0.0
    explainable, left = (
        np.nansum(np.maximum(each - 1.0 - errors**2, 0.0)[_moved(found, judged)]) for each in (before, after)
    )
    return float(1 - np.sqrt(left / explainable))


def _worth(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether a second effect explains a good part of what the first one leaves."""
    needs = SETTINGS.decision
    least = single.ln_bayes + _second_evidence(found, single, double) + needs.second_share * single.ln_bayes
    likely = double.ln_bayes > least
    if not likely or signal_to_noise(found, double, single) < needs.second_size:
        return False
    if not _together(double):
        return True
    # In the same storey it is more likely that the first one's law is not quite the catalogue's.
    which = 1 if found.held_out else 0
    left = [np.nansum(np.maximum(_over(found, one)[which] ** 2 - 1, 0.0)) for one in (single, double)]
    return bool(left[1] < (1 - needs.same_storey) * left[0])


def _eases(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether a frame that is another one with the first effect alone is itself with a likelier pair of effects.

    What the first effect leaves has then moved into stiffness and mass, where it shows as no misfit.
    """
    if any(effect.rival for effect in double.effects) or double.ln_bayes <= single.ln_bayes:
        return False
    alone, both = (strained(found.model, one.fit.filtered) for one in (single, double))
    return bool(alone) and not both


def _one_motion(found: Findings, one: Judged, other: Judged) -> bool:
    """Return whether two single effects move a shaken frame alike whatever their size; contact forces would part them."""
    return found.pair is None and same_motion(one.effects[0]) == other.effects[0]


def _together(judged: Judged) -> bool:
    """Return whether effects act in one storey, one in all storeys of a frame counting as in that of the other."""
    everywhere = any(effect.where == EVERY for effect in judged.effects)
    return len({(effect.frame, None if everywhere else effect.storey) for effect in judged.effects}) == 1


def _second_evidence(found: Findings, single: Judged, double: Judged) -> float:
    """Return the ln Bayes factor that a second effect needs beside a first one, whatever that one leaves."""
    if found.pair is None:
        return SETTINGS.decision.second_evidence
    second = (effect.absorbing for effect in double.effects if effect not in single.effects)
    return SETTINGS.pair_decision.second_factor * thresholds(found, any(second))[0]


def features(found: Findings, decision: Decision) -> Features:
    """Return what the confidence in a verdict rests on."""
    shown = decision.judged
    if decision.verdict == "nothing_missing" and found.judged:
        shown = found.judged[0]
    return features_of(found, decision, signal_to_noise(found, shown), explained(found, shown))
