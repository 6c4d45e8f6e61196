"""The runner of the stored nulls: frames off their model by what was drawn, and a file that is gone on with."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from pounding.diagnosis.benchmark import nulls
from pounding.diagnosis.decision.false_alarms import read_nulls
from pounding.diagnosis.decision.nulls import Shown
from pounding.diagnosis.hidden.worlds import OWN


def test_a_discrepancy_moves_the_lowest_modes_by_its_scale() -> None:
    built = OWN.built(np.random.default_rng(1), "5A")
    squared = []
    for scale in (0.0, 0.01):
        known = nulls._off(built, np.random.default_rng(2), scale).matrices()
        squared.append(eigh(known.stiffness, known.mass, eigvals_only=True))
    changed = squared[1] / squared[0] - 1
    assert 0.001 < np.abs(changed[:5]).max() < 0.1
    np.testing.assert_allclose(changed[5:], 0.0, atol=1e-6)
    known = built.matrices()
    np.testing.assert_allclose(squared[0], eigh(known.stiffness, known.mass, eigvals_only=True))


def test_a_file_is_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def null(number: int, seed: int) -> dict[str, object]:
        made.append(number)
        names = [one.name for one in (*fields(nulls.Row), *fields(Shown))]
        return dict.fromkeys(names, 1.0) | {"number": number, "seed": seed, "ordinary": 1e3}

    monkeypatch.setattr(nulls, "null", null)
    out = tmp_path / "nulls.csv"
    nulls.make(range(2), 7, out, workers=1)
    nulls.make(range(4), 7, out, workers=1)
    assert made == [0, 1, 2, 3]
    rows, said = read_nulls(out)
    assert [row["number"] for row in rows] == ["0", "1", "2", "3"]
    assert said == ""
    named, left, told = nulls.judged(out)
    assert named.startswith("enough evidence for an effect: 4 of 4 nulls, 51 to 100 %")
    assert left.startswith("more remains than noise: 0 of 4")
    assert ": 4 of 4 nulls" in told
