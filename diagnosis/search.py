"""The search: null model, scores of all candidates, refinement of the best, doubles, and what fits nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.baseline import calibrated, starting_noise
from diagnosis.believed import Believed
from diagnosis.calibrate import BOX, Baseline, log_likelihood, run_baseline
from diagnosis.catalogue import Effect, Scales
from diagnosis.evidence import Score, Scores, scales, score
from diagnosis.gap import channel_gaps, floors, simulate
from diagnosis.quantities import STANDARD_GRAVITY
from diagnosis.refine import Fit, refine
from diagnosis.sensors import SWAPPED_NATS, exchange, exchanged

if TYPE_CHECKING:
    from diagnosis.colliding import Pair

REFINED = 8
THOROUGH = 3
WORTH = 2.0
"""Candidates refined at most, those of them refined to the end, and the least evidence [nats] for which one is."""
UNEXPLAINED = 1.5
"""Gap over noise floor above which the search goes on: larger amplitudes, second effects."""
START_FACTORS = (0.5, 2.0)
"""Sizes tried beside the scored one before a refinement."""
RESCUE_LEVEL = 0.01
RESCUE_FACTORS = (0.5, 1.5, 4.0, 12.0)
RESCUED = 50.0
RESCUES = 3
RESCUED_STOREYS = 6
RESCUED_SCORES = 4
"""Where nothing fits: latent force, sizes tried, evidence [nats] that is worth a refinement, how many, where, and how
many of what scores best are tried as scored, from ordinary parameters as believed."""
RESTARTS, RESTARTED = 2, 5.0
"""How often, and for which gain [nats], the null model is calibrated again from where the likeliest effect led."""
SWAPPED_GAP = 0.6
"""Largest gap of two exchanged channels, as a share of that before, at which the exchange is believed."""
GAINS = (-2.0, STANDARD_GRAVITY - 1, 1 / STANDARD_GRAVITY - 1, 9.0, -0.9, 99.0, -0.99, 999.0, -0.999)
"""Relative changes tried for a sensor's gain: a wrong polarity, a unit typed wrong."""
SECOND = 12.0
"""Evidence [nats] that a second effect needs."""

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Judged:
    """A refined candidate as it is judged.

    Attributes:
        fit: The fit. nats: Its log evidence against the null model.
        gap: Median gap over the training and over the held-out runs (NaN without any).
        channel_gap: Gap of each channel over the training and the held-out runs, shape (2, channels).
        innovation: Mean square of the whitened innovations on the held-out runs, by the null model's filter.
    """

    fit: Fit
    nats: float
    gap: tuple[float, float]
    channel_gap: np.ndarray

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects in the fit."""
        return self.fit.effects


@dataclass
class Findings:
    """What the search found.

    Attributes:
        null: The refined null model. scores: All candidates about it.
        judged: Refined candidates, best first.
        floor: Gap that a perfect model would leave over the training and the held-out runs, (2, channels).
        sizes: Typical sizes of motion.
        training, held_out: Numbers of the runs.
    """

    believed: Believed
    null: Judged
    scores: Scores
    sizes: Scales
    training: tuple[int, ...]
    held_out: tuple[int, ...]
    judged: list[Judged] = field(default_factory=list)
    floor: np.ndarray = field(default_factory=lambda: np.zeros((2, 0)))
    later: Scores | None = None
    """Scores of second effects about the best fit."""
    pair: Pair | None = None
    """Two frames that touch, at the rate of the logger."""
    engine: dict[int, np.ndarray] = field(default_factory=dict)
    """Channels (samples, channels) in SI of each run as the engine gives them for the model of the verdict."""


def search(
    believed: Believed,
    effects: Sequence[Effect],
    training: Sequence[int],
    held_out: Sequence[int],
    progress: Progress,
) -> Findings:
    """Return what speaks for each effect."""
    progress("calibrating the believed model", 0.05)
    start = calibrated(believed, training)
    null = _null(believed, refine(believed, start, (), (), ()))
    believed, null = _unswapped(believed, null, training)
    runs = (tuple(training), tuple(held_out))
    found = _refined_best(believed, null, effects, runs, progress)
    for _ in range(RESTARTS):
        again = _null_again(found)
        if again.log_posterior < null.log_posterior + RESTARTED:
            break
        # The calibration had not found its optimum, and the effects got credit for leading there.
        null = again
        found = _refined_best(believed, null, effects, runs, progress)
    if found.judged:
        progress("looking for a second effect", 0.75)
        _second(found, effects)
    found.floor = _floor(found, best(found).fit)
    return found


def _refined_best(
    believed: Believed,
    null: Fit,
    effects: Sequence[Effect],
    runs: tuple[tuple[int, ...], tuple[int, ...]],
    progress: Progress,
) -> Findings:
    """Return the findings of single effects about a null model."""
    progress("scoring the catalogue", 0.25)
    sizes = scales(believed, null.baseline)
    scores = score(believed, null.baseline, effects, sizes)
    found = Findings(believed, judge(believed, null, null, *runs), scores, sizes, *runs)
    chosen = _chosen(scores)
    quick = []
    for count, one in enumerate(chosen):
        progress(f"refining {one.effect.label()}", 0.35 + 0.15 * count / max(len(chosen), 1))
        quick.append(_refined(found, null.baseline, one, thorough=False))
    order = sorted(range(len(chosen)), key=lambda i: -quick[i].log_posterior)
    if chosen and 0 not in order[:THOROUGH]:
        order.insert(THOROUGH - 1, 0)  # What scores best is refined to the end, however hard it is to start.
    for count, i in enumerate(order[:THOROUGH]):
        progress(f"refining {chosen[i].effect.label()} further", 0.5 + 0.05 * count)
        _keep(found, _refined(found, null.baseline, chosen[i], start=quick[i]))
    if unexplained(found, best(found)):
        progress("trying larger effects", 0.65)
        _rescue(found, effects)
    return found


def _null(believed: Believed, null: Fit) -> Fit:
    """Return the null model, calibrated also with small latent forces from the believed parameters if it leaves much."""
    if not _leaves(believed, null, null.baseline.runs):
        return null
    noise = starting_noise(believed, null.baseline.runs, RESCUE_LEVEL)
    start = run_baseline(believed, np.zeros(len(believed.std)), noise, null.baseline.runs)
    return max(null, refine(believed, start, (), (), ()), key=lambda fit: fit.log_posterior)


def _leaves(believed: Believed, fit: Fit, runs: tuple[int, ...]) -> bool:
    with np.errstate(invalid="ignore"):
        over = _channel_gaps(believed, fit, runs) / floors(believed, fit.baseline, runs)
        return bool(np.nanmedian(over) > UNEXPLAINED)


def _null_again(found: Findings) -> Fit:
    """Return the null model calibrated again from where the likeliest effect led, or the one at hand."""
    null, believed = found.null.fit, found.believed
    if best(found) is found.null:
        return null
    led = best(found).fit.baseline
    starts = [
        run_baseline(believed, led.values, noise, led.runs) for noise in (led.noise, null.baseline.noise)
    ]
    tried = [refine(believed, start, (), (), ()) for start in starts]
    return max([null, *tried], key=lambda fit: fit.log_posterior)


def _unswapped(believed: Believed, null: Fit, training: Sequence[int]) -> tuple[Believed, Fit]:
    """Return model and fit with two channels exchanged where that is plainly what was measured."""
    pair = exchange(believed, null.baseline)
    if pair is None:
        return believed, null
    observed = exchanged(believed.observed, *pair)
    again = Believed(believed.structure, observed, believed.prior)
    fit = refine(again, calibrated(again, training), (), (), ())
    runs = tuple(training)
    before, after = (_channel_gaps(*one, runs)[list(pair)].max() for one in ((believed, null), (again, fit)))
    if fit.log_posterior < null.log_posterior + SWAPPED_NATS or after > SWAPPED_GAP * before:
        return believed, null
    one, other = (observed.names[channel] for channel in pair)
    observed.warnings.append(
        f"channels {one} and {other} are swapped: the model fits far better with the two exchanged, and so it was done"
    )
    return again, fit


def judge(
    believed: Believed, fit: Fit, null: Fit, training: tuple[int, ...], held_out: tuple[int, ...]
) -> Judged:
    """Return a fit with its evidence and its gaps."""
    each = [_channel_gaps(believed, fit, runs) for runs in (training, held_out)]
    median = [float(np.nanmedian(gaps)) if np.isfinite(gaps).any() else float("nan") for gaps in each]
    return Judged(fit, fit.log_posterior - null.log_posterior, (median[0], median[1]), np.array(each))


def _channel_gaps(believed: Believed, fit: Fit, runs: tuple[int, ...]) -> np.ndarray:
    if not runs:
        return np.full(len(believed.observed.names), np.nan)
    outputs = simulate(believed, fit.baseline.values, fit.baseline.effects, runs)
    return channel_gaps(believed, outputs, runs)


def _floor(found: Findings, fit: Fit) -> np.ndarray:
    nothing = np.full(len(found.believed.observed.names), np.nan)
    return np.array(
        [
            floors(found.believed, fit.baseline, runs) if runs else nothing
            for runs in (found.training, found.held_out)
        ]
    )


def best(found: Findings) -> Judged:
    """Return the candidate with most evidence, or the null model."""
    return found.judged[0] if found.judged and found.judged[0].nats > 0 else found.null


def _keep(found: Findings, fit: Fit) -> None:
    judged = judge(found.believed, fit, found.null.fit, found.training, found.held_out)
    if np.isfinite(judged.nats):
        found.judged.append(judged)
    found.judged.sort(key=lambda one: -one.nats)


def _chosen(scores: Scores) -> list[Score]:
    """Return the candidates to refine: the best ones, and the best of those that look like none of them."""
    chosen: list[Score] = []
    for one in scores.ranked:
        if one.nats < WORTH or len(chosen) >= REFINED:
            break
        chosen.append(one)
    return chosen


def widths(believed: Believed, effect: Effect, sizes: Scales, shape: tuple[float, ...]) -> np.ndarray:
    """Return prior standard deviations of an effect's parameters; those refined as logarithms ignore them."""
    size = effect.size(believed, sizes, shape)
    start = effect.values(size, shape)
    return np.maximum(np.abs(start), 1e-12)


