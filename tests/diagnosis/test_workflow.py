"""The whole diagnosis on three cases that another simulator made.

The priors of a plate frame's base and joints were chosen after looking at them: they guard, they do not judge.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pounding.diagnosis.workflow import diagnose_case

pytestmark = pytest.mark.slow

REPORT_KEYS = {"schema", "verdict", "confidence", "effects", "gap", "where", "candidates", "warnings"}


def named(report: dict[str, Any]) -> list[tuple[str, int | None]]:
    return [(effect["effect"], effect["storey"]) for effect in report["effects"]]


def test_nothing_is_missing_where_nothing_is_hidden(open_cases: Path) -> None:
    report = diagnose_case(open_cases / "open-null")
    assert set(report) >= REPORT_KEYS
    assert report["verdict"] == "nothing_missing"
    assert report["effects"] == []
    gap = report["gap"]["held_out"]
    assert gap["after"] == gap["before"]
    # The generator's noise is 2 % of each channel's rms; the floor is estimated without knowing it.
    assert gap["noise_floor"] == pytest.approx(0.02, rel=0.1)


def test_cubic_stiffness_is_named_and_closes_the_gap(open_cases: Path, tmp_path: Path) -> None:
    report = diagnose_case(open_cases / "open-cubic", tmp_path)
    assert report["verdict"] == "effect_named"
    assert named(report) == [("cubic_stiffness", 3)]
    gap = report["gap"]["held_out"]
    explainable = gap["before"] - gap["noise_floor"]
    # 80 % of the explainable gap is the acceptance of the workflow.
    assert gap["before"] - gap["after"] > 0.8 * explainable
    assert (tmp_path / "report.json").is_file()
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "cubic stiffness" in html
    assert "http://" not in html.replace("http://www.w3.org", "")


def test_friction_is_named_first_and_closes_the_gap(open_cases: Path) -> None:
    report = diagnose_case(open_cases / "open-friction")
    assert report["verdict"] == "effect_named"
    assert named(report) == [("coulomb_friction", 2)]
    gap = report["gap"]["held_out"]
    assert gap["before"] - gap["after"] > 0.8 * (gap["before"] - gap["noise_floor"])
