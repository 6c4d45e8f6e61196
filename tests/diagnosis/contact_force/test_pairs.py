"""Pairs that collide: contacts and force cells named from data of another integrator, and bad input of pairs."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.contact.laws import Hertz, HertzDamp, LinearViscoelastic, NonlinearViscoelastic
from pounding.diagnosis.case.case import Case, Contact
from pounding.diagnosis.contact_force import contacts, impacts, pairs, second_contact
from pounding.diagnosis.contact_force.held_out import HeldOutImpacts, predicted_impacts
from pounding.diagnosis.contact_force.hypotheses import hypotheses
from pounding.diagnosis.contact_force.impacts import Law
from pounding.diagnosis.contact_force.pair import ContactFindings, found_again, prepare
from pounding.diagnosis.contact_force.striking import STEP_S as FINE_S
from pounding.diagnosis.contact_force.striking import strike
from pounding.diagnosis.decision.claims import Candidate
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.decision.pair_decision import joined
from pounding.diagnosis.design import contact_advice
from pounding.diagnosis.inference.filtering import run_signatures, whitened
from pounding.diagnosis.inference.misfit import contact_response, simulate
from pounding.diagnosis.inference.motions import motion_of
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.terms import nuisance_terms
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.pair_models import (
    CONTACT,
    MASS,
    NOTHING,
    STEP_S,
    claimed,
    colliding,
    found_of,
    judged,
    model_of,
    still_frames,
    value,
)

BLIND_EVIDENCE = SETTINGS.pair_decision.unmeasured_factor * SETTINGS.pair_decision.contact_evidence
"""What an effect of the contact needs where no force cell measured."""
SECOND = replace(CONTACT, floor=2, gap_m=0.0018)
JANKOWSKI = Law("nonlinear_viscoelastic", 0.0, 2e9, np.nan, 0.7, 3.0)


@pytest.mark.parametrize(
    ("law", "reference"),
    [
        (Law("hertz", 0.0, 1e9, np.nan, np.nan, 3.0), Hertz(1e9)),
        (Law("linear_viscoelastic", 0.0, 2e7, 1200.0, np.nan, 3.0), LinearViscoelastic(2e7, damping=1200.0)),
        (Law("hertz_damp", 0.0, 1e9, np.nan, 0.7, 3.0), HertzDamp(1e9, restitution=0.7)),
        (
            JANKOWSKI,
            NonlinearViscoelastic(2e9, damping_ratio=JANKOWSKI.numbers()[4], reduced_mass=3.0),
        ),
    ],
)
def test_an_impact_of_two_masses_is_that_of_the_contact_package(law: Law, reference: Any) -> None:
    speed, steps = 0.4, 300
    at = np.arange(steps) * FINE_S
    held = (np.arange(steps) - 0.5) * FINE_S**2 / law.mass
    held[0] = 0.0
    rate = np.full(steps, FINE_S / law.mass)
    rate[0] = 0.0
    push = strike(speed * at, np.full(steps, speed), held, rate, *law.numbers())
    # The same collision in twentieths of the step.
    depth, velocity, impulse, fine = 0.0, speed, 0.0, FINE_S / 20
    for _ in range(20 * steps):
        middle = depth + 0.5 * fine * velocity
        force = float(reference.force(middle, velocity, speed)) if middle > 0 else 0.0
        impulse += force * fine
        velocity -= force * fine / law.mass
        depth += fine * velocity
    assert push.sum() * FINE_S == pytest.approx(impulse, rel=0.01)


def test_a_contact_as_believed_leaves_nothing_to_say() -> None:
    pair, found, concluded = found_of(CONTACT)
    assert found.impacts > 10
    assert pair.cell is not None
    assert pair.cell.faults == ()
    assert concluded.verdict == "nothing_missing"


GAP = (replace(CONTACT, gap_m=0.0048), "gap_offset", "offset", 0.8, 0.05)
DAMPING = (replace(CONTACT, restitution=0.45), "contact_damping", "restitution", 0.45, 0.05)
STIFFNESS = (replace(CONTACT, stiffness=5e6), "contact_stiffness", "stiffness", 5e6, 1e6)
SELDOM = (pytest.mark.slow, pytest.mark.guard)


@pytest.mark.parametrize(
    ("measured", "true", "effect", "parameter", "wanted", "within"),
    [
        pytest.param(True, *GAP, marks=SELDOM),
        # `test_a_found_contact_foretells_the_held_out_impacts_and_the_believed_one_does_not` says the same on three runs.
        pytest.param(True, *DAMPING, marks=SELDOM),
        pytest.param(True, *STIFFNESS, marks=SELDOM),
        (False, *GAP),
        pytest.param(False, *DAMPING, marks=SELDOM),
        (False, *STIFFNESS),
    ],
)
def test_what_is_different_in_a_contact_is_named(
    measured: bool, true: Contact, effect: str, parameter: str, wanted: float, within: float
) -> None:
    case = colliding(true, measured=measured, runs=2 if measured else 3)
    pair, found, concluded = judged(case)
    if not measured:
        # Forces that the motion asks for need more where no impacts that they were not fitted to agree.
        (_, best), *others = found.ranked
        for ln_bayes, expected in (
            (1.9 * BLIND_EVIDENCE, []),
            (2.1 * BLIND_EVIDENCE, [effect]),
        ):
            sure = replace(found, ranked=((ln_bayes, best), *others))
            assert claimed(joined(case, pair, sure, NOTHING)) == expected
        told = predicted_by(case, pair, found)
        assert told is not None
        assert told.gained > 0
        concluded = joined(case, pair, found, NOTHING, told)
    assert claimed(concluded) == [effect]
    assert concluded.effects[0].contact == 1
    assert value(concluded, parameter) == pytest.approx(wanted, abs=within)


def predicted_by(case: Case, pair: Pair, found: ContactFindings) -> HeldOutImpacts | None:
    """Return what the third run says of what the first two did, the frames being as believed."""
    return predicted_impacts(case, *still_frames(pair), found)


def test_laws_share_what_is_believed_of_another_law() -> None:
    law = Law("hertz_damp", 0.003, 1e9, np.nan, 0.7, 3.0)
    fits: Any = [SimpleNamespace(hypothesis=one) for one in hypotheses(law, 0.1)]
    ranked = contacts.ranked([20.0] * len(fits), fits)
    assert [one.hypothesis.effect for _, one in ranked[:3]] == [
        "gap_offset",
        "contact_stiffness",
        "contact_damping",
    ]
    assert sum(np.exp(ln_bayes - 20.0) for ln_bayes, _ in ranked[3:]) == pytest.approx(1.0)


def test_another_law_is_named() -> None:
    true = replace(CONTACT, law="hertz", stiffness=1e9, restitution=None)
    _, _, concluded = judged(colliding(true))
    assert claimed(concluded) == ["contact_law"]
    assert value(concluded, "law") == "hertz"


def test_a_second_contact_is_found_at_its_floor() -> None:
    pair, _, concluded = found_of(CONTACT, SECOND)
    assert pair.second is not None
    # Its pushes are no fault of the force cell at the other floor.
    assert claimed(concluded) == ["second_contact"]
    assert {concluded.effects[0].left, concluded.effects[0].right} == {"tall", "stiff"}
    assert concluded.effects[0].floor == 2
    assert value(concluded, "gap") == pytest.approx(1.8, abs=0.03)


def test_a_second_contact_is_named_though_its_force_leaves_more_than_noise() -> None:
    case = colliding(CONTACT, SECOND)
    pair, found, _ = found_of(CONTACT, SECOND)
    poor = replace(NOTHING, verdict="unknown_effect")
    assert claimed(joined(case, pair, found, poor)) == ["second_contact"]
    # Another frame than the believed one, or a tone, is something else.
    assert joined(case, pair, found, poor, objections=True).verdict == "unknown_effect"
    alone = replace(pair, second=None)
    assert joined(case, alone, found, poor).verdict == "unknown_effect"


@pytest.mark.parametrize(
    ("met", "one", "contact"),
    [
        ("second_contact.share", 9e9, True),
        ("second_contact.least_share", -9e9, False),
        ("between", -1.0, True),
        ("between", 1.0, False),
    ],
)
def test_pushes_that_meet_some_approaches_are_a_contact_only_if_they_push_both_frames(
    met: str, one: float, contact: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`one` is how much more a push on one frame alone explains than the least that a push on both must be ahead by."""
    needs = SETTINGS.second_contact
    share = {
        "second_contact.share": needs.share,
        "second_contact.least_share": 0.99 * needs.least_share,
        "between": 0.5 * (needs.share + needs.least_share),
    }[met]
    none = np.zeros(0)

    def pushes(*given: Any) -> list[pairs.Pushes]:
        sides = given[4:]
        return [pairs.Pushes(none, (), 100.0 if not sides else 100.0 - needs.both + one)]

    monkeypatch.setattr(pairs, "pushes", pushes)
    monkeypatch.setattr(second_contact, "_opposed", lambda *given: share)
    anything = cast(Any, None)
    assert second_contact._of_a_contact(anything, anything, (0, 1), ()) is contact


