"""Which second effects are refined, and beside which first ones: hand-made scores."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import pytest

from pounding.diagnosis.inference import second as module
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.refine import Race
from pounding.diagnosis.inference.refining import not_yet_likelier


@dataclass(frozen=True)
class Named:
    """An effect by its name alone."""

    name: str
    rival: bool = False

    def grid(self, _: object) -> list[tuple[float, ...]]:
        """Return the one shape that it has."""
        return [()]


FROM_SCORE = 3.0
"""Evidence of what is refined alone from its score about the null model."""
AHEAD = Race(1000.0)
"""What all effects are up against."""

A, B, C, D, ERROR, RIVAL = (*map(Named, ("a", "b", "c", "d", "error")), Named("rival", rival=True))


def judged(
    ln_bayes: float, *effects: Named, errors: tuple[Named, ...] = (), to_the_end: bool = True
) -> Judged:
    every = (*errors, *effects)
    filtered = SimpleNamespace(effects=every, values=None)
    fit: Any = SimpleNamespace(
        effects=every,
        values=every,
        filtered=filtered,
        columns=None,
        log_posterior=ln_bayes,
        to_the_end=to_the_end,
    )
    return cast(Judged, SimpleNamespace(fit=fit, effects=effects, ln_bayes=ln_bayes))


def searched(
    monkeypatch: pytest.MonkeyPatch,
    alone: dict[Named, float],
    both: dict[frozenset[Named], float],
    after: dict[Named, float] | None = None,
    errors: tuple[Named, ...] = (),
    promised: dict[Named, float] | None = None,
    from_baseline: float = 0.0,
) -> Findings:
    """Return findings on single effects after the search for a second one, with the evidence that pairs would have.

    `after`: evidence of what is refined alone from where it was found beside another; `errors` act in the null model;
    `promised`: what scores say beside any effect, where that is not what is kept; `from_baseline`: what a pair that is
    refined again from the baseline frame gains by it.
    """
    null = judged(0.0, errors=errors)
    each = (judged(value, one, errors=errors) for one, value in alone.items())
    ranked = sorted(each, key=lambda one: -one.ln_bayes)
    scores = SimpleNamespace(ranked=[SimpleNamespace(effect=C)])
    found = cast(
        Findings,
        SimpleNamespace(judged=ranked, null=null, model=None, sizes=None, later=None, scores=scores),
    )

    def scored(_: Any, filtered: Any, others: list[Named], *__: Any) -> Any:
        about = filtered.effects[len(errors) :]

        def says(one: Named) -> float:
            kept = both.get(frozenset({*about, one}), 0.0) - alone[about[0]]
            return (promised or {}).get(one, kept)

        each = [SimpleNamespace(effect=one, ln_bayes=says(one)) for one in others]
        return SimpleNamespace(ranked=sorted(each, key=lambda one: -one.ln_bayes), about=about)

    def keep(found: Findings, fit: Any) -> None:
        assert fit.effects[: len(errors)] == errors
        known = [one for one in found.judged if one.fit.effects == fit.effects]
        if any(one.ln_bayes >= fit.log_posterior for one in known):
            return
        found.judged = [one for one in found.judged if one not in known]
        found.judged.append(judged(fit.log_posterior, *fit.effects[len(errors) :], errors=errors))
        found.judged.sort(key=lambda one: -one.ln_bayes)

    def refined(
        _: Any, filtered: Any, one: Any, with_fit: Any = None, start: Any = None, thorough: bool = True
    ) -> Any:
        effects = (*filtered.effects, one.effect)
        assert (start is None) == (with_fit is None or not thorough)
        own = frozenset(effects[len(errors) :])
        return SimpleNamespace(effects=effects, log_posterior=both.get(own, FROM_SCORE))

    def refine(_: Any, __: Any, effects: tuple[Named, ...], *___: Any, race: Any, **____: Any) -> Any:
        # What acts alone is given up where it will not come near what both do.
        assert race is AHEAD
        return SimpleNamespace(effects=effects, log_posterior=(after or {}).get(effects[-1], 0.0))

    def again(_: Any, effects: tuple[Named, ...], __: Any) -> Any:
        own = frozenset(effects[len(errors) :])
        return SimpleNamespace(effects=effects, log_posterior=both.get(own, 0.0) + from_baseline)

    monkeypatch.setattr(module, "score", scored)
    monkeypatch.setattr(module, "from_baseline", again)
    monkeypatch.setattr(module, "refine", refine)
    monkeypatch.setattr(module, "race", lambda _: AHEAD)
    monkeypatch.setattr(module, "usual_widths", lambda *_: None)
    monkeypatch.setattr(module, "keep", keep)
    monkeypatch.setattr(module, "refined", refined)
    monkeypatch.setattr(module, "same_motion", lambda one: None)
    monkeypatch.setattr(module, "each", lambda found, function, pieces: [function(one) for one in pieces])
    module.second(found, [*alone, C])  # type: ignore[list-item]
    return found


def test_a_single_effect_that_was_behind_leads_with_the_second_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    both = {frozenset({A, C}): 1150.0, frozenset({B, C}): 1400.0}
    found = searched(monkeypatch, {A: 1000.0, B: 900.0, D: 800.0}, both)
    assert found.judged[0].effects == (B, C)
    # What else could be missing is asked about the effects that lead.
    assert cast(Any, found.later).about == (B,)


def test_one_that_is_further_behind_than_the_second_gained_is_not_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    both = {frozenset({A, C}): 1050.0, frozenset({B, C}): 1400.0}
    found = searched(monkeypatch, {A: 1000.0, B: 900.0}, both)
    assert found.judged[0].effects == (A, C)
    assert cast(Any, found.later).about == (A,)


def test_a_pair_that_was_refined_from_the_one_side_is_not_from_the_other_unless_it_begins_likelier(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    both = {frozenset({A, B}): 1400.0, frozenset({B, C}): 1300.0}
    found = searched(monkeypatch, {A: 1000.0, B: 900.0}, both)
    pairs = [one.effects for one in found.judged if len(one.effects) == 2]
    assert pairs == [(A, B), (B, C)]
    known = [judged(1400.0, A, B), judged(1300.0, B, C)]
    quick: Any = [
        judged(value, *effects).fit for value, *effects in ((1300.0, C, B), (1401.0, B, A), (9.0, C))
    ]
    assert not_yet_likelier(known, quick) == [1, 2]
    # What lost a race before may win another one.
    assert not_yet_likelier([judged(1300.0, B, C, to_the_end=False)], quick) == [1, 0, 2]


EACH = {frozenset({A, C}): 1100.0, frozenset({A, B}): 1030.0, frozenset({A, D}): 1020.0}
"""Evidence of pairs, of which (A, C) is the likeliest."""
HOLLOW = {B: 400.0, D: 300.0, C: 150.0}
"""Scores of which the best two promise what no fit keeps."""


@pytest.mark.parametrize(
    ("promised", "pairs"),
    [
        (HOLLOW, [(A, C), (A, B), (A, D)]),
        # What promises less than was gained is not refined.
        ({**HOLLOW, C: 29.0}, [(A, B), (A, D)]),
    ],
)
def test_scores_that_promise_what_no_fit_keeps_do_not_hide_the_next_one(
    promised: dict[Named, float], pairs: list[tuple[Named, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = searched(monkeypatch, {A: 1000.0, B: 9.0, D: 8.0}, EACH, promised=promised)
    assert [one.effects for one in found.judged if len(one.effects) == 2] == pairs


@pytest.mark.parametrize(("gained", "again"), [(30.0, 80.0), (11.0, 0.0)])
def test_a_pair_is_refined_from_the_baseline_frame_too_where_it_says_anything(
    gained: float, again: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = searched(
        monkeypatch,
        {A: 1000.0},
        {frozenset({A, C}): 1000.0 + gained},
        promised={C: 100.0},
        from_baseline=80.0,
    )
    assert found.judged[0].effects == (A, C)
    assert found.judged[0].ln_bayes == 1000.0 + gained + again


@pytest.mark.parametrize("single", [B, RIVAL])
def test_without_a_second_effect_nothing_else_is_tried(
    monkeypatch: pytest.MonkeyPatch, single: Named
) -> None:
    found = searched(monkeypatch, {A: 1000.0, single: 999.0}, {frozenset({single, C}): 1400.0})
    assert [one.effects for one in found.judged] == [(A,), (single,)]


def test_what_was_found_beside_what_imitates_it_may_lead_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    found = searched(monkeypatch, {A: 1000.0, B: 900.0}, {frozenset({A, C}): 1400.0}, {C: 1401.0})
    assert [one.effects for one in found.judged[:2]] == [(C,), (A, C)]


def test_errors_of_the_frame_stay_beside_what_is_refined_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    found = searched(
        monkeypatch, {A: 1000.0, B: 900.0}, {frozenset({A, C}): 1400.0}, {C: 1401.0}, errors=(ERROR,)
    )
    assert [one.effects for one in found.judged] == [(C,), (A, C), (A,), (B,)]
    assert found.judged[0].fit.effects == (ERROR, C)


def test_what_adds_too_little_to_be_named_beside_another_is_not_refined_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = searched(monkeypatch, {A: 1000.0}, {frozenset({A, C}): 1050.0}, {C: 1401.0})
    assert [one.effects for one in found.judged] == [(A, C), (A,)]


@pytest.mark.parametrize(("reached", "kept"), [(-6000.0, FROM_SCORE), (0.0, FROM_SCORE), (40.0, 40.0)])
def test_what_goes_astray_alone_begins_from_its_score(
    reached: float, kept: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = searched(monkeypatch, {A: 1000.0}, {frozenset({A, C}): 1400.0}, {C: reached})
    assert [one.ln_bayes for one in found.judged if one.effects == (C,)] == [kept]
