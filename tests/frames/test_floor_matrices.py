"""A stick by the matrices of its floors: the same frame as by its storeys, and refused where it cannot stand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding import frames
from pounding.frames import FrameError
from pounding.frames.chain import chain
from pounding.frames.definition import Matrices

STIFFNESS = chain(np.array([5e3, 4e3])).tolist()
MASS = [[6.0, 0.2], [0.2, 5.0]]


def stick(**fields: Any) -> frames.StickFrame:
    usual = {"name": "tower", "storeys": 2, "storey_height_m": 0.1, "damping_ratio": 0.01}
    return frames.StickFrame(**(usual | fields))


def test_matrices_of_a_chain_are_the_chain() -> None:
    chained = stick(floor_mass_kg=[6.0, 5.0], storey_stiffness_n_per_m=[5e3, 4e3])
    diagonal = Matrices(mass_kg=[[6.0, 0.0], [0.0, 5.0]], stiffness_n_per_m=STIFFNESS)
    by_storeys, by_matrices = frames.build(chained), frames.build(stick(matrices=diagonal))
    np.testing.assert_allclose(by_matrices.frequencies_hz, by_storeys.frequencies_hz, rtol=1e-12)
    np.testing.assert_allclose(by_matrices.damping, by_storeys.damping, rtol=1e-9)


def test_masses_may_be_coupled() -> None:
    built = frames.build(stick(matrices=Matrices(stiffness_n_per_m=STIFFNESS, mass_kg=MASS)))
    squares = np.linalg.eigvals(np.linalg.solve(np.array(MASS), np.array(STIFFNESS)))
    np.testing.assert_allclose(built.frequencies_hz, np.sqrt(np.sort(squares)) / (2 * np.pi), rtol=1e-10)
    assert built.moving_mass_kg == pytest.approx(11.4)


@pytest.mark.parametrize(
    ("stiffness", "said"),
    [
        ([[1.0]], "must be 2 rows of 2 values"),
        ([[2, -1], [0, 2]], "is not symmetric"),
        ([[1, -2], [-2, 1]], "is not positive definite"),
        ([[1, np.nan], [0, 1]], "is not finite"),
    ],
)
def test_matrices_that_cannot_be_are_refused(stiffness: list[list[float]], said: str) -> None:
    with pytest.raises(FrameError, match=said):
        stick(matrices=Matrices(stiffness_n_per_m=stiffness, mass_kg=MASS))


def test_a_frequency_beside_matrices_is_refused() -> None:
    with pytest.raises(FrameError, match="frequency_hz and matrices are stated"):
        stick(frequency_hz=[2.0], matrices=Matrices(stiffness_n_per_m=STIFFNESS, mass_kg=MASS))