@pytest.mark.parametrize(
    ("verdict", "effect", "said"),
    [
        ("unknown_effect", "sensor_delay", True),
        ("unknown_effect", "added_mass", False),
        ("nothing_missing", "sensor_delay", False),
    ],
)
def test_a_delay_that_explains_not_all_is_said_to_be_a_second_logger(
    verdict: Verdict, effect: str, said: bool
) -> None:
    pair, found, _ = found_of(CONTACT)
    late = Candidate(effect=effect, channel="stiff_a", log_evidence=900.0)
    frames = replace(NOTHING, verdict=verdict, candidates=(late,))
    warnings = joined(colliding(CONTACT), pair, found, frames).warnings
    assert any("different loggers" in one for one in warnings) is said


def test_the_sticks_are_those_of_the_case() -> None:
    assert model_of(colliding(CONTACT)).structure.frames[0].floor_mass == pytest.approx(MASS)


def test_what_a_cell_reads_between_touches_shakes_no_frame() -> None:
    pair, *_ = found_of(CONTACT)
    force = pair.slow.observed.runs[0].contact[:, 0]
    contact_events = [event for event in pair.slow.observed.contact_events if event.run == 0]
    times = np.arange(len(force)) * pair.slow.observed.runs[0].step_s
    # The filter of the lower rate rings for some samples beyond a touch.
    near = np.any([(times > t.first_s - 0.05) & (times < t.last_s + 0.05) for t in contact_events], axis=0)
    assert len(contact_events) > 3
    assert force[near].max() > 50.0
    assert not near.all()
    assert np.abs(force[~near]).max() < 1e-3
    # As recorded, the cell is as noisy as ever.
    assert np.abs(pair.full.observed.runs[0].contact[:40, 0]).max() > 0.5


