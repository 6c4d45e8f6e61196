"""The force of a fit's effects in a storey, whatever they act along."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.storey import CubicStiffness, Loosening, StiffnessChange
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.inference.storey_force import storey_force
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import STEP_S, measured, three_storeys, with_joints_that_turn

PLACE = {"index": 1, "frame": "bench", "storey": 2}
TIME = STEP_S * np.arange(2000)
DRIFT = 1e-3 * np.sin(2 * np.pi * np.outer(TIME, [3.0, 4.0, 5.0]))
RATE = np.gradient(DRIFT, STEP_S, axis=0)


def fitted(effect: Effect, numbers: list[float]) -> tuple[Model, Filtered]:
    model = measured(runs=1)
    model = Model(with_joints_that_turn(three_storeys()), model.observed, model.prior)
    quiet = np.zeros(len(model.std))
    noise = starting_noise(model, (0,), 0.01)
    return model, run_filter(model, quiet, noise, (0,), [(effect, np.array(numbers))])


def test_a_law_along_a_drift_acts_in_its_storey_alone() -> None:
    model, fit = fitted(CubicStiffness(**PLACE), [1e8])
    forces = [storey_force(model, fit, storey, DRIFT, RATE, STEP_S) for storey in range(3)]
    assert forces[1] == pytest.approx(1e8 * DRIFT[:, 1] ** 3, abs=1e-12)
    for other in (forces[0], forces[2]):
        assert other is None or np.abs(other).max() < 1e-9 * np.abs(forces[1]).max()


def test_columns_that_loosen_carry_what_a_softer_storey_does_at_the_end_of_the_run() -> None:
    """They bend as their joints turn, so the storeys beside them feel it, and their own by less than its drift."""
    softer = fitted(StiffnessChange(**PLACE), [-0.3])
    loosened = fitted(Loosening(**PLACE), [-0.3, 1.0])
    for storey in range(3):
        whole, growing = (storey_force(*one, storey, DRIFT, RATE, STEP_S) for one in (softer, loosened))
        assert whole is not None
        assert growing is not None
        share = TIME / TIME[-1]
        assert growing == pytest.approx(share * whole, abs=2e-3 * np.abs(whole).max())
