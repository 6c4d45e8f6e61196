"""The study of strong motion: its tables on made-up runs, and the exact solver's figures."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from pounding.experiments.campaign.cases import chapter_6, run_apart
from pounding.experiments.records import RECORDS
from pounding.experiments.rig.pounding import built_in, shaking
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.states import states_of
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.studies import strong_motion as study
from pounding.experiments.studies.strong_motion import LABELS
from pounding.experiments.studies.table_4_1 import FRAMES, measured

STRONG = LABELS["strong-motion"]


def test_only_strong_motion_is_called_fitted_and_only_free_vibration_blind() -> None:
    assert {state: ("fitted" in name, "blind" in name) for state, name in LABELS.items()} == {
        "free-vibration": (False, True),
        "strong-motion": (True, False),
    }


@pytest.fixture
def made_up() -> dict[str, pd.DataFrame]:
    """Runs whose peaks, gaps and counts are the measured ones, those in strong motion half as large again."""
    truth, alone, apart, collided = measured(), [], [], []
    for state in LABELS:
        factor = 1.5 if state == "strong-motion" else 1.0
        for frame in FRAMES:
            places = truth.frame == frame
            for record in RECORDS:
                found = truth.sel(record=record)[places]
                floors = zip(found.floor.values, found.values, strict=True)
                peaks = [
                    {"floor": int(n), "max_mm": factor * high, "min_mm": factor * low}
                    for n, (high, low) in floors
                ]
                row = {"frame": frame, "record": record, "state": state, "peaks": json.dumps(peaks)}
                alone.append(row | {"max_stress_mpa": 279.0 if state == "strong-motion" else 281.0})
        for left, right, _ in tables_4.pairs():
            for record in RECORDS:
                row = {"left": left, "right": right, "record": record, "state": state}
                apart.append(row | {"closing_mm": 1.0, "opening_mm": 2.0})
        for test in chapter_6():
            row = {"left": test.left, "right": test.right, "record": test.record, "state": state}
            collided.append(row | {"count": 2})
    return {
        "alone": pd.DataFrame(alone),
        "apart": pd.DataFrame(apart),
        "collided": pd.DataFrame(collided),
    }


def test_misfits_of_made_up_runs(made_up: dict[str, pd.DataFrame]) -> None:
    alone = made_up["alone"]
    computed = {state: study.peaks(alone[alone["state"] == state]) for state in LABELS}
    tables = {
        "gaps": study.gaps(made_up["apart"]),
        "impacts": study.impacts(made_up["collided"]),
        "impacts_chapter_5": study.collided(
            made_up["collided"].assign(gap_mm=[*range(len(chapter_6()))] * 2)
        ),
        "stress": study.stresses(alone),
    }
    found = study.misfits(computed, tables)
    assert found.loc[LABELS["free-vibration"], ["peaks_58", "peaks_64"]].tolist() == [0.0, 0.0]
    assert found.loc[STRONG, "peaks_58"] == pytest.approx(0.5)
    assert found["shakes_beyond_yield"].tolist()[1:] == [20.0, 0.0]
    assert tables["stress"]["at_measured"].to_numpy() == pytest.approx(279.0 / 1.5)
    assert found.loc[STRONG, "impacts"] == 24
    # counted: 2, 1, 1, 3, 2, 7, 2, 2, 5, 4, 3, 8
    assert found.loc[STRONG, "sum_of_differences"] == 20
    assert found.loc["SAP2000 (printed)", "gap_equation_4_1"] == pytest.approx(0.099, abs=5e-4)
    assert found.loc[STRONG, "gap_closing"] > found.loc[STRONG, "gap_equation_4_1"]
    assert list(study.show(tables | {"misfits": found, "held_out": pd.DataFrame({"held_out": [0.1]})}))


def test_a_pair_apart_moves_as_the_required_gap_says() -> None:
    found = run_apart("10", "5B", "elcentro-chopra", state="strong-motion")
    one, other = map(built_in, states_of(["10", "5B"], "strong-motion"))
    gap = pair_gap(one, other, shaking("elcentro-chopra"))
    assert found["closing_mm"] == pytest.approx(1e3 * gap.closing_m, rel=2e-3)
    assert found["opening_mm"] == pytest.approx(1e3 * gap.opening_m, rel=2e-3)


@pytest.mark.slow
@pytest.mark.guard
def test_the_exact_solver_gives_the_figures_of_the_page(test_records: Path) -> None:
    result, tables = study.study(test_records, workers=0, solver="exact")
    found = tables["misfits"]
    assert found.loc[LABELS["free-vibration"], "peaks_58"] == pytest.approx(0.219, abs=0.005)
    assert found.loc[STRONG, "peaks_58"] == pytest.approx(0.120, abs=0.005)
    assert found.loc[LABELS["free-vibration"], "shakes_beyond_yield"] == 6
    assert found.loc[STRONG, "shakes_beyond_yield"] == 5
    halves = tables["held_out"].loc[2]
    assert halves["held_out"].mean() == pytest.approx(0.130, abs=0.005)
    assert halves["blind"].mean() == pytest.approx(0.218, abs=0.005)
    assert [one["state"] for one in result["parameters"]["states"][-5:]] == ["strong-motion"] * 5
