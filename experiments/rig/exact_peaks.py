"""The largest displacements and drifts of a run, compiled: of thousands of runs only these are kept."""

from __future__ import annotations

from typing import Any

from numba import njit

from pounding.experiments.rig.exact_loop import turn


@njit(cache=True, nogil=True, error_model="numpy")
def largest(times: Any, value: Any, rate: Any, floors: Any, storeys: Any) -> None:
    """Fill in the largest magnitude of each floor's displacement and of each storey's drift.

    Between two steps with rates of opposite sign the motion is Hermite's cubic, and its turning point is found on it.

    Args:
        times: Times (m,) [s].
        value: Displacement of the floors, from the first up (m, n) [m].
        rate: Their velocity (m, n) [m/s].
        floors: Filled with the largest displacements (n,) [m].
        storeys: Filled with the largest drifts (n,) [m].
    """
    floors[:], storeys[:] = 0.0, 0.0
    for row in range(value.shape[0]):
        for k in range(value.shape[1]):
            d1, v1 = value[row, k], rate[row, k]
            e1, w1 = d1, v1
            if k > 0:
                e1, w1 = d1 - value[row, k - 1], v1 - rate[row, k - 1]
            floors[k], storeys[k] = max(floors[k], abs(d1)), max(storeys[k], abs(e1))
            if row == 0:
                continue
            d0, v0 = value[row - 1, k], rate[row - 1, k]
            e0, w0 = d0, v0
            if k > 0:
                e0, w0 = d0 - value[row - 1, k - 1], v0 - rate[row - 1, k - 1]
            step = times[row] - times[row - 1]
            if v0 * v1 < 0.0:
                floors[k] = max(floors[k], abs(turn(d0, step * v0, d1, step * v1)[1]))
            if w0 * w1 < 0.0:
                storeys[k] = max(storeys[k], abs(turn(e0, step * w0, e1, step * w1)[1]))