def _refined(
    found: Findings,
    baseline: Baseline,
    one: Score,
    with_fit: Fit | None = None,
    start: Fit | None = None,
    thorough: bool = True,
) -> Fit:
    believed, effect = found.believed, one.effect
    values = effect.values(one.amplitude, one.shape)
    width = widths(believed, effect, found.sizes, one.shape)
    if with_fit is not None:
        before = [widths(believed, e, found.sizes, e.grid(found.sizes)[0]) for e in with_fit.effects]
        moved = np.clip(baseline.values + one.ordinary, -BOX * believed.std, BOX * believed.std)
        return refine(
            believed,
            baseline,
            (*with_fit.effects, effect),
            (*with_fit.values, values),
            (*before, width),
            ordinary=moved,
        )
    if start is not None:
        return refine(believed, start.baseline, (effect,), (start.values[0],), (width,), thorough=thorough)
    values, ordinary = _better_start(found, baseline, one)
    return refine(believed, baseline, (effect,), (values,), (width,), thorough=thorough, ordinary=ordinary)


def _better_start(found: Findings, baseline: Baseline, one: Score) -> tuple[np.ndarray, np.ndarray]:
    """Return effect and ordinary parameters from which to refine: as scored, or a shape or size that predicts better.

    The score is linear in the amplitude and knows the shape on a coarse grid only.
    """
    believed, effect = found.believed, one.effect
    shapes = effect.grid(found.sizes)
    tried = [(one.shape, factor) for factor in (1.0, *START_FACTORS)]
    if len(shapes) > 1:
        tried += [
            (shape, 1.0) for shape in sorted(shapes, key=lambda shape: abs(shape[0] - one.shape[0]))[1:3]
        ]
    scanned = effect.near(one.shape)
    tried += [(shape, factor) for shape in scanned for factor in (0.5, 1.0)]
    limit = BOX * believed.std
    starts: list[tuple[np.ndarray, np.ndarray]] = []
    for shape, factor in tried:
        values = effect.values(factor * one.amplitude, shape)
        moved = np.clip(baseline.values + factor * one.ordinary, -limit, limit)
        # A scan over what is tuned is long enough with what the ordinary parameters give back.
        starts += [(values, moved)] if shape in scanned else [(values, moved), (values, baseline.values)]

    def likely(start: tuple[np.ndarray, np.ndarray]) -> float:
        values, ordinary = start
        with np.errstate(over="ignore", invalid="ignore"):
            found_there = run_baseline(
                believed, ordinary, baseline.noise, baseline.runs, [(effect, values)]
            ).log_likelihood
        return found_there if np.isfinite(found_there) else -np.inf

    return max(starts, key=likely)


