"""Refinement: nuisance and effect parameters together, on the predictor with the effect in it, and its evidence."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.constancy import between_windows
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.discrepancy import Linearised, wider
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.likeliest_noise import likeliest_noise
from pounding.diagnosis.inference.numbers import Numbers, NumbersTerm
from pounding.diagnosis.inference.posterior import (
    DAMPED,
    SHORTENED,
    Marquardt,
    Trials,
    descend,
    posterior_covariance,
)
from pounding.diagnosis.model.free_memory import give_back
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class Race:
    """What a refinement is up against.

    Attributes:
        ahead: Log likelihood of the likeliest other fit of these data; what will not come near it is not converged.
        about: That of the model about which it is refined: what that explains no effect has gained.
    """

    ahead: float = -np.inf
    about: float = -np.inf

    def lost(self, reached: float, before: float) -> bool:
        """Return whether a refinement will not come near what is ahead, by what it has gained.

        Args:
            reached: Its log likelihood.
            before: That from which the gain counts.
        """
        return reached + SETTINGS.refinement.catches_up * max(reached - before, 0.0) < self.ahead

    def stopped(self, reached: float, before: float, last: float) -> bool:
        """Return whether a refinement that lacks much of what is ahead gains too little to come near it.

        Args:
            reached: Its log likelihood.
            before: That from which the gain counts.
            last: That before its last step.
        """
        lacks = SETTINGS.refinement.catches_up * (self.ahead - reached)
        return lacks > reached - before and self.lost(reached, last)


ALONE = Race()
"""Nothing else is known of these data."""


@dataclass(frozen=True)
class Fit:
    """A refined set of effects.

    Attributes:
        effects: The effects. values: SI parameters of each.
        std: Standard errors of those, with what they vary between windows beyond chance (`inference.constancy`).
        between: That variation alone, of the same shapes.
        filtered: The predictor with them.
        nuisance_std: Standard errors of the nuisance parameters in their own units, shape (nuisance,).
        covariance: Of these and the effects' parameters in turn, in their own units and SI, shape (parameters, parameters).
        log_posterior: Log likelihood plus log prior less half the log determinant of the information.
        columns: Whitened, prior-scaled signatures of the effects' parameters in each run, and in the numbers beside them.
        to_the_end: Whether it was refined until nothing gained; not after the few steps of a first look, nor in a lost race.
    """

    effects: tuple[Effect, ...]
    values: tuple[np.ndarray, ...]
    std: tuple[np.ndarray, ...]
    between: tuple[np.ndarray, ...]
    nuisance_std: np.ndarray
    covariance: np.ndarray
    filtered: Filtered
    log_posterior: float
    columns: tuple[np.ndarray, ...]
    to_the_end: bool

    @property
    def key(self) -> Hashable:
        """What tells fits of the same data apart: effects with their sizes, and the frame."""
        numbers = (*self.values, self.filtered.values)
        return self.effects, self.filtered.discrepancy, tuple(one.tobytes() for one in numbers)

    def put_away(self) -> None:
        """Keep the prediction no longer; it is made again where it is asked for."""
        self.filtered.kept.put_away()

    def widened(self, by: float) -> tuple[np.ndarray, ...]:
        """Return each effect's standard errors, (parameters,) each, the likelihood's part of them so many times as large.

        Args:
            by: The factor; what varies between windows is as it is.
        """
        each = zip(self.std, self.between, strict=True)
        return tuple(_wider(std, between, by) for std, between in each)

    def stated(self, model: Model, sizes: Scales, wider: float = 1.0) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return SI parameters and standard errors of each effect, (parameters,) each, relative to the calibrated frame.

        The errors of effects on frames contain that of the law itself.

        Args:
            model: The baseline model.
            sizes: Typical sizes of the motion.
            wider: What the standard errors of the likelihood are multiplied by; what varies between windows is not.
        """
        found, first = [], len(self.nuisance_std)
        each = zip(self.effects, self.values, self.widened(wider), self.between, strict=True)
        for effect, values, std, between in each:
            beside = effect.relative_to(model)
            whole = 1.0 + float(self.filtered.values[beside].sum())
            if beside:
                # The quotient's error to first order: both come from the same data. What of the model discrepancy is of
                # this place nobody knows.
                share, which = values[0] / whole, [first, *beside]
                slope = np.array([1.0, *[-share] * len(beside)]) / whole
                square = slope @ self.covariance[np.ix_(which, which)] @ slope
                known = _wider(np.sqrt(square), between[0] / whole, wider)
                error = np.hypot(known, share * self.filtered.discrepancy)
                values, std = np.r_[share, values[1:]], np.r_[error, std[1:]]
            std = np.hypot(std, effect.law_error(model, values, sizes) * np.abs(values))
            found.append((values, std))
            first += len(values)
        return found


