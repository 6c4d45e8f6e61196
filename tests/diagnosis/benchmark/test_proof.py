"""The sets of a proof and the figures that only they ask for."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from msgspec import structs

from pounding.diagnosis.benchmark import proof
from pounding.diagnosis.benchmark.drawing import Counts, draw_set
from pounding.diagnosis.benchmark.proof import SETS, prove, seed_of
from pounding.diagnosis.benchmark.run import kind
from pounding.diagnosis.benchmark.scoring import judge
from pounding.diagnosis.benchmark.summary import summarise
from pounding.diagnosis.errors import CaseError
from tests.diagnosis.benchmark.test_benchmark import ELSEWHERE, FRICTION, GAIN, report, truth

COMMIT = "5d638ea" + 33 * "0"


def test_a_set_has_the_counts_that_are_asked_for_and_its_nulls_every_noise_as_often() -> None:
    one = SETS["frames"]
    drawn = draw_set(one.count, 1, engine=one.engine, counts=one.counts)
    assert Counter(map(kind, drawn)) == {"nothing": 60, "single": 80, "double": 20, "outside": 20}
    noises = Counter(case.noise for case in drawn if not case.effects)
    assert noises == dict.fromkeys((0.005, 0.01, 0.02, 0.05), 15)
    pairs = SETS["pairs"]
    drawn = draw_set(pairs.count, 1, pairs=True, engine=pairs.engine, counts=pairs.counts)
    assert Counter(map(kind, drawn))["nothing"] == 10
    assert all(len(case.frames) == 2 for case in drawn)
    with pytest.raises(CaseError, match="3 cases are fewer"):
        draw_set(3, 1, counts=Counts(2, 1, 1))


def test_a_seed_follows_from_the_whole_hash_and_the_set() -> None:
    seeds = {seed_of(COMMIT, name) for name in SETS}
    assert len(seeds) == len(SETS)
    assert seeds == {seed_of(COMMIT, name) for name in SETS}
    assert all(0 <= seed < 2**31 for seed in seeds)
    for commit in ("5d638ea", COMMIT.upper(), "main"):
        with pytest.raises(CaseError, match="whole hash"):
            seed_of(commit, "own")


def test_a_proof_runs_the_set_in_its_own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    asked: dict[str, Any] = {}

    def run(count: int, seed: int, **options: Any) -> dict[str, Any]:
        asked.update(options, count=count, seed=seed)
        return {}

    monkeypatch.setattr(proof, "run_benchmark", run)
    prove(COMMIT, tmp_path, name="pairs")
    assert (asked["count"], asked["seed"], asked["pairs"]) == (40, seed_of(COMMIT, "pairs"), True)
    assert (asked["out"], asked["workers"], asked["engine"]) == (tmp_path / "pairs", 2, "opensees")


def test_what_an_unknown_effect_closes_counts_and_what_is_named_wrong_does() -> None:
    unknown = judge(truth(FRICTION), report("unknown_effect", FRICTION))
    assert (unknown.misfit_explained, unknown.misfit_closed) == (0.0, pytest.approx(0.8))
    missed = judge(truth(FRICTION), report("nothing_missing"))
    outside = judge(truth(FRICTION, kind="outside"), report("effect_named", GAIN))
    figures = summarise([unknown, missed, outside])
    assert figures["misfit_closed_median"] == pytest.approx(0.8)
    assert figures["outsiders_misnamed"]["share"] == 1.0
    assert figures["singles_detected"]["share"] == 0.5


def test_errors_in_standard_errors() -> None:
    """The truth is 10, what is found is 9."""
    found = report("effect_named", FRICTION)
    assert judge(truth(FRICTION), found).parameter_deviations == pytest.approx((10.0,))
    wide = structs.replace(found.effects[0].parameters[0], std=2.0)
    effects = (structs.replace(found.effects[0], parameters=(wide,)),)
    near = judge(truth(FRICTION), structs.replace(found, effects=effects))
    assert near.parameter_deviations == pytest.approx((0.5,))
    figures = summarise([near, judge(truth(FRICTION), found)])
    assert figures["parameter_deviation_median"] == pytest.approx(5.25)
    assert figures["parameters_below_two_deviations"]["share"] == 0.5
    without = structs.replace(found.effects[0].parameters[0], std=None)
    effects = (structs.replace(found.effects[0], parameters=(without,)),)
    silent = judge(truth(FRICTION), structs.replace(found, effects=effects))
    assert (silent.parameter_errors, silent.parameter_deviations) == (pytest.approx((0.1,)), ())


def test_confidence_is_off_by_its_worst_bin_of_enough_cases() -> None:
    right, wrong = (judge(truth(FRICTION), report("effect_named", place)) for place in (FRICTION, ELSEWHERE))
    assert summarise([wrong] * 9)["confidence_off"] is None
    assert summarise([right] * 6 + [wrong] * 4)["confidence_off"] == pytest.approx(0.3)


def test_misses_are_listed_by_kind() -> None:
    cases = [
        judge(truth(kind="nothing"), report("nothing_missing")),
        judge(truth(kind="nothing"), report("unknown_effect", FRICTION)),
        judge(truth(FRICTION), report("effect_named", FRICTION)),
        judge(truth(FRICTION), report("effect_named", GAIN)),
        judge(truth(FRICTION), report("unknown_effect", FRICTION)),
        judge(truth(FRICTION, GAIN, kind="double"), report("nothing_missing")),
        judge(truth(FRICTION, kind="outside"), report("effect_named", GAIN)),
    ]
    told = {one["number"]: one["miss"] for one in summarise(cases)["misses"]}
    assert told == {
        1: "false alarm",
        3: "single misnamed",
        4: "single unknown",
        5: "double missed",
        6: "outsider misnamed",
    }
