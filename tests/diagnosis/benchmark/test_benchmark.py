"""The benchmark's machinery: what is drawn, how verdicts are judged and summed up, that it resumes."""

from __future__ import annotations

import io
import json
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import UNSET, structs, to_builtins
from rich.console import Console

from pounding.diagnosis import diagnose
from pounding.diagnosis.benchmark import reliability, run
from pounding.diagnosis.benchmark.drawing import draw_set
from pounding.diagnosis.benchmark.scoring import judge
from pounding.diagnosis.benchmark.summary import share, summarise
from pounding.diagnosis.benchmark.tables import tables
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.decision.claims import Place, claim, parameter
from pounding.diagnosis.decision.conclusion import ContactMisfit
from pounding.diagnosis.decision.confidence import Basis, Features, confidence, read_pairs
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.effects import CATALOGUE
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.outsiders import OUTSIDE
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.diagnosis.report.report import HeldOutMisfit, Misfits, Report

FRICTION = Place(effect="coulomb_friction", frame="5A", storey=3)
GAIN = Place(effect="table_gain")
STIFFNESS = Place(effect="contact_stiffness", contact=1)
OWN = Place(effect="tie_of_mine", frame="5A", storey=3)
"""A candidate of the user's, which no case hides."""
ELSEWHERE = Place(effect="coulomb_friction", frame="5A", storey=2)
HELD_OUT = HeldOutMisfit(run="run3.csv", before=0.3, after=0.1, noise_floor=0.05)


def truth(*effects: Place, kind: str = "single", value: float = 10.0) -> dict[str, Any]:
    told = [{"name": "friction_force", "value": value, "unit": "N"}]
    hidden = [to_builtins(effect) | {"visibility": 3.0, "parameters": told} for effect in effects]
    return {"kind": kind, "effects": hidden, "frames": ["5A"], "seed": 0}


def report(
    verdict: Verdict, *effects: Place, classes: tuple[Place, ...] = (), behind: Basis | None = None
) -> Report:
    told = [parameter("friction_force", 9.0, 0.1, "N")]
    return Report(
        verdict=verdict,
        confidence=0.9,
        confidence_basis=behind or UNSET,
        effects=tuple(claim(effect, told, 40.0, list(classes)) for effect in effects),
        misfit=Misfits(training=HELD_OUT, held_out=HELD_OUT),
        where=(),
        candidates=(),
        warnings=(),
    )


def test_a_set_has_its_shares_and_deals_evenly() -> None:
    drawn = draw_set(200, 1)
    kinds = Counter(
        "nothing" if not d.effects else "outside" if d.effects[0] in OUTSIDE else f"{len(d.effects)}"
        for d in drawn
    )
    assert kinds == {"nothing": 40, "outside": 20, "2": 20, "1": 120}
    singles = Counter(d.effects[0] for d in drawn if len(d.effects) == 1 and d.effects[0] in CATALOGUE)
    assert set(singles) == set(CATALOGUE)
    assert set(Counter(d.frames for d in drawn).values()) == {50}
    assert all(len(set(d.effects)) == len(d.effects) for d in drawn)
    assert len({d.seed for d in drawn}) == 200
    assert draw_set(200, 1) == drawn
    assert draw_set(200, 2) != drawn
    with pytest.raises(CaseError, match="a benchmark of 0 cases"):
        draw_set(0, 1)


