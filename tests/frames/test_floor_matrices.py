"""A stick by the matrices of its floors: the same frame as by its storeys, and refused where it cannot stand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding import frames
from pounding.frames import FrameError
from pounding.frames.floor_matrices import FloorMatrices
from pounding.frames.stick import chain

STIFFNESS = chain(np.array([5e3, 4e3])).tolist()
MASS = [[6.0, 0.2], [0.2, 5.0]]


def stick(**fields: Any) -> frames.StickFrame:
    usual = {
        "name": "tower",
        "storeys": 2,
        "storey_height_m": 0.1,
        "floor_mass_kg": [6.0, 5.0],
        "damping_ratio": 0.01,
    }
    return frames.StickFrame(**(usual | fields))


def test_matrices_of_a_chain_are_the_chain() -> None:
    by_storeys = frames.build(stick(storey_stiffness_n_per_m=[5e3, 4e3]))
    by_matrices = frames.build(stick(floor_matrices=FloorMatrices(stiffness_n_per_m=STIFFNESS)))
    np.testing.assert_allclose(by_matrices.frequencies_hz, by_storeys.frequencies_hz, rtol=1e-12)
    np.testing.assert_allclose(by_matrices.damping, by_storeys.damping, rtol=1e-9)


def test_masses_may_be_coupled() -> None:
    matrices = FloorMatrices(stiffness_n_per_m=STIFFNESS, mass_kg=MASS)
    built = frames.build(stick(floor_mass_kg=[6.2, 5.2], floor_matrices=matrices))
    squares = np.linalg.eigvals(np.linalg.solve(np.array(MASS), np.array(STIFFNESS)))
    np.testing.assert_allclose(built.frequencies_hz, np.sqrt(np.sort(squares)) / (2 * np.pi), rtol=1e-10)
    assert built.moving_mass_kg == pytest.approx(11.4)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"frequency_hz": [2.0]}, "frequency_hz and floor_matrices exclude each other"),
        ({"floor_matrices": FloorMatrices(stiffness_n_per_m=[[1.0]])}, "needs 2 rows of 2 values"),
        ({"floor_matrices": FloorMatrices(stiffness_n_per_m=[[2, -1], [0, 2]])}, "is not symmetric"),
        ({"floor_matrices": FloorMatrices(stiffness_n_per_m=[[1, -2], [-2, 1]])}, "is not positive definite"),
        ({"floor_matrices": FloorMatrices(stiffness_n_per_m=[[1, np.nan], [0, 1]])}, "is not finite"),
        (
            {"floor_matrices": FloorMatrices(stiffness_n_per_m=STIFFNESS, mass_kg=MASS)},
            "floor_mass_kg of floor 1 is 6, and its row of floor_matrices.mass_kg sums to 6.2",
        ),
    ],
)
def test_matrices_that_cannot_be_are_refused(fields: dict[str, Any], said: str) -> None:
    with pytest.raises(FrameError, match=said):
        stick(**({"floor_matrices": FloorMatrices(stiffness_n_per_m=STIFFNESS)} | fields))
