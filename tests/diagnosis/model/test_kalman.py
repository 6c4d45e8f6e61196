"""The predictor and the sensitivities through it; its steady filter is tested in test_steady_filter.py."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pounding import frames
from pounding.diagnosis.inference.filtering import (
    whitened,
)
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.kalman import discretise
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.shifting import shift
from pounding.experiments.rig.storey_forces import cubic_spring
from pounding.frames.response.exact import linear_response
from tests.diagnosis.models import STEP_S, measured


class Cubic:
    def apply(self, assembly, values, model):  # type: ignore[no-untyped-def]
        assembly.laws.append(PlacedLaw(cubic_spring, model.structure.drift[1], (float(values[0]),)))


def test_without_gain_it_is_the_exact_linear_response() -> None:
    model = measured(noise=0.0)
    run = model.observed.runs[0]
    stick = frames.build(
        frames.StickFrame(
            name="bench",
            storeys=3,
            storey_height_m=0.2,
            floor_mass_kg=[6.5] * 3,
            damping_ratio=0.01,
            storey_stiffness_n_per_m=[6e4] * 3,
        )
    )
    finer = 8
    at = np.arange(finer * (len(run.table) - 1) + 1) * STEP_S / finer
    table = model._tables[0].at(at)
    displacement, _ = linear_response(stick, table, STEP_S / finer)
    expected = displacement[::finer][:, [0, 2]]
    simulated = run.measured[:, 3:]
    error = root_mean_square(simulated - expected) / root_mean_square(expected)
    # Force held over a substep of 0.5 ms: (omega h)^2 / 24 at 26 Hz is 3e-4.
    assert error.max() < 5e-4


def test_a_law_acts_as_an_integrator_of_another_kind_says() -> None:
    model = measured([(Cubic(), np.array([4e8]))], noise=0.0, samples=1000, runs=1)
    run = model.observed.runs[0]
    modes = model.modes(model.assemble(np.zeros(len(model.std))))
    row = model.structure.drift[1] @ modes.floors
    spline = model._tables[0].at
    n = len(modes.omega)

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        eta, speed = z[:n], z[n:]
        force = -modes.participation * spline(t) - row * 4e8 * (row @ eta) ** 3
        return np.concatenate([speed, force - modes.omega**2 * eta - 2 * modes.ratio * modes.omega * speed])

    end = STEP_S * (len(run.table) - 1)
    solved = solve_ivp(
        rate, (0, end), np.zeros(2 * n), "DOP853", STEP_S * np.arange(len(run.table)), rtol=1e-9, atol=1e-12
    )
    expected = (modes.floors @ solved.y[:n]).T[:, [0, 2]]
    error = root_mean_square(run.measured[:, 3:] - expected) / root_mean_square(expected)
    assert error.max() < 2e-3


def test_innovations_of_the_right_model_are_white_and_of_the_stated_size() -> None:
    model = measured()
    filtered = calibrated(model, (0, 1))
    for series, steady in zip(filtered.prediction.innovations, filtered.filters, strict=True):
        white = whitened(series, steady)
        assert np.mean(white**2, axis=0) == pytest.approx(np.ones(5), abs=0.15)
        neighbours = np.mean(white[1:] * white[:-1], axis=0)
        # Four standard deviations of the correlation of 2000 independent samples.
        assert np.abs(neighbours).max() < 4 / np.sqrt(len(white))


def test_discretisation_is_that_of_twice_half_a_step() -> None:
    rate = np.array([[0.0, 1.0], [-100.0, -0.2]])
    density = np.array([0.0, 2.0])
    step, covariance = discretise(rate, density, 0.01)
    half, part = discretise(rate, density, 0.005)
    assert step == pytest.approx(half @ half)
    assert covariance == pytest.approx(part + half @ part @ half.T)


def test_a_shift_moves_a_series_and_keeps_its_noise() -> None:
    rng = np.random.default_rng(0)
    at = np.arange(4000) * STEP_S
    slow = np.sin(2 * np.pi * 7 * at)
    assert shift(slow, STEP_S, 0.0007)[300:-300] == pytest.approx(
        np.sin(2 * np.pi * 7 * (at + 0.0007))[300:-300], abs=1e-3
    )
    noise = rng.standard_normal(4000)
    # An interpolation half-way between samples would lose a third of its variance.
    assert shift(noise, STEP_S, STEP_S / 2).std() == pytest.approx(noise.std(), rel=0.01)
