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
        pytest.param(("cubic_stiffness",), "5A", 9602, marks=pytest.mark.guard),
        pytest.param(("coulomb_friction",), "5B", 9603, marks=pytest.mark.guard),
        pytest.param(("table_tilt",), "5A", 9604, marks=pytest.mark.guard),
        pytest.param(("hidden_appendage",), "5B", 9605, marks=pytest.mark.guard),
        pytest.param(("hammer_knocks",), "5B", 9607, marks=pytest.mark.guard),
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


@pytest.mark.guard
def test_friction_that_weakens_with_the_rate_is_no_coulomb_friction_and_comes_nearest_to_it(
    tmp_path: Path,
) -> None:
    """A rival outside the catalogue explains clearly more; the nearest law is shown at its place with what it closes."""
    hidden = hide(("weakening_friction",), ["5A"], seed=9606, visibility=4.0)
    write_hidden(hidden, tmp_path / "case")
    report = diagnose(tmp_path / "case")
    assert report.verdict == "unknown_effect"
    (truth,) = hidden.truth["effects"]
    nearest = report.candidates[0]
    assert (nearest.effect, nearest.storey) == ("coulomb_friction", truth["storey"])
    held_out = report.misfit.held_out
    assert held_out is not None
    assert held_out.after is not None
    assert held_out.noise_floor is not None
    assert 1.5 * held_out.noise_floor < held_out.after < 0.5 * held_out.before
