"""The search: null model, scores of all candidates, refinement of the best, doubles, and what fits nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from diagnosis.baseline import calibrated, starting_noise
from diagnosis.believed import Believed
from diagnosis.calibrate import Baseline, log_likelihood, run_baseline
from diagnosis.catalogue import Effect, Scales
from diagnosis.evidence import Score, Scores, scales, score
from diagnosis.gap import channel_gaps, floors, simulate
from diagnosis.refine import Fit, refine

REFINED = 5
WORTH = 2.0
"""Candidates refined at most, and the least evidence [nats] for which one is."""
UNEXPLAINED = 1.5
"""Gap over noise floor above which the search goes on: larger amplitudes, second effects."""
RESCUE_LEVEL = 0.01
RESCUE_FACTORS = (0.5, 1.5, 4.0)
RESCUED = 50.0
RESCUES = 2
RESCUED_STOREYS = 6
"""Where nothing fits: latent force, sizes tried, evidence [nats] that is worth a refinement, how many, and where."""
SECOND = 12.0
"""Evidence [nats] that a second effect needs."""

Progress = Callable[[str, float], None]


@dataclass
class Findings:
    """What the search found.

    Attributes:
        null: The refined null model. scores: All candidates about it.
        fits: Refined candidates, best first; evidence is the difference of log posteriors to `null`.
        sizes: Typical sizes of motion.
        training, held_out: Numbers of the runs.
    """

    believed: Believed
    null: Fit
    scores: Scores
    sizes: Scales
    training: tuple[int, ...]
    held_out: tuple[int, ...]
    fits: list[Fit] = field(default_factory=list)
    later: Scores | None = None
    """Scores of second effects about the best fit."""

    def evidence(self, fit: Fit) -> float:
        """Return a fit's log evidence against the null model [nats]."""
        return fit.log_posterior - self.null.log_posterior


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
    null = refine(believed, start, (), (), ())
    progress("scoring the catalogue", 0.25)
    sizes = scales(believed, null.baseline)
    scores = score(believed, null.baseline, effects, sizes)
    found = Findings(believed, null, scores, sizes, tuple(training), tuple(held_out))
    chosen = _chosen(scores)
    for count, one in enumerate(chosen):
        progress(f"refining {one.effect.label()}", 0.35 + 0.3 * count / max(len(chosen), 1))
        found.fits.append(_refined(found, null.baseline, one))
    _sort(found)
    if _unexplained(found, best(found)):
        progress("trying larger effects", 0.65)
        _rescue(found, effects)
        _sort(found)
    if found.fits:
        progress("looking for a second effect", 0.75)
        _second(found, effects)
        _sort(found)
    return found


def best(found: Findings) -> Fit:
    """Return the fit with most evidence, or the null model."""
    return found.fits[0] if found.fits and found.evidence(found.fits[0]) > 0 else found.null


def _sort(found: Findings) -> None:
    found.fits.sort(key=lambda fit: -fit.log_posterior)


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


def _refined(found: Findings, baseline: Baseline, one: Score, with_fit: Fit | None = None) -> Fit:
    believed, effect = found.believed, one.effect
    values = effect.values(one.amplitude, one.shape)
    width = widths(believed, effect, found.sizes, one.shape)
    if with_fit is None:
        return refine(believed, baseline, (effect,), (values,), (width,))
    before = [widths(believed, e, found.sizes, e.grid(found.sizes)[0]) for e in with_fit.effects]
    return refine(
        believed, baseline, (*with_fit.effects, effect), (*with_fit.values, values), (*before, width)
    )


def _unexplained(found: Findings, fit: Fit) -> bool:
    believed = found.believed
    outputs = simulate(believed, fit.baseline.values, fit.baseline.effects, found.training)
    ratio = channel_gaps(believed, outputs, found.training) / floors(believed, fit.baseline, found.training)
    return bool(np.nanmedian(ratio) > UNEXPLAINED)


def _rescue(found: Findings, effects: Sequence[Effect]) -> None:
    """Try effects at several sizes with small latent forces: a strong one is not near the null model."""
    believed = found.believed
    ordinary = np.zeros(len(believed.std))
    tried: list[tuple[float, Effect, np.ndarray]] = []
    noise = starting_noise(believed, found.training, RESCUE_LEVEL)
    start = run_baseline(believed, ordinary, noise, found.training)
    gains = [steady.gain for steady in start.filters]
    for effect in _suspects(found, effects):
        grid = effect.grid(found.sizes)
        for shape in grid[:: max(1, len(grid) // 4)]:
            size = (effect.sign or 1) * effect.size(believed, found.sizes, shape)
            for factor in RESCUE_FACTORS:
                values = effect.values(factor * size, shape)
                acting = [(effect, values)]
                prediction = believed.predict(ordinary, gains, acting, found.training)
                with np.errstate(over="ignore", invalid="ignore"):
                    likely = log_likelihood(believed, prediction.innovations, start.filters, found.training)
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
        found.fits.append(refine(believed, baseline, (effect,), (values,), (width,)))


def _suspects(found: Findings, effects: Sequence[Effect]) -> list[Effect]:
    """Return the storeys' laws, in the storeys that score best where there are many."""
    ranked = {one.effect: rank for rank, one in enumerate(found.scores.ranked)}
    storeys: list[int] = []
    for effect in sorted(effects, key=lambda e: ranked.get(e, len(ranked))):
        if effect.where == "storey" and effect.index not in storeys:
            storeys.append(effect.index)
    return [e for e in effects if e.where == "storey" and e.index in storeys[:RESCUED_STOREYS]]


def _second(found: Findings, effects: Sequence[Effect]) -> None:
    fit = best(found)
    if not fit.effects:
        return
    believed = found.believed
    others = [effect for effect in effects if effect not in fit.effects]
    found.later = score(believed, fit.baseline, others, found.sizes, fit.columns)
    if found.later.ranked[0].nats < SECOND:
        return
    for one in found.later.ranked[:2]:
        if one.nats > SECOND:
            found.fits.append(_refined(found, fit.baseline, one, fit))