@pytest.mark.parametrize(
    ("hidden", "found", "detected", "exact", "in_class"),
    [
        (truth(kind="nothing"), report("nothing_missing"), False, True, True),
        (truth(kind="nothing"), report("effect_named", FRICTION), True, False, False),
        (truth(kind="nothing"), report("unknown_effect", FRICTION), True, False, False),
        (truth(FRICTION), report("effect_named", FRICTION), True, True, True),
        (truth(FRICTION), report("nothing_missing"), False, False, False),
        (truth(FRICTION), report("effect_named", ELSEWHERE), True, False, False),
        (truth(FRICTION), report("effect_class", GAIN, classes=(GAIN, FRICTION)), True, False, True),
        (truth(FRICTION), report("effect_class", FRICTION, classes=(FRICTION, GAIN)), True, True, True),
        (truth(FRICTION), report("effect_named", FRICTION, GAIN), True, False, True),
        (truth(FRICTION), report("unknown_effect", FRICTION), True, False, False),
        (truth(FRICTION), report("effect_named", OWN), True, False, False),
        (truth(FRICTION), report("effect_class", OWN, classes=(OWN, FRICTION)), True, False, True),
        (truth(kind="nothing"), report("effect_named", OWN), True, False, False),
        (truth(FRICTION, kind="outside"), report("effect_named", OWN), True, False, False),
        (truth(FRICTION, GAIN, kind="double"), report("effect_named", GAIN, FRICTION), True, True, True),
        (truth(FRICTION, GAIN, kind="double"), report("effect_named", FRICTION), True, False, False),
        (truth(FRICTION, kind="outside"), report("effect_named", FRICTION), True, False, False),
        (truth(FRICTION, kind="outside"), report("unknown_effect"), True, True, True),
    ],
)
def test_judging(hidden: dict[str, Any], found: Report, detected: bool, exact: bool, in_class: bool) -> None:
    judged = judge(hidden, found, 1.0)
    assert (judged.detected, judged.exact, judged.in_class) == (detected, exact, in_class)


def test_explained_misfit_and_parameter_error() -> None:
    judged = judge(truth(FRICTION), report("effect_named", FRICTION))
    assert judged.misfit_explained == pytest.approx(0.2 / 0.25)
    assert judged.parameter_errors == pytest.approx((0.1,))
    wrong = judge(truth(FRICTION), report("effect_named", GAIN))
    assert wrong.parameter_errors == ()
    single = structs.replace(
        report("effect_named", FRICTION), misfit=Misfits(training=HELD_OUT, held_out=None)
    )
    assert np.isnan(judge(truth(FRICTION), single).misfit_explained)


def test_what_is_named_of_a_contact_is_judged_by_the_impacts() -> None:
    """The frames' misfit, whose forces are known inputs, has nothing to do with it."""
    found = report("effect_named", STIFFNESS)
    assert np.isnan(judge(truth(STIFFNESS), found).misfit_explained)
    for before, part in ((5.0, 0.9), (1.05, np.nan)):
        impacts = ContactMisfit(impacts=9, before=before, after=1.4)
        with_impacts = structs.replace(found, misfit=structs.replace(found.misfit, contact=impacts))
        assert judge(truth(STIFFNESS), with_impacts).misfit_explained == pytest.approx(part, nan_ok=True)


def test_a_candidate_of_the_users_is_a_wrong_name_under_its_own_name() -> None:
    case = judge(truth(FRICTION), report("effect_named", OWN))
    assert (case.called, case.parameter_errors) == ("tie_of_mine", ())
    assert case.misfit_explained == pytest.approx(0.2 / 0.25)
    assert summarise([case])["confusion"] == {"coulomb_friction": {"tie_of_mine": 1}}


def test_wilson_interval_of_textbooks() -> None:
    """Newcombe 1998, Statist. Med. 17, table I: 81 of 263 has 0.2553 to 0.3662 by Wilson's score."""
    part = share([judge(truth(FRICTION), report("effect_named", FRICTION))] * 263, lambda case: True)
    assert (part["hits"], part["share"]) == (263, 1.0)
    cases = [judge(truth(FRICTION), report("effect_named", FRICTION if i < 81 else GAIN)) for i in range(263)]
    part = share(cases, lambda case: case.exact)
    assert (part["low"], part["high"]) == pytest.approx((0.2553, 0.3662), abs=1e-4)


