"""Refinement: ordinary and effect parameters together, on the predictor with the effect in it, and its evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.filtering import (
    BOX,
    Filtered,
    bounded_step,
    grouped_signatures,
    log_likelihood,
    matched_noise,
    motions,
    run_filter,
    whitened,
    whitened_innovations,
)
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.terms import nuisance_terms

DAMPINGS = (0.0, 0.1, 1.0, 10.0)
PATTERN = (0.1, 0.03, 0.01)
PATTERN_BELOW = 20.0
"""Damping of the Gauss-Newton step; strides of the search along single parameters, and the gain below which it runs."""
WORSE = 5.0
"""Loss of likelihood [nats] at which a step is taken back."""
LOG_WIDTH = 1.5
"""Prior standard deviation of a parameter that is refined as a logarithm."""
LARGEST_SLOPE = 1e12
"""Whitened derivative from which on the simulation has blown up."""
LAST = 6
"""Times as many steps at the end; a descent ends by itself when it gains nothing more."""
LEAST_LATENT = 1e-4
"""[N] below which a latent force is none."""
LATENT_STEP = 0.3
"""Factor by which the latent forces are reduced as long as the data like it better."""


@dataclass(frozen=True)
class Fit:
    """A refined set of effects.

    Attributes:
        effects: The effects. values: SI parameters of each.
        std: Standard errors of those.
        filtered: The predictor with them.
        log_posterior: Log likelihood plus log prior less half the log determinant of the information [nats].
        columns: Whitened, prior-scaled signatures of the effects' parameters in each run.
    """

    effects: tuple[Effect, ...]
    values: tuple[np.ndarray, ...]
    std: tuple[np.ndarray, ...]
    filtered: Filtered
    log_posterior: float
    columns: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Coordinates:
    """How the effects' SI parameters are varied: as logarithms or in units of `width`."""

    effects: tuple[Effect, ...]
    start: np.ndarray
    width: np.ndarray
    logarithmic: np.ndarray

    @classmethod
    def of(
        cls, effects: Sequence[Effect], values: Sequence[np.ndarray], widths: Sequence[np.ndarray]
    ) -> Coordinates:
        """Return coordinates that are zero at `values`."""
        logarithmic = np.concatenate(
            [np.array(effect.logarithmic()) for effect in effects] or [np.zeros(0, bool)]
        )
        start = np.concatenate([np.asarray(v, float) for v in values] or [np.zeros(0)])
        width = np.concatenate([np.asarray(w, float) for w in widths] or [np.zeros(0)])
        return cls(tuple(effects), start, np.where(logarithmic, LOG_WIDTH, width), logarithmic)

    def values(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the SI parameters of each effect at `x`, in units of the widths from the start."""
        moved = np.where(
            self.logarithmic,
            self.start * np.exp(np.clip(x * self.width, -6, 6)),
            self.start + x * self.width,
        )
        ends = np.cumsum([len(effect.quantities) for effect in self.effects])
        return tuple(np.split(moved, ends[:-1])) if self.effects else ()

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """Return d value / d x."""
        flat = np.concatenate(self.values(x)) if self.effects else np.zeros(0)
        return np.where(self.logarithmic, flat * self.width, self.width)

    def prior(self, x: np.ndarray) -> np.ndarray:
        """Return how far from the prior's centre: amplitudes are centred on zero, logarithms on the start."""
        return np.where(self.logarithmic, x, x + self.start / self.width)


def refine(
    model: Model,
    filtered: Filtered,
    effects: Sequence[Effect],
    values: Sequence[np.ndarray],
    widths: Sequence[np.ndarray],
    iterations: int = 3,
    thorough: bool = True,
    nuisance: np.ndarray | None = None,
) -> Fit:
    """Return the best fit of effects together with the nuisance parameters, the latent forces as small as they may be.

    Args:
        model: The baseline model.
        filtered: Where to start: nuisance parameters, noise and runs are taken from it.
        effects: Effects to put in; may be none.
        values: Their SI parameters to start from.
        widths: Prior standard deviations of those that are not logarithmic.
        iterations: Gauss-Newton steps for each size of the latent forces.
        thorough: Whether noise and latent forces are estimated again; else they stay as in `filtered`.
        nuisance: Other nuisance parameters from which it may start.
    """
    coordinates = Coordinates.of(effects, values, widths)
    x = np.zeros(len(coordinates.start))
    current = _start(model, filtered, coordinates, x, nuisance)
    current, x = _descend(model, current, coordinates, x, iterations)
    if not thorough:
        return _finished(model, current, coordinates, x)
    while current.noise[0].latent.max() > LEAST_LATENT:
        noise = tuple(replace(one, latent=LATENT_STEP * one.latent) for one in current.noise)
        trial = run_filter(model, current.values, noise, current.runs, current.effects)
        trial = run_filter(model, current.values, matched_noise(model, trial), trial.runs, trial.effects)
        trial, moved = _descend(model, trial, coordinates, x, iterations)
        if trial.log_likelihood < current.log_likelihood + 1.0:
            break
        current, x = trial, moved
    current = _table_noise(model, current)
    noise = matched_noise(model, current)
    trial = run_filter(model, current.values, noise, current.runs, current.effects)
    current = max(current, trial, key=lambda one: one.log_likelihood)
    current, x = _descend(model, current, coordinates, x, LAST * iterations)
    return _finished(model, current, coordinates, x)


def _start(
    model: Model,
    filtered: Filtered,
    coordinates: Coordinates,
    x: np.ndarray,
    nuisance: np.ndarray | None,
) -> Filtered:
    """Return where to start: with the null model's nuisance parameters, or, where those were bent, with the believed."""
    tried = [filtered.values, np.zeros(len(model.std))] + ([] if nuisance is None else [nuisance])
    starts = [_at(model, filtered, coordinates, x, values) for values in tried]
    return min(starts, key=lambda one: _misfit(model, one, coordinates, x, one.values))


def _at(
    model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray, nuisance: np.ndarray
) -> Filtered:
    acting = tuple(zip(coordinates.effects, coordinates.values(x), strict=True))
    return run_filter(model, nuisance, filtered.noise, filtered.runs, acting)


def _table_noise(model: Model, filtered: Filtered) -> Filtered:
    """Return the baseline with the table's noise that the data like best."""
    best = filtered
    for factor in (0.5, 2.0):
        for _ in range(3):
            noise = tuple(replace(one, table=factor * one.table) for one in best.noise)
            trial = run_filter(model, best.values, noise, best.runs, best.effects)
            if model.observed.contact_events:
                trial = _run_by_run(model, best, trial)
            if trial.log_likelihood < best.log_likelihood + 0.5:
                break
            best = trial
    return best


def _run_by_run(model: Model, one: Filtered, other: Filtered) -> Filtered:
    """Return a baseline with the likelier noise in each run: what a collision leaves is no noise of a run without one."""
    likely = [
        [
            log_likelihood(model, [series], [steady], [run])
            for series, steady, run in zip(each.prediction.innovations, each.filters, each.runs, strict=True)
        ]
        for each in (one, other)
    ]
    noise = [
        (one, other)[later > first].noise[i] for i, (first, later) in enumerate(zip(*likely, strict=True))
    ]
    return run_filter(model, one.values, noise, one.runs, one.effects)


def _descend(
    model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray, iterations: int
) -> tuple[Filtered, np.ndarray]:
    nuisance_columns: list[np.ndarray] | None = None
    for iteration in range(iterations):
        if nuisance_columns is None or iteration % 2 == 0:
            nuisance_columns = _nuisance_columns(model, filtered)
        columns = effect_columns(model, filtered, coordinates, x)
        residuals = whitened_innovations(model, filtered)
        start = np.concatenate([filtered.values / model.std, coordinates.prior(x)])
        gram, slope = _normal(nuisance_columns, columns, residuals)
        if not (np.isfinite(gram).all() and np.isfinite(slope).all()):
            # Where an effect blows up there is no direction to go.
            break
        before = _misfit(model, filtered, coordinates, x, filtered.values)
        after = before
        for damping in DAMPINGS:
            step = _step(gram, slope, start, len(model.std), damping)
            nuisance = filtered.values + step[: len(model.std)] * model.std
            moved = x + step[len(model.std) :]
            after = _misfit(model, filtered, coordinates, moved, nuisance)
            if after < before:
                break
        else:
            nuisance, moved = filtered.values, x
        if len(x) and before - after < PATTERN_BELOW:
            moved, after = _pattern(model, filtered, coordinates, moved, nuisance, min(after, before))
        if after >= before:
            break
        trial = _at(model, filtered, coordinates, moved, nuisance)
        if trial.log_likelihood < filtered.log_likelihood - WORSE:
            # The gain that fits the new parameters likes them less than the old gain did.
            break
        filtered, x = trial, moved
        if before - after < 0.2:
            break
    return filtered, x


def _pattern(
    model: Model,
    filtered: Filtered,
    coordinates: Coordinates,
    x: np.ndarray,
    nuisance: np.ndarray,
    cost: float,
) -> tuple[np.ndarray, float]:
    """Search the effects' own parameters one by one: sticking and touching make kinks that a slope does not see."""
    for stride in PATTERN:
        for j in range(len(x)):
            for sign in (1.0, -1.0):
                while True:
                    moved = x.copy()
                    moved[j] += sign * stride
                    tried = _misfit(model, filtered, coordinates, moved, nuisance)
                    if tried > cost - 0.1:
                        break
                    x, cost = moved, tried
    return x, cost


def _nuisance_columns(model: Model, filtered: Filtered) -> list[np.ndarray]:
    groups = [nuisance_terms(model, filtered.modes, motion) for motion in motions(model, filtered)]
    return [
        columns * model.std.astype(columns.dtype) for columns in grouped_signatures(model, filtered, groups)
    ]


def effect_columns(
    model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray
) -> list[np.ndarray]:
    """Return for each run the whitened derivative of the prediction with respect to the effects' coordinates."""
    found = [np.zeros((series.size, len(x)), np.float32) for series in filtered.prediction.innovations]
    slopes = coordinates.slopes(x)
    first = 0
    for effect in coordinates.effects:
        if effect.linear:
            # As the nuisance parameters' columns are made: two that mean the same must not differ by an approximation.
            groups = [
                [effect.terms(model, filtered.modes, motion, ())] for motion in motions(model, filtered)
            ]
            for store, column in zip(found, grouped_signatures(model, filtered, groups), strict=True):
                store[:, first] = column[:, 0] * slopes[first]
        else:
            for j in range(first, first + len(effect.quantities)):
                for store, column in zip(found, _difference(model, filtered, coordinates, x, j), strict=True):
                    store[:, j] = column
        first += len(effect.quantities)
    return found


def _difference(
    model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray, j: int
) -> list[np.ndarray]:
    """Return for each run the whitened derivative with respect to one coordinate, by a small change."""
    moved = x.copy()
    size = abs(x[j] + coordinates.start[j] / coordinates.width[j])
    delta = 1e-3 if coordinates.logarithmic[j] else 1e-3 * max(1.0, size)
    moved[j] += delta
    acting = tuple(zip(coordinates.effects, coordinates.values(moved), strict=True))
    gains = [steady.gain for steady in filtered.filters]
    prediction = model.predict(filtered.values, gains, acting, filtered.runs)
    found = []
    for number, run in enumerate(filtered.runs):
        change = filtered.prediction.innovations[number] - prediction.innovations[number]
        good = np.isfinite(model.observed.runs[run].measured)
        with np.errstate(over="ignore", invalid="ignore"):
            column = whitened(change / delta, filtered.filters[number], good).ravel()
        # A model that blows up at the small change has no slope there.
        found.append(column if np.all(np.abs(column) < LARGEST_SLOPE) else np.zeros_like(column))
    return found


def _normal(
    nuisance: Sequence[np.ndarray], columns: Sequence[np.ndarray], residuals: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    count = nuisance[0].shape[1] + columns[0].shape[1]
    gram, slope = np.zeros((count, count)), np.zeros(count)
    for one, other, residual in zip(nuisance, columns, residuals, strict=True):
        both = np.hstack([one, other]).astype(float)
        gram += both.T @ both
        slope += both.T @ residual
    return gram, slope


def _step(gram: np.ndarray, slope: np.ndarray, start: np.ndarray, boxed: int, damping: float) -> np.ndarray:
    """Return the damped Gauss-Newton step (Levenberg and Marquardt).

    The first `boxed` coordinates stay within their priors, the rest move by at most 1.
    """
    precision = gram + np.eye(len(gram)) + damping * np.diag(np.diag(gram))
    lower = np.concatenate([np.full(boxed, -BOX), start[boxed:] - 1.0])
    upper = np.concatenate([np.full(boxed, BOX), start[boxed:] + 1.0])
    return bounded_step(precision, slope - start, lower - start, upper - start)


def _misfit(
    model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray, nuisance: np.ndarray
) -> float:
    acting = tuple(zip(coordinates.effects, coordinates.values(x), strict=True))
    prediction = model.predict(nuisance, [steady.gain for steady in filtered.filters], acting, filtered.runs)
    total = 0.5 * float(np.sum((nuisance / model.std) ** 2) + np.sum(coordinates.prior(x) ** 2))
    for series, steady, run in zip(prediction.innovations, filtered.filters, filtered.runs, strict=True):
        good = np.isfinite(model.observed.runs[run].measured)
        # A trial step may well blow up: its misfit is then infinite, and the step is not taken.
        with np.errstate(over="ignore", invalid="ignore"):
            total += 0.5 * float(np.sum(whitened(series, steady, good) ** 2))
    return total if np.isfinite(total) else float("inf")


def _finished(model: Model, filtered: Filtered, coordinates: Coordinates, x: np.ndarray) -> Fit:
    columns = effect_columns(model, filtered, coordinates, x)
    gram, _ = _normal(_nuisance_columns(model, filtered), columns, whitened_innovations(model, filtered))
    precision = gram + np.eye(len(gram))
    log_prior = -0.5 * float(np.sum((filtered.values / model.std) ** 2) + np.sum(coordinates.prior(x) ** 2))
    posterior = filtered.log_likelihood + log_prior - 0.5 * float(np.linalg.slogdet(precision)[1])
    spread = np.sqrt(np.diag(np.linalg.inv(precision)))[len(model.std) :] * np.abs(coordinates.slopes(x))
    ends = np.cumsum([len(effect.quantities) for effect in coordinates.effects])
    return Fit(
        effects=coordinates.effects,
        values=coordinates.values(x),
        std=tuple(np.split(spread, ends[:-1])) if coordinates.effects else (),
        filtered=filtered,
        log_posterior=posterior,
        columns=tuple(columns),
    )
