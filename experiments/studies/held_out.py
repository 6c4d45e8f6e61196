"""How near models of Table 4.1 come to peaks that they were not fitted to: records or frames left out, picks inside."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np

from pounding.experiments.records import RECORDS
from pounding.experiments.studies.peak_lattice import Freedom, Lattice
from pounding.experiments.studies.table_4_1 import FRAMES


def split_errors(lattice: Lattice, freedom: Freedom, count: int, every: bool) -> list[float]:
    """Return the mean error on the records that were not fitted, for each way to fit `count` of four [-].

    Args:
        lattice: The errors of all models.
        freedom: What may be chosen.
        count: How many records are fitted.
        every: Whether contested peaks count, too.
    """
    found = []
    for fitted in combinations(range(len(RECORDS)), count):
        chosen = lattice.fit(freedom, fitted, every=every)
        rest = [one for one in range(len(RECORDS)) if one not in fitted]
        found.append(lattice.error(chosen, rest, every=every))
    return found


def frame_errors(lattice: Lattice, freedom: Freedom) -> list[float]:
    """Return the mean error on each frame when the others are fitted; its own state is then the first that it may have.

    Args:
        lattice: The errors of all models.
        freedom: What may be chosen.
    """
    everything = range(len(RECORDS))
    found = []
    for left_out in FRAMES:
        rest = [name for name in FRAMES if name != left_out]
        found.append(lattice.error(lattice.fit(freedom, everything, rest), everything, [left_out]))
    return found


def picked_inside(
    models: Sequence[tuple[Lattice, Freedom]], every: bool = False
) -> tuple[float, list[Freedom]]:
    """Return the held-out error over six splits when the model, too, is picked inside each of them, and those picked.

    The one is picked that, fitted to one of the two records, is nearest on the other, both ways.

    Args:
        models: The models to pick from, each in its lattice.
        every: Whether contested peaks count, too.
    """
    errors, picked = [], []
    for pair in combinations(range(len(RECORDS)), 2):
        crossed = [
            np.mean(
                [
                    lattice.error(lattice.fit(one, [a], every=every), [b], every=every)
                    for a, b in (pair, pair[::-1])
                ]
            )
            for lattice, one in models
        ]
        lattice, best = models[int(np.argmin(crossed))]
        rest = [one for one in range(len(RECORDS)) if one not in pair]
        errors.append(lattice.error(lattice.fit(best, pair, every=every), rest, every=every))
        picked.append(best)
    return float(np.mean(errors)), picked


def row(lattice: Lattice, name: str, freedom: Freedom) -> dict[str, Any]:
    """Return how near a model comes to the peaks: fitted to all, and on what it was not fitted to [-].

    Args:
        lattice: The errors of all models.
        name: What the model is called.
        freedom: What it may choose.
    """
    chosen = lattice.fit(freedom, range(len(RECORDS)))
    halves = split_errors(lattice, freedom, 2, False)
    return {
        "model": name,
        "fitted": freedom.fitted,
        "all_58": chosen.error,
        "halves_58": float(np.mean(halves)),
        "halves_by_split": halves,
        "three_58": float(np.mean(split_errors(lattice, freedom, 3, False))),
        "frames_58": float(np.mean(frame_errors(lattice, freedom))),
        "all_64": lattice.fit(freedom, range(len(RECORDS)), every=True).error,
        "halves_64": float(np.mean(split_errors(lattice, freedom, 2, True))),
        "numbers": dict(chosen.numbers),
        "states": chosen.states,
    }
