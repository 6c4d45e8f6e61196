"""Dropouts of the table's motion are filled in from what stands around them, to its noise where they are short."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.model.dropouts import filled
from tests.diagnosis.models import shaking

SAMPLES, NOISE = 4000, 0.005


def table(seed: int = 0) -> np.ndarray:
    return shaking(SAMPLES, seed) + NOISE * np.random.default_rng(seed).standard_normal(SAMPLES)


def error(series: np.ndarray, missing: np.ndarray) -> float:
    """Return the error in the gaps as a share of what the series did there."""
    found = filled(np.where(missing, np.nan, series))
    np.testing.assert_array_equal(found[~missing], series[~missing])
    return float((found - series)[missing].std() / series[missing].std())


@pytest.mark.parametrize("share", [0.02, 0.2])
def test_single_dropouts_are_filled_to_the_noise(share: float) -> None:
    missing = np.random.default_rng(1).random(SAMPLES) < share
    assert error(table(), missing) < 3 * NOISE


@pytest.mark.parametrize(("samples", "most"), [(10, 0.1), (25, 0.7)])
def test_short_gaps_of_a_measured_motion_are_filled_and_long_ones_hardly(
    samples: int, most: float, open_cases: Path
) -> None:
    run = read_case(open_cases / "open-null").runs[0]
    assert run.step_s == pytest.approx(0.002)
    missing = np.zeros(len(run.values), bool)
    for first in range(200, len(missing) - 200, 1000):
        missing[first : first + samples] = True
    assert 0.5 * most < error(run.values[:, 0], missing) < most


def test_gaps_at_the_ends_beside_each_other_and_of_any_length_are_filled() -> None:
    series = table()
    missing = np.zeros(SAMPLES, bool)
    for first, last in ((0, 5), (7, 9), (1000, 1800), (1805, 1810), (SAMPLES - 3, SAMPLES)):
        missing[first:last] = True
    found = filled(np.where(missing, np.nan, series))
    assert np.isfinite(found).all()
    assert np.abs(found).max() <= 1.2 * np.abs(series).max()


def test_what_has_no_spectrum_is_joined_without_a_word() -> None:
    flat = np.full(100, 0.3)
    flat[40:43] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_allclose(filled(flat), 0.3)
        assert np.isnan(filled(np.full(10, np.nan))).all()


def test_a_series_is_filled_about_its_own_level() -> None:
    series = table()
    missing = np.random.default_rng(2).random(SAMPLES) < 0.02
    gapped = np.where(missing, np.nan, series)
    level = 40.0 * series.std()
    np.testing.assert_allclose(filled(gapped + level) - level, filled(gapped), atol=0.02 * series.std())
