"""Held-out impacts: what they say of a contact that was fitted to others, and what they could have said at best."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from pounding.diagnosis.contact_force import contacts
from pounding.diagnosis.contact_force.held_out import (
    HeldOutImpacts,
    compared,
    expected_gain,
    predicted_impacts,
)
from pounding.diagnosis.contact_force.hypotheses import baseline_law, null
from pounding.diagnosis.contact_force.impacts import Bodies, sharper
from pounding.diagnosis.contact_force.pair import met_in, prepare
from pounding.diagnosis.decision.conclusion import ContactMisfit
from pounding.diagnosis.decision.pair_decision import joined
from pounding.diagnosis.inference.findings import Findings
from tests.diagnosis.pair_models import (
    CONTACT,
    NOTHING,
    claimed,
    colliding,
    judged,
    model_of,
    still_frames,
    value,
)

TRUE = replace(CONTACT, restitution=0.55)


@cache
def met() -> Bodies:
    case = colliding(TRUE, runs=1)
    model = model_of(case)
    return met_in(prepare(case, model), np.zeros(len(model.std)), (), (0,))[2]


def told(gained: float, expected: float) -> HeldOutImpacts:
    return HeldOutImpacts(10, 1.0, 1.0, gained, expected)


def test_impacts_as_a_fit_makes_them_leave_that_fit_nothing() -> None:
    bodies = met()
    law = baseline_law(TRUE, bodies.mass)
    fitted = contacts.held(bodies, law)
    # From where it ended, no descent can leave more than the prior of the filter and of the states before the impacts.
    made = contacts.again(contacts.as_fitted(bodies, fitted), fitted, fitted)
    assert made.cost <= 0.5 * float(fitted.unknowns @ fitted.unknowns) + 1e-6
    assert made.cost < fitted.cost


def test_the_gain_that_is_expected_is_that_of_impacts_of_the_likeliest_contact() -> None:
    bodies = met()
    true = baseline_law(TRUE, bodies.mass)
    other = replace(true, restitution=true.restitution + 0.05)
    baseline, likeliest = compared(bodies, other, true)
    gained, expected = baseline.cost - likeliest.cost, expected_gain(bodies, other, likeliest)
    assert expected > 0.0
    # A normal likelihood ratio has its mean twice as a variance; four standard deviations hold whatever the noise.
    assert abs(gained - expected) < 4.0 * np.sqrt(2.0 * expected) + 1.0
    # Impacts that are known half as well tell a quarter.
    blunt = sharper(bodies, 2.0)
    assert expected_gain(blunt, other, compared(blunt, other, true)[1]) < 0.6 * expected
    assert expected_gain(bodies, true, likeliest) == pytest.approx(0.0, abs=1e-6)


def test_a_contact_beyond_its_scatter_is_compared_with_one_within_it() -> None:
    """Impacts pull the baseline's numbers as far as they like, past any prior: what is missing would be in both contacts."""
    bodies = met()
    stated = baseline_law(TRUE, bodies.mass)
    right, other = (
        contacts.fit(bodies, null(replace(stated, restitution=restitution))) for restitution in (0.55, 0.85)
    )
    assert contacts.within_scatter(right) == right.law
    kept = contacts.within_scatter(other).restitution
    assert other.law.restitution < kept - 0.01
    assert 0.8 < kept < 0.85


def test_impacts_without_an_opinion_veto_nothing_and_those_with_one_do() -> None:
    assert told(0.0, 0.5).supports
    assert told(1.7, 1.7).supports
    assert not told(0.0, 12.0).supports
    assert told(11.0, 200.0).supports
    assert not told(-5.0, 2.0).supports


def test_more_gain_never_takes_the_support_away() -> None:
    for expected in (0.0, 1.0, 5.0, 40.0):
        answers = [told(float(gained), expected).supports for gained in np.linspace(-30.0, 60.0, 91)]
        assert answers == sorted(answers)


def test_a_found_contact_predicts_held_out_impacts_and_that_of_the_baseline_model_does_not() -> None:
    case = colliding(replace(CONTACT, restitution=0.45), runs=3)
    pair, found, _ = judged(case)
    findings = still_frames(pair)
    told = predicted_impacts(case, *findings, found)
    assert told is not None
    assert told.impacts >= 5
    assert told.model > 1.25 * told.likeliest
    assert told.likeliest == pytest.approx(1.0, abs=0.35)
    concluded = joined(case, pair, found, NOTHING, told)
    assert concluded.effects[0].contact == 1
    assert value(concluded, "restitution") == pytest.approx(0.45, abs=0.05)
    shown = concluded.contact_misfit
    assert shown == ContactMisfit(impacts=told.impacts, before=told.model, after=told.likeliest)
    kept = joined(case, pair, replace(found, ranked=()), NOTHING, told).contact_misfit
    assert kept is not None
    assert kept.after == told.model
    # An effect that the held-out impacts do not like is not claimed.
    assert claimed(joined(case, pair, found, NOTHING, told)) == ["contact_damping"]
    worse = replace(told, gained=-10.0)
    assert claimed(joined(case, pair, found, NOTHING, worse)) == []
    # However plain it is to the others, what they say must not be strong, only true.
    (_, best), *others = found.ranked
    plainer = replace(found, ranked=((500.0, best), *others))
    agreed = replace(told, gained=11.0, expected=400.0)
    assert claimed(joined(case, pair, plainer, NOTHING, agreed)) == ["contact_damping"]
    # A single one that says nothing either way is no veto.
    few = replace(told, gained=-0.5, impacts=1, expected=0.3)
    assert claimed(joined(case, pair, found, NOTHING, few)) == ["contact_damping"]
    nothing = cast(Findings, SimpleNamespace(pair=pair, held_out=()))
    assert predicted_impacts(case, nothing, findings[1], found) is None
