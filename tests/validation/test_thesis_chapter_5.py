"""Chapter 5: the tests as data, the spread over stiffnesses, and a few real cases."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pounding.contact.parameters import STIFFNESS_SETS
from pounding.experiments.campaign.cases import chapter_5
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.studies import chapter_5 as study


def test_twenty_gaps_as_printed(test_records: Path) -> None:
    tests = chapter_5()
    assert len(tests) == 20
    assert {(test.left, test.right) for test in tests} == {("15B", "5B")}
    assert [test.gap_mm for test in tests if test.record == "kobe"] == [16.8, 16.4, 15.6, 15.0, 14.0]
    assert all(0.5 < test.fraction < 1.0 for test in tests)
    lengths = [shaking(test.record, str(test_records)).duration_s for test in tests[::5]]
    assert sum(lengths) == pytest.approx(54.0, abs=0.1)


def test_spread_of_two_free_bodies_is_the_root_of_the_stiffness() -> None:
    index = pd.MultiIndex.from_tuples([("kobe", 15.0), ("kobe", 14.0)], names=["record", "gap_mm"])
    roots = {name: np.sqrt(k) * np.array([1.0, 2.0]) for name, (k, _) in STIFFNESS_SETS.items()}
    peaks = pd.DataFrame(roots, index=index)
    found = study.spread(peaks, peaks)
    assert found.loc["experiment", "first_peak_percent_error"] == 0.0
    np.testing.assert_allclose(found["first_peak_mean_ratio"], found["square_root_of_stiffness"])
    np.testing.assert_allclose(found["first_peak_lowest"], found["first_peak_highest"])


def test_a_record_without_impact_does_not_spoil_the_spread() -> None:
    index = pd.MultiIndex.from_tuples([("kobe", 15.0), ("kobe", 99.0)], names=["record", "gap_mm"])
    first = pd.DataFrame({name: [1.0, np.nan] for name in STIFFNESS_SETS}, index=index)
    assert np.isfinite(study.spread(first, first.fillna(0.0)).to_numpy()).all()


@pytest.mark.slow
def test_two_gaps_for_real(test_records: Path, tmp_path: Path) -> None:
    """A stiffer contact pushes harder in the first impact, in the order of the stiffnesses."""
    tests = [test for test in chapter_5() if test.record == "elcentro"][2:4]
    result, tables = study.study(test_records, workers=0, tests=tests)
    assert result["runs"] == 2 * 5 * 2 + 2
    assert result["energy_error"] < 5e-3
    first = tables["first_peak_same_fraction"]
    order = sorted(STIFFNESS_SETS, key=lambda name: STIFFNESS_SETS[name][0])
    assert (np.diff(first[order].to_numpy(), axis=1) > 0).all()
    study.write_tables(tables, tmp_path)
    assert (tmp_path / "spread_same_fraction.csv").stat().st_size > 100
