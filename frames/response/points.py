"""Coordinates for the body of a frame: the table coupled in, and places on floors as coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pounding.frames.errors import FrameError

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


def coupled(mass: Real, influence: Real) -> Real:
    """Return the mass matrix (n + 1, n + 1) of relative coordinates and the table's displacement.

    Args:
        mass: Mass of the relative coordinates (n, n) [kg].
        influence: Their motion under a unit translation of the table (n,) [-].
    """
    moved = mass @ influence
    return np.block([[mass, moved[:, None]], [moved[None, :], np.array([[influence @ moved]])]])


def bordered(matrix: Real) -> Real:
    """Return a matrix with a row and a column of zeros for the table, (n + 1, n + 1).

    Args:
        matrix: Any matrix (n, n).
    """
    return np.pad(matrix, ((0, 1), (0, 1)))


def point_basis(
    reduced: ReducedFrame, points: Iterable[tuple[int, float]]
) -> tuple[Real, dict[tuple[int, float], int]]:
    """Return (n, n) from the body's coordinates to the frame's, and the coordinate of each point.

    Each point's displacement takes the place of the coordinate that it moves with most; the floors' own
    displacements stay coordinates.
    """
    rows = np.eye(len(reduced.mass))
    taken = {int(index) for index in reduced.floor_x}
    places: dict[tuple[int, float], int] = {}
    for floor, y_m in points:
        row = np.asarray(reduced.point_row(checked_floor(reduced, floor), y_m), float)
        # Weighted by a typical amplitude, that of a unit of strain energy, to compare metres with radians.
        weight = np.abs(row) / np.sqrt(np.diag(reduced.stiffness))
        if y_m == 0.0:
            places[floor, y_m] = int(reduced.floor_x[floor - 1])
            continue
        weight[list(taken)] = 0.0
        pivot = int(weight.argmax())
        if weight[pivot] == 0.0:
            raise FrameError(
                f"{reduced.name}: floor {floor} cannot move at y = {y_m} m apart from its middle"
            )
        rows[pivot] = row
        taken.add(pivot)
        places[floor, y_m] = pivot
    return np.linalg.inv(rows), places


def checked_floor(reduced: ReducedFrame, floor: int) -> int:
    """Return a floor's number, or raise `FrameError` if the frame has no such floor."""
    if not 1 <= floor <= reduced.storeys:
        raise FrameError(f"{reduced.name}: floor {floor}; it has floors 1 to {reduced.storeys}")
    return floor
