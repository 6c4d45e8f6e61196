"""Hum of the mains is told from what shaking excites at the same frequency, and is taken out of what was recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from pounding.diagnosis.model.hum import hum_of
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.sensors import screened
from tests.diagnosis.models import STEP_S, measured, shaking

SAMPLES = 4000
TIME = STEP_S * np.arange(SAMPLES)


def sine(hertz: float, size: float) -> np.ndarray:
    return np.asarray(size * np.sin(2 * np.pi * hertz * TIME + 0.4))


def resonant(hertz: float, damping: float, seed: int) -> np.ndarray:
    """What noise that swells and fades excites in a mode, with a rms of one."""
    rng = np.random.default_rng(seed)
    pole = np.exp(2 * np.pi * hertz * STEP_S * (1j - damping))
    driven = rng.standard_normal(SAMPLES) * np.sin(np.pi * TIME / TIME[-1])
    series = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], driven)
    return np.asarray(series / series.std())


@pytest.mark.parametrize("hertz", [50.0, 49.95, 60.03, 100.06])
@pytest.mark.parametrize("size", [0.05, 1.0])
def test_hum_is_found_and_what_is_below_it_is_kept(hertz: float, size: float) -> None:
    plain = shaking(SAMPLES, 1) + 0.02 * np.random.default_rng(2).standard_normal(SAMPLES)
    series = plain + sine(hertz, size)
    series[700:705] = np.nan
    found, lines = hum_of(series, STEP_S)
    assert lines == pytest.approx([hertz], abs=0.05)
    assert (found - sine(hertz, size)).std() < 0.1 * size


def test_a_higher_multiple_is_hum_only_beside_a_lower_one() -> None:
    plain = shaking(SAMPLES, 1) + 0.02 * np.random.default_rng(2).standard_normal(SAMPLES)
    for alone in (150.1, 180.0):
        assert hum_of(plain + sine(alone, 1.0), STEP_S)[1] == []
    assert hum_of(np.zeros(SAMPLES), STEP_S)[1] == []
    assert hum_of(plain + sine(50.03, 0.5) + sine(150.1, 1.0), STEP_S)[1] == pytest.approx(
        [50.03, 150.1], abs=0.05
    )


@pytest.mark.parametrize("seed", range(10))
def test_a_mode_at_a_mains_frequency_is_no_hum(seed: int) -> None:
    for damping in (0.003, 0.02):
        assert hum_of(resonant(50.0, damping, seed), STEP_S)[1] == []
    assert hum_of(np.random.default_rng(seed).standard_normal(SAMPLES), STEP_S)[1] == []


def with_hum(of_table: float) -> Observations:
    observed = measured(samples=SAMPLES, runs=1).observed
    (run,) = observed.runs
    series = run.measured + 0.2 * run.measured.std(axis=0) * sine(50.0, 1.0)[:, None]
    return replace(observed, runs=(replace(run, table=run.table + sine(50.0, of_table), measured=series),))


def test_a_table_that_is_shaken_at_a_mains_frequency_keeps_its_motion() -> None:
    shaken = with_hum(2.0)
    assert screened(shaken).runs[0].table is shaken.runs[0].table
    assert [one for one in shaken.warnings if "swings steadily at 50 Hz" in one] == shaken.warnings
    assert len(shaken.warnings) == 1


@pytest.mark.parametrize("of_table", [0.05, 0.5])
def test_hum_of_the_cables_is_subtracted_from_the_table_too(of_table: float) -> None:
    in_cables = with_hum(of_table)
    clean = screened(in_cables).runs[0]
    assert in_cables.warnings == [
        "run1.csv: hum of the mains (50 Hz) in the table, a1, a2, a3, d1, d3; subtracted"
    ]
    plain = measured(samples=SAMPLES, runs=1).observed.runs[0]
    assert np.all((clean.measured - plain.measured).std(axis=0) < 0.01 * plain.measured.std(axis=0))
