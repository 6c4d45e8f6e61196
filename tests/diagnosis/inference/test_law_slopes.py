"""Slopes of the likelihood by an effect's own numbers beside its differences: of what sticks, yields, touches, drifts."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.every_storey import AllHysteresis
from pounding.diagnosis.effects.storey import Bumper, CoulombFriction, CubicStiffness, Hysteresis
from pounding.diagnosis.effects.table_and_sensors import TableClock
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.starting import starting_noise
from tests.diagnosis.models import measured

LAWS: dict[str, tuple[Effect, list[float]]] = {
    "friction": (CoulombFriction(index=0, frame="bench", storey=1), [4.0, 4.0, 0.2, 0.3]),
    "yielding": (Hysteresis(index=0, frame="bench", storey=1), [25.0, 3e4, 2.0, 0.3]),
    "yielding of all storeys": (AllHysteresis(index=0, frame="bench"), [8e-4, 0.4, 2.0, 0.3, 0.1]),
    "stop": (Bumper(index=1, frame="bench", storey=2), [4e-4, 4e4, 0.2, 0.0, 0.0]),
    "cubic spring": (CubicStiffness(index=1, frame="bench", storey=2), [2e10]),
    "clock of the table": (TableClock(), [-0.01]),
}


@pytest.mark.parametrize("law", LAWS)
def test_slopes_by_an_effects_own_numbers_are_those_of_differences(law: str) -> None:
    """Each in standard errors: a hundredth of the largest is a hundredth of the step that is taken."""
    effect, numbers = LAWS[law]
    truth = np.array(numbers)
    # A fit that is on its way.
    start = truth * np.r_[1.1, np.ones(len(truth) - 1)]
    model = measured([(effect, truth)], runs=1)
    noise = starting_noise(model, (0,), 0.003)
    filtered = run_filter(model, np.zeros(len(model.std)), noise, (0,), [(effect, start)])
    width = np.maximum(np.abs(truth), 1e-12)
    coordinates = Coordinates.of(model, (effect,), (start,), (width,), discrepancy=filtered.discrepancy)
    theta = coordinates.theta(filtered.values)
    posterior = coordinates.posterior([Histories(model, filtered, coordinates)])
    gram, slope = posterior.normal_equations(theta)
    own = np.arange(len(coordinates.scale), len(theta))
    errors = 1.0 / np.sqrt(np.diag(gram) + 1.0)
    differences = [
        (posterior.cost(theta - move) - posterior.cost(theta + move)) / 0.1
        for move in 0.05 * np.diag(errors)[own]
    ]
    found = ((slope - theta) * errors)[own]
    assert np.abs(found - differences).max() < 0.01 * np.abs(differences).max()