def unexplained(found: Findings, judged: Judged) -> bool:
    """Return whether a fit leaves much more than noise in the training runs."""
    floor = floors(found.believed, judged.fit.baseline, found.training)
    with np.errstate(invalid="ignore"):
        return bool(np.nanmedian(judged.channel_gap[0] / floor) > UNEXPLAINED)


def _rescue(found: Findings, effects: Sequence[Effect]) -> None:
    """Try effects at several sizes with small latent forces: a strong one is not near the null model."""
    believed = found.believed
    ordinary = np.zeros(len(believed.std))
    tried: list[tuple[float, Effect, np.ndarray]] = []
    noise = starting_noise(believed, found.training, RESCUE_LEVEL)
    start = run_baseline(believed, ordinary, noise, found.training)
    gains = [steady.gain for steady in start.filters]
    scored = [
        (one.effect, one.effect.values(one.amplitude, one.shape))
        for one in found.scores.ranked[:RESCUED_SCORES]
    ]
    sized = [(effect, values) for effect in _suspects(found, effects) for values in _sizes(found, effect)]
    for effect, values in (*scored, *sized):
        if not effect.foil:
            likely = _likely(found, start, gains, [(effect, values)])
            if np.isfinite(likely) and likely > start.log_likelihood + RESCUED:
                tried.append((likely, effect, values))
    tried.sort(key=lambda entry: -entry[0])
    seen: list[Effect] = []
    for _, effect, values in tried:
        if effect in seen or len(seen) >= RESCUES:
            continue
        seen.append(effect)
        baseline = run_baseline(believed, ordinary, noise, found.training, [(effect, values)])
        width = np.maximum(np.abs(values), 1e-12)
        _keep(found, refine(believed, baseline, (effect,), (values,), (width,)))


