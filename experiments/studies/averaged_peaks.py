"""Peaks of Table 4.1 foretold by all models of the lattice at once, each with the weight that the fitted peaks give it.

A model picked from thousands by few peaks is one of many that fit them nearly as well. Their weighted median foretells
what was not fitted without a pick: every state and number of a lattice is as likely as any other beforehand, and so is
every lattice where there are several; errors of the fitted peaks follow Laplace's distribution, whose scale is the mean
error of the model that fits best. The median is the value of least mean error, by which the study judges (Bayesian
model averaging: Hoeting and others 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.records import RECORDS
from pounding.experiments.studies.peak_lattice import Freedom, Lattice
from pounding.experiments.studies.table_4_1 import FRAMES

Real = NDArray[np.float64]
NEGLIGIBLE = 1e-7
"""Weight over the largest below which a model is left out."""


def averaged(lattices: Sequence[Lattice], records: Sequence[int], every: bool = False) -> dict[str, Real]:
    """Return the weighted median of what all models say of each peak [mm], each frame's of shape (floors, records, sides).

    Args:
        lattices: The models, and the measured peaks.
        records: Numbers of the records whose peaks give the weights.
        every: Whether contested peaks give weights, too.
    """
    scale = min(one.fit(_free(one), records, every=every).error for one in lattices)
    joint = [_log_weights(one, records, every, scale) for one in lattices]
    found = {}
    for name in FRAMES:
        heaviest = max(float(logs[name].max()) for logs in joint)
        weights = [np.exp(logs[name] - heaviest) for logs in joint]
        heavy = [each > NEGLIGIBLE for each in weights]
        values = [one.predictions[name][chosen] for one, chosen in zip(lattices, heavy, strict=True)]
        chosen_weights = [each[chosen] for each, chosen in zip(weights, heavy, strict=True)]
        found[name] = weighted_median(np.concatenate(values), np.concatenate(chosen_weights))
    return found


def _free(lattice: Lattice) -> Freedom:
    """Return the freedom to choose all that a model of the lattice may."""
    return Freedom(tuple(lattice.axes), "fitted")


def _log_weights(lattice: Lattice, records: Sequence[int], every: bool, scale: float) -> dict[str, Real]:
    """Return the logarithm of each model's weight, by frame: over its states, the other frames' summed up."""
    free = _free(lattice)
    each = {name: -lattice.summed(name, free, records, every)[0] / scale for name in FRAMES}
    # States are the frames' own and the numbers are common to all frames.
    common = {name: np.logaddexp.reduce(logs, axis=0) for name, logs in each.items()}
    all_frames = np.sum(list(common.values()), axis=0)
    beforehand = np.log(all_frames.size)
    return {name: logs + (all_frames - common[name]) - beforehand for name, logs in each.items()}


def weighted_median(values: Real, weights: Real) -> Real:
    """Return the value at which half of the weight is reached, over the first axis, shape (...).

    Args:
        values: Values, shape (n, ...).
        weights: Weight of each, positive, shape (n,).
    """
    order = np.argsort(values, axis=0)
    reached = np.cumsum(weights[order], axis=0)
    middle = np.argmax(reached >= 0.5 * reached[-1], axis=0)
    at = np.take_along_axis(order, middle[None], axis=0)
    return np.asarray(np.take_along_axis(values, at, axis=0)[0])


def averaged_errors(lattices: Sequence[Lattice], count: int, every: bool = False) -> list[float]:
    """Return the mean error on the records that gave no weights, for each way to take `count` of four [-].

    Args:
        lattices: The models, and the measured peaks.
        count: How many records give the weights.
        every: Whether contested peaks count, too.
    """
    found = []
    for fitted in combinations(range(len(RECORDS)), count):
        rest = [one for one in range(len(RECORDS)) if one not in fitted]
        found.append(lattices[0].error_of(averaged(lattices, fitted, every), rest, every=every))
    return found