def test_a_touch_too_weak_to_judge_the_contact_by_moves_the_frames_all_the_same() -> None:
    case = colliding(CONTACT)
    (first, *others), at = case.runs, slice(4, 8)
    values = first.values.copy()
    weak = 0.02 * values[:, -1].max()
    values[at, -1] += weak
    pair = prepare(case, model_of(replace(case, runs=(replace(first, values=values), *others))))
    step_s = pair.full.observed.runs[0].step_s
    assert impacts.groups(pair.full.observed.runs[0].contact[:, 0], pair.noise[0], step_s)[0][0] > 20
    slow = pair.slow.observed.runs[0]
    begun = slow.contact[: int(0.05 / slow.step_s), 0].sum() * slow.step_s
    assert begun == pytest.approx(4 * weak * STEP_S, rel=0.3)


def test_an_impact_that_a_fit_has_lost_is_looked_for_again() -> None:
    _, found, _ = found_of(CONTACT)
    assert found.bodies is not None
    assert found.null is not None
    # So far back that the floors miss each other, and nothing tells a descent where to go.
    lost = found.null.unknowns.copy()
    lost[contacts.COMMON] -= 60.0
    again = contacts.fit(found.bodies, found.null.hypothesis, others=lost)
    assert again.distance.max() < SETTINGS.impacts.off
    # One that stayed lost would cost this much.
    assert again.cost < found.null.cost + SETTINGS.impacts.most


def test_a_single_impact_decides_nothing() -> None:
    _, found, _ = found_of(CONTACT)
    assert found.bodies is not None
    assert found.null is not None
    first, *others = found.bodies.impacts
    odd = replace(first, seen=first.seen + np.array([0, 1, 1, 1, 1, 1, 1]))
    one_odd = replace(found.bodies, impacts=(odd, *others))
    again = contacts.again(one_odd, found.null, found.null)
    assert again.distance[0] > 2 * SETTINGS.impacts.off
    assert again.cost < found.null.cost + SETTINGS.impacts.most + 0.5
    # Nor does it pull the others away.
    assert again.distance[1:] == pytest.approx(found.null.distance[1:], abs=0.5)
    assert again.law.gap_m == pytest.approx(found.null.law.gap_m, abs=found.null.std[0])


def test_impacts_are_believed_as_well_known_as_they_are_seen_to_be() -> None:
    _, found, _ = found_of(CONTACT)
    assert found.bodies is not None
    plain = found.bodies.impacts[0].whiten
    assert impacts.sharper(found.bodies, 0.5).impacts[0].whiten == pytest.approx(2 * plain)
    assert found.null is not None
    expected = found.null.freedom - 3 * found.impacts
    assert 0.2 < 2 * found.null.cost / expected < 1.5


