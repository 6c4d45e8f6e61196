"""Storeys in a row, each a spring between two floors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]


def chain(storeys: Real) -> Real:
    """Return the stiffness matrix (n, n) of storeys (n,) in a row, the first on the base, in the unit of the storeys."""
    storeys = np.asarray(storeys, float)
    above = np.append(storeys[1:], 0.0)
    return np.diag(storeys + above) - np.diag(above[:-1], 1) - np.diag(above[:-1], -1)


def storeys_of(matrix: Real) -> Real:
    """Return the storeys (n,) of a stiffness matrix (n, n) that `chain` made."""
    above = np.append(-np.diag(matrix, 1), 0.0)
    return np.asarray(np.diag(matrix) - above)
