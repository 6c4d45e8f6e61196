"""The search: scores of all candidates about the null model, refinement of the best, doubles, and what fits nothing."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial
from itertools import chain, count
from operator import call

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.frame import BaseRocking
from pounding.diagnosis.inference.evidence import Score, Scores, scales, score
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import (
    Findings,
    Judged,
    best,
    judge,
    leaders,
    noise_floor,
    unexplained,
    worth_anew,
)
from pounding.diagnosis.inference.model_checks import bent
from pounding.diagnosis.inference.null_model import best_null, null_again, unswapped
from pounding.diagnosis.inference.other_starts import Start, from_baseline, other_starts, softer
from pounding.diagnosis.inference.own_motion import moved_by_themselves
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.refining import each, keep, not_yet_likelier, refined
from pounding.diagnosis.inference.rescue import rescue
from pounding.diagnosis.inference.second import second
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS

Progress = Callable[[str, float], None]
Enough = Callable[[Findings], bool]
"""Says of single effects whether they are enough to go on with, so that no second effect need be looked for."""


def never(found: Findings) -> bool:
    """Return that single effects are not enough.

    Args:
        found: What was found of them.
    """
    return False


def silent(what: str, share: float) -> None:
    """Tell nobody of the progress.

    Args:
        what: What is being done.
        share: The share that is done.
    """


def search(
    model: Model,
    effects: Sequence[Effect],
    training: Sequence[int],
    held_out: Sequence[int],
    progress: Progress,
    start: Filtered | None = None,
    enough: Enough = never,
) -> Findings:
    """Return what the search finds of each effect.

    Args:
        model: The baseline model.
        effects: The candidates.
        training: Numbers of the runs that are fitted, reference runs among them.
        held_out: Numbers of the runs that are only predicted.
        progress: Called with what is being done and the share that is done.
        start: The null model as calibrated, where that is known already.
        enough: Whether single effects are enough, once they are refined.
    """
    progress("calibrating the baseline model", 0.05)
    start = start or calibrated(model, training)
    null = best_null(model, start)
    model, null = unswapped(model, null, training)
    runs = (model.since(training), tuple(held_out))
    found, again = _refined_best(model, null, effects, runs, progress)
    for _ in range(SETTINGS.search.restarts):
        if again is None:
            break
        # The calibration had not found its optimum, and the effects got credit for leading there.
        found, again = _refined_best(model, again, effects, runs, progress, found)
    found.floor = noise_floor(found, best(found).fit)
    if found.judged and not enough(found):
        progress("looking for a second effect", 0.75)
        second(found, effects)
        found.floor = noise_floor(found, best(found).fit)
    moved_by_themselves(found)
    return found


def _refined_best(
    model: Model,
    null: Fit,
    effects: Sequence[Effect],
    runs: tuple[tuple[int, ...], tuple[int, ...]],
    progress: Progress,
    before: Findings | None = None,
) -> tuple[Findings, Fit | None]:
    """Return the findings of single effects about a null model, those about another one before it among them.

    The second is a null model that is likelier, None without any.
    """
    progress("scoring the catalogue", 0.25)
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, effects, sizes)
    found = Findings(model, judge(model, null, null, *runs), scores, sizes, *runs)
    found.reference = tuple(run for run in null.filtered.runs if not model.acts(run))
    chosen = _chosen(scores)
    quick = each(
        found,
        partial(refined, found, null.filtered, thorough=False),
        chosen,
        lambda one: progress(
            f"refining {one.effect.label()}", 0.35 + 0.15 * chosen.index(one) / max(len(chosen), 1)
        ),
    )
    worth = not_yet_likelier(before.judged if before is not None else [], quick)
    order = [i for i in to_the_end(chosen, [fit.log_posterior for fit in quick]) if i in worth]

    _refine_to_the_end(found, [(chosen[i], quick[i]) for i in order], progress)
    for one in before.judged if before is not None else []:
        keep(found, one.fit)
    again = _led_further(found, [quick[i].effects for i in order[:1]])
    if before is None and (unexplained(found, best(found)) or bent(model, best(found).fit.filtered)):
        # What starts from the baseline model is the same about any null model.
        progress("trying larger effects", 0.65)
        led = best(found).effects
        rescue(found, effects)
        if best(found).effects != led:
            again = _led_further(found)
    return found, again


def _refine_to_the_end(found: Findings, ends: Sequence[tuple[Score, Fit]], progress: Progress) -> None:
    """Refine candidates to the end, and keep the fits.

    What leads is refined first, about the null model and from the baseline frame: of the others only those that come near it
    need be.

    Args:
        found: The findings, to which the fits are added.
        ends: Scores and fits of a few steps, the likeliest first.
        progress: Called with what is being done and the share that is done.
    """

    def further(one: tuple[Score, Fit]) -> list[Fit]:
        score, quick = one
        fit = refined(found, found.null.fit.filtered, score, start=quick)
        return [fit, softer(found, fit)] if isinstance(score.effect, BaseRocking) else [fit]

    turn = count()

    def told(one: tuple[Score, Fit]) -> None:
        progress(f"refining {one[0].effect.label()} further", 0.5 + 0.05 * next(turn))

    def kept(fits: list[list[Fit]]) -> None:
        for fit in chain.from_iterable(fits):
            keep(found, fit)

    if not ends:
        return
    leading, *others = ends
    _, quick = leading
    told(leading)
    both: list[Callable[[], list[Fit]]] = [
        partial(further, leading),
        lambda: [from_baseline(found, quick.effects, quick.values)],
    ]
    kept(each(found, call, both))
    kept(each(found, further, others, told))


def to_the_end(chosen: Sequence[Score], likely: Sequence[float]) -> list[int]:
    """Return the numbers of the candidates to refine to the end, the likeliest first.

    Among them are the one that scores best, however hard it is to start, and the likeliest that is no fault of a sensor:
    what is wrong with sensors says nothing of whether something is wrong with the frame.

    Args:
        chosen: The candidates, as they score.
        likely: Log posterior of each after a few steps.
    """
    order = sorted(range(len(chosen)), key=lambda i: -likely[i])
    ends = order[: SETTINGS.search.thorough]
    if chosen and 0 not in ends:
        ends[-1] = 0
    of_frames = [i for i in order if chosen[i].effect.channel is None][:1]
    return ends + [i for i in of_frames if i not in ends]


def _led_further(found: Findings, begun: Sequence[tuple[Effect, ...]] = ()) -> Fit | None:
    """Refine what leads, and what is alike, from other starts until these lead no further; return the null model from there.

    What leads much further from another start has moved itself, and so has where it starts from.

    Args:
        found: The findings, to which the fits are added.
        begun: What has been refined from the baseline frame already.
    """
    again: Fit | None = None
    known: set[Hashable] = set(begun)
    while True:
        led = leaders(found)
        if not led:
            return None
        # From where what leads still is nothing leads further than the last time.
        anew: list[Start] = [] if led[0].fit.key in known else [partial(null_again, found)]
        fits = each(found, call, [*anew, *other_starts(found, known)])
        if anew:
            again = fits.pop(0)
        known = {one.fit.key for one in led}
        for fit in fits:
            if fit is not None:
                keep(found, fit)
        if not _further(found, led):
            return again


def _further(found: Findings, led: Sequence[Judged]) -> bool:
    """Return whether something else leads now, or the same much further.

    Args:
        found: The findings.
        led: What led before.
    """
    now, enough = leaders(found), worth_anew(found)
    if [one.effects for one in now] != [one.effects for one in led]:
        return True
    return any(one.ln_bayes >= before.ln_bayes + enough for one, before in zip(now, led, strict=True))


def _chosen(scores: Scores) -> list[Score]:
    """Return the candidates to refine, the best first, and of those outside the catalogue only a few."""
    chosen: list[Score] = []
    rivals = 0
    for one in scores.ranked:
        if one.ln_bayes < SETTINGS.search.worth or len(chosen) >= SETTINGS.search.refined:
            break
        # A rival outside the catalogue acts alike on neighbouring floors, and two of them say enough.
        rivals += one.effect.rival
        if not one.effect.rival or rivals <= SETTINGS.search.rivals:
            chosen.append(one)
    return chosen
