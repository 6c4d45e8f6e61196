"""Starts anew from the baseline model: for effects too strong to be near the null model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.every_storey import EveryStorey
from pounding.diagnosis.inference.filtering import Filtered, log_likelihood, run_filter
from pounding.diagnosis.inference.findings import Findings, best, race, unexplained
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.refining import each, keep
from pounding.diagnosis.inference.starting import uncalibrated
from pounding.diagnosis.model.kalman import Gain
from pounding.diagnosis.model.side_by_side import side_by_side
from pounding.diagnosis.settings import SETTINGS


def rescue(found: Findings, effects: Sequence[Effect]) -> None:
    """Start anew from the baseline model, with small latent forces: what scores best, and what is strong.

    A strong effect is not near the null model, and a null model that imitates one may hold its refinement back.

    Args:
        found: The findings, to which the fits are added.
        effects: The candidates.
    """
    model = found.model
    start, against = uncalibrated(model, found.fitted), race(found)

    def rescued(tried: tuple[Effect, np.ndarray]) -> Fit:
        effect, values = tried
        filtered = run_filter(model, start.values, start.noise, found.fitted, [tried])
        return refine(model, filtered, (effect,), (values,), race=against)

    for fit in each(found, rescued, _hopeful(found, effects, start)):
        keep(found, fit)


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
    gains = start.gains
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
    found: Findings, start: Filtered, gains: Sequence[Gain], acting: list[tuple[Effect, np.ndarray]]
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
