"""The search: scores of all candidates about the null model, refinement of the best, doubles, and what fits nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.effects.frame import BaseRocking, TorsionalEccentricity
from pounding.diagnosis.effects.rivals import FadingFriction
from pounding.diagnosis.effects.storey import CoulombFriction
from pounding.diagnosis.effects.whole_frame import EveryStorey, same_motion
from pounding.diagnosis.inference.clocks import clocks
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.inference.evidence import Score, Scores, scales, score
from pounding.diagnosis.inference.filtering import Filtered, log_likelihood, run_filter
from pounding.diagnosis.inference.findings import Findings, best, judge, noise_floor, unexplained
from pounding.diagnosis.inference.model_checks import bent
from pounding.diagnosis.inference.null_model import best_null, null_again, unswapped
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import calibrated, starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.side_by_side import R, T, in_turn, side_by_side
from pounding.diagnosis.settings import SETTINGS

Progress = Callable[[str, float], None]


def search(
    model: Model,
    effects: Sequence[Effect],
    training: Sequence[int],
    held_out: Sequence[int],
    progress: Progress,
    start: Filtered | None = None,
) -> Findings:
    """Return what the search finds of each effect.

    Args:
        model: The baseline model.
        effects: The candidates.
        training: Numbers of the runs that are fitted, reference runs among them.
        held_out: Numbers of the runs that are only predicted.
        progress: Called with what is being done and the share that is done.
        start: The null model as calibrated, where that is known already.
    """
    progress("calibrating the baseline model", 0.05)
    start = start or calibrated(model, training)
    null = best_null(model, refine(model, start))
    model, null = unswapped(model, null, training)
    runs = (model.since(training), tuple(held_out))
    found = _refined_best(model, null, effects, runs, progress)
    for _ in range(SETTINGS.search.restarts):
        again = null_again(found)
        worth = max(SETTINGS.search.restart_gain, SETTINGS.search.restart_share * best(found).ln_bayes)
        if again.log_posterior < null.log_posterior + worth:
            break
        # The calibration had not found its optimum, and the effects got credit for leading there.
        null = again
        found = _refined_best(model, null, effects, runs, progress)
    if found.judged:
        progress("looking for a second effect", 0.75)
        _second(found, effects)
    found.floor = noise_floor(found, best(found).fit)
    return found


def _refined_best(
    model: Model,
    null: Fit,
    effects: Sequence[Effect],
    runs: tuple[tuple[int, ...], tuple[int, ...]],
    progress: Progress,
) -> Findings:
    """Return the findings of single effects about a null model."""
    progress("scoring the catalogue", 0.25)
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, effects, sizes)
    found = Findings(model, judge(model, null, null, *runs), scores, sizes, *runs)
    found.reference = tuple(run for run in null.filtered.runs if not model.acts(run))
    chosen = _chosen(scores)
    quick = _each(
        found,
        partial(_refined, found, null.filtered, thorough=False),
        chosen,
        lambda one: progress(
            f"refining {one.effect.label()}", 0.35 + 0.15 * chosen.index(one) / max(len(chosen), 1)
        ),
    )
    order = sorted(range(len(chosen)), key=lambda i: -quick[i].log_posterior)
    if chosen and 0 not in order[: SETTINGS.search.thorough]:
        # What scores best is refined to the end, however hard it is to start.
        order.insert(SETTINGS.search.thorough - 1, 0)
    order = order[: SETTINGS.search.thorough]

    def further(i: int) -> list[Fit]:
        fit = _refined(found, null.filtered, chosen[i], start=quick[i])
        return [fit, softer(found, fit)] if isinstance(chosen[i].effect, BaseRocking) else [fit]

    def told(i: int) -> None:
        progress(f"refining {chosen[i].effect.label()} further", 0.5 + 0.05 * order.index(i))

    for fits in _each(found, further, order, told):
        for fit in fits:
            _keep(found, fit)
    _turned(found, effects)
    _ticked(found)
    _weighed(found)
    if unexplained(found, best(found)) or bent(model, best(found).fit.filtered):
        progress("trying larger effects", 0.65)
        _rescue(found, effects)
    _faded(found)
    return found


def _each(
    found: Findings,
    function: Callable[[T], R],
    pieces: Sequence[T],
    told: Callable[[T], None] | None = None,
) -> list[R]:
    """Return what is refined for each piece, side by side where there is memory for it."""
    observed = found.model.observed
    samples = sum(observed.runs[run].measured.size for run in found.training)
    if samples * len(found.model.std) < SETTINGS.search.side_by_side:
        return side_by_side(function, pieces, told)
    return in_turn(function, pieces, told)


def _keep(found: Findings, fit: Fit) -> None:
    """Add a fit to what was judged, the better one only where two starts led to the same effects."""
    judged = judge(found.model, fit, found.null.fit, found.training, found.held_out)
    if np.isfinite(judged.ln_bayes):
        found.judged.append(judged)
    ranked = sorted(found.judged, key=lambda one: -one.ln_bayes)
    best_of = {one.effects: one for one in reversed(ranked)}
    found.judged = [one for one in ranked if best_of[one.effects] is one]


def _chosen(scores: Scores) -> list[Score]:
    """Return the candidates to refine: the best ones, and the best of those that look like none of them."""
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


def _refined(
    found: Findings,
    filtered: Filtered,
    one: Score,
    with_fit: Fit | None = None,
    start: Fit | None = None,
    thorough: bool = True,
) -> Fit:
    model, effect = found.model, one.effect
    values = effect.values(one.amplitude, one.shape)
    width = widths(model, effect, found.sizes, one.shape)
    if with_fit is not None:
        before = [widths(model, e, found.sizes, e.grid(found.sizes)[0]) for e in with_fit.effects]
        limit = box_of(len(model.std)) * model.spread(filtered.discrepancy)
        moved = np.clip(filtered.values + one.nuisance, -limit, limit)
        return refine(
            model,
            filtered,
            (*with_fit.effects, effect),
            (*with_fit.values, values),
            (*before, width),
            nuisance=moved,
        )
    if start is not None:
        return refine(model, start.filtered, (effect,), (start.values[0],), (width,), thorough=thorough)
    values, nuisance = _better_start(found, filtered, one)
    return refine(model, filtered, (effect,), (values,), (width,), thorough=thorough, nuisance=nuisance)


def _better_start(found: Findings, filtered: Filtered, one: Score) -> tuple[np.ndarray, np.ndarray]:
    """Return effect and nuisance parameters from which to refine: as scored, or a shape or size that predicts better.

    The score is linear in the amplitude and knows the shape on a coarse grid only.
    """
    model, effect = found.model, one.effect
    shapes = effect.grid(found.sizes)
    tried = [(one.shape, factor) for factor in (1.0, *SETTINGS.search.start_factors)]
    if len(shapes) > 1:
        nearest = sorted(shapes, key=lambda shape: abs(shape[0] - one.shape[0]))
        tried += [(shape, 1.0) for shape in nearest[1 : 1 + SETTINGS.search.start_shapes]]
    scanned = effect.near(one.shape)
    tried += [(shape, factor) for shape in scanned for factor in SETTINGS.search.scanned_factors]
    limit = box_of(len(model.std)) * model.spread(filtered.discrepancy)
    starts: list[tuple[np.ndarray, np.ndarray]] = []
    for shape, factor in tried:
        values = effect.values(factor * one.amplitude, shape)
        moved = np.clip(filtered.values + factor * one.nuisance, -limit, limit)
        # A scan over what is tuned is long enough with what the nuisance parameters give back.
        starts += [(values, moved)] if shape in scanned else [(values, moved), (values, filtered.values)]

    def likely(start: tuple[np.ndarray, np.ndarray]) -> float:
        values, nuisance = start
        with np.errstate(over="ignore", invalid="ignore"):
            found_there = run_filter(
                model, nuisance, filtered.noise, filtered.runs, [(effect, values)]
            ).log_likelihood
        return found_there if np.isfinite(found_there) else -np.inf

    return max(starts, key=likely)


def softer(found: Findings, fit: Fit) -> Fit:
    """Refine a base that turns from one that is much softer: far from a fixed one its stiffness has other best values."""
    values = SETTINGS.search.softer * fit.values[0]
    return refine(found.model, found.null.fit.filtered, fit.effects, (values,))


def _turned(found: Findings, effects: Sequence[Effect]) -> None:
    """Refine floors that turn from where a mass on a spring led: the frequency of turning is as sharp as that of a mass."""
    leading = best(found)
    if [effect.name for effect in leading.effects] != ["appendage"]:
        return
    rival, fit = leading.effects[0], leading.fit
    for effect in effects:
        if isinstance(effect, TorsionalEccentricity) and effect.frame == rival.frame:
            values = effect.like_appendage(found.model, fit.filtered.values, rival.index, fit.values[0])
            turned = refine(found.model, fit.filtered, (effect,), (values,), nuisance=fit.filtered.values)
            _keep(found, turned)


def _ticked(found: Findings) -> None:
    """Refine clocks of another rate where an effect of table or sensors leads.

    They start from the baseline model, as what is rescued: a null model that follows a table out of step bears no other.
    """
    leading = best(found).effects
    if not leading or any(effect.where not in ("", "channel", "logger") for effect in leading):
        return
    start = _anew(found)

    def ticked(tried: tuple[Effect, np.ndarray]) -> Fit:
        clock, values = tried
        filtered = run_filter(found.model, start.values, start.noise, found.fitted, [(clock, values)])
        width = widths(found.model, clock, found.sizes, ())
        return refine(found.model, filtered, (clock,), (values,), (width,))

    for fit in _each(found, ticked, clocks(found.model, start, leading)[: SETTINGS.search.rescues]):
        _keep(found, fit)


def _weighed(found: Findings) -> None:
    """Refine the mass of a whole frame from where its stiffness led, or the other way round: a table tells only their ratio.

    Contact forces would tell them apart.
    """
    leading, model = best(found), found.model
    other = same_motion(leading.effects[0]) if len(leading.effects) == 1 else None
    if other is None or model.observed.contact_floors:
        return
    fit = leading.fit
    values = 1.0 / (1.0 + fit.values[0]) - 1.0
    _keep(found, refine(model, fit.filtered, (other,), (values,), nuisance=fit.filtered.values))


def _faded(found: Findings) -> None:
    """Refine friction that has faded by half or more at the usual rate, from where plain friction led.

    That of dry parts fades a little beside what breaks them loose: only what fades as a whole is no Coulomb friction.
    """
    leading = best(found)
    if len(leading.effects) != 1 or not isinstance(leading.effects[0], CoulombFriction):
        return
    plain, fit = leading.effects[0], leading.fit
    rival = FadingFriction(index=plain.index, frame=plain.frame, storey=plain.storey)
    usual = float(found.sizes.drift_rate[plain.index])

    def fading(share: float) -> Fit:
        force, stiffness = fit.values[0][:2]
        values = np.array([force * (1.0 + 1.0 / share), stiffness, share * usual])
        return refine(found.model, fit.filtered, (rival,), (values,))

    for faded in _each(found, fading, SETTINGS.search.faded):
        if faded.values[0][2] < usual:
            _keep(found, faded)


def _rescue(found: Findings, effects: Sequence[Effect]) -> None:
    """Start anew from the baseline model, with small latent forces: what scores best, and what is strong.

    A strong effect is not near the null model, and a null model that imitates one may hold its refinement back.
    """
    model = found.model
    start = _anew(found)

    def rescued(tried: tuple[Effect, np.ndarray]) -> Fit:
        effect, values = tried
        filtered = run_filter(model, start.values, start.noise, found.fitted, [tried])
        return refine(model, filtered, (effect,), (values,))

    for fit in _each(found, rescued, _hopeful(found, effects, start)):
        _keep(found, fit)


def _anew(found: Findings) -> Filtered:
    """Return the baseline model with small latent forces."""
    noise = starting_noise(found.model, found.fitted, SETTINGS.start.rescue_level)
    return run_filter(found.model, np.zeros(len(found.model.std)), noise, found.fitted)


def _hopeful(found: Findings, effects: Sequence[Effect], start: Filtered) -> list[tuple[Effect, np.ndarray]]:
    """Return effects and sizes to start anew with, each effect once at its likeliest size."""
    scored = [one for one in found.scores.ranked if not one.effect.rival][: SETTINGS.search.rescued_scores]
    tried = [
        (one.effect, one.effect.values(factor * one.amplitude, one.shape))
        for one in scored
        for factor in SETTINGS.search.rescued_factors
    ]
    if unexplained(found, best(found)):
        tried += [
            (effect, values) for effect in _suspects(found, effects) for values in _sizes(found, effect)
        ]
    gains = [steady.gain for steady in start.filters]
    likeliest: dict[Effect, tuple[float, np.ndarray]] = {}
    each = side_by_side(lambda one: _likely(found, start, gains, [one]), tried)
    for (effect, values), likely in zip(tried, each, strict=True):
        better = effect not in likeliest or likely > likeliest[effect][0]
        if np.isfinite(likely) and likely > start.log_likelihood + SETTINGS.search.rescued and better:
            likeliest[effect] = (likely, values)
    ranked = sorted(likeliest, key=lambda effect: -likeliest[effect][0])
    # Raw likelihood knows nothing of what the nuisance parameters can do: what scores best goes first.
    first = [one.effect for one in scored if one.effect in likeliest][:1]
    others = [effect for effect in ranked if effect not in first]
    chosen = first + others[: SETTINGS.search.rescues - len(first)]
    return [(effect, likeliest[effect][1]) for effect in chosen]


def _sizes(found: Findings, effect: Effect) -> list[np.ndarray]:
    """Return the parameters of an effect that a rescue tries."""
    if effect.name == "sensor_gain":
        return [effect.values(change, ()) for change in SETTINGS.search.gains]
    grid = effect.grid(found.sizes)
    tried = []
    for shape in grid[:: max(1, len(grid) // SETTINGS.search.rescue_shapes)]:
        size = (effect.sign or 1) * effect.size(found.model, found.sizes, shape)
        tried += [effect.values(factor * size, shape) for factor in SETTINGS.search.rescue_factors]
    return tried


def _likely(
    found: Findings, start: Filtered, gains: Sequence[np.ndarray], acting: list[tuple[Effect, np.ndarray]]
) -> float:
    """Return the log likelihood of an effect at a size; one that changes no matrix can keep the filter's gain."""
    model = found.model
    with np.errstate(over="ignore", invalid="ignore"):
        if acting[0][0].where not in ("storey", "channel") and not isinstance(acting[0][0], EveryStorey):
            return run_filter(model, start.values, start.noise, start.runs, acting).log_likelihood
        prediction = model.predict(start.values, gains, acting, start.runs, whole=False)
        return log_likelihood(model, prediction.innovations, start.filters, start.runs)


