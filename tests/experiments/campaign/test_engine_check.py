"""A campaign by the exact solver is checked by exudyn, and says how far the two agree."""

from __future__ import annotations

import dataclasses

import pytest

from pounding.experiments.campaign import engine_check
from pounding.experiments.campaign.cases import run_all
from pounding.experiments.campaign.engine_check import CLOSES, SAMPLE, check_in_engine

CASES = [
    {"left": "5A", "right": "5B", "record": "elcentro-chopra", "law": law, "gap_mm": gap}
    for law, gap in (("hertz", 2.0), ("linear_viscoelastic", 3.0), ("hertz_damp", 60.0))
]


def test_a_sample_is_run_again_and_told() -> None:
    runs = run_all(CASES, workers=0)
    found = check_in_engine(CASES, runs, workers=0)
    assert (found.runs, found.checked) == (3, 3)
    assert found.checked <= SAMPLE
    assert found.same_count == 3
    assert 0.0 < found.displacement < 1e-3
    assert 0.0 < found.first_peak < 1e-2
    assert "exudyn ran 3 of them again: 3 with the same number of impacts" in found.sentence
    assert 0.0 < found.energy < 1e-5
    assert found.sentence.endswith(f"the energy of all runs closes within {100 * found.energy:.2g} %")
    # What disagrees is told: the same check against runs of another gap.
    other = run_all([case | {"gap_mm": 4.0} for case in CASES], workers=0)
    told = check_in_engine(CASES, other, workers=0)
    assert told.displacement > 0.01
    assert dataclasses.asdict(told) == told.as_dict()


def test_a_fault_outside_the_sample_is_told_by_the_energy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stiffness changed and the old modes kept, as happened once in cases that no sample had."""
    changed = CASES[0] | {"frame_stiffness": 1.1}
    cases = [CASES[0], changed, CASES[1]]
    monkeypatch.setattr(engine_check, "SAMPLE", 2)
    with monkeypatch.context() as patch:
        patch.setattr("pounding.frames.response.exact._differ", lambda one, other: False)
        runs = run_all(cases, workers=0)
    found = check_in_engine(cases, runs, workers=0)
    # All that exudyn runs again agrees.
    assert (found.checked, found.same_count) == (2, 2)
    assert found.displacement < 1e-3
    assert found.unbalanced == 1
    assert found.energy > 10 * CLOSES
    assert "but energy does not close within 0.01 % in 1 of all runs, least in 5A-5B under" in found.sentence
    assert "frame_stiffness 1.1" in found.sentence
    assert "--solver exudyn" in found.sentence


def test_cases_keep_the_solver_they_ran_with() -> None:
    exact = run_all(CASES[:1], workers=0, solver="exact")
    engine = run_all(CASES[:1], workers=0, solver="exudyn")
    assert exact["count"].iloc[0] == engine["count"].iloc[0] > 0
    assert exact["peak_force_n"].iloc[0] == pytest.approx(engine["peak_force_n"].iloc[0], rel=1e-2)
    # Steps of an integrator lose energy, closed formulas hardly any.
    assert exact["energy_error"].iloc[0] < engine["energy_error"].iloc[0] / 10
