"""A storey that lost a third of its stiffness: a wide model discrepancy imitates it, and is no reason to say nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.decision import imitated
from pounding.diagnosis.decision.imitated import unhide
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.search import search
from tests.diagnosis.models import measured

LOSS = -0.3
DAMPING = 2.5


def findings(lost: float, damping: float = 0.0) -> Findings:
    """Return what is found of the storeys of a frame of which the second lost a share of its stiffness.

    It may have gained a little damping [N s/m], too.
    """
    blank = measured(samples=50, runs=1)
    second = {one.name: one for one in candidates(blank) if one.storey == 2}
    effects = [(second["stiffness_change"], np.array([lost]))] if lost else []
    effects += [(second["damping_change"], np.array([damping, 0.0]))] if damping else []
    model = measured(effects, noise=0.01, samples=1500)
    storeys = [one for one in candidates(model) if one.name in ("stiffness_change", "damping_change")]
    return search(model, storeys, (0,), (1,), lambda *_: None)


def test_a_storey_that_a_wide_discrepancy_imitates_is_named() -> None:
    found = findings(LOSS)
    hidden = found.null
    unhide(found)
    named = decide(found)
    assert (named.verdict, named.judged.label()) == ("effect_named", "stiffness change, storey 2 of bench")
    assert float(named.judged.fit.values[0][0]) == pytest.approx(LOSS, abs=0.06)
    assert found.null.fit.filtered.discrepancy < hidden.fit.filtered.discrepancy
    assert found.null.misfit[1] > 2 * hidden.misfit[1]
    # What the evidence says is of the likeliest null model still.
    assert found.null.fit.log_posterior == hidden.fit.log_posterior


def test_a_little_damping_is_not_named_in_its_place() -> None:
    found = findings(LOSS, DAMPING)
    unhide(found)
    named = decide(found)
    assert (named.verdict, named.judged.label()) == ("effect_named", "stiffness change, storey 2 of bench")


def test_a_second_effect_that_makes_the_discrepancy_needless_is_likelier_than_the_first_alone() -> None:
    # The scale of the discrepancy goes down by a factor of 256 at once, and what was in it must find its place.
    found = findings(LOSS, 30.0)
    alone = next(one for one in found.judged if one.label() == "damping change, storey 2 of bench")
    both = next(one for one in found.judged if len(one.effects) == 2)
    assert both.label() == "damping change, storey 2 of bench and stiffness change, storey 2 of bench"
    assert both.fit.filtered.discrepancy < 0.1 * alone.fit.filtered.discrepancy
    assert both.ln_bayes > alone.ln_bayes + 10.0


@pytest.mark.parametrize("stands_out", [True, False])
def test_what_is_large_but_less_than_it_leaves_is_hidden_too(
    stands_out: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = findings(LOSS)
    wide = found.null.fit.filtered.discrepancy
    monkeypatch.setattr(imitated, "signal_to_noise", lambda *_: 1.0)
    monkeypatch.setattr(imitated, "stands_out", lambda *_: stands_out)
    unhide(found)
    assert (found.null.fit.filtered.discrepancy < wide) == (not stands_out)


def test_what_is_judged_beside_an_error_is_so_by_the_discrepancy_that_is_put_right() -> None:
    found = findings(LOSS)
    found.null = replace(found.null, beside=found.null)
    found.judge_beside_errors()
    unhide(found)
    narrow = found.null.fit.filtered.discrepancy
    assert found.null.beside is not None
    assert all(one.beside is found.null.beside for one in found.judged)
    assert found.null.beside.fit.filtered.discrepancy == narrow


def test_where_nothing_is_likely_nothing_changes() -> None:
    found = findings(0.0)
    null = found.null
    unhide(found)
    assert found.null is null
