"""Calibration inside the priors: Gauss-Newton on the filter's innovations, the latent forces going from large to small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from pounding.diagnosis.model.kalman import Noise, SteadyFilter, linear_system, steady_filter
from pounding.diagnosis.model.model import Acting, Model, Prediction
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.model.sensitivity import Term, signatures
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, nuisance_terms

BOX = 3.0
"""Prior standard deviations that an nuisance parameter may move: what lies beyond is not ordinary."""


@dataclass(frozen=True)
class Filtered:
    """A calibrated predictor: parameter values, effects in it, noise of each run, its filters, and what they leave.

    Attributes:
        values: Nuisance parameters in their own units.
        effects: Effects that act, with their SI parameters.
        modes: Modes with these.
        noise: Noise of each training run.
        filters: Steady filter of each training run.
        prediction: Innovations and states of each training run.
        log_likelihood: Of the innovations [nats].
        runs: Numbers of the runs used.
    """

    values: np.ndarray
    effects: tuple[tuple[Acting, np.ndarray], ...]
    modes: Modes
    noise: tuple[Noise, ...]
    filters: tuple[SteadyFilter, ...]
    prediction: Prediction
    log_likelihood: float
    runs: tuple[int, ...]


def run_filter(
    model: Model,
    values: np.ndarray,
    noise: Sequence[Noise],
    runs: Sequence[int],
    effects: Sequence[tuple[Acting, np.ndarray]] = (),
) -> Filtered:
    """Return the predictor at `values` with its steady filters and innovations."""
    modes = model.modes(model.assemble(values, effects))
    filters = design(model, modes, noise, runs)
    prediction = model.predict(values, [f.gain for f in filters], effects, runs)
    return Filtered(
        values=np.array(values, float),
        effects=tuple(effects),
        modes=modes,
        noise=tuple(noise),
        filters=filters,
        prediction=prediction,
        log_likelihood=log_likelihood(model, prediction.innovations, filters, runs),
        runs=tuple(runs),
    )


def design(
    model: Model, modes: Modes, noise: Sequence[Noise], runs: Sequence[int]
) -> tuple[SteadyFilter, ...]:
    """Return the steady filter of each run."""
    rows = model.structure.drift @ modes.floors
    system = linear_system(modes, rows, model.observed.quantity, model.observed.floor)
    return tuple(
        steady_filter(system, one, model.observed.runs[run].step_s)
        for one, run in zip(noise, runs, strict=True)
    )


def log_likelihood(
    model: Model,
    innovations: Sequence[np.ndarray],
    filters: Sequence[SteadyFilter],
    runs: Sequence[int],
) -> float:
    """Return the Gaussian log likelihood of the innovations [nats], missing samples left out."""
    total = 0.0
    for series, steady, run in zip(innovations, filters, runs, strict=True):
        good = np.isfinite(model.observed.runs[run].measured)
        total -= 0.5 * float(np.sum(whitened(series, steady, good) ** 2))
        total -= float(np.sum(good.sum(axis=0) * np.log(np.diag(_factor(steady)))))
    return total


def whitened(series: np.ndarray, steady: SteadyFilter, good: np.ndarray | None = None) -> np.ndarray:
    """Return a series (samples, channels[, terms]) with the innovations' covariance divided out."""
    factor = np.linalg.inv(_factor(steady)).astype(series.dtype)
    if good is not None and not good.all():
        series = np.where(good if series.ndim == 2 else good[..., None], series, 0.0)
    if series.ndim == 2:
        return np.asarray(series @ factor.T)
    return np.asarray(np.matmul(factor, series))


def _factor(steady: SteadyFilter) -> np.ndarray:
    return np.asarray(np.linalg.cholesky(steady.covariance))


def motions(model: Model, filtered: Filtered) -> list[Motion]:
    """Return the motion of each run of a baseline, as predicted and as filtered."""
    found = []
    for number, run in enumerate(filtered.runs):
        data, outputs = model.observed.runs[run], filtered.prediction.outputs[number]
        start = _motion(model, filtered.modes, filtered.prediction.after[number], data, outputs)
        predicted = _motion(model, filtered.modes, filtered.prediction.before[number], data, outputs)
        found.append(replace(predicted, start=start))
    return found


def _motion(model: Model, modes: Modes, states: np.ndarray, run: RunData, outputs: np.ndarray) -> Motion:
    n = len(modes.omega)
    eta, rate = states[:, :n], states[:, n : 2 * n]
    floor, floor_rate = eta @ modes.floors.T, rate @ modes.floors.T
    drift = model.structure.drift
    return Motion(
        run=run,
        eta=eta,
        eta_rate=rate,
        floor=floor,
        floor_rate=floor_rate,
        drift=floor @ drift.T,
        drift_rate=floor_rate @ drift.T,
        acceleration=_acceleration(model, modes, states),
        table_rate=states[:, -1],
        outputs=outputs,
        output_rate=_output_rate(model, modes, states, run),
    )


def _acceleration(model: Model, modes: Modes, states: np.ndarray) -> np.ndarray:
    """Return the absolute acceleration of every floor for predicted states, shape (samples, floors)."""
    floors = np.arange(model.structure.floors)
    rows = model.structure.drift @ modes.floors
    system = linear_system(modes, rows, np.full(len(floors), ACCELERATION), floors)
    return np.asarray(states @ system.output.T)


def _output_rate(model: Model, modes: Modes, states: np.ndarray, run: RunData) -> np.ndarray:
    """Return the rate of each channel that follows from the state alone, shape (samples, channels).

    A difference between predicted samples would hold the innovation that it is to be compared with.
    """
    system = linear_system(
        modes, model.structure.drift @ modes.floors, model.observed.quantity, model.observed.floor
    )
    table = system.output @ (system.force[:, :-1] @ modes.participation - system.force[:, -1])
    return np.asarray(states @ (system.output @ system.rate).T - np.outer(run.table, table))


