"""The null model of a case: noise estimated from the data, nuisance parameters calibrated, nothing missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.refine import calibrated_further
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.noise import spectral_floor
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.settings import SETTINGS


def starting_noise(
    model: Model, runs: Sequence[int], level: float = SETTINGS.start.first_level
) -> list[Noise]:
    """Return noise to start from: channels by their spectral floor, latent forces by the storeys' shear.

    Args:
        model: The baseline model.
        runs: Numbers of the runs.
        level: Standard deviation of the latent forces as a share of the storeys' shear.
    """
    found = []
    mass = np.concatenate([frame.floor_mass for frame in model.structure.frames])
    for number in runs:
        run = model.observed.runs[number]
        rms = model.observed.rms(run)
        floor = np.array([spectral_floor(column, run.step_s) for column in run.measured.T])
        measured = np.isfinite(floor) & (rms > 0)
        channel = np.where(
            measured, np.maximum(floor, SETTINGS.start.least_noise * np.nan_to_num(rms)), np.inf
        )
        accelerations = rms[(model.observed.quantity == ACCELERATION) & measured]
        table = float(root_mean_square(run.table))
        typical = float(np.median(accelerations)) if len(accelerations) else 3.0 * table
        shear = np.concatenate(
            [
                np.cumsum(mass[span][::-1])[::-1] * typical
                for span in map(model.structure.span, range(len(model.structure.frames)))
            ]
        )
        found.append(
            Noise(level * shear, max(SETTINGS.start.table_noise * table, SETTINGS.start.least_table), channel)
        )
    return found


def uncalibrated(model: Model, runs: Sequence[int], level: float = SETTINGS.start.rescue_level) -> Filtered:
    """Return the baseline model as it is stated, by default with small latent forces.

    Args:
        model: The baseline model.
        runs: Numbers of the runs.
        level: As in `starting_noise`.
    """
    return run_filter(model, np.zeros(len(model.std)), starting_noise(model, runs, level), runs)


def calibrated(model: Model, runs: Sequence[int]) -> Filtered:
    """Return the null model, its latent forces going from large to as small as the data like."""
    filtered = calibrated_further(model, uncalibrated(model, runs, SETTINGS.start.first_level), 2)
    level = SETTINGS.start.first_level
    while level > SETTINGS.start.last_level:
        level *= SETTINGS.start.reduction
        noise = [replace(one, latent=SETTINGS.start.reduction * one.latent) for one in filtered.noise]
        trial = calibrated_further(model, run_filter(model, filtered.values, noise, runs), 2)
        if trial.log_likelihood < filtered.log_likelihood:
            break
        filtered = trial
    return filtered