def _sizes(found: Findings, effect: Effect) -> list[np.ndarray]:
    """Return the parameters of an effect that a rescue tries."""
    if effect.name == "sensor_gain":
        return [effect.values(change, ()) for change in GAINS]
    grid = effect.grid(found.sizes)
    tried = []
    for shape in grid[:: max(1, len(grid) // 4)]:
        size = (effect.sign or 1) * effect.size(found.believed, found.sizes, shape)
        tried += [effect.values(factor * size, shape) for factor in RESCUE_FACTORS]
    return tried


def _likely(
    found: Findings, start: Baseline, gains: Sequence[np.ndarray], acting: list[tuple[Effect, np.ndarray]]
) -> float:
    """Return the log likelihood of an effect at a size; one that changes no matrix can keep the filter's gain."""
    believed = found.believed
    with np.errstate(over="ignore", invalid="ignore"):
        if acting[0][0].where not in ("storey", "channel"):
            return run_baseline(believed, start.values, start.noise, start.runs, acting).log_likelihood
        prediction = believed.predict(start.values, gains, acting, start.runs)
        return log_likelihood(believed, prediction.innovations, start.filters, start.runs)


def _suspects(found: Findings, effects: Sequence[Effect]) -> list[Effect]:
    """Return what acts in the storeys that score best, on whole frames and on the table."""
    ranked = {one.effect: rank for rank, one in enumerate(found.scores.ranked)}
    storeys: list[int] = []
    for effect in sorted(effects, key=lambda e: ranked.get(e, len(ranked))):
        if effect.where == "storey" and effect.index not in storeys:
            storeys.append(effect.index)
    inside = storeys[:RESCUED_STOREYS]
    return [
        e
        for e in effects
        if (e.where == "storey" and e.index in inside)
        or (e.where in ("frame", "") and not e.foil)
        or e.name == "sensor_gain"
    ]


def _second(found: Findings, effects: Sequence[Effect]) -> None:
    fit = best(found).fit
    if not fit.effects:
        return
    believed = found.believed
    others = [effect for effect in effects if effect not in fit.effects]
    found.later = score(believed, fit.baseline, others, found.sizes, fit.columns)
    if found.later.ranked[0].nats < SECOND:
        return
    for one in found.later.ranked[:2]:
        if one.nats > SECOND:
            _keep(found, _refined(found, fit.baseline, one, fit))