def _wider(std: np.ndarray, between: np.ndarray, wider: float) -> np.ndarray:
    """Return standard errors of which the part that is not between windows is so many times as large."""
    return np.asarray(np.sqrt(between**2 + wider**2 * np.maximum(std**2 - between**2, 0.0)))


def refine(
    model: Model,
    filtered: Filtered,
    effects: Sequence[Effect] = (),
    values: Sequence[np.ndarray] = (),
    widths: Sequence[np.ndarray] | None = None,
    iterations: int = SETTINGS.refinement.calming_steps,
    thorough: bool = True,
    nuisance: np.ndarray | None = None,
    race: Race = ALONE,
) -> Fit:
    """Return the best fit of effects together with the nuisance parameters, the latent forces as small as they may be.

    Args:
        model: The baseline model.
        filtered: Where to start: nuisance parameters, noise and runs are taken from it.
        effects: Effects to put in; may be none.
        values: SI parameters of each effect to start from, each of shape (parameters,).
        widths: Prior standard deviations of those that are not logarithmic [SI], each of shape (parameters,); as
            large as `values` by default.
        iterations: Steps at each size of the latent forces.
        thorough: Whether noise and latent forces are estimated again; else they stay as in `filtered`.
        nuisance: Other nuisance parameters from which it may start, in their own units, shape (nuisance,).
        race: What it is up against.
    """
    usual = [np.maximum(np.abs(one), 1e-12) for one in values]
    coordinates = Coordinates.of(
        model, effects, values, usual if widths is None else widths, discrepancy=filtered.discrepancy
    )
    theta = _start(model, filtered, coordinates, nuisance)
    start = Histories(model, _at(model, filtered, coordinates, theta), coordinates)
    began = start.filtered.log_likelihood
    histories, theta = _rescaled(*_descended(start, theta, iterations))
    if not thorough:
        return _finished(histories, theta, to_the_end=False)
    # What the histories have worked out is much, and only good for these.
    del start
    gained, scales, calm = np.inf, {filtered.discrepancy}, False
    while gained > SETTINGS.refinement.likelier:
        before = histories.filtered.log_likelihood
        if not calm:
            histories, theta, lost = _calmed(histories, theta, iterations, race, min(race.about, began))
            if lost:
                break
        histories = _with_noise(histories)
        quiet = histories.filtered.log_likelihood
        histories, theta = _descended(histories, theta, SETTINGS.refinement.steps)
        changed, moved = _rescaled(histories, theta)
        if changed is not histories:
            histories, theta = _descended(changed, moved, SETTINGS.refinement.steps)
        reached = histories.filtered.log_likelihood
        # What smaller forces and other noise gave once they will not give again.
        lost = race.lost(reached, quiet)
        calm = histories.filtered.discrepancy in scales
        scales.add(histories.filtered.discrepancy)
        if calm and not lost and reached < before + SETTINGS.refinement.likelier:
            # Steps that begin afresh creep in a long, bent valley, as between a frame's masses and the discrepancy.
            histories, theta = _descended(histories, theta, SETTINGS.refinement.steps, Marquardt())
        if calm:
            # What a smaller scale takes from the likelihood it gives to the prior: only rounds at one scale compare.
            gained = histories.filtered.log_likelihood - before
        if lost:
            break
    return _finished(histories, theta, to_the_end=gained <= SETTINGS.refinement.likelier)


