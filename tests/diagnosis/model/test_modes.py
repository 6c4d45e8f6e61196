"""Modes of trials: also of those that take more from a frame than it has."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.model.storeys import solve_modes

STIFFNESS = 1e4 * np.array([[2.0, -1.0], [-1.0, 1.0]])


def test_modes_are_those_of_the_frame() -> None:
    omega, shapes = solve_modes(np.diag([2.0, 1.0]), STIFFNESS)
    assert shapes.T @ np.diag([2.0, 1.0]) @ shapes == pytest.approx(np.eye(2), abs=1e-12)
    assert shapes.T @ STIFFNESS @ shapes == pytest.approx(np.diag(omega**2), abs=1e-6)


def test_a_tall_building_sways_as_slowly_as_it_does() -> None:
    slow = STIFFNESS * 1e-6
    omega, _ = solve_modes(np.diag([2.0, 1.0]), slow)
    assert omega == pytest.approx(1e-3 * solve_modes(np.diag([2.0, 1.0]), STIFFNESS)[0])


def test_a_trial_that_leaves_no_stiffness_has_modes_as_well() -> None:
    omega, _ = solve_modes(np.diag([2.0, 1.0]), np.diag([-1.0, 4e4]))
    assert omega == pytest.approx([2.0, 200.0])


def test_a_trial_that_leaves_a_floor_no_mass_has_modes_as_well() -> None:
    """Else a fit in which effect and calibration both take from a floor would end the whole diagnosis."""
    omega, shapes = solve_modes(np.diag([2.0, -0.1]), STIFFNESS)
    assert np.all(np.isfinite(omega))
    assert np.all(np.isfinite(shapes))
    light = solve_modes(np.diag([2.0, 2e-3]), STIFFNESS)
    assert omega == pytest.approx(light[0])


def test_a_trial_that_leaves_less_than_no_stiffness_at_all_has_modes_as_well() -> None:
    omega, shapes = solve_modes(np.diag([2.0, 1.0]), -STIFFNESS)
    assert np.all(omega > 0.0)
    assert np.all(np.isfinite(shapes))
