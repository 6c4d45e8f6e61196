"""A small seeded set of hidden cases: fails when the diagnosis gets worse. Its cases are in no benchmark."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.diagnosis import diagnose
from pounding.diagnosis.benchmark.scoring import judge
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden

pytestmark = pytest.mark.slow

PARAMETER_ERROR = 0.15
"""Largest relative error of a parameter: what is hidden follows laws that differ from the catalogue's."""


@pytest.mark.parametrize(
    ("effects", "frame", "seed"),
    [
        ((), "5B", 9601),
        (("cubic_stiffness",), "5A", 9602),
        (("coulomb_friction",), "5B", 9603),
        (("table_tilt",), "5A", 9604),
        (("hidden_appendage",), "5B", 9605),
        (("weakening_friction",), "5A", 9606),
        (("hammer_knocks",), "5B", 9607),
    ],
)
def test_a_plain_hidden_effect_is_named_alone_at_its_place(
    effects: tuple[str, ...], frame: str, seed: int, tmp_path: Path
) -> None:
    hidden = hide(effects, [frame], seed=seed, visibility=4.0)
    write_hidden(hidden, tmp_path / "case")
    judged = judge(hidden.truth, diagnose(tmp_path / "case"))
    assert judged.exact, judged
    assert all(error < PARAMETER_ERROR for error in judged.parameter_errors), judged