def _suspects(found: Findings, effects: Sequence[Effect]) -> list[Effect]:
    """Return what acts in the storeys that score best, on whole frames and on the table."""
    ranked = {one.effect: rank for rank, one in enumerate(found.scores.ranked)}
    storeys: list[int] = []
    for effect in sorted(effects, key=lambda e: ranked.get(e, len(ranked))):
        if effect.where == "storey" and effect.index not in storeys:
            storeys.append(effect.index)
    inside = storeys[: SETTINGS.search.rescued_storeys]
    return [
        e
        for e in effects
        if (e.where == "storey" and e.index in inside)
        or (e.where in ("frame", "all storeys", "") and not e.rival)
        or e.name == "sensor_gain"
    ]


def _second(found: Findings, effects: Sequence[Effect]) -> None:
    fit = best(found).fit
    if not fit.effects:
        return
    model = found.model
    told = {*fit.effects, *map(same_motion, fit.effects)}
    others = [effect for effect in effects if effect not in told]
    found.later = score(model, fit.filtered, others, found.sizes, fit.columns)
    if found.later.ranked[0].ln_bayes < SETTINGS.search.second:
        return
    worth = [
        one
        for number, one in enumerate(found.later.ranked[: SETTINGS.search.seconds])
        if one.ln_bayes > SETTINGS.search.second and not (number and one.effect.rival)
    ]
    for both in _each(found, lambda one: _refined(found, fit.filtered, one, fit), worth):
        _keep(found, both)
