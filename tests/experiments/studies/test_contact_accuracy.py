"""Accuracy of colliding runs: how impacts are compared and summed up."""

from __future__ import annotations

from typing import Any

import pandas as pd

from pounding.experiments.rig.impacts import Impact
from pounding.experiments.studies.contact_accuracy import COMPARISONS, compared, show, summary


def impact(time_s: float, peak_n: float, impulse: float = 1.0) -> Impact:
    return Impact(time_s, 1.0, peak_n, impulse, 0.3, 0.8, "10", "5B", 5, 1, 1.0, (0.8,))


WHOLE = {"displacement": 1e-5, "touches": 1, "touches_reference": 1, "energy": 1e-6}


def test_impacts_agree_up_to_the_first_that_does_not() -> None:
    found = compared(
        [impact(1.0, 1000.0), impact(2.0, 500.0), impact(3.0, 300.0)],
        [impact(1.00005, 1005.0), impact(2.0, 510.0), impact(3.0, 300.0)],
    )
    assert (found["impacts"], found["agree"], found["converged"]) == (3, 1, False)
    assert found["first_peak"] < 0.01 < found["peak"]


def test_another_number_of_impacts_has_not_converged() -> None:
    assert not compared([impact(1.0, 100.0)], [impact(1.0, 100.0), impact(2.0, 20.0)])["converged"]
    assert compared([impact(1.0, 100.0)], [impact(1.0, 100.5)])["converged"]
    assert compared([], [])["converged"]


def test_summary_counts_cases_and_impacts() -> None:
    rows: list[dict[str, Any]] = [
        {"case": "a", "law": "hertz"} | compared([impact(1.0, 100.0)], [impact(1.0, 100.5)]) | WHOLE,
        {"case": "b", "law": "hertz"} | compared([impact(1.0, 100.0)], [impact(1.0, 150.0)]) | WHOLE,
    ]
    tables = {name: pd.DataFrame(rows) for name in COMPARISONS}
    found = summary(tables)
    assert found.loc["modes", ["cases", "converged", "impacts", "impacts that agree"]].tolist() == [
        2,
        1,
        2,
        1,
    ]
    assert found.loc["gap", "largest peak error of the converged"] < 0.01
    assert len(list(show(tables | {"summary": found}))) == 1 + len(COMPARISONS)
    nothing = summary({name: pd.DataFrame(rows[1:]) for name in COMPARISONS})
    assert nothing.loc["step", "largest peak error of the converged"] == 0.0
