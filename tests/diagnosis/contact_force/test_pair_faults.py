"""Bad input of pairs that collide: each fault is said, and none makes a contact or a frame's effect of itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from pounding.diagnosis import workflow as diagnose
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force import pairs
from pounding.diagnosis.contact_force.pair import cell_at_its_word, prepare
from pounding.diagnosis.decision.claims import Place, candidate
from pounding.diagnosis.decision.decision import Decision, Verdict
from pounding.diagnosis.decision.diagnosis import conclude
from pounding.diagnosis.decision.impulses import impulses
from pounding.diagnosis.decision.pair_decision import _two_loggers, contact_claims
from pounding.diagnosis.report.making import poor_forces
from pounding.diagnosis.settings import SETTINGS
from pounding.diagnosis.workflow import find
from tests.diagnosis.pair_models import (
    CONTACT,
    DRIFT,
    FLOORS,
    GAP_M,
    MASS,
    NOTHING,
    STEP_S,
    STIFFNESS,
    claimed,
    colliding,
    damping,
    judged,
    model_of,
    value,
)


def changed(case: Case, change: Any) -> Case:
    runs = []
    for run in case.runs:
        values = run.values.copy()
        values[:, -1] = change(values[:, -1])
        runs.append(replace(run, values=values))
    return replace(case, runs=tuple(runs))


def test_a_force_channel_of_the_wrong_polarity_is_said_and_turned() -> None:
    pair, _, concluded = judged(changed(colliding(CONTACT), lambda force: -force))
    assert pair.cell is not None
    assert [(name, size) for name, size, *_ in pair.cell.faults] == [("sensor_gain", -2.0)]
    assert claimed(concluded) == ["sensor_gain"]
    assert concluded.effects[0].channel == "force_1"
    assert any("polarity" in warning for warning in concluded.warnings)


def test_a_force_cell_of_the_wrong_gain_is_no_other_contact() -> None:
    _, _, concluded = judged(changed(colliding(CONTACT), lambda force: 1.25 * force))
    assert claimed(concluded) == ["sensor_gain"]
    assert value(concluded, "relative_change") == pytest.approx(0.25, abs=0.04)


def test_a_force_cell_is_not_judged_by_a_sensor_that_is_wrong_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    case = changed(colliding(CONTACT), lambda force: 1.25 * force)
    asked = []

    named: list[str | None] = ["tall_a3"]

    def findings(case: Case, progress: Any, own: Any, rate: float, against_motion: bool = True) -> Any:
        asked.append(against_motion)
        effect = SimpleNamespace(channel=named[-1])
        decision = Decision("effect_named", cast(Any, SimpleNamespace(effects=(effect,))))
        return SimpleNamespace(pair=prepare(case, model_of(case), against_motion)), decision

    monkeypatch.setattr(diagnose, "_find", findings)
    pair = find(case, lambda what, share: None)[0].pair
    assert asked == [True, False]
    assert pair is not None
    assert pair.cell is not None
    assert pair.cell.faults == ()
    # Sensors of which none is wrong are believed.
    named.append(None)
    pair = find(case, lambda what, share: None)[0].pair
    assert asked == [True, False, True]
    assert pair is not None
    assert pair.cell is not None
    assert pair.cell.corrected


def test_a_force_cell_is_put_right_only_if_calibrated_frames_like_it_better() -> None:
    """Frames as believed may be wrong by more than the cell, and then misjudge its gain."""
    told = (("sensor_gain", 0.25, 0.03, 20.0),)
    for gain, kept in ((1.25, True), (1.0, False)):
        case = changed(colliding(CONTACT), lambda force, by=gain: by * force)
        less = changed(case, lambda force: force / 1.25)
        right = prepare(less, model_of(less), against_motion=False)
        assert right.cell is not None
        pair = replace(right, cell=replace(right.cell, faults=told))
        kept_or_not = cell_at_its_word(case, model_of(case), pair, [0, 1])
        assert kept_or_not.cell is not None
        assert kept_or_not.cell.corrected == kept
        if kept:
            (_, gain_found, _, ln_bayes), *others = kept_or_not.cell.faults
            assert not others
            assert gain_found == 0.25
            # What calibrated frames say is more than what those of the baseline said.
            assert ln_bayes > 20.0


def test_a_gain_of_a_force_cell_that_hardly_shows_is_tried() -> None:
    """Three standard deviations: too few by themselves, and what calibrated frames are asked."""
    case = changed(colliding(CONTACT), lambda force: 1.07 * force)
    pair = prepare(case, model_of(case))
    assert pair.cell is not None
    assert [fault[0] for fault in pair.cell.faults] == ["sensor_gain"]
    assert 0.0 < pair.cell.faults[0][3] < SETTINGS.pair_decision.contact_evidence
    assert pair.cell.with_evidence(60.0).faults[0][3] == 60.0
    delayed = replace(pair.cell, faults=(*pair.cell.faults, ("sensor_delay", 4e-4, 1.5e-4, 0.5)))
    assert delayed.with_evidence(60.0) == delayed


def test_a_force_cell_that_clips_is_replaced_by_what_the_motion_says() -> None:
    case = colliding(CONTACT)
    top = 0.4 * max(run.values[:, -1].max() for run in case.runs)
    pair, _, concluded = judged(changed(case, lambda force: np.minimum(force, top)))
    assert pair.cell is None
    assert concluded.verdict == "nothing_missing"
    assert any("clipped" in warning for warning in concluded.warnings)


def test_a_contact_that_never_closes_is_said() -> None:
    far = replace(CONTACT, gap_m=0.2)
    _, found, concluded = judged(colliding(far, model=far))
    assert found.impacts == 0
    assert concluded.verdict == "nothing_missing"
    assert any("never closes" in warning for warning in concluded.warnings)


def test_floors_that_pass_through_the_believed_contact_have_a_wider_gap() -> None:
    _, found, concluded = judged(colliding(replace(CONTACT, gap_m=0.2)))
    assert found.impacts == 0
    assert claimed(concluded) == ["gap_offset"]
    assert value(concluded, "offset") > 0


@pytest.mark.slow
@pytest.mark.guard
def test_a_gap_believed_closed_is_corrected() -> None:
    case = colliding(CONTACT, model=replace(CONTACT, gap_m=0.0))
    _, found, concluded = judged(case)
    assert claimed(concluded)[0] == "gap_offset"
    assert value(concluded, "offset") == pytest.approx(1e3 * GAP_M, abs=0.1)
    assert contact_claims(case, found)[0].effect == "gap_offset"


def test_poor_forces_that_no_cell_measured_are_said() -> None:
    case = colliding(CONTACT, measured=False)
    pair = prepare(case, model_of(case))
    for left, said in ((0.02, False), (0.2, True)):
        warnings = poor_forces(pair, left, 0.02)
        assert any("worth less than with a force cell" in warning for warning in warnings) is said
    assert pair.blind
    heard = prepare(cell := colliding(CONTACT), model_of(cell))
    assert poor_forces(heard, 0.2, 0.02) == []


def struck(case: Case, floor: int = 2, times: Sequence[float] = tuple(np.linspace(0.3, 2.2, 12))) -> Case:
    """Return a case in which a floor of the frame on the right was struck at some times [s], away from the other."""
    stiffness = STIFFNESS["stiff"] * DRIFT.T @ DRIFT
    still = np.zeros((FLOORS, FLOORS))
    system = np.block([[still, np.eye(FLOORS)], [-stiffness / MASS, -damping(stiffness) / MASS]])
    push = np.concatenate([np.zeros(FLOORS), np.eye(FLOORS)[floor - 1] / MASS])[:, None]
    at = np.arange(len(case.runs[0].time_s)) * STEP_S
    force = np.zeros(len(at))
    for begin in times:
        inside = (at > begin) & (at < begin + 0.005)
        force[inside] = 400.0 * np.sin(np.pi * (at[inside] - begin) / 0.005)
    states = lsim(StateSpace(system, push, np.eye(2 * FLOORS), np.zeros((2 * FLOORS, 1))), force, at)[1]
    rates = states @ system.T + force[:, None] * push.T
    runs = []
    for run in case.runs:
        values = run.values.copy()
        for column, channel in enumerate(case.channels):
            if channel.frame == "stiff" and channel.floor is not None:
                moved = states if channel.quantity == "relative_displacement" else rates[:, FLOORS:]
                values[:, column] += moved[:, channel.floor - 1]
        runs.append(replace(run, values=values))
    return replace(case, runs=tuple(runs))


def test_blows_on_one_frame_are_no_second_contact() -> None:
    case = struck(colliding(CONTACT))
    assert prepare(case, model_of(case)).second is None


@pytest.mark.parametrize("floor", [2, FLOORS])
def test_blows_on_one_frame_are_told_even_where_the_frames_meet(floor: int) -> None:
    model = prepare(case := struck(colliding(CONTACT), floor, (0.47, 0.82)), model_of(case)).slow
    found = impulses(model, pairs.quick_filter(model, (0, 1)))
    assert found is not None
    assert found.place == ("stiff", floor)


def test_touches_that_the_force_cell_did_not_show_are_no_blows() -> None:
    case = colliding(CONTACT)
    runs = []
    for run in case.runs:
        values = run.values.copy()
        third = STEP_S * np.arange(len(values)) > 2 * STEP_S * len(values) / 3
        values[third, -1] = 0.0
        runs.append(replace(run, values=values))
    model = prepare(case, model_of(case)).slow
    blinded = prepare(part := replace(case, runs=tuple(runs)), model_of(part)).slow
    lost = [
        np.abs(a.contact - b.contact).max()
        for a, b in zip(model.observed.runs, blinded.observed.runs, strict=True)
    ]
    assert max(lost) > 100.0
    assert impulses(blinded, pairs.quick_filter(blinded, (0, 1))) is None
    assert impulses(model, pairs.quick_filter(model, (0, 1))) is None


@pytest.mark.slow
@pytest.mark.guard
def test_a_frame_on_another_logger_is_late_in_all_of_its_channels() -> None:
    """Forces that frames without the delay had put right kept most of it: no channel showed it, then 1.3 ms."""
    case = colliding(CONTACT)
    late = [i for i, channel in enumerate(case.channels) if channel.frame == "stiff"]
    runs = []
    for run in case.runs:
        values = run.values.copy()
        for column in late:
            values[:, column] = np.interp(run.time_s - 0.003, run.time_s, values[:, column])
        runs.append(replace(run, values=values))
    case = replace(case, runs=tuple(runs))
    found, decision = find(case, lambda what, share: None)
    assert found.pair is not None
    concluded = conclude(case, found, decision).conclusion
    assert concluded.verdict == "effect_named"
    stiff = {channel.name for channel in case.channels if channel.frame == "stiff"}
    assert {(one.place.effect, one.place.channel) for one in concluded.effects} == {
        ("sensor_delay", name) for name in stiff
    }
    # The other frame's channels are earlier by what their prior allows.
    assert concluded.effects[0].parameters[0].value == pytest.approx(2.3, abs=0.1)


@pytest.mark.parametrize(("verdict", "said"), [("unknown_effect", True), ("nothing_missing", False)])
def test_a_delay_that_explains_not_enough_asks_for_one_time_base(verdict: Verdict, said: bool) -> None:
    late = candidate(Place(effect="sensor_delay", channel="stiff_a1"), 900.0)
    warned = _two_loggers(replace(NOTHING, verdict=verdict, candidates=(late,)))
    assert ["different loggers" in warning for warning in warned] == [True] * said
