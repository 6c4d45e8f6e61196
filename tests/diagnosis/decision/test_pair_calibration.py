"""The calibration of a pair: simulated as it is measured, against another integrator, and diagnosed like it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from pounding.contact.parameters import make_law
from pounding.diagnosis.case.case import Case, Contact
from pounding.diagnosis.contact_force.pair import ContactFindings, prepare
from pounding.diagnosis.contact_force.pairs import quick_filter
from pounding.diagnosis.decision.claims import Claim, Place, claim
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.confidence import CONTACT as CONTACT_CLAIM
from pounding.diagnosis.decision.confidence import Basis, Features, basis
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.decision.pair_calibration import Truth, right, simulate_and_judge, simulated, truths
from pounding.diagnosis.decision.rig_calibration import turn
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.sensors import screened
from pounding.diagnosis.model.twin import Between, simulate_pair
from tests.diagnosis.pair_models import (
    CONTACT,
    FLOORS,
    MASS,
    SAMPLES,
    STEP_S,
    colliding,
    found_of,
    judged,
    model_of,
    shaken,
    structure,
)

OFFSET = replace(CONTACT, gap_m=0.0048)


@pytest.mark.parametrize("contact", [CONTACT, replace(CONTACT, law="hertz", stiffness=1e9, restitution=None)])
def test_a_pair_in_the_engine_moves_as_another_integrator_has_it(contact: Contact) -> None:
    wanted = shaken((contact,), 0)
    model = model_of(colliding(contact, measured=False))
    run = replace(model.observed.runs[0], table=wanted[:, 0])
    alone = Model(model.structure, replace(model.observed, runs=(run,)), model.prior)
    law = make_law(
        contact.law, stiffness=contact.stiffness, restitution=contact.restitution, masses=(MASS, MASS)
    )
    between = Between(FLOORS - 1, 2 * FLOORS - 1, law, contact.gap_m)
    channels, force = simulate_pair(alone, np.zeros(len(alone.std)), (), 0, between)
    assert force.sum() * STEP_S == pytest.approx(wanted[:, -1].sum() * STEP_S, rel=0.02)
    for c, name in enumerate(alone.observed.names):
        column = [one.name for one in colliding(contact).channels].index(name)
        mine, other = channels[:, c], wanted[:, column]
        if "_a" in name:
            # Of accelerations the velocities: each logger's filter shapes an impact in its own way, its impulse stays.
            mine, other = np.cumsum(mine) * STEP_S, np.cumsum(other) * STEP_S
        rms = float(np.sqrt(np.mean(other**2)))
        assert float(np.sqrt(np.mean((mine - other) ** 2))) < 0.03 * rms, name


def findings(case: Case) -> tuple[Findings, ContactFindings]:
    """Return findings on a pair whose frames are as believed, and what its impacts say."""
    pair, contact_findings, _ = judged(case)
    return found_on(pair), contact_findings


def findings_of(contact: Contact) -> tuple[Findings, ContactFindings]:
    """Return findings on a pair with such a contact, which tests change nothing of."""
    pair, contact_findings, _ = found_of(contact)
    return found_on(pair), contact_findings


def found_on(pair: Pair) -> Findings:
    null = SimpleNamespace(fit=SimpleNamespace(filtered=quick_filter(pair.slow, [0])), ln_bayes=0.0)
    found = SimpleNamespace(pair=pair, judged=[], null=null, model=pair.slow, claimable=lambda: [])
    return cast(Findings, found)


def test_nothing_and_the_contacts_rivals_take_turns() -> None:
    found, contact_findings = findings_of(OFFSET)
    tried = truths(found, contact_findings)
    assert [one.label for one in tried][:2] == ["nothing missing", "gap offset"]
    assert len(tried) == 3
    assert [turn(number, 2) for number in range(6)] == [0, 1, 2, 0, 1, 2]
    assert turn(1, 0) == 0


def test_a_simulated_pair_is_recorded_as_the_measured_one_was() -> None:
    case = colliding(CONTACT)
    case.runs[0].values[100:120, 2] = np.nan
    found, _ = findings(case)
    made = [simulated(case, found, Truth(), np.random.default_rng(seed)) for seed in (1, 1, 2)]
    first, again, other = (one.runs[0].values for one in made)
    np.testing.assert_array_equal(first, again)
    assert np.isnan(first[100:120, 2]).all()
    assert not np.allclose(first[200:], other[200:])
    force = first[:, -1]
    assert force.max() > 20.0
    # Between touches the cell is as noisy as it was.
    assert found.pair is not None
    assert np.std(force[np.abs(force) < 3.0]) == pytest.approx(found.pair.noise[0], rel=0.3)
    assert [run.file for run in made[0].runs] == [run.file for run in case.runs]


def test_a_run_whose_end_was_left_out_is_simulated_up_to_there() -> None:
    case, dead = colliding(CONTACT), 200
    case.runs[0].values[-dead:] = case.runs[0].values[-dead]
    observed = screened(observe(case, structure()))
    assert len(observed.runs[0].table) == SAMPLES - dead
    found = found_on(prepare(case, Model(structure(), observed, case.prior)))
    made = simulated(case, found, Truth(), np.random.default_rng(1))
    assert [run.values.shape for run in made.runs] == [(SAMPLES - dead, 14), (SAMPLES, 14)]
    assert [len(run.time_s) for run in made.runs] == [SAMPLES - dead, SAMPLES]
    # It can be read as the measured case was, and nothing of it is left out.
    assert screened(observe(made, structure())).warnings == []


@pytest.mark.slow
@pytest.mark.guard
def test_what_is_hidden_in_a_simulated_contact_is_there() -> None:
    case = colliding(OFFSET)
    found, contact_findings = findings_of(OFFSET)
    offset = truths(found, contact_findings)[1]
    assert offset.contact is not None
    made = simulated(case, found, offset, np.random.default_rng(5))
    _, _, conclusion = judged(made)
    (named,) = conclusion.effects
    assert named.effect == "gap_offset"
    # Of the size that was found, times a factor of chance.
    assert 0.2 < float(named.parameters[0].value or 0.0) < 3.0


def concluded(verdict: Verdict, *claims: Claim) -> Conclusion:
    behind = basis(Features("pair_nothing_missing", 12.0, 3.0, 1.0, 1.0, 1))
    return Conclusion(verdict, 0.9, behind, claims, ())


def test_a_verdict_is_right_by_type_and_place_alone() -> None:
    gap, law = (Place(effect=name, contact=1) for name in ("gap_offset", "contact_law"))
    hidden = Truth("gap offset", gap)
    named = claim(gap, [], 40.0)
    assert right(concluded("effect_named", named), hidden)
    assert not right(concluded("effect_named", named), Truth())
    assert right(concluded("effect_class", claim(law, [], 40.0, [law, gap])), hidden)
    assert not right(concluded("effect_named", named, named), hidden)
    assert not right(concluded("unknown_effect", named), hidden)
    assert right(concluded("nothing_missing"), Truth())


def test_an_outcome_rests_on_what_the_report_rests_on() -> None:
    case = colliding(CONTACT)
    found, contact_findings = findings_of(CONTACT)
    frames, contact = (Features(name, 12.0, 3.0, 1.0, 1.0, 1) for name in ("nothing_missing", CONTACT_CLAIM))

    def diagnose(made: Case) -> Conclusion:
        assert not np.array_equal(made.runs[0].values, case.runs[0].values)
        behind = Basis(calibration="a test", features=frames, contact=contact)
        return replace(concluded("effect_named"), basis=behind)

    outcome = simulate_and_judge(case, found, contact_findings, diagnose, 0)
    assert (outcome.truth, outcome.right, outcome.features) == ("nothing missing", False, contact)


def test_a_damping_that_no_law_of_the_engine_has_is_refused() -> None:
    case = colliding(CONTACT)
    found, _ = findings_of(CONTACT)
    odd = replace(CONTACT, law="nonlinear_viscoelastic", damping=900.0, restitution=None)
    with pytest.raises(CaseError, match="--calibrate cannot simulate contact 1"):
        simulated(replace(case, contacts=(odd,)), found, Truth(), np.random.default_rng(1))