def calibrated_further(
    model: Model, filtered: Filtered, iterations: int, trials: Trials = SHORTENED
) -> Filtered:
    """Return the filtered model with its nuisance parameters calibrated further; noise and effects stay as they are.

    Args:
        model: The baseline model.
        filtered: Where to start.
        iterations: Largest number of Gauss-Newton steps.
        trials: Which steps are tried.
    """
    fixed = Coordinates.of(model, (), (), (), filtered.effects, filtered.discrepancy)
    start = Histories(model, filtered, fixed)
    return _descended(start, fixed.theta(filtered.values), iterations, trials)[0].filtered


def calibrated_at_scale(model: Model, filtered: Filtered, scale: float, iterations: int) -> Filtered:
    """Return the filtered model calibrated with another scale of the model discrepancy; noise and effects stay as they are.

    Args:
        model: The baseline model.
        filtered: Where to start.
        scale: The scale [-].
        iterations: Largest number of Gauss-Newton steps.
    """
    fixed = Coordinates.of(model, (), (), (), filtered.effects, filtered.discrepancy)
    start, theta = Histories(model, filtered, fixed), fixed.theta(filtered.values)
    gram, slope = fixed.posterior(_terms(start)).normal_equations(theta)
    return _descended(*_at_scale(start, theta, gram, slope, scale), iterations, Marquardt())[0].filtered


def _descended(
    start: Histories, theta: np.ndarray, iterations: int, trials: Trials = DAMPED
) -> tuple[Histories, np.ndarray]:
    posterior, theta = descend(start.coordinates.posterior(_terms(start)), theta, iterations, trials)
    histories = posterior.terms[0]
    assert isinstance(histories, Histories)
    return histories.fresh(), theta


def _calmed(
    histories: Histories, theta: np.ndarray, iterations: int, race: Race, before: float
) -> tuple[Histories, np.ndarray, bool]:
    """Return the fit with latent forces as small as the data like, each size of them after a few steps, and whether it lost.

    Smaller latent forces part what is right from what is not: what gains little while something else gains much is not.

    Args:
        histories: The fit.
        theta: Its parameters, shape (parameters,).
        iterations: Steps at each size of the latent forces.
        race: What it is up against.
        before: Log likelihood from which its gain counts.
    """
    model, coordinates = histories.model, histories.coordinates
    smaller = True
    while smaller and histories.filtered.noise[0].latent.max() > SETTINGS.refinement.least_latent_n:
        current = histories.filtered
        reached = current.log_likelihood
        noise = tuple(replace(one, latent=SETTINGS.start.reduction * one.latent) for one in current.noise)
        trial = run_filter(model, current.values, noise, current.runs, current.effects)
        trial = likeliest_noise(model, trial, latent=False)
        descended, moved = _descended(Histories(model, trial, coordinates), theta, iterations)
        smaller = descended.filtered.log_likelihood > reached + SETTINGS.refinement.likelier
        if smaller:
            histories, theta = descended, moved
        there = histories.filtered.log_likelihood
        if race.lost(there, before) or race.stopped(there, before, reached):
            return histories, theta, True
    return histories, theta, False


def _rescaled(histories: Histories, theta: np.ndarray) -> tuple[Histories, np.ndarray]:
    """Return the fit with a likelier scale of the model discrepancy, and theta in its units; as it is without one.

    What slopes promise of a scale far from here need not be so: the likeliest that keeps its promise is taken.
    """
    model, filtered, coordinates = histories.model, histories.filtered, histories.coordinates
    if not model.discrepant.any():
        return histories, theta
    posterior = coordinates.posterior(_terms(histories))
    gram, slope = posterior.normal_equations(theta)
    if not (np.isfinite(gram).all() and np.isfinite(slope).all()):
        # Where an effect blows up there is no other scale to go to.
        return histories, theta
    here = posterior.log_evidence(theta, gram)
    for scale in Linearised(gram, slope, theta, model.discrepant, filtered.discrepancy).likelier():
        moved, there = _at_scale(histories, theta, gram, slope, scale)
        by = wider(model.discrepant, len(theta), scale / filtered.discrepancy)
        if moved.coordinates.posterior(_terms(moved)).log_evidence(there, gram * np.outer(by, by)) > here:
            return moved, there
    return histories, theta


