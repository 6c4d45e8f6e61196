"""Noise of channels and table and latent forces at their likeliest, the frame's parameters being as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import (
    Filtered,
    reads_of,
    run_filter,
    run_signatures,
    whitened_innovations,
)
from pounding.diagnosis.model.kalman import Noise, filter_slopes
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.side_by_side import side_by_side
from pounding.diagnosis.settings import SETTINGS

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


def _of_run(model: Model, filtered: Filtered, number: int, latent: bool) -> Noise:
    """Return the likeliest noise of one run, that of the filtered model where nothing is to be gained."""
    run, first = filtered.runs[number], filtered.noise[number]

    def at(noise: Noise) -> Filtered:
        return run_filter(model, filtered.values, [noise], [run], filtered.effects)

    rms = np.nan_to_num(model.observed.rms(model.observed.runs[run]), nan=1.0)
    start = here = at(first)
    free = np.eye(2 + int(np.isfinite(first.channel).sum()))[0 if latent else 1 :]
    for _ in range(SETTINGS.refinement.noise_steps):
        before = here
        information, slope = _scored(model, here)
        information, slope = free @ information @ free.T, free @ slope
        if not (np.isfinite(information).all() and np.isfinite(slope).all()):
            break
        step = np.clip(np.linalg.solve(information + np.eye(len(free)), slope), -REACH, REACH) @ free
        trials = (at(_louder(here.noise[0], share * step, rms)) for share in SHARES)
        here = next((one for one in trials if one.log_likelihood > before.log_likelihood), before)
        if here.log_likelihood < before.log_likelihood + SETTINGS.refinement.noise_likelier:
            break
    gained = here.log_likelihood - start.log_likelihood
    return here.noise[0] if gained > SETTINGS.refinement.noise_likelier else first


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


def _scored(model: Model, here: Filtered) -> tuple[np.ndarray, np.ndarray]:
    """Return Fisher's information (numbers, numbers) and the slope (numbers,) of the log likelihood by each logarithm.

    Another gain corrects the states by more or less of each innovation, which the closed loop passes on; another covariance
    divides other noise out.

    Args:
        model: The baseline model.
        here: The filtered model of one run.
    """
    run = model.observed.runs[here.runs[0]]
    steady, innovations = here.filters[0], here.prediction.innovations[0]
    slopes = filter_slopes(model.linear_system(here.run_modes[0]), here.noise[0], run.step_s, steady)
    # What the filter corrects the model by, the motion lacks.
    still = np.zeros(len(innovations))
    true = innovations / reads_of(model, here, 0)
    columns = [[Term(still, jumps=(true, -one))] for one in slopes.gain]
    moved = run_signatures(model, here, 0, columns)
    white = whitened_innovations(model, here)[0]
    good = np.isfinite(run.measured)
    spread = steady.whitening @ slopes.covariance @ steady.whitening.T
    halves = np.tril(spread, -1) + 0.5 * spread * np.eye(len(steady.covariance))
    each = white.reshape(good.shape)
    seen = each.T @ each
    information = moved.T @ moved + 0.5 * len(innovations) * np.einsum("iab,jba->ij", spread, spread)
    slope = np.einsum("ab,iab->i", seen, halves) - white.astype(moved.dtype) @ moved
    return information, slope - 0.5 * np.einsum("iaa,a->i", spread, good.sum(axis=0))
