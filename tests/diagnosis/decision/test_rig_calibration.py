"""The calibration on one's own rig: simulated cases, kept and resumed, turned into a stated rate."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis import diagnose, workflow
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.decision import rig_calibration
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.confidence import SimulatedTruth, basis, shipped
from pounding.diagnosis.decision.rig_calibration import (
    Outcome,
    calibrate,
    fingerprint,
    hypotheses,
    read_outcomes,
    simulate_and_judge,
    simulated,
    stated,
)
from pounding.diagnosis.decision.verdict import decide, features
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.search import search
from pounding.experiments.command.app import main
from pounding.frames.files import DamageWarning, sealed
from tests.diagnosis.case.test_bad_input import case_of
from tests.diagnosis.models import measured

CUBIC = next(one for one in candidates(measured()) if one.name == "cubic_stiffness" and one.storey == 2)


@pytest.fixture(scope="module")
def found() -> Findings:
    model = measured([(CUBIC, np.array([2e9]))])
    effects = [one for one in candidates(model) if one.name in ("cubic_stiffness", "damping_change")]
    return search(model, effects, [0], [1], lambda what, share: None)


def test_simulated_data_have_the_noise_and_the_dropouts_of_the_measured(found: Findings) -> None:
    found.model.observed.runs[0].measured[10:20, 1] = np.nan
    truth = hypotheses(found)[1]
    made = [simulated(found, truth, np.random.default_rng(seed)) for seed in (1, 1, 2)]
    first = [one.observed.runs[0].measured for one in made]
    assert np.isnan(first[0][10:20, 1]).all()
    np.testing.assert_array_equal(first[0], first[1])
    assert not np.allclose(first[0][30:], first[2][30:])
    clean = made[0].predict(np.zeros(len(made[0].std)), None, []).outputs[0]
    assert np.nanstd(first[0] - clean, axis=0).min() > 0
    found.model.observed.runs[0].measured[10:20, 1] = 0.0


@pytest.mark.slow
def test_an_interrupted_calibration_goes_on_and_a_finished_one_costs_nothing(
    found: Findings, tmp_path: Path
) -> None:
    kept = tmp_path / "kept.jsonl"
    first = calibrate(partial(simulate_and_judge, found), kept, cases=2, workers=1)
    assert [one.number for one in first] == [0, 1]
    assert first[0].truth == "nothing missing"
    assert all(one.right for one in first)
    kept.write_text(kept.read_text() + '{"number": 2, "tru')  # cut off in the middle of a line
    assert read_outcomes(kept) == first

    def refused(number: int) -> Outcome:
        pytest.fail(f"case {number} was kept, or there is no time left")

    assert calibrate(refused, kept, cases=2, workers=1) == first
    assert calibrate(refused, kept, cases=5, minutes=0.0, workers=1) == first


def test_another_record_is_another_calibration(found: Findings) -> None:
    before = fingerprint(found, ["cubic stiffness"])
    assert fingerprint(found, ["another"]) != before
    found.model.observed.runs[1].table[5] += 1e-3
    assert fingerprint(found, ["cubic stiffness"]) != before
    found.model.observed.runs[1].table[5] -= 1e-3


def outcomes(found: Findings, right: int, of: int) -> list[Outcome]:
    """Cases that look like the measured one."""
    mine = features(found, decide(found))
    return [Outcome(number, "cubic stiffness", number < right, mine) for number in range(of)]


def test_the_stated_rate_follows_what_happened_on_the_rig(found: Findings) -> None:
    concluded = Conclusion("effect_named", 0.5, basis(features(found, decide(found))), (), ())
    good, bad = (stated(concluded, outcomes(found, right, 20)) for right in (20, 4))
    assert good.confidence > 0.8
    assert bad.confidence < 0.4
    assert good.basis.calibration.startswith("20 cases simulated on this rig")
    assert shipped().source in good.basis.calibration
    assert good.basis.simulated == (SimulatedTruth(truth="cubic stiffness", right=20, cases=20),)


def test_kept_outcomes_of_before_are_read_and_what_is_none_is_simulated_anew(tmp_path: Path) -> None:
    features = {"verdict": "effect_named", "margin": 3.0, "effects": 1}
    former = {"nats": 40.0, "visible": 2.0, "closed": 0.9}
    new = {"ln_bayes": 40.0, "signal_to_noise": 2.0, "explained": 0.9}
    lines = [
        {"number": 0, "truth": "bumper", "right": True, "features": features | former},
        {"number": 1, "truth": "bumper", "right": True, "features": features | new},
        {"number": 2, "truth": "bumper", "right": True, "features": {"verdict": "another"}},
        {"number": 3, "truth": "bumper"},
        [4],
    ]
    kept = tmp_path / "kept.jsonl"
    # The last line was cut off by an interruption.
    kept.write_bytes(b"".join(sealed(json.dumps(line).encode()) for line in lines) + b'{"sha256": "77')
    with pytest.warns(DamageWarning, match=r"kept.jsonl is damaged"):
        first, second = read_outcomes(kept)
    assert (first.number, second.number) == (0, 1)
    assert first.features == second.features

    def simulate(number: int) -> Outcome:
        return replace(first, number=number)

    with pytest.warns(DamageWarning):
        again = calibrate(simulate, kept, cases=6, workers=1)
    assert [one.number for one in again] == list(range(6))
    assert calibrate(lambda number: pytest.fail("all are kept"), kept, cases=6, workers=1) == again


@pytest.mark.parametrize(
    ("before", "after"), [(b'"right": true', b'"right": false'), (b'"number": 1', b'"number": 7')]
)
def test_a_damaged_line_is_told_and_its_case_is_simulated_anew(
    found: Findings, tmp_path: Path, before: bytes, after: bytes
) -> None:
    kept, whole = tmp_path / "kept.jsonl", outcomes(found, 3, 3)
    calibrate(whole.__getitem__, kept, cases=3, workers=1)
    assert read_outcomes(kept) == whole
    lines = kept.read_bytes().splitlines(keepends=True)
    lines[1] = lines[1].replace(before, after)
    kept.write_bytes(b"".join(lines))
    asked: list[int] = []

    def simulate(number: int) -> Outcome:
        asked.append(number)
        return whole[number]

    with pytest.warns(DamageWarning, match=r"kept.jsonl is damaged: what it kept is made anew"):
        assert calibrate(simulate, kept, cases=3, workers=1) == whole
    assert asked == [1]
    # The damaged line is gone.
    assert sorted(read_outcomes(kept), key=lambda one: one.number) == whole


def test_the_time_that_remains_is_told_from_the_first_case_on(
    found: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten seconds a case: 20 remain after the first, no more than the two minutes that are allowed."""
    now, told = [0.0], []
    monkeypatch.setattr(rig_calibration, "monotonic", lambda: now[0])

    def simulate(number: int) -> Outcome:
        now[0] += 10.0
        return outcomes(found, 3, 3)[number]

    calibrate(simulate, tmp_path / "kept.jsonl", lambda what, share: told.append(what), cases=3, workers=1)
    assert told == [
        "calibrating on this rig, 0 of 3 cases",
        "calibrating on this rig, 1 of 3 cases, about 20 s remain",
        "calibrating on this rig, 2 of 3 cases, about 10 s remain",
    ]


def test_a_calibration_is_announced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_case(case_of(measured(samples=50, runs=2).observed), tmp_path)

    def stopped(*_args: object, **_options: object) -> None:
        raise CaseError("enough")

    monkeypatch.setattr(workflow, "diagnose", stopped)
    for words, announced in (([], False), (["--calibrate"], True)):
        with pytest.raises(SystemExit):
            main(["diagnose", str(tmp_path), *words, "--json"])
        said = capsys.readouterr()
        assert (
            "the calibration, unless it is kept from before, takes about 15 minutes" in said.err
        ) == announced
        assert said.out == ""


def test_modal_data_are_refused_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(
        '[[frame]]\nname = "5B"\n[[modal]]\nquantity = "mass"\nvalue = 33.0\nunit = "kg"\nstd = 1.0\n'
    )
    with pytest.raises(CaseError, match=r"this case has no run; leave --calibrate out"):
        diagnose(tmp_path, calibrate=True)
