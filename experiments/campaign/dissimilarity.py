"""How alike two force histories are: the thesis' dissimilarity and the ranking of the laws by it.

Section 6.6.2 calls it a Kolmogorov and Smirnov test: both histories are summed up over an interval, and
the largest difference of the sums is the dissimilarity. It is in newtons, not a probability, because
nothing is normalised, and it grows with the number of samples.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.stats import rankdata

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import RECORDS

PAIRS = (("10", "5B"), ("15B", "5B"), ("15B", "10"))


def dissimilarity(first_n: ArrayLike, second_n: ArrayLike) -> float:
    """Return the dissimilarity [N] of two force histories (m,) [N] at the same moments (section 6.6.2).

    Raises:
        ExperimentError: The histories are not rows of the same length, or hold something not finite.
    """
    first, second = np.asarray(first_n, float), np.asarray(second_n, float)
    if first.ndim != 1 or first.shape != second.shape or not first.size:
        raise ExperimentError(
            f"force histories of shapes {first.shape} and {second.shape}: give two rows of the same length"
        )
    if not (np.isfinite(first).all() and np.isfinite(second).all()):
        raise ExperimentError("a force history holds a value that is not finite")
    return float(np.abs(np.cumsum(first - second)).max())


def ranks(values: ArrayLike) -> NDArray[np.int64]:
    """Return each law's rank in each row (rows, laws): 1 for the lowest; equals share the better rank."""
    return np.asarray(rankdata(np.asarray(values, float), method="min", axis=1), np.int64)


def rank_sums(values: ArrayLike, laws: list[str]) -> dict[str, int]:
    """Return the sum of ranks of each law over all rows (rows, laws); the lowest is the best."""
    return dict(zip(laws, ranks(values).sum(axis=0).tolist(), strict=True))


def printed_values() -> pd.DataFrame:
    """Return Table 6.2 as one row an impact (40, 5) [N], in the order of Table 6.3's rows."""
    table = published.table("6.2").sort_index()
    rows = {}
    for left, right in PAIRS:
        block = table.xs((left, right))
        for record in RECORDS:
            for impact, values in block[record].dropna().iterrows():
                rows[left, right, record, int(impact)] = values.astype(float)
    found = pd.DataFrame(rows).T
    found.index.names = ["left", "right", "record", "impact"]
    return found


def counted_impacts() -> dict[tuple[str, str, str], int]:
    """Return the number of impacts that Table 6.2 lists for each (left, right, record); 40 in all."""
    return dict(Counter((left, right, record) for left, right, record, _ in printed_values().index))


def ranking_table() -> pd.DataFrame:
    """Return Table 6.3 recomputed from Table 6.2: ranks (40, 5), and whether the printed row agrees."""
    values = printed_values()
    found = pd.DataFrame(ranks(values), index=values.index, columns=values.columns)
    printed = published.table("6.3").drop(index="sum")
    found["agrees"] = (found.to_numpy() == printed[list(values.columns)].to_numpy(float)).all(axis=1)
    return found
