import time

import numpy as np
import pytest
from scipy.signal import lsim

from pounding.frames.errors import FrameError
from pounding.frames.response import exact

STEP = 0.02 / np.sqrt(30)


def shaking(samples=400, seed=1):
    history = np.random.default_rng(seed).normal(size=samples)
    history[0] = 1.5  # a start that is not zero: the frame is at rest, the table is not
    return history


def first_order_hold(frame, history, step):
    """scipy's linear simulation with linear interpolation of the input: another exact solution."""
    n = len(frame.mass)
    inverse = np.linalg.inv(frame.mass)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ frame.stiffness, -inverse @ frame.damping]])
    load = np.r_[np.zeros(n), -frame.influence][:, None]
    times = step * np.arange(len(history))
    _, out, _ = lsim((state, load, np.eye(2 * n), np.zeros((2 * n, 1))), history, times, interp=True)
    return out[:, :n], out[:, n:]


@pytest.mark.parametrize("step", [STEP, 0.05, 1e-5])
def test_agrees_with_first_order_hold_of_the_state_space(shear_building, step):
    frame, history = shear_building(), shaking()
    displacement, velocity = exact.linear_response(frame, history, step)
    expected = first_order_hold(frame, history, step)
    np.testing.assert_allclose(displacement, expected[0], atol=1e-9 * np.abs(expected[0]).max())
    np.testing.assert_allclose(velocity, expected[1], atol=1e-9 * np.abs(expected[1]).max())


@pytest.mark.parametrize("damper", [30.0, 4000.0])  # coupled but oscillating; partly overdamped
def test_any_damping_matrix(shear_building, damper):
    storey_damper = np.zeros((3, 3))
    storey_damper[:2, :2] = [[damper, -damper], [-damper, damper]]
    frame, history = shear_building(damping=storey_damper + np.eye(3)), shaking()
    displacement, _ = exact.linear_response(frame, history, STEP)
    expected, _ = first_order_hold(frame, history, STEP)
    np.testing.assert_allclose(displacement, expected, atol=1e-9 * np.abs(expected).max())


def test_sub_steps_do_not_change_the_samples(shear_building):
    frame, history = shear_building(), shaking()
    coarse, _ = exact.linear_response(frame, history, STEP)
    fine, _ = exact.linear_response(frame, exact.refine(history, 7), STEP / 7)
    np.testing.assert_allclose(fine[::7], coarse, atol=1e-12 * np.abs(coarse).max())


def test_outputs_by_index_and_by_row(shear_building):
    frame, history = shear_building(), shaking()
    displacement, _ = exact.linear_response(frame, history, STEP)
    by_index, _ = exact.linear_response(frame, history, STEP, outputs=[2])
    drift, _ = exact.linear_response(frame, history, STEP, outputs=np.array([[0.0, -1.0, 1.0]]))
    np.testing.assert_allclose(by_index[:, 0], displacement[:, 2])
    np.testing.assert_allclose(drift[:, 0], displacement[:, 2] - displacement[:, 1], atol=1e-12)


def test_free_vibration_of_one_mode_is_the_textbook_decay(shear_building):
    frame = shear_building(storeys=1, ratio=0.02)
    circular = 2 * np.pi * frame.frequencies_hz[0]
    times = np.linspace(0.0, 3.0, 200)
    displacement, velocity = exact.free_response(frame, [0.01], [0.0], times)
    damped = circular * np.sqrt(1 - 0.02**2)
    expected = (
        0.01
        * np.exp(-0.02 * circular * times)
        * (np.cos(damped * times) + 0.02 * circular / damped * np.sin(damped * times))
    )
    np.testing.assert_allclose(displacement[:, 0], expected, atol=1e-14)
    assert velocity[0, 0] == pytest.approx(0.0, abs=1e-12)


def test_absolute_acceleration_is_the_second_derivative_plus_the_table(shear_building):
    frame = shear_building()
    step = 1e-4
    history = np.sin(2 * np.pi * 5.0 * step * np.arange(8000))
    displacement, velocity = exact.linear_response(frame, history, step)
    total = exact.absolute_acceleration(frame, displacement, velocity)
    numeric = np.gradient(velocity, step, axis=0) + history[:, None]
    # Central differences of a 5 Hz motion: the error is (omega step)^2 / 6, a few 1e-6.
    np.testing.assert_allclose(total[1:-1], numeric[1:-1], atol=2e-5 * np.abs(total).max())


def test_oscillator_peaks_of_a_step_are_known():
    # A sudden constant acceleration a: the displacement swings between 0 and -2 a / omega^2 without damping.
    peaks = exact.oscillator_peaks([1.0, 4.0], 0.0, np.full(300, 2.0), 0.01, points_per_period=100)
    static = 2.0 / (2 * np.pi * np.array([1.0, 4.0])) ** 2
    np.testing.assert_allclose(-peaks.minimum, 2 * static, rtol=1e-3)
    np.testing.assert_allclose(peaks.maximum, 0.0, atol=1e-9)
    np.testing.assert_allclose(peaks.absolute, 2 * static, rtol=1e-3)


def test_oscillator_peaks_broadcast_and_agree_with_the_frame(shear_building):
    frame, history = shear_building(storeys=1), shaking()
    peaks = exact.oscillator_peaks(
        frame.frequencies_hz[:, None], [0.005, 0.05], history, STEP, points_per_period=1
    )
    displacement, _ = exact.linear_response(frame, history, STEP)
    assert peaks.maximum.shape == (1, 2)
    assert peaks.maximum[0, 0] == pytest.approx(displacement.max(), rel=1e-9)
    assert peaks.minimum[0, 1] > peaks.minimum[0, 0]


def test_ten_thousand_oscillators_take_seconds():
    started = time.perf_counter()
    exact.oscillator_peaks(np.linspace(0.5, 10.0, 5000)[:, None], [0.005, 0.05], shaking(2500), STEP)
    assert time.perf_counter() - started < 10.0  # 1 s measured; a regression to a Python loop takes minutes


@pytest.mark.parametrize(
    ("history", "step", "words"),
    [
        ([0.0, np.nan, 1.0], 0.01, "sample 1 is nan"),
        ([1.0], 0.01, "at least two samples"),
        (np.zeros((2, 2)), 0.01, "one row"),
        ([0.0, 1.0], 0.0, "step 0.0 s"),
        ([0.0, 1.0], np.nan, "step nan s"),
    ],
)
def test_bad_histories_are_named(shear_building, history, step, words):
    with pytest.raises(FrameError, match=words):
        exact.linear_response(shear_building(), history, step)


def test_bad_oscillators_are_named():
    with pytest.raises(FrameError, match="damping ratios"):
        exact.oscillator_peaks([1.0], [1.0], shaking(), STEP)
    with pytest.raises(FrameError, match="frequencies"):
        exact.oscillator_peaks([0.0], [0.1], shaking(), STEP)
