"""What cannot be the mass or the stiffness of a stick's floors."""

from __future__ import annotations

import numpy as np

from pounding.frames.errors import FrameError

ROUND_OFF = 1e-6
"""A matrix is symmetric within this share of its largest entry."""


def check(where: str, rows: list[list[float]], storeys: int) -> None:
    """Refuse rows that are no symmetric and positive definite matrix of the floors.

    Args:
        where: What messages call the matrix.
        rows: Its rows (storeys, storeys).
        storeys: Number of floors.

    Raises:
        FrameError: It is none; the sentence says why.
    """
    if len(rows) != storeys or any(len(row) != storeys for row in rows):
        raise FrameError(f"{where} must be {storeys} rows of {storeys} values, one for each floor")
    matrix = np.asarray(rows, float)
    if not np.isfinite(matrix).all():
        raise FrameError(f"{where} holds a value that is not finite; correct it")
    if np.abs(matrix - matrix.T).max() > ROUND_OFF * np.abs(matrix).max():
        raise FrameError(f"{where} is not symmetric; what one floor does to another, the other does to it")
    values, motions = np.linalg.eigh(matrix)
    if not values[0] > 0.0:
        floor = int(np.abs(motions[:, 0]).argmax()) + 1
        raise FrameError(
            f"{where} is not positive definite: the frame would not stand (least eigenvalue {values[0]:.3g}, mostly of "
            f"floor {floor}); correct these rows, or export the matrices of a building on a fixed base"
        )
