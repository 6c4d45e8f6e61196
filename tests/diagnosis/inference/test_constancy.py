"""A parameter that is not the same in all windows of the runs, because the law is not the frame's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.effects.storey import CubicStiffness, Hysteresis
from pounding.diagnosis.inference.constancy import _beyond_chance
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import starting_noise
from tests.diagnosis.models import measured

PLACE: dict[str, Any] = {"index": 1, "frame": "bench", "storey": 2}


@pytest.mark.parametrize("between", [0.0, 0.5])
def test_the_variance_between_windows_is_found_beyond_chance(between: float) -> None:
    rng = np.random.default_rng(1)
    information = rng.uniform(5.0, 50.0, 4000)
    there = between * rng.standard_normal(4000) + rng.standard_normal(4000) / np.sqrt(information)
    found = _beyond_chance(information * there, information, float(information.sum()))
    assert found == pytest.approx(between**2, abs=0.02)


def test_one_window_says_nothing_of_others() -> None:
    assert _beyond_chance(np.array([3.0]), np.array([2.0]), 2.0) == 0.0


def fitted(hidden: list[tuple[Any, np.ndarray]], tried: Any, start: list[float]) -> Fit:
    model = measured(hidden, noise=0.005)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1), 0.01), (0, 1))
    return refine(model, filtered, (tried,), (np.array(start),))


def test_the_standard_error_of_a_wrong_law_contains_how_its_parameter_varies() -> None:
    """A cubic spring that stands for yielding is another one in strong and in weak shaking."""
    cubic = CubicStiffness(**PLACE)
    right = fitted([(cubic, np.array([-3e8]))], cubic, [-2e8])
    assert abs(right.values[0][0] + 3e8) < 3.0 * right.std[0][0]
    yielding = (Hysteresis(**PLACE), np.array([30.0, 4e4, 4.0, 0.0]))
    wrong = fitted([yielding], cubic, [-2e8])
    assert wrong.std[0][0] / abs(wrong.values[0][0]) > 5.0 * right.std[0][0] / abs(right.values[0][0])
