"""What records say of the touching of floors and of limits, as samples to which fragilities are fitted."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.fragility.capacity import Limit
from pounding.experiments.fragility.lognormal import fit_capacities, fit_counts
from pounding.experiments.fragility.pictures import Sample

Real = NDArray[np.floating[Any]]


def of_touching(label: str, capacity_g: Real) -> Sample:
    """Return the sample of the intensities at which records bring floors together.

    Args:
        label: What touches.
        capacity_g: The intensity of each record at which it does (n,) [g].
    """
    shares = (np.arange(len(capacity_g)) + 0.5) / len(capacity_g)
    return Sample(label, lambda chosen: fit_capacities(capacity_g[chosen]), np.sort(capacity_g), shares)


def of_limit(limit: Limit, passed: NDArray[np.bool_], levels_g: Real) -> Sample:
    """Return the sample of how many records pass a limit at each level.

    Args:
        limit: The limit.
        passed: Whether each record at each level passes it (n, m).
        levels_g: The levels of the intensity (m,) [g].
    """
    label = (
        f"force above {limit.value / 1e3:g} kN"
        if limit.kind == "force"
        else f"drift above {100 * limit.value:g} %"
    )
    return Sample(label, lambda chosen: fit_counts(levels_g, passed[chosen]), levels_g, passed.mean(axis=0))
