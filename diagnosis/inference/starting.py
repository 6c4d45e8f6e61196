"""The null model of a case: noise estimated from the data, ordinary parameters calibrated, nothing missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import Baseline, descend, run_baseline
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Believed
from pounding.diagnosis.model.noise import spectral_floor
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.predictor import ACCELERATION

FIRST_LEVEL = 0.3
REDUCTION = 0.3
LAST_LEVEL = 1e-5
"""Latent force as a share of a storey's shear: where calibration starts, by what it falls, and where it ends."""

TABLE_NOISE = 0.005
LEAST_NOISE = 0.003
"""Noise to start from: of the table over its rms; the least that is believed of any channel."""


def starting_noise(believed: Believed, runs: Sequence[int], level: float = FIRST_LEVEL) -> list[Noise]:
    """Return noise to start from: channels by their spectral floor, latent forces by the storeys' shear."""
    found = []
    mass = np.concatenate([frame.floor_mass for frame in believed.structure.frames])
    for number in runs:
        run = believed.observed.runs[number]
        rms = believed.observed.rms(run)
        floor = np.array([spectral_floor(column, run.step_s) for column in run.measured.T])
        measured = np.isfinite(floor) & (rms > 0)
        channel = np.where(measured, np.maximum(floor, LEAST_NOISE * np.nan_to_num(rms)), np.inf)
        accelerations = rms[(believed.observed.quantity == ACCELERATION) & measured]
        table = float(root_mean_square(run.table))
        typical = float(np.median(accelerations)) if len(accelerations) else 3.0 * table
        shear = np.concatenate(
            [
                np.cumsum(mass[span][::-1])[::-1] * typical
                for span in map(believed.structure.span, range(len(believed.structure.frames)))
            ]
        )
        found.append(Noise(level * shear, max(TABLE_NOISE * table, 1e-6), channel))
    return found


def calibrated(believed: Believed, runs: Sequence[int]) -> Baseline:
    """Return the null model, its latent forces going from large to as small as the data like."""
    baseline = run_baseline(believed, np.zeros(len(believed.std)), starting_noise(believed, runs), runs)
    baseline = descend(believed, baseline, 2)
    level = FIRST_LEVEL
    while level > LAST_LEVEL:
        level *= REDUCTION
        noise = [replace(one, latent=REDUCTION * one.latent) for one in baseline.noise]
        trial = descend(believed, run_baseline(believed, baseline.values, noise, runs), 2)
        if trial.log_likelihood < baseline.log_likelihood:
            break
        baseline = trial
    return baseline
