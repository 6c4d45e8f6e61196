"""The stated confidence: a hit rate that is learnt from cases and holds on others."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.benchmark.fitting import main
from pounding.diagnosis.decision.confidence import (
    FILE,
    FORMER,
    VERDICTS,
    Features,
    confidence,
    fit,
    read_calibration,
    read_pairs,
    refitted,
    shipped,
    write_calibration,
)
from pounding.diagnosis.errors import CaseError


def cases(count: int, seed: int) -> list[tuple[Features, bool]]:
    """Verdicts whose hit rate rises with evidence in a way that is not the regression's own."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        ln_bayes, margin = rng.lognormal(4.0, 1.5), rng.lognormal(3.0, 1.5)
        verdict = VERDICTS[rng.integers(4)]
        effects = int(rng.integers(1, 3)) if verdict == "effect_named" else 1
        signal_to_noise, closed = rng.lognormal(0.5, 1.0), rng.uniform(0.0, 1.0)
        rate = 0.3 + 0.65 * margin / (margin + 15.0) if verdict != "nothing_missing" else 0.9
        found.append(
            (Features(verdict, ln_bayes, margin, signal_to_noise, closed, effects), bool(rng.random() < rate))
        )
    return found


def test_a_fitted_confidence_is_the_hit_rate_on_cases_that_were_not_fitted() -> None:
    learnt = fit(cases(1000, 1), "a test")
    stated = np.array([confidence(features, learnt) for features, _ in cases(4000, 2)])
    right = np.array([right for _, right in cases(4000, 2)])
    for low, high in ((0.0, 0.6), (0.6, 0.75), (0.75, 0.85), (0.85, 1.0)):
        chosen = (stated >= low) & (stated < high)
        assert chosen.sum() > 100
        assert stated[chosen].mean() == pytest.approx(right[chosen].mean(), abs=0.06)


def test_few_cases_make_no_steep_rule() -> None:
    sure = fit([(Features("effect_named", 500.0, 100.0, 3.0, 0.9, 1), True)] * 5, "five hits")
    weak = Features("effect_named", 35.0, 1.0, 0.3, 0.6, 1)
    assert 0.5 < confidence(weak, sure) < 0.97
    with pytest.raises(CaseError, match="no case to fit"):
        fit([], "none")


def test_the_shipped_file_says_where_it_comes_from_and_more_evidence_never_lowers_a_named_effect() -> None:
    assert shipped().source
    rates = [
        confidence(Features("effect_named", ln_bayes, margin, 1.0, 0.9, 1))
        for ln_bayes, margin in ((40.0, 1.0), (40.0, 30.0), (400.0, 300.0))
    ]
    assert rates == sorted(rates)
    assert all(0.01 <= confidence(Features(verdict, 0.0, 0.0, 0.0, 0.0, 0)) <= 0.99 for verdict in VERDICTS)


def test_what_is_not_finite_is_no_evidence() -> None:
    nothing = Features("nothing_missing", float("nan"), float("inf"), float("nan"), float("nan"), 0)
    assert 0.01 <= confidence(nothing) <= 0.99


def test_written_calibrations_are_read_back(tmp_path: Path) -> None:
    learnt = fit(cases(200, 3), 'cases "of" a test')
    write_calibration(learnt, tmp_path / "own.toml")
    back = read_calibration(tmp_path / "own.toml")
    assert back.source == learnt.source
    assert back.coefficients["effect_named"] == pytest.approx(learnt.coefficients["effect_named"], abs=1e-4)
    (tmp_path / "own.toml").write_text('source = "x"\n')
    with pytest.raises(CaseError, match="is missing"):
        read_calibration(tmp_path / "own.toml")


def test_only_the_kinds_that_are_asked_for_are_fitted_anew(tmp_path: Path) -> None:
    known = [(one, right) for one, right in cases(200, 4) if one.verdict != "nothing_missing"]
    learnt = refitted(known, "both", ["effect_class"])
    assert learnt.coefficients["effect_class"] != shipped().coefficients["effect_class"]
    assert {**learnt.coefficients, "effect_class": 0} == {**shipped().coefficients, "effect_class": 0}
    with pytest.raises(CaseError, match="no case has the verdict 'nothing_missing'"):
        refitted(known, "both", ["nothing_missing"])
    with pytest.raises(CaseError, match="verdict 'nothing' is not known; use one of nothing_missing"):
        refitted(known, "both", ["nothing"])
    text = "".join(json.dumps(asdict(one) | {"right": right}) + "\n" for one, right in known)
    (tmp_path / "pairs.jsonl").write_text(text, encoding="utf-8")
    main(tmp_path / "pairs.jsonl", "both", out=tmp_path / "own.toml")
    written = read_calibration(tmp_path / "own.toml").coefficients
    assert written["nothing_missing"] == shipped().coefficients["nothing_missing"]
    assert written["effect_class"] == pytest.approx(learnt.coefficients["effect_class"], abs=1e-4)


def test_calibrations_and_features_of_before_are_read_by_their_names_of_then(tmp_path: Path) -> None:
    written = FILE.read_text(encoding="utf-8")
    for old, new in FORMER.items():
        written = written.replace(f"\n{new} =", f"\n{old} =")
    (tmp_path / "former.toml").write_text(written, encoding="utf-8")
    assert read_calibration(tmp_path / "former.toml") == shipped()
    line = {
        "verdict": "effect_named",
        "nats": 40.0,
        "margin": 3.0,
        "visible": 2.0,
        "closed": None,
        "effects": 1,
    }
    (tmp_path / "pairs.jsonl").write_text(json.dumps(line | {"right": True}))
    assert read_pairs(tmp_path / "pairs.jsonl") == [(Features("effect_named", 40.0, 3.0, 2.0, 0.0, 1), True)]


def test_pairs_are_lines_of_json(tmp_path: Path) -> None:
    file = tmp_path / "pairs.jsonl"
    one = {
        "verdict": "effect_named",
        "ln_bayes": 1,
        "margin": 1,
        "signal_to_noise": 1,
        "explained": 1,
        "effects": 1,
        "right": True,
    }
    file.write_text(json.dumps(one) + "\n\n")
    assert read_pairs(file)[0][1] is True
    file.write_text('{"verdict": "effect_named"}\n')
    with pytest.raises(CaseError, match="line 1"):
        read_pairs(file)