def grouped_signatures(
    model: Model, filtered: Filtered, groups: Sequence[Sequence[list[Term]]]
) -> list[np.ndarray]:
    """Return whitened signatures of each run, (samples * channels, columns); `groups[run][column]` lists terms."""
    found = []
    for number, run in enumerate(filtered.runs):
        steady = filtered.filters[number]
        good = np.isfinite(model.observed.runs[run].measured)
        if good.all():
            each = signatures(steady, groups[number], np.linalg.inv(_factor(steady)))
        else:
            each = whitened(signatures(steady, groups[number], np.eye(good.shape[1])), steady, good)
        found.append(each.reshape(-1, each.shape[2]))
    return found


def whitened_innovations(model: Model, filtered: Filtered) -> list[np.ndarray]:
    """Return the whitened innovations of each run, flat."""
    return [
        whitened(series, steady, np.isfinite(model.observed.runs[run].measured)).ravel()
        for series, steady, run in zip(
            filtered.prediction.innovations, filtered.filters, filtered.runs, strict=True
        )
    ]


def normal_equations(model: Model, filtered: Filtered) -> tuple[np.ndarray, np.ndarray]:
    """Return the Gauss-Newton matrix and slope of the nuisance parameters in units of their priors, priors left out."""
    groups = [nuisance_terms(model, filtered.modes, motion) for motion in motions(model, filtered)]
    signature = grouped_signatures(model, filtered, groups)
    innovations = whitened_innovations(model, filtered)
    count = len(model.std)
    gram, slope = np.zeros((count, count)), np.zeros(count)
    for columns, series in zip(signature, innovations, strict=True):
        scaled = columns.astype(float) * model.std
        gram += scaled.T @ scaled
        slope += scaled.T @ series
    return gram, slope


def boxed_step(gram: np.ndarray, slope: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the step from `start` (in prior standard deviations) that stays within `BOX` of them."""
    return bounded_step(
        gram + np.eye(len(gram)),
        slope - start,
        np.full(len(start), -BOX) - start,
        np.full(len(start), BOX) - start,
    )


def bounded_step(precision: np.ndarray, pull: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return the least of s' precision s / 2 - pull' s between bounds (bounded least squares on its factor)."""
    factor = np.linalg.cholesky(precision).T
    free = np.linalg.solve(precision, pull)
    if np.all((free >= lower) & (free <= upper)):
        return np.asarray(free)
    # The start may lie on a bound, or past it by a rounding.
    bounds = (np.minimum(lower, -1e-9), np.maximum(upper, 1e-9))
    return np.asarray(lsq_linear(factor, factor @ free, bounds, method="bvls").x)


def misfit(model: Model, filtered: Filtered, values: np.ndarray) -> float:
    """Return half the sum of squares of whitened innovations and scaled parameters with the baseline's gains kept."""
    prediction = model.predict(
        values, [steady.gain for steady in filtered.filters], filtered.effects, filtered.runs
    )
    total = 0.5 * float(np.sum((values / model.std) ** 2))
    for series, steady, run in zip(prediction.innovations, filtered.filters, filtered.runs, strict=True):
        good = np.isfinite(model.observed.runs[run].measured)
        # A trial step may well blow up: its misfit is then infinite, and the step is not taken.
        with np.errstate(over="ignore", invalid="ignore"):
            total += 0.5 * float(np.sum(whitened(series, steady, good) ** 2))
    return total if np.isfinite(total) else float("inf")


def descend(model: Model, filtered: Filtered, iterations: int, enough: float = 0.5) -> Filtered:
    """Take up to `iterations` Gauss-Newton steps inside the priors, each halved until it helps.

    Gain and innovation covariance stay while a step is judged: were they to follow the parameters, a likelihood with
    too large a latent force would be improved by modes that shrink it rather than by ones that fit.
    """
    for _ in range(iterations):
        gram, slope = normal_equations(model, filtered)
        start = filtered.values / model.std
        step = boxed_step(gram, slope, start) * model.std
        before = misfit(model, filtered, filtered.values)
        for fraction in (1.0, 0.5, 0.2, 0.05):
            after = misfit(model, filtered, filtered.values + fraction * step)
            if after < before:
                break
        else:
            return filtered
        values = filtered.values + fraction * step
        filtered = run_filter(model, values, filtered.noise, filtered.runs, filtered.effects)
        if before - after < enough:
            break
    return filtered


def penalised(model: Model, filtered: Filtered) -> float:
    """Return log likelihood plus log prior of the nuisance parameters [nats]."""
    return filtered.log_likelihood - 0.5 * float(np.sum((filtered.values / model.std) ** 2))


def matched_noise(model: Model, filtered: Filtered) -> tuple[Noise, ...]:
    """Return the noise with each channel's variance moved to what the innovations show."""
    found = []
    for number, run in enumerate(filtered.runs):
        noise, steady = filtered.noise[number], filtered.filters[number]
        measured = np.isfinite(model.observed.runs[run].measured)
        count = np.maximum(measured.sum(axis=0), 1)
        seen = np.sum(filtered.prediction.innovations[number] ** 2, axis=0) / count
        expected = np.diag(steady.covariance)
        floor = 1e-4 * np.nan_to_num(model.observed.rms(model.observed.runs[run]), nan=1.0)
        ratio = np.clip(seen / expected, 0.1, 10.0)
        channel = np.where(np.isfinite(noise.channel), noise.channel * np.sqrt(ratio), np.inf)
        found.append(replace(noise, channel=np.maximum(channel, floor)))
    return tuple(found)
