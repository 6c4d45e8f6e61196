"""Scored candidates refined side by side, and the better fit of each kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.inference.evidence import Score
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.findings import Findings, Judged, judge_in, race
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.model.forked import forked
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.side_by_side import R, T
from pounding.diagnosis.settings import SETTINGS


def each(
    found: Findings,
    function: Callable[[T], R],
    pieces: Sequence[T],
    told: Callable[[T], None] | None = None,
) -> list[R]:
    """Return what is refined for each piece, side by side where there is memory for it.

    Args:
        found: The findings, whose data say how much memory a refinement takes.
        function: What refines a piece.
        pieces: The pieces.
        told: Called with each piece before it is refined.
    """
    return forked(function, pieces, told, found.shared, found.is_light)


def keep(found: Findings, fit: Fit) -> None:
    """Add a fit to what was judged, the better one only where two starts led to the same effects.

    Args:
        found: The findings.
        fit: The fit.
    """
    judged = judge_in(found, fit)
    # What blows up as soon as no filter corrects it explains nothing.
    moves = np.isfinite(judged.channel_misfit[0]) | ~np.isfinite(found.null.channel_misfit[0])
    if np.isfinite(judged.ln_bayes) and moves.all():
        found.judged.append(judged)
    ranked = sorted(found.judged, key=lambda one: -one.ln_bayes)
    best_of = {one.effects: one for one in reversed(ranked)}
    found.judged = [one for one in ranked if best_of[one.effects] is one]


def not_yet_likelier(judged: Sequence[Judged], quick: Sequence[Fit]) -> list[int]:
    """Return the numbers of fits that are worth refining to the end, the likeliest first.

    What was refined to the end from another start, and is likelier than it begins from this one, is known already.

    Args:
        judged: What was refined before.
        quick: The fits, after a few steps.
    """
    known = {frozenset(one.fit.effects): one.fit.log_posterior for one in judged if one.fit.to_the_end}
    order = sorted(range(len(quick)), key=lambda i: -quick[i].log_posterior)
    return [i for i in order if quick[i].log_posterior > known.get(frozenset(quick[i].effects), -np.inf)]


def widths(model: Model, effect: Effect, sizes: Scales, shape: tuple[float, ...]) -> np.ndarray:
    """Return prior standard deviations of an effect's parameters [SI], (parameters,); those of logarithms are not used.

    Args:
        model: The baseline model.
        effect: The effect.
        sizes: Typical sizes of the motion.
        shape: Values of what is not an amplitude, one of the effect's `grid`.
    """
    size = effect.size(model, sizes, shape)
    start = effect.values(size, shape)
    return np.asarray(np.maximum(np.abs(start), 1e-12))


def usual_widths(found: Findings, effects: Sequence[Effect]) -> list[np.ndarray]:
    """Return `widths` of effects, of each with the first of its shapes.

    Args:
        found: The findings.
        effects: The effects.
    """
    return [widths(found.model, one, found.sizes, one.grid(found.sizes)[0]) for one in effects]


def refined_at_its_noise(found: Findings, fit: Fit, filtered: Filtered) -> Fit:
    """Return a fit refined from what is filtered, noise and latent forces as they are there.

    Args:
        found: The findings.
        fit: The fit.
        filtered: Where it starts.
    """
    wide = usual_widths(found, fit.effects)
    best, gained = replace(fit, filtered=filtered, log_posterior=-np.inf), np.inf
    while gained > SETTINGS.refinement.likelier:
        start, steps = best.filtered, SETTINGS.refinement.steps
        then = refine(found.model, start, best.effects, best.values, wide, steps, thorough=False)
        gained = then.log_posterior - best.log_posterior
        best = max(best, then, key=lambda one: one.log_posterior)
    return best


def refined(
    found: Findings,
    filtered: Filtered,
    one: Score,
    with_fit: Fit | None = None,
    start: Fit | None = None,
    thorough: bool = True,
) -> Fit:
    """Return a scored candidate refined.

    Args:
        found: The findings.
        filtered: The model about which it was scored, filtered.
        one: The candidate's score.
        with_fit: A fit whose effects act beside it; when None it acts alone.
        start: A fit of all these that was ended early; when None it is refined from its score.
        thorough: Whether to refine to the end.
    """
    model, effect = found.model, one.effect
    width = widths(model, effect, found.sizes, one.shape)
    others, theirs = ((), ()) if with_fit is None else (with_fit.effects, with_fit.values)
    wide = (*usual_widths(found, others), width)

    against = race(found, with_fit)
    if start is not None:
        return refine(model, start.filtered, start.effects, start.values, wide, race=against)

    def fitted(start: tuple[np.ndarray, np.ndarray], thorough: bool) -> Fit:
        return refine(
            model,
            filtered,
            (*others, effect),
            (*theirs, start[0]),
            wide,
            thorough=thorough,
            nuisance=start[1],
            race=against,
        )

    starts = _starts(found, filtered, one)
    if len(starts) == 1:
        return fitted(starts[0], thorough)
    quick = max((fitted(start, False) for start in starts), key=lambda fit: fit.log_posterior)
    if not thorough:
        return quick
    return refine(model, quick.filtered, quick.effects, quick.values, wide, race=against)


def _starts(found: Findings, filtered: Filtered, one: Score) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return effect and nuisance parameters from which to refine: what predicts best of scored and other shapes and sizes.

    What acts in the filtered model acts beside it. The score is linear in the amplitude and knows the shape on a coarse
    grid only. Where another shape predicts better, the scored one is a start too: what is tuned to a mode moves its
    frequency, and predicts badly until the nuisance parameters have made up for that.
    """
    model, effect = found.model, one.effect
    shapes = effect.grid(found.sizes)
    tried = [(one.shape, factor) for factor in (1.0, *SETTINGS.search.start_factors)]
    if len(shapes) > 1:
        nearest = sorted(shapes, key=lambda shape: abs(shape[0] - one.shape[0]))
        tried += [(shape, 1.0) for shape in nearest[1 : 1 + SETTINGS.search.start_shapes]]
    limit = box_of(len(model.std)) * model.spread(filtered.discrepancy)
    starts: list[tuple[tuple[float, ...], np.ndarray, np.ndarray]] = []
    for shape, factor in tried:
        values = effect.values(factor * one.amplitude, shape)
        moved = np.clip(filtered.values + factor * one.nuisance, -limit, limit)
        starts.append((shape, values, moved))
        starts.append((shape, values, filtered.values))

    def likely(start: tuple[tuple[float, ...], np.ndarray, np.ndarray]) -> float:
        _, values, nuisance = start
        with np.errstate(over="ignore", invalid="ignore"):
            found_there = run_filter(
                model, nuisance, filtered.noise, filtered.runs, [*filtered.effects, (effect, values)]
            ).log_likelihood
        return found_there if np.isfinite(found_there) else -np.inf

    best = max(starts, key=likely)
    chosen = [best] if best[0] == one.shape else [best, starts[0]]
    return [(values, nuisance) for _, values, nuisance in chosen]
