"""Peaks: what effects of a whole frame make of them, and the judgement on records that were not fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.case.numbers import Peak
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.studies.peak_diagnosis import RECORDS, judge, thesis_peaks
from pounding.diagnosis.studies.whole_frames import CATALOGUE, PeakModel, evidence, log_likelihood
from tests.diagnosis.models import STEP_S, shaking, three_storeys

EFFECTS = {effect.name: effect for effect in CATALOGUE}


def bench(peaks: list[Peak]) -> PeakModel:
    time = STEP_S * np.arange(1500)
    blank = np.zeros((1500, 0))
    runs = [
        RunData(name, STEP_S, time, shaking(1500, seed), blank, blank) for seed, name in enumerate(RECORDS)
    ]
    return PeakModel(three_storeys().frames[0], runs, peaks, Prior())


def peaks_of(name: str, size: float) -> list[Peak]:
    """Peaks that the bench itself gives with an effect, three floors, four records, both sides."""
    blank = [
        Peak(run, "bench", floor, side, 1.0, 0.1)
        for run in RECORDS
        for floor in (1, 2, 3)
        for side in ("max", "min")
    ]
    found = bench(blank).predict(EFFECTS[name], size)
    return [
        Peak(one.run, "bench", one.floor, one.side, float(value), 0.03 * float(value))
        for one, value in zip(blank, found, strict=True)
    ]


@pytest.mark.parametrize(
    ("name", "index"), [("damping_change", 8), ("table_gain", 3), ("stiffness_change", 4)]
)
def test_the_effect_behind_the_peaks_wins_on_records_not_fitted(name: str, index: int) -> None:
    size = EFFECTS[name].sizes[index]
    peaks = peaks_of(name, size)
    model = bench(peaks)
    held = {}
    for other in ("damping_change", "table_gain", "stiffness_change", "air_drag"):
        predicted = {"bench": np.array([model.predict(EFFECTS[other], s) for s in EFFECTS[other].sizes])}
        held[other] = judge(predicted, {"bench": model.peaks}, each=False)
    assert min(held, key=lambda one: held[one]["held_out"]) == name
    assert held[name]["held_out"] < 1e-9
    assert held[name]["closed"] == pytest.approx(1.0)
    assert [EFFECTS[name].sizes[one[0]] for one in held[name]["picked"]] == [size] * 6


def test_no_effect_is_the_believed_model_for_every_kind() -> None:
    model = bench(peaks_of("table_gain", 0.0))
    expected = np.array([peak.value for peak in model.peaks])
    for effect in CATALOGUE:
        assert effect.sizes[0] == 0
        assert model.predict(effect, 0.0) == pytest.approx(expected)
        assert np.abs(model.predict(effect, effect.sizes[-1]) / expected - 1).max() > 1e-4


def test_a_frame_that_runs_away_is_infinitely_far() -> None:
    model = bench(peaks_of("table_gain", 0.0))
    away = model.predict(EFFECTS["cubic_stiffness"], -5.0)
    assert np.isinf(away).any()
    assert np.isfinite(log_likelihood(away[None], model.peaks)).all()


def test_evidence_is_averaged_over_size_and_scatter() -> None:
    peaks = [Peak("a", "b", 1, "max", 1.0, 0.01)] * 8
    good, bad = (log_likelihood(np.full((1, 8), value), peaks) for value in (1.0, 1.5))
    assert evidence(good) > evidence(bad) + 5
    # Twice the same size says the same; a useless second size costs no more than a factor of two.
    assert evidence(np.vstack([good, good])) == pytest.approx(evidence(good))
    assert evidence(np.vstack([good, bad])) == pytest.approx(evidence(good) - np.log(2), abs=0.01)


def test_the_contested_peaks_of_the_thesis_are_left_out() -> None:
    counts = {name: len(thesis_peaks(name)) for name in ("5A", "5B", "10", "15A", "15B")}
    assert counts == {"5A": 8, "5B": 8, "10": 16, "15A": 8, "15B": 18}
    assert not [peak for peak in thesis_peaks("15B") if peak.run == "hachinohe"]


PEAK = """
[[frame]]
name = "5B"
[[run]]
file = "run.csv"
[[channel]]
name = "table"
quantity = "table_acceleration"
unit = "g"
[[peak]]
run = "{run}"
floor = {floor}
side = "{side}"
value = 4.5
unit = "{unit}"
std = 0.25
"""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"run": "other.csv"}, "run 'other.csv' is not listed"),
        ({"floor": 6}, "floor 6 is not on 5B"),
        ({"side": "left"}, "neither 'max' (towards +x) nor 'min'"),
        ({"unit": "N"}, "unit 'N' does not fit"),
    ],
)
def test_bad_peaks_are_one_sentence(tmp_path: Path, change: dict[str, object], said: str) -> None:
    good: dict[str, object] = {"run": "run.csv", "floor": 5, "side": "max", "unit": "mm"}
    rows = "\n".join(f"{0.01 * k:.2f},0.0{k % 7}" for k in range(40))
    (tmp_path / "run.csv").write_text(f"time_s,table\n{rows}\n")
    (tmp_path / "case.toml").write_text(PEAK.format(**good))
    (read,) = read_case(tmp_path).peaks
    assert (read.run, read.frame, read.floor, read.side) == ("run.csv", "5B", 5, "max")
    assert (read.value, read.std) == pytest.approx((0.0045, 0.00025))
    (tmp_path / "case.toml").write_text(PEAK.format(**(good | change)))
    with pytest.raises(CaseError) as caught:
        read_case(tmp_path)
    assert said in str(caught.value)
