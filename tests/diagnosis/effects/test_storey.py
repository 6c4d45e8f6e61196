"""What a law in one storey may have of its own beyond its size."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.effects.every_storey import AllHysteresis
from pounding.diagnosis.effects.storey import (
    STICKING_RATIO,
    CoulombFriction,
    DampingChange,
    Hysteresis,
    Loosening,
)
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import column_drift
from pounding.diagnosis.model.storeys import Structure
from pounding.experiments.rig.storey_forces import damper
from tests.diagnosis.models import measured, three_storeys, with_joints_that_turn

DAMPER = DampingChange(index=1, frame="bench", storey=2)


def test_a_damper_of_another_power_is_as_strong_at_its_rate() -> None:
    time = np.linspace(0.0, 1.0, 201)
    rate = np.linspace(-0.2, 0.2, 201)
    linear, square = (damper.along((30.0, beyond, 0.1), rate, rate, time) for beyond in (0.0, 1.0))
    np.testing.assert_allclose(linear, 30.0 * rate, rtol=1e-12)
    np.testing.assert_allclose(square, 30.0 * rate * np.abs(rate) / 0.1, rtol=1e-12, atol=1e-15)


def test_a_damper_of_a_lower_power_is_as_strong_at_its_rate_and_not_stiff_at_rest() -> None:
    """It grows with its power, but for the slowest twentieth, where its slope has an end."""
    rate = np.array([1e-9, 0.02, 0.1, 0.5])
    slow, *others = damper.along((30.0, -0.8, 0.1), rate, rate, np.arange(4.0))
    assert slow == pytest.approx(30.0 * 1e-9 * 0.05**-0.8, rel=2e-3)
    assert others[1] == pytest.approx(3.0, rel=1e-12)
    np.testing.assert_allclose(others, 3.0 * (rate[1:] / 0.1) ** 0.2, rtol=0.03)


def test_slopes_of_a_damper_of_a_lower_power_are_the_likelihoods_though_it_comes_to_rest() -> None:
    """A force that chatters about rest makes the likelihood rough: differences over two widths would not agree."""
    truth, start = np.array([100.0, -0.75]), np.array([80.0, -0.75])
    model = measured([(DAMPER, truth)], runs=1)
    noise = starting_noise(model, (0,), 0.01)
    filtered = run_filter(model, np.zeros(len(model.std)), noise, (0,), [(DAMPER, start)])
    coordinates = Coordinates.of(model, (DAMPER,), (start,), (truth,), discrepancy=filtered.discrepancy)
    theta = coordinates.theta(filtered.values)
    posterior = coordinates.posterior([Histories(model, filtered, coordinates)])
    gram, slope = posterior.normal_equations(theta)
    width = 1.0 / np.sqrt(np.diag(gram) + 1.0)

    def differences(share: float) -> np.ndarray:
        moves = share * np.diag(width)
        return np.array(
            [(posterior.cost(theta - one) - posterior.cost(theta + one)) / (2 * share) for one in moves]
        )

    near, far = differences(0.02), differences(0.2)
    size = np.linalg.norm(near)
    assert np.linalg.norm(far - near) < 1e-3 * size
    assert np.linalg.norm((slope - theta) * width - near) < 0.03 * size


def test_the_power_of_a_damper_is_found_with_its_size() -> None:
    truth = np.array([25.0, 0.5])
    model = measured([(DAMPER, truth)], runs=1)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    fit = refine(model, filtered, (DAMPER,), (np.array([15.0, 0.0]),))
    assert np.all(np.abs(fit.values[0] - truth) < 3.0 * fit.std[0])
    assert np.all(fit.std[0] < 0.1 * truth)


@pytest.mark.parametrize(("stiffness", "damping"), [(4.0, 0.02), (15.0, 1.5)])
def test_the_force_of_a_joint_is_found_whatever_damps_it_while_it_sticks(
    stiffness: float, damping: float
) -> None:
    effect, truth = (
        CoulombFriction(index=1, frame="bench", storey=2),
        np.array([3.0, stiffness, 0.0, damping]),
    )
    model = measured([(effect, truth)], runs=1)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    fit = refine(model, filtered, (effect,), (effect.values(2.0, ()),))
    assert abs(fit.values[0][0] - truth[0]) < 3.0 * fit.std[0][0]
    assert fit.std[0][0] < 0.1 * truth[0]
    assert abs(np.log(fit.values[0][3] / damping)) < 0.5 * abs(np.log(STICKING_RATIO / damping))


def bench_with_joints_that_turn() -> Model:
    """Return the bench as measured, with columns that bend otherwise than its storeys drift."""
    model = measured(runs=1)
    return Model(with_joints_that_turn(three_storeys()), model.observed, model.prior)


def test_columns_bend_by_the_drift_where_no_joint_turns_and_otherwise_by_the_pattern_of_their_storey() -> (
    None
):
    plain = Structure(three_storeys().frames)
    np.testing.assert_allclose(column_drift(plain, 1), plain.drift[1], atol=1e-12)
    turning = bench_with_joints_that_turn().structure
    frame = turning.frames[0]
    row = column_drift(turning, 1)
    np.testing.assert_allclose(frame.storey_stiffness[1] * np.outer(row, row), frame.storey_pattern(1))
    assert row @ turning.drift[1] > 0.0


@pytest.mark.parametrize("columns", [0.0, 1.0])
def test_whether_a_storey_loosens_as_a_whole_or_its_columns_is_found_with_its_size(columns: float) -> None:
    model, effect = bench_with_joints_that_turn(), Loosening(index=1, frame="bench", storey=2)
    truth = np.array([-0.3, columns])
    (run,), rng = model.observed.runs, np.random.default_rng(5)
    output = model.predict(np.zeros(len(model.std)), None, [(effect, truth)]).outputs[0]
    noisy = output + 0.01 * output.std(axis=0) * rng.standard_normal(output.shape)
    model = model.seeing(replace(model.observed, runs=(replace(run, measured=noisy),)))
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    fit = refine(model, filtered, (effect,), (np.array([-0.2, 0.0]),))
    assert np.all(np.abs(fit.values[0] - truth) < 3.0 * fit.std[0])
    assert np.all(fit.std[0] < [0.05, 0.3])


def test_the_law_of_what_yields_is_known_the_better_the_further_its_storey_drifts_beyond() -> None:
    """So is that of what yields in all storeys, by the one that drifts furthest."""
    moved: Any = SimpleNamespace(highest=np.array([1e-3, 4e-3, 0.0]), lowest=np.array([0.0, -2e-3, -1e-3]))
    model: Any = measured([], runs=1)
    one = Hysteresis(index=1, frame="bench", storey=2)
    shares = [one.law_error(model, np.array([force, 1e5, 8.0, 0.0]), moved) for force in (400.0, 100.0)]
    assert shares == pytest.approx(np.hypot(0.4, [1.2, 0.3]))
    everywhere = AllHysteresis(frame="bench").law_error(model, np.array([1e-3, 0.5, 8.0, 0.0, 0.0]), moved)
    assert everywhere == pytest.approx(0.5)