def test_summary_counts_each_kind_by_what_was_asked_of_it() -> None:
    cases = [
        judge(truth(kind="nothing"), report("nothing_missing"), 1.0),
        judge(truth(kind="nothing"), report("effect_named", FRICTION), 2.0),
        judge(truth(FRICTION), report("effect_named", FRICTION), 3.0),
        judge(truth(FRICTION), report("effect_named", ELSEWHERE), 4.0),
        judge(truth(FRICTION, kind="outside"), report("unknown_effect"), 5.0),
    ]
    figures = summarise(cases)
    assert figures["false_alarms"]["share"] == 0.5
    assert figures["exact_of_detected"]["share"] == 0.5
    assert figures["outsiders_caught"]["share"] == 1.0
    assert figures["outsiders_not_misnamed"]["share"] == 1.0
    assert figures["seconds_median"] == 3.0
    assert figures["confusion"]["coulomb_friction"] == {
        "coulomb_friction": 1,
        "coulomb_friction, elsewhere": 1,
    }
    assert figures["reliability"][-1]["right"]["share"] == 0.6
    console = Console(width=160, file=io.StringIO())
    for item in tables({**figures, "failures": ["case 3: it broke"], "memory_mb": 100.0}):
        console.print(item)
    text = console.file.getvalue()
    assert "50% (1/2; 9% to 91%)" in text
    assert "it broke" in text


def test_effects_of_a_contact_are_summed_up_apart() -> None:
    gap = Place(effect="gap_offset", contact=1)
    cases = [
        judge(truth(gap), report("effect_named", gap)),
        judge(truth(gap), report("nothing_missing")),
        judge(truth(FRICTION), report("effect_named", GAIN)),
    ]
    figures = summarise(cases)
    assert figures["exact_of_contact_singles"]["share"] == 0.5
    assert figures["exact_of_detected_contact_singles"]["share"] == 1.0
    assert figures["exact_of_plain_frame_singles"]["share"] == 0.0
    assert "exact_of_contact_singles" not in summarise(cases[2:])


