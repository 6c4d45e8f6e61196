"""Noise of channels and table and latent forces at their likeliest, the frame's parameters being as they are."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.side_by_side import side_by_side
from pounding.diagnosis.settings import SETTINGS

CHANGE = 0.01
"""Change of a logarithm by which slopes are taken."""
REACH = 1.0
"""Largest change of a logarithm in one step."""
SHARES = (1.0, 0.3, 0.1)
"""Shares of a step that are tried in turn."""


def likeliest_noise(model: Model, filtered: Filtered, latent: bool = True) -> Filtered:
    """Return the filtered model with the likeliest noise of channels and table and size of the latent forces in each run.

    Fisher's scoring of their logarithms, each run by itself: what an impact adds is no noise of a run without one.

    Args:
        model: The baseline model.
        filtered: Where to start; it is returned itself where nothing is to be gained.
        latent: Whether the latent forces change, too.
    """
    if not np.isfinite(filtered.log_likelihood):
        # Where an effect blows up its innovations are no noise.
        return filtered
    found = side_by_side(
        lambda number: _of_run(model, filtered, number, latent), list(range(len(filtered.runs)))
    )
    if all(one is other for one, other in zip(found, filtered.noise, strict=True)):
        return filtered
    return run_filter(model, filtered.values, found, filtered.runs, filtered.effects)


@dataclass(frozen=True)
class _Run:
    """One run with its noise.

    Attributes:
        noise: The noise.
        innovations: In SI, shape (samples, channels).
        covariance: Of these, as the filter expects it, shape (channels, channels).
        log_likelihood: Of these.
    """

    noise: Noise
    innovations: np.ndarray
    covariance: np.ndarray
    log_likelihood: float


def _of_run(model: Model, filtered: Filtered, number: int, latent: bool) -> Noise:
    """Return the likeliest noise of one run, that of the filtered model where nothing is to be gained."""
    run, first = filtered.runs[number], filtered.noise[number]

    def at(noise: Noise) -> _Run:
        one = run_filter(model, filtered.values, [noise], [run], filtered.effects)
        return _Run(noise, one.prediction.innovations[0], one.filters[0].covariance, one.log_likelihood)

    rms = np.nan_to_num(model.observed.rms(model.observed.runs[run]), nan=1.0)
    start = here = at(first)
    free = np.eye(2 + int(np.isfinite(first.channel).sum()))[0 if latent else 1 :]
    for _ in range(SETTINGS.refinement.noise_steps):
        before = here
        beside = [at(_louder(here.noise, CHANGE * row, rms)) for row in free]
        information, slope = _scored(here, beside)
        if not (np.isfinite(information).all() and np.isfinite(slope).all()):
            break
        step = np.clip(np.linalg.solve(information + np.eye(len(free)), slope), -REACH, REACH) @ free
        trials = (at(_louder(here.noise, share * step, rms)) for share in SHARES)
        here = next((one for one in trials if one.log_likelihood > before.log_likelihood), before)
        if here.log_likelihood < before.log_likelihood + SETTINGS.refinement.noise_likelier:
            break
    gained = here.log_likelihood - start.log_likelihood
    return here.noise if gained > SETTINGS.refinement.noise_likelier else first


def _louder(noise: Noise, by: np.ndarray, rms: np.ndarray) -> Noise:
    """Return noise of which the logarithms are larger: of the latent forces, of the table, and of each channel's.

    Args:
        noise: The noise.
        by: By how much, shape (2 + measured channels,).
        rms: Of each channel in SI, shape (channels,).
    """
    needs = SETTINGS.refinement
    channel = noise.channel.copy()
    known = np.isfinite(channel)
    channel[known] = np.maximum(np.exp(by[2:]) * channel[known], needs.least_channel * rms[known])
    latent = np.exp(by[0]) * noise.latent
    if latent.max() < needs.least_latent_n:
        latent = noise.latent
    table = max(float(np.exp(by[1])) * noise.table, SETTINGS.start.least_table)
    return replace(noise, latent=latent, table=table, channel=channel)


def _scored(here: _Run, beside: list[_Run]) -> tuple[np.ndarray, np.ndarray]:
    """Return Fisher's information (numbers, numbers) and the slope (numbers,) of the log likelihood by each logarithm."""
    inverse = np.linalg.inv(here.covariance)
    white = np.linalg.cholesky(inverse).T
    series = np.stack([((one.innovations - here.innovations) @ white.T).ravel() for one in beside]) / CHANGE
    spread = np.stack([inverse @ (one.covariance - here.covariance) for one in beside]) / CHANGE
    samples = len(here.innovations)
    information = series @ series.T + 0.5 * samples * np.einsum("iab,jba->ij", spread, spread)
    gained = np.array([one.log_likelihood - here.log_likelihood for one in beside]) / CHANGE
    return information, gained + 0.5 * CHANGE * np.diag(information)
