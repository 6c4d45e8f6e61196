"""A second effect beside a first one, and beside others that the second may bring to the lead."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from operator import call

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.evidence import Score, Scores, score
from pounding.diagnosis.inference.findings import Findings, Judged, best, race
from pounding.diagnosis.inference.other_starts import from_baseline
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.refining import (
    each,
    keep,
    not_yet_likelier,
    refined,
    usual_widths,
)
from pounding.diagnosis.settings import SETTINGS


def second(found: Findings, effects: Sequence[Effect]) -> None:
    """Refine a second effect beside the leading one, where another one has evidence about it.

    What best explains two effects alone may be neither of them, but one that imitates the first and a little of the other.
    A single effect can overtake only if it was behind by less than the second gained: those are tried beside a second too.

    Args:
        found: The findings, to which the fits are added.
        effects: The candidates.
    """
    first = best(found)
    if not first.effects:
        return
    found.later = beside(found, effects, first)
    gained = best(found).ln_bayes - first.ln_bayes
    near = [one for one in found.judged if _may_overtake(one, first, gained)]
    for single in near[: SETTINGS.search.seconds]:
        led = best(found)
        later = beside(found, effects, single)
        if best(found) is not led:
            found.later = later
    _pair_further(found, first)


def _pair_further(found: Findings, first: Judged) -> None:
    """Refine what was found beside the leading effect once more from the baseline frame, and alone where it says much.

    What the leading effect left was in the frame's parameters, and a descent from there may end with a part of it. About a
    null model far from the frame a large effect may look like nothing, and be found only beside what imitates it: it may
    need that one no longer. The errors that the null model has stay beside it.

    Args:
        found: The findings, to which the fits are added.
        first: The effect that led alone.
    """
    both = best(found)
    gained = both.ln_bayes - first.ln_bayes
    if gained < SETTINGS.search.second:
        return
    starts: list[Callable[[], Fit]] = [partial(from_baseline, found, both.fit.effects, both.fit.values)]
    known = {one.effects for one in found.judged}
    null, scores = found.null.fit, {one.effect: one for one in reversed(found.scores.ranked)}
    own = list(zip(both.fit.effects, both.fit.values, strict=True))
    errors = [one for one in own if one[0] in null.effects]
    new = [one for one in own if one[0] not in null.effects and (one[0],) not in known]

    def refined_alone(one: tuple[Effect, np.ndarray]) -> Fit:
        filtered, (effects, values) = both.fit.filtered, zip(*errors, one, strict=True)
        wide = usual_widths(found, effects)
        fit = refine(found.model, filtered, effects, values, wide, nuisance=filtered.values, race=race(found))
        if fit.log_posterior > null.log_posterior or one[0] not in scores:
            return fit
        # It went astray without what it acted beside: what is less likely than nothing is no optimum.
        again = refined(found, null.filtered, scores[one[0]], null if errors else None)
        return max(fit, again, key=lambda either: either.log_posterior)

    if gained >= SETTINGS.decision.second_evidence:
        starts += [partial(refined_alone, one) for one in new]
    for fit in each(found, call, starts):
        keep(found, fit)


def _may_overtake(one: Judged, first: Judged, gained: float) -> bool:
    single = len(one.effects) == 1 and one.effects != first.effects and not one.effects[0].rival
    return single and one.ln_bayes > first.ln_bayes - gained


def beside(
    found: Findings, effects: Sequence[Effect], first: Judged, most: int = SETTINGS.search.seconds
) -> Scores:
    """Refine what has evidence beside effects; return the scores of all others about them.

    Args:
        found: The findings, to which the fits are added.
        effects: The candidates.
        first: A fit of effects, all of which stay free.
        most: So many are refined at a time, as long as the next one's score promises more than was gained.
    """
    fit = first.fit
    told = {*fit.effects, *map(same_motion, fit.effects)}
    others = [effect for effect in effects if effect not in told]
    later = score(found.model, fit.filtered, others, found.sizes, fit.columns)

    worth = _worth(later)
    for begin in range(0, most * SETTINGS.search.rounds, most):
        together = worth[begin : begin + most]
        if not together or together[0].ln_bayes < _gained(found, first):
            break
        _refine_beside(found, first, together)
    return later


def _gained(found: Findings, first: Judged) -> float:
    """Return what the best second effect beside effects has gained in log evidence."""
    inside = set(first.fit.effects)
    both = [one.ln_bayes for one in found.judged if inside < set(one.fit.effects)]
    return max(both, default=first.ln_bayes) - first.ln_bayes


def _refine_beside(found: Findings, first: Judged, worth: Sequence[Score]) -> None:
    fit = first.fit
    quick = each(found, partial(refined, found, fit.filtered, with_fit=fit, thorough=False), worth)
    order = not_yet_likelier(found.judged, quick)

    def both(i: int) -> Fit:
        return refined(found, fit.filtered, worth[i], fit, quick[i])

    # What leads is refined first: of the others only those that come near it need be.
    for together in (order[:1], order[1:]):
        for fitted in each(found, both, together):
            keep(found, fitted)


def _worth(later: Scores) -> list[Score]:
    """Return the effects to refine: those with evidence, and only a rival that is the very best."""
    return [
        one
        for number, one in enumerate(later.ranked)
        if one.ln_bayes > SETTINGS.search.second and not (number and one.effect.rival)
    ]
