"""A record and what can be done to it."""

import math

import numpy as np
import pytest

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.scale import THESIS

STEP = 0.01


def burst(count=2000, offset=0.0):
    time = STEP * np.arange(count)
    return Record("burst", np.exp(-(((time - 8) / 2) ** 2)) * np.sin(9 * time) + offset, STEP)


def test_scaling_compresses_time_and_leaves_the_samples():
    record = burst()
    model = record.scaled(THESIS.time_factor)
    assert model.step_s == STEP * math.sqrt(1 / 30)
    assert model.sha256 == record.sha256
    assert model.history == ("time multiplied by 0.182574",)
    assert record.scaled(1.0, pga_g=0.5).pga_g == pytest.approx(0.5, rel=1e-14)
    assert record.scaled(1.0, pga_g=0.5).sha256 != record.sha256


def test_a_record_cannot_be_changed_by_accident():
    record = burst()
    with pytest.raises(ValueError, match="read-only"):
        record.acceleration_m_s2[0] = 1.0
    source = np.ones(3)
    kept = Record("x", source, 0.1)
    source[0] = 5.0
    assert kept.acceleration_m_s2[0] == 1.0


@pytest.mark.parametrize(
    ("samples", "step", "message"),
    [
        ([0.0, math.nan, 1.0], 0.1, "sample 2 of 3 is nan"),
        ([0.0, math.inf, 1.0, math.nan], 0.1, r"sample 2 of 4 is inf \(2 not finite in all\)"),
        ([1.0], 0.1, r"has 1 sample\(s\)"),
        ([], 0.1, r"has 0 sample\(s\)"),
        ([[1.0, 2.0]], 0.1, "needs a row"),
        ([0.0, 1.0], 0.0, "the time step is 0 s; it must be"),
        ([0.0, 1.0], math.nan, "the time step is nan s; it must be"),
    ],
)
def test_what_is_no_record(samples, step, message):
    with pytest.raises(ExperimentError, match=message):
        Record("bad", samples, step)


def test_a_peak_of_zero_cannot_be_scaled():
    silence = Record("silence", np.zeros(10), 0.1)
    assert silence.pga_g == 0.0
    with pytest.raises(ExperimentError, match="'silence' from memory is zero throughout"):
        silence.scaled(THESIS.time_factor, pga_g=0.3)
    with pytest.raises(ExperimentError, match=r"keeps 0 sample\(s\)"):
        silence.trimmed()
    for wrong in (0.0, -1.0, math.nan):
        with pytest.raises(ExperimentError, match="must be positive"):
            burst().scaled(THESIS.time_factor, pga_g=wrong)
        with pytest.raises(ExperimentError, match="must be positive"):
            burst().scaled(wrong)


def test_a_finer_step_is_the_same_motion():
    record = burst()
    fine = record.resampled(STEP / 4)
    np.testing.assert_allclose(fine.acceleration_m_s2[::4], record.acceleration_m_s2, atol=1e-14)
    assert len(fine.acceleration_m_s2) == 4 * (len(record.acceleration_m_s2) - 1) + 1


def test_a_coarser_step_keeps_what_it_can_carry_and_drops_the_rest():
    time = STEP * np.arange(4000)
    slow, fast = np.sin(2 * np.pi * 2 * time), np.sin(2 * np.pi * 40 * time)
    window = np.hanning(len(time))
    coarse = Record("two", window * (slow + fast), STEP).resampled(0.04)
    expected = np.interp(coarse.time_s, time, window * slow)
    # without the filter the 40 Hz part would come back as 10 Hz with its whole amplitude of 1
    assert np.abs(coarse.acceleration_m_s2 - expected).max() < 0.01
    for wrong in (0.0, 1e3):
        with pytest.raises(ExperimentError, match="time step"):
            burst().resampled(wrong)


@pytest.mark.parametrize("degree", [1, 2])
def test_the_baseline_is_taken_off(degree):
    record = burst()
    drift = 0.05 if degree == 1 else 0.05 + 0.004 * record.time_s
    drifting = Record("d", record.acceleration_m_s2 + drift, STEP).baseline_corrected(degree)
    clean = record.baseline_corrected(degree)
    np.testing.assert_allclose(drifting.acceleration_m_s2, clean.acceleration_m_s2, atol=1e-10)
    assert np.abs(clean.acceleration_m_s2 - record.acceleration_m_s2).max() < 0.002
    with pytest.raises(ExperimentError, match="baseline of degree 0"):
        record.baseline_corrected(0)


def test_trimming_states_its_criterion():
    record = burst()
    strong = record.trimmed("arias", lower=0.05, upper=0.95)
    assert 2.0 < strong.duration_s < 6.0
    assert strong.history[-1].startswith("trimmed to 0.05 to 0.95 of the Arias intensity: ")
    bracket = record.trimmed("bracket", threshold_g=0.05)
    ends = np.abs(bracket.acceleration_m_s2[[0, -1]]) / STANDARD_GRAVITY
    assert (ends >= 0.05).all()
    assert bracket.pga_g == record.pga_g
    with pytest.raises(ExperimentError, match="criterion 'by eye' is not known"):
        record.trimmed("by eye")
    with pytest.raises(ExperimentError, match="Arias fractions"):
        record.trimmed(lower=0.9, upper=0.1)
    with pytest.raises(ExperimentError, match=r"keeps 0 sample\(s\)"):
        record.trimmed("bracket", threshold_g=5.0)


def test_rest_and_polarity():
    record = burst(100)
    assert len(record.padded(0.5).acceleration_m_s2) == 150
    np.testing.assert_array_equal(record.flipped().acceleration_m_s2, -record.acceleration_m_s2)
    assert record.flipped().flipped().sha256 == record.sha256


def test_a_record_knows_whether_it_is_the_laboratorys() -> None:
    """Only then can a run be compared with what the thesis measured."""
    assert burst().scaled(THESIS.time_factor).is_as_in_the_laboratory
    assert not burst().is_as_in_the_laboratory
    assert not burst().scaled(0.2).is_as_in_the_laboratory
    assert not burst().scaled(THESIS.time_factor, pga_g=0.1).is_as_in_the_laboratory