def _at_scale(
    histories: Histories, theta: np.ndarray, gram: np.ndarray, slope: np.ndarray, scale: float
) -> tuple[Histories, np.ndarray]:
    """Return the fit with another scale of the model discrepancy, and theta in its units.

    What no longer fits into a smaller scale, others take over as far as slopes say.

    Args:
        histories: The fit.
        theta: Its parameters, shape (parameters,).
        gram, slope: Information (parameters, parameters) and slope (parameters,) of the data there.
        scale: The scale [-].
    """
    model, filtered, coordinates = histories.model, histories.filtered, histories.coordinates
    moved = replace(coordinates, scale=model.spread(scale))
    by = wider(model.discrepant, len(theta), scale / filtered.discrepancy)
    gram, slope, there = gram * np.outer(by, by), slope * by, theta / by
    posterior = moved.posterior(())
    inside = np.clip(there, posterior.lower, posterior.upper)
    onwards = inside + posterior.step(gram, slope - gram @ (inside - there), inside, 0.0)
    rescaled = filtered.with_discrepancy(scale)
    trials = [(Histories(model, _at(model, rescaled, moved, one), moved), one) for one in (inside, onwards)]
    return min(trials, key=lambda trial: moved.posterior(_terms(trial[0])).cost(trial[1]))


def _terms(histories: Histories) -> list[Histories | NumbersTerm]:
    """Return the runs' histories and the numbers that stand beside them, the histories first."""
    numbers = Numbers(histories.model, histories.filtered.runs)
    beside = [NumbersTerm(numbers, histories.coordinates)] if len(numbers) else []
    return [histories, *beside]


def _start(
    model: Model, filtered: Filtered, coordinates: Coordinates, nuisance: np.ndarray | None
) -> np.ndarray:
    """Return where to start: with the null model's nuisance parameters, or, where those were bent, with the baseline's."""
    tried = [filtered.values, np.zeros(len(model.std))] + ([] if nuisance is None else [nuisance])
    starts = [coordinates.theta(values) for values in tried]

    def cost(theta: np.ndarray) -> float:
        there = _at(model, filtered, coordinates, theta)
        return coordinates.posterior(_terms(Histories(model, there, coordinates))).cost(theta)

    return min(starts, key=cost)


def _at(model: Model, filtered: Filtered, coordinates: Coordinates, theta: np.ndarray) -> Filtered:
    return run_filter(
        model, coordinates.nuisance(theta), filtered.noise, filtered.runs, coordinates.acting(theta)
    )


def _with_noise(histories: Histories) -> Histories:
    """Return the fit with the likeliest noise and latent forces."""
    quiet = likeliest_noise(histories.model, histories.filtered)
    if quiet is histories.filtered:
        return histories
    return Histories(histories.model, quiet, histories.coordinates)


def _finished(histories: Histories, theta: np.ndarray, to_the_end: bool) -> Fit:
    model, filtered, coordinates = histories.model, histories.filtered, histories.coordinates
    terms = _terms(histories)
    posterior = coordinates.posterior(terms)
    gram, slope = posterior.normal_equations(theta)
    own = len(model.std)
    any_scale = Linearised(gram, slope, theta, model.discrepant, filtered.discrepancy).gained()
    size = np.concatenate([coordinates.scale, coordinates.slopes(theta)])
    scaled, between = posterior_covariance(gram), np.zeros(len(gram) - own)
    if coordinates.effects:
        between = between_windows(histories, theta, gram[own:, own:])
        scaled[range(own, len(scaled)), range(own, len(scaled))] += between
    covariance = scaled * np.outer(size, size)
    known = np.sqrt(np.diag(covariance))
    give_back()
    return Fit(
        effects=coordinates.effects,
        values=coordinates.values(theta),
        std=coordinates.split(known[own:]),
        between=coordinates.split(np.sqrt(between) * np.abs(size[own:])),
        nuisance_std=known[:own],
        covariance=covariance,
        filtered=filtered,
        log_posterior=posterior.log_evidence(theta, gram) + any_scale,
        columns=tuple(column for term in terms for column in term.effect_columns(theta)),
        to_the_end=to_the_end,
    )
