import numpy as np
import pytest

from pounding.frames.errors import FrameError
from pounding.frames.response import laboratory


@pytest.fixture
def frame(shear_building):
    return shear_building(storeys=5)


def test_push_test_gives_the_springs_in_series(frame):
    test = laboratory.push_test(frame)
    assert test.stiffness_n_per_m == pytest.approx(20e3 / 5, rel=1e-9)
    np.testing.assert_allclose(test.force_n, test.stiffness_n_per_m * test.deflection_m)


@pytest.mark.parametrize("ratio", [0.002, 0.005, 0.02])
def test_free_vibration_gives_back_frequency_and_damping(shear_building, ratio):
    frame = shear_building(storeys=5, ratio=ratio)
    reading = laboratory.free_vibration_test(frame).reading
    # The grid of the spectrum resolves a hundredth of the bandwidth; the peak of a decay in acceleration
    # lies above the natural frequency by a term of the order of the ratio squared.
    assert reading.frequency_hz == pytest.approx(frame.frequencies_hz[0], rel=0.01 * ratio + ratio**2)
    # e^-7 of the motion is cut off, a ripple of 0.1 %; the half-power formula itself is off by ratio squared.
    assert reading.damping_ratio == pytest.approx(ratio, rel=2e-3 + 2 * ratio**2)


def test_a_short_record_reads_too_much_damping(frame):
    time_constant = 1.0 / (0.005 * 2 * np.pi * frame.frequencies_hz[0])
    readings = [
        laboratory.free_vibration_test(frame, record_s=n * time_constant).reading.damping_ratio
        for n in (2, 4, 7)
    ]
    assert readings[0] > 1.4 * 0.005
    assert readings[0] > readings[1] > readings[2]
    assert readings[2] == pytest.approx(0.005, rel=2e-3)


def test_a_window_reads_too_much_damping_from_a_record_of_a_few_time_constants(frame):
    record = 4.0 / (0.005 * 2 * np.pi * frame.frequencies_hz[0])
    plain = laboratory.free_vibration_test(frame, record_s=record).reading.damping_ratio
    tapered = laboratory.free_vibration_test(frame, record_s=record, window="hann").reading.damping_ratio
    assert tapered > 1.1 * plain > 1.1 * 0.005


@pytest.mark.parametrize("rate", [2.0, 8.0])
def test_sweep_gives_back_three_modes_at_any_rate(frame, rate):
    sweep = laboratory.sine_sweep_test(frame, octaves_per_minute=rate)
    for mode, reading in enumerate(sweep.readings):
        # The grid has a hundredth of a bandwidth between lines.
        assert reading.frequency_hz == pytest.approx(frame.frequencies_hz[mode], rel=1e-4)
        # Neighbouring modes add to the flanks of a peak: 0.1 % seen at the third mode.
        assert reading.damping_ratio == pytest.approx(0.005, rel=3e-3)
    assert np.abs(sweep.table_m_s2).max() == pytest.approx(0.1, rel=1e-4)
    assert np.abs(sweep.roof_m_s2[-100:]).max() < 2e-3 * np.abs(sweep.roof_m_s2).max()


def test_the_loudest_instant_of_a_sweep_upwards_comes_late(frame):
    slow = laboratory.sine_sweep_test(frame, octaves_per_minute=1.0)
    fast = laboratory.sine_sweep_test(frame, octaves_per_minute=4.0)
    natural = frame.frequencies_hz[0]
    assert natural < slow.instant_hz[0] < fast.instant_hz[0] < 1.25 * natural


def test_half_power_of_a_known_peak():
    frequency = np.linspace(1.9, 2.1, 4001)
    shape = 1.0 / np.hypot(frequency - 2.0, 0.01 * 2.0)
    reading = laboratory.half_power(frequency, shape)
    assert reading.frequency_hz == pytest.approx(2.0, abs=1e-6)
    assert reading.damping_ratio == pytest.approx(0.01, rel=1e-4)


def test_what_cannot_be_read_is_told(shear_building, frame):
    with pytest.raises(FrameError, match="not resolved"):
        laboratory.half_power([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    with pytest.raises(FrameError, match="without damping"):
        laboratory.free_vibration_test(shear_building(ratio=0.0))
    with pytest.raises(FrameError, match="5 resonances below 50 Hz, 9 wanted"):
        laboratory.sine_sweep_test(frame, modes=9)