def test_confidence_is_judged_on_cases_that_it_was_not_fitted_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cases").mkdir()
    named = Features("effect_named", 500.0, 400.0, 3.0, 1.0, 1)
    contact_findings = Features("contact_named", 90.0, 80.0, 1.0, 1.0, 1)
    gap = Place(effect="gap_offset", contact=1)
    nothing = Features("nothing_missing", 3.0, 0.0, 0.1, 1.0, 0)
    behind = Basis(calibration="a test", features=named)
    both = structs.replace(behind, contact=contact_findings)
    told = [
        (truth(FRICTION), report("effect_named", FRICTION, behind=behind)),
        (truth(FRICTION), report("effect_named", GAIN, behind=behind)),
        (truth(gap), report("effect_named", gap, behind=structs.replace(both, features=nothing))),
        (truth(FRICTION, gap), report("effect_named", FRICTION, gap, behind=both)),
    ]
    for index, (hidden, found) in enumerate(told):
        values = {"truth": json.dumps(hidden), "report": found.json()}
        kept = {"case": {"index": index}, "failure": "", "values": values}
        (tmp_path / "cases" / f"{9 - index}.json").write_text(json.dumps(kept))
    reliability.main(tmp_path, first=3, fit=tmp_path / "pairs.jsonl")
    assert read_pairs(tmp_path / "pairs.jsonl") == [(named, True), (named, False), (contact_findings, True)]
    # One effect of a frame and one of the contact are right together or not at all, and give no line.
    reliability.main(tmp_path, skip=3, fit=tmp_path / "none.jsonl", picture=tmp_path / "reliability.png")
    assert read_pairs(tmp_path / "none.jsonl") == []
    stated = confidence(named) * confidence(contact_findings)
    assert f"stated {stated:.2f}, right 1.00 (1 of 1)" in capsys.readouterr().out
    assert (tmp_path / "reliability.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(CaseError, match="no finished case"):
        reliability.main(tmp_path / "cases")
    for damaged in ('{"values"', "[]", '{"values": {"truth": "{}", "report": "[]"}, "case": {"index": 3}}'):
        (tmp_path / "cases" / "9.json").write_text(damaged)
        with pytest.raises(CaseError, match=r"9\.json"):
            reliability.main(tmp_path)


def test_an_unknown_method_is_said() -> None:
    with pytest.raises(CaseError, match="no method 'guessing'"):
        run.run_benchmark(2, way="guessing")


def test_a_benchmark_runs_resumes_and_does_not_show_the_truth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a way of diagnosis that only looks at what it is given."""
    seen = []

    def look(folder: Path) -> Report:
        seen.append(sorted(path.name for path in Path(folder).iterdir()))
        case = read_case(folder)
        assert "hidden" not in case.title
        return report("nothing_missing")

    monkeypatch.setattr(run, "method", lambda name: look)
    monkeypatch.setattr(run, "hide", partial(hide, duration_s=0.6))
    # Finished cases belong to the source that made them.
    monkeypatch.setattr(run, "_version", lambda: "one")
    options: dict[str, Any] = {"out": tmp_path, "workers": 0, "motions": "artificial"}
    result = run.run_benchmark(3, 3, **options)
    assert len(seen) == 3
    assert set(map(tuple, seen)) == {("case.toml", "run1.csv", "run2.csv", "run3.csv")}
    assert result["false_alarms"]["share"] == 0.0
    assert result["cases"] == 3
    assert result["failures"] == []
    assert json.loads((tmp_path / "benchmark.json").read_text())["cases"] == 3
    again = run.run_benchmark(3, 3, **options)
    assert len(seen) == 3
    assert [case["seed"] for case in again["judged"]] == [case["seed"] for case in result["judged"]]
    fewer = run.run_benchmark(3, 3, first=2, **options)
    assert len(seen) == 3
    assert [case["seed"] for case in fewer["judged"]] == [case["seed"] for case in result["judged"]][:2]
    kinds = [run.kind(one) for one in draw_set(3, 3)]
    some = run.run_benchmark(3, 3, only=[kinds[0]], **options)
    assert len(seen) == 3
    assert some["cases"] == kinds.count(kinds[0])
    with pytest.raises(CaseError, match="no case of the kind outside among the 3"):
        run.run_benchmark(3, 3, only=["outside"], **options)
    with pytest.raises(CaseError, match="give 1 to 3"):
        run.run_benchmark(3, 3, first=4, **options)
    monkeypatch.setattr(run, "_version", lambda: "two")
    run.run_benchmark(3, 3, **options)
    assert len(seen) == 6


@pytest.mark.slow
@pytest.mark.guard
def test_a_small_seeded_set_is_diagnosed_as_well_as_before(tmp_path: Path) -> None:
    """Four plain cases: nothing, friction, a cubic spring, a sensor's gain."""
    judged = {}
    for words in ([], ["coulomb_friction:2"], ["cubic_stiffness:3"], ["sensor_gain"]):
        truth, report = _of_5a(words, tmp_path / "-".join(["case", *words]).replace(":", ""))
        judged["-".join(words)] = judge(truth, report)
    wrong = {name: case.called for name, case in judged.items() if not case.exact}
    assert not wrong
    closed = [
        case.misfit_explained
        for case in judged.values()
        if case.kind == "single" and np.isfinite(case.misfit_explained)
    ]
    assert np.median(closed) > 0.9
    errors = [error for case in judged.values() for error in case.parameter_errors]
    assert np.median(errors) < 0.05


@pytest.mark.slow
@pytest.mark.guard
def test_a_part_that_sways_is_said_where_it_is_no_larger_than_an_error_of_the_frame(tmp_path: Path) -> None:
    """It takes 2 % of a motion that is measured with 4 % of noise: every real frame may have as much."""
    truth, report = _of_5a(["hidden_appendage"], tmp_path / "case")
    floor = truth["effects"][0]["floor"]
    assert report.verdict == "nothing_missing"
    assert any(f"a little appendage, floor {floor} of 5A" in warning for warning in report.warnings)


def _of_5a(words: Sequence[str], folder: Path) -> tuple[dict[str, Any], Report]:
    """Return truth and report of effects hidden in 5A."""
    hidden = hide(words, ["5A"], seed=31, visibility=5.0, source="artificial", duration_s=4.0)
    write_hidden(hidden, folder)
    return hidden.truth, diagnose(folder)