def test_the_size_of_a_touch_changes_that_push_alone() -> None:
    pair, *_ = found_of(CONTACT)
    model = pair.slow
    place, event = 1, pair.slow.observed.contact_events[1]
    number = next(
        i for i, one in enumerate(model.parameters) if (one.kind, one.place) == ("event_gain", place)
    )
    values = np.zeros(len(model.std))
    values[number] = 0.1
    times = np.linspace(0.0, model.observed.runs[event.run].time_s[-1], 4001)
    plain, larger = (
        model.contact_force(model.assemble(v), event.run, event.column, times)
        for v in (np.zeros(len(model.std)), values)
    )
    within = event.within(times)
    assert larger[within] == pytest.approx(1.1 * plain[within])
    assert np.array_equal(larger[~within], plain[~within])


def test_the_signature_of_a_touch_is_the_derivative_of_the_prediction() -> None:
    pair, *_ = found_of(CONTACT)
    model = pair.slow
    start = pairs.quick_filter(model, (0, 1))
    number = next(i for i, one in enumerate(model.parameters) if one.kind == "event_gain")
    event = model.observed.contact_events[0]
    values = np.zeros(len(model.std))
    values[number] = 0.01
    gains = start.gains
    place = start.runs.index(event.run)
    before, after = (
        whitened(model.predict(v, gains, (), start.runs).innovations[place], start.filters[place]).ravel()
        for v in (start.values, start.values + values)
    )
    terms = nuisance_terms(model, start.modes, motion_of(model, start, place))
    column = run_signatures(model, start, place, terms)[:, number]
    change = (before - after) / 0.01
    assert column @ change / np.linalg.norm(column) / np.linalg.norm(change) > 0.95


def test_what_uncertain_forces_add_is_what_their_simulation_adds() -> None:
    pair, *_ = found_of(CONTACT)
    model = pair.slow
    start = pairs.quick_filter(model, (0, 1))
    plain = simulate(model, start.values, (), [0])[0]
    added = np.zeros(plain.shape[1])
    for number, parameter in enumerate(model.parameters):
        if parameter.kind == "event_gain" and model.observed.contact_events[parameter.place].run == 0:
            values = start.values.copy()
            values[number] = parameter.std
            added += np.mean((simulate(model, values, (), [0])[0] - plain) ** 2, axis=0)
    expected = contact_response(model, start.modes, 0)
    displaced = np.array(["_d" in name for name in model.observed.names])
    assert expected[displaced] == pytest.approx(added[displaced], rel=0.15)


def test_forces_without_a_cell_are_found_better_by_calibrated_frames() -> None:
    case = colliding(CONTACT)
    cell = [run.values[:, -1] for run in case.runs]
    blind = colliding(CONTACT, measured=False)
    model = model_of(blind)
    for frame in model.structure.frames:
        frame.stiffness[:] *= 1.1
    quick = prepare(blind, model)
    better = found_again(quick, (0, 1))

    def errors(pair: Pair) -> float:
        off = [
            run.contact[:, 0].sum() / force.sum() - 1
            for run, force in zip(pair.full.observed.runs, cell, strict=True)
        ]
        return float(np.abs(off).max())

    assert errors(better) < min(0.05, errors(quick))
    measured = prepare(case, model_of(case))
    assert found_again(measured, (0, 1)) is measured


@pytest.mark.slow
@pytest.mark.guard
def test_a_softer_contact_that_a_slow_logger_cannot_show_asks_for_a_faster_one() -> None:
    _, found, concluded = judged(colliding(replace(CONTACT, stiffness=1.5e7)))
    assert concluded.verdict == "nothing_missing"
    said = contact_advice.advice(found, SETTINGS.pair_decision.contact_evidence)
    assert said[0].sentence.startswith("The same shaking recorded at four times the sampling rate")
    assert (
        "between another stiffness of the contact and the contact of the baseline model" in said[0].sentence
    )
    assert found.bodies is not None
    assert found.null is not None
    expected = contact_advice.expected(found.bodies, found.ranked[0][1], found.null)
    gains = {gain.what: gain.ln_bayes for gain in expected}
    finest = gains["the same shaking recorded at four times the sampling rate, force cell included"]
    assert finest > 20
    # What a coarser record tells a finer one tells, too.
    assert finest >= gains["the same shaking recorded at twice the sampling rate, force cell included"]
    clear = replace(found, ranked=((500.0, found.ranked[0][1]), *found.ranked[1:]))
    assert contact_advice.advice(clear, SETTINGS.pair_decision.contact_evidence) == []
