"""Two channels that were swapped: told from how the null model likes their exchange."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, log_likelihood
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.settings import SETTINGS


def exchange(model: Model, null: Filtered) -> tuple[int, int] | None:
    """Return the two channels of one kind and frame whose exchange the null model likes best, if it likes one much."""
    observed = model.observed
    frames = [
        model.structure.place(int(floor))[0] if floor < model.structure.floors else ""
        for floor in observed.floor
    ]
    best, gain = None, SETTINGS.search.swapped
    gains = null.gains
    for one, other in combinations(range(len(observed.names)), 2):
        if observed.quantity[one] != observed.quantity[other] or frames[one] != frames[other]:
            continue
        trial = model.seeing(exchanged(observed, one, other))
        prediction = trial.predict(null.values, gains, (), null.runs)
        gained = log_likelihood(trial, prediction.innovations, null.filters, null.runs) - null.log_likelihood
        if gained > gain:
            best, gain = (one, other), gained
    return best


def exchanged(observed: Observations, one: int, other: int) -> Observations:
    """Return the observations with two channels' columns exchanged.

    Args:
        observed: The observations.
        one, other: Numbers of the channels.
    """
    order = np.arange(len(observed.names))
    order[[one, other]] = other, one
    return replace(
        observed,
        runs=tuple(
            replace(run, measured=np.ascontiguousarray(run.measured[:, order])) for run in observed.runs
        ),
    )
