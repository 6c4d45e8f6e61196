"""The whole diagnosis on three cases that another simulator made.

The priors of a plate frame's base and joints were chosen after looking at them: they guard, they do not judge.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.diagnosis import Report, diagnose, read_report

pytestmark = pytest.mark.slow

EXPLAINED = 0.8
"""Share of the explainable misfit that a named effect explains: the acceptance of the workflow."""


def named(report: Report) -> list[tuple[str, int | None]]:
    return [(effect.effect, effect.storey) for effect in report.effects]


def explained(report: Report) -> float:
    assert report.misfit.held_out is not None
    share = report.misfit.held_out.share()
    assert share is not None
    return share


def test_nothing_is_missing_where_nothing_is_hidden(open_cases: Path) -> None:
    report = diagnose(open_cases / "open-null")
    assert report.verdict == "nothing_missing"
    assert report.effects == ()
    misfit = report.misfit.held_out
    assert misfit is not None
    # The likeliest candidate, which is not claimed, is in the model of `after`.
    assert misfit.after == pytest.approx(misfit.before, rel=0.05)
    # The generator's noise is 2 % of each channel's rms; the floor is estimated without knowing it.
    assert misfit.noise_floor == pytest.approx(0.02, rel=0.1)


def test_cubic_stiffness_is_named_and_explains_the_misfit(open_cases: Path, tmp_path: Path) -> None:
    report = diagnose(open_cases / "open-cubic", tmp_path)
    assert report.verdict == "effect_named"
    assert named(report) == [("cubic_stiffness", 3)]
    assert explained(report) > EXPLAINED
    assert read_report(tmp_path / "report.json") == report
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "cubic stiffness" in html
    assert "http://" not in html.replace("http://www.w3.org", "")


def test_friction_is_named_first_and_explains_the_misfit(open_cases: Path) -> None:
    report = diagnose(open_cases / "open-friction")
    assert report.verdict == "effect_named"
    assert named(report) == [("coulomb_friction", 2)]
    assert explained(report) > EXPLAINED
