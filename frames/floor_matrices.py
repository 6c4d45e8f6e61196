"""A stick by the matrices of its floors: the table `[floor_matrices]` of a frame file.

Measurements show a frame by how its floors move. What a diagnosis finds of a frame of plates, or of storeys that are more
than a chain of springs, is such a pair of matrices.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from pounding.frames.errors import FrameError

if TYPE_CHECKING:
    from pounding.frames.definition import StickFrame

ROUND_OFF = 1e-6
"""Matrices are symmetric, and masses are the sums of their rows, within this share of the largest entry."""


class FloorMatrices(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Stiffness and mass of the floors' displacements along x, relative to the base.

    Attributes:
        stiffness_n_per_m: Stiffness matrix, a list of rows from the first floor up (storeys, storeys) [N/m].
        mass_kg: Mass matrix alike (storeys, storeys) [kg], whose rows sum to `floor_mass_kg`; empty: these on the diagonal.
    """

    stiffness_n_per_m: list[list[float]]
    mass_kg: list[list[float]] = []


def mass(frame: StickFrame) -> NDArray[np.float64]:
    """Return the mass matrix (storeys, storeys) [kg] of a stick."""
    matrices = frame.floor_matrices
    if matrices is None or not matrices.mass_kg:
        return np.diag(np.asarray(frame.floor_mass_kg, float))
    return np.asarray(matrices.mass_kg, float)


def check(name: str, frame: StickFrame) -> None:
    """Refuse matrices that a stick cannot have.

    Args:
        name: What messages call the frame.
        frame: The stick, which has matrices.

    Raises:
        FrameError: Another statement of its stiffness beside them, a wrong size, or matrices that are not symmetric and
            positive definite.
    """
    others = {
        "storey_stiffness_n_per_m": frame.storey_stiffness_n_per_m,
        "frequency_hz": frame.frequency_hz,
        "stiffness_ratio": frame.stiffness_ratio is not None,
    }
    for key, stated in others.items():
        if stated:
            raise FrameError(f"{name}: {key} and floor_matrices exclude each other; give one of the two")
    assert frame.floor_matrices is not None
    _matrix(name, "stiffness_n_per_m", frame.floor_matrices.stiffness_n_per_m, frame.storeys)
    if not frame.floor_matrices.mass_kg:
        return
    masses = _matrix(name, "mass_kg", frame.floor_matrices.mass_kg, frame.storeys)
    stated, summed = np.asarray(frame.floor_mass_kg, float), masses.sum(axis=1)
    if np.abs(summed - stated).max() > ROUND_OFF * np.abs(masses).max():
        floor = int(np.abs(summed - stated).argmax())
        raise FrameError(
            f"{name}: floor_mass_kg of floor {floor + 1} is {stated[floor]:g}, and its row of floor_matrices.mass_kg sums "
            f"to {summed[floor]:g}; state the sum"
        )


def _matrix(name: str, key: str, rows: Any, storeys: int) -> NDArray[np.float64]:
    where = f"{name}: floor_matrices.{key}"
    if len(rows) != storeys or any(len(row) != storeys for row in rows):
        raise FrameError(f"{where} needs {storeys} rows of {storeys} values, one for each floor")
    matrix = np.asarray(rows, float)
    if not np.isfinite(matrix).all():
        raise FrameError(f"{where} holds a value that is not finite; correct it")
    if np.abs(matrix - matrix.T).max() > ROUND_OFF * np.abs(matrix).max():
        raise FrameError(f"{where} is not symmetric; what one floor does to another, the other does to it")
    if not np.linalg.eigvalsh(matrix)[0] > 0.0:
        raise FrameError(f"{where} is not positive definite: the frame would not stand")
    return matrix
