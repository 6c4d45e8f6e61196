"""What a law in one storey may have of its own beyond its size."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.effects.storey import DampingChange
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import starting_noise
from pounding.experiments.rig.storey_forces import damper
from tests.diagnosis.models import measured

DAMPER = DampingChange(index=1, frame="bench", storey=2)


def test_a_damper_of_another_power_is_as_strong_at_its_rate() -> None:
    time = np.linspace(0.0, 1.0, 201)
    rate = np.linspace(-0.2, 0.2, 201)
    linear, square = (damper.along((30.0, beyond, 0.1), rate, rate, time) for beyond in (0.0, 1.0))
    np.testing.assert_allclose(linear, 30.0 * rate, rtol=1e-12)
    np.testing.assert_allclose(square, 30.0 * rate * np.abs(rate) / 0.1, rtol=1e-12, atol=1e-15)


def test_the_power_of_a_damper_is_found_with_its_size() -> None:
    truth = np.array([25.0, 0.5])
    model = measured([(DAMPER, truth)], runs=1)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    fit = refine(model, filtered, (DAMPER,), (np.array([15.0, 0.0]),))
    assert np.all(np.abs(fit.values[0] - truth) < 3.0 * fit.std[0])
    assert np.all(fit.std[0] < 0.1 * truth)
