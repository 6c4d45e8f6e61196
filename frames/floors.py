"""Which floors of two frames are level, so that they can meet edge to edge."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

LEVEL_SHARE = 0.05
"""Floors are level if their heights differ by at most this share of the lowest storey of either frame [-].

For the frames of the thesis, with storeys of 100 mm, that is 5 mm, the thickness of a floor: plates that lie further apart
pass over each other. A share, not a length, because frames may be of any scale and stick frames have no plates.
"""


def level_floors(
    left_m: Sequence[float] | NDArray[np.float64], right_m: Sequence[float] | NDArray[np.float64]
) -> list[tuple[int, int]]:
    """Return the pairs of floors of two frames that are level, as floor numbers from 1, from the table up.

    Args:
        left_m: Height of each floor of one frame above the table [m], rising, shape (floors,).
        right_m: The same of the other frame, shape (its floors,).
    """
    left, right = np.asarray(left_m, float), np.asarray(right_m, float)
    lowest_storey = min(np.diff(heights, prepend=0.0).min() for heights in (left, right))
    away = np.abs(left[:, None] - right[None, :])
    # Rounding of a sum of storeys must not decide.
    level = away <= LEVEL_SHARE * lowest_storey * (1.0 + 1e-9)
    return [(int(i) + 1, int(j) + 1) for i, j in np.argwhere(level)]
