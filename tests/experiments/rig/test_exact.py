"""The exact solver against closed formulas, against the engine and against itself."""

from __future__ import annotations

import dataclasses
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from pounding import frames
from pounding.contact import Law, LinearSpring, LinearViscoelastic, collide, thesis_law
from pounding.contact.errors import ContactError
from pounding.contact.laws import LAWS
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import ExactRig, longest_step, run_exact
from pounding.experiments.rig.impacts import all_impacts, impacts
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.rig import Accuracy, Rig
from pounding.frames.response.exact import linear_response
from tests.experiments.rig.models import FIVE, shear

SHAKEN_S = 3.0
TIGHT = Accuracy(1e-11, 1e-13, 2e-4)
"""At 1e-9 the engine's own error after thirty elastic impacts is 2e-3 of a peak."""


def both(
    row: Any, contacts: list[Contact], record: Record, accuracy: Accuracy = TIGHT
) -> tuple[Motion, Motion]:
    rig = Rig(row, contacts)
    return rig.run(record, solver="exact"), rig.run(record, accuracy=accuracy)


def agree(found: Motion, reference: Motion) -> None:
    """Assert what the solver promises: displacements to 1e-4, forces and impulses to 1 %, touches equal."""
    for one, other in zip(found.frames, reference.frames, strict=True):
        for mine, theirs in zip(one.peaks(), other.peaks(), strict=True):
            for key in ("max_mm", "min_mm"):
                assert mine[key] == pytest.approx(theirs[key], rel=1e-4)
    mine, theirs = all_impacts(found), all_impacts(reference)
    assert len(mine) == len(theirs) > 0
    for one, other in zip(mine, theirs, strict=True):
        assert one.touches == other.touches
        assert one.time_s == pytest.approx(other.time_s, abs=1e-5)
        assert one.peak_force_n == pytest.approx(other.peak_force_n, rel=0.01)
        assert one.impulse_n_s == pytest.approx(other.impulse_n_s, rel=0.01)
    assert found.energy.error < 1e-3


def test_without_contact_it_is_the_exact_response(pair: Any, shaking: Record) -> None:
    motion = Rig(pair).run(shaking, solver="exact")
    for frame, done in zip(pair, motion.frames, strict=True):
        exact, rate = linear_response(frame, shaking.acceleration_m_s2, shaking.step_s)
        at = np.searchsorted(motion.time_s, shaking.time_s - 1e-9)
        assert np.abs(done.displacement_m[at] - exact).max() < 1e-12 * np.abs(exact).max() + 1e-15
        assert np.abs(done.velocity_m_s[at] - rate).max() < 1e-11 * np.abs(rate).max()
        balance = (
            done.acceleration_m_s2 @ frame.mass
            + done.velocity_m_s @ frame.damping
            + done.displacement_m @ frame.stiffness
            + np.outer(done.table_m_s2, frame.mass @ frame.influence)
        )
        assert np.abs(balance).max() < 1e-8 * np.abs(done.acceleration_m_s2).max()
    assert motion.solver == "exact"
    assert motion.energy.error < 1e-4


@pytest.mark.parametrize("name", FIVE)
def test_it_agrees_with_the_engine_for_every_law(name: str, pair: Any, shaking: Record) -> None:
    law = thesis_law(name, masses=(6.0, 6.0))
    agree(*both(pair, [Contact(law, 0.004, 2)], shaking))


@pytest.mark.parametrize("name", ["linear_viscoelastic", "hertz_damp"])
def test_it_agrees_where_a_contact_may_pull(name: str, pair: Any, shaking: Record) -> None:
    law = thesis_law(name, masses=(6.0, 6.0), tension=True)
    agree(*both(pair, [Contact(law, 0.004, 2)], shaking))


def test_it_agrees_for_the_plates_and_several_contacts() -> None:
    row = [frames.build(frames.load(name)) for name in ("15B", "5B")]
    time = np.arange(0.0, 1.5, 0.004)
    history = 4.0 * np.sin(2 * np.pi * 2.3 * time) + 2.0 * np.sin(2 * np.pi * 6.4 * time)
    contacts = [Contact(thesis_law("linear_viscoelastic"), 0.004, floor) for floor in (5, 4)]
    agree(*both(row, contacts, Record("two sines", history, 0.004)))


def test_it_agrees_for_three_frames_in_a_row_and_unlike_gaps(shaking: Record) -> None:
    row = [shear(3, 3.1), shear(4, 2.3), shear(2, 5.2)]
    law = LinearViscoelastic(1e5, damping=60.0)
    agree(*both(row, [Contact(law, 0.006, 3), Contact(law, 0.009, 2, pair=1)], shaking))


def test_it_agrees_off_centre() -> None:
    row = [frames.build(frames.load(name), planar=False) for name in ("5A", "5B")]
    time = np.arange(0.0, 0.3, 0.004)
    history = 6.0 * np.sin(2 * np.pi * 6.6 * time) * np.minimum(1.0, time / 0.2)
    contacts = [Contact(thesis_law("hertz"), 5e-4, 5, y_m=y) for y in (0.15, -0.1)]
    found, reference = both(row, contacts, Record("sine", history, 0.004), Accuracy(1e-8, 1e-10))
    assert all_impacts(reference)
    for history, other in zip(found.contacts, reference.contacts, strict=True):
        mine, theirs = impacts(history)[0], impacts(other)[0]
        assert mine.time_s == pytest.approx(theirs.time_s, abs=1e-5)
        assert mine.peak_force_n == pytest.approx(theirs.peak_force_n, rel=0.01)


def test_floors_that_lie_against_each_other_touch_from_the_first_sample(pair: Any, shaking: Record) -> None:
    law = LinearViscoelastic(1e5, damping=300.0)
    found, reference = both(pair, [Contact(law, 0.0, 2)], shaking)
    assert len(all_impacts(found)) == len(all_impacts(reference)) > 3
    assert found.energy.error < 1e-3
    for one, other in zip(found.frames, reference.frames, strict=True):
        assert one.peaks()[-1]["max_mm"] == pytest.approx(other.peaks()[-1]["max_mm"], rel=1e-3)


def test_the_time_to_a_touch_is_that_of_the_closed_formula() -> None:
    """A single mass against a heavy stiff one: the touch comes when its own response reaches the gap."""
    soft, stiff = shear(1, 2.0), shear(1, 900.0, mass_kg=1e6)
    time = np.arange(0.0, 0.6, 0.01)
    record = Record("step", np.full(len(time), -3.0), 0.01)
    gap = 0.01
    motion = Rig([soft, stiff], [Contact(LinearSpring(1e6), gap, 1)]).run(record, solver="exact")
    fine = np.linspace(0.0, 0.59, 590_001)
    exact, _ = linear_response(soft, np.interp(fine, time, record.acceleration_m_s2), fine[1])
    crossed = np.flatnonzero(exact[:, 0] >= gap)[0]
    touched = float(motion.contacts[0].touches[0][0])
    assert touched == pytest.approx(fine[crossed], abs=3e-6)


def test_a_collision_restores_what_two_free_masses_restore() -> None:
    """Two soft sticks, of which the table drives one only, collide as free bodies do while the contact lasts."""
    left, right = shear(1, 0.2, mass_kg=5.0, damping=0.0), shear(1, 0.2, mass_kg=9.0, damping=0.0)
    right = dataclasses.replace(right, influence=0.0 * right.influence)
    law = thesis_law("hertz_damp", masses=(5.0, 9.0))
    time = np.arange(0.0, 1.0, 0.002)
    record = Record("push", -0.5 * np.sin(np.pi * np.minimum(time / 0.2, 1.0)), 0.002)
    motion = Rig([left, right], [Contact(law, 0.02, 1)]).run(record, solver="exact")
    impact = all_impacts(motion)[0]
    free = collide(law, 5.0, 9.0, impact.approach_velocity_m_s)
    assert impact.touches == 1
    assert impact.peak_force_n == pytest.approx(free.force_n.max(), rel=2e-3)
    assert impact.restitution == pytest.approx(free.restitution, rel=2e-3)


def test_a_touch_shorter_than_the_longest_step_is_not_missed(pair: Any, shaking: Record) -> None:
    """Steps of a fifth of a second and of 0.1 ms see the same grazing touch."""
    free = Rig(pair).run(shaking, solver="exact")
    apart = free.frames[0].floor_displacement(2) - free.frames[1].floor_displacement(2)
    contacts = [Contact(LinearSpring(2e5), float(apart.max()) - 2e-7, 2)]
    counts = []
    for longest in (4e-3, 1e-4):
        rig = ExactRig(pair, contacts)
        solution = rig.solve(shaking.acceleration_m_s2, shaking.step_s, longest_s=longest)
        motion = rig.motion(solution, (0.0, 0.0))
        counts.append([len(motion.contacts[0].pulses), motion.contacts[0].pulses[0][0]])
    assert counts[0][0] == counts[1][0] >= 1
    assert counts[0][1] == pytest.approx(counts[1][1], abs=1e-9)


def test_steps_in_contact_converge_with_order_four(pair: Any, shaking: Record) -> None:
    rig = ExactRig(pair, [Contact(LinearViscoelastic(1e5, tension=True, damping=50.0), 0.004, 2)])

    def roof(level: int) -> float:
        solution = rig.solve(shaking.acceleration_m_s2, shaking.step_s, duration_s=0.6, contact_level=level)
        return float(rig.motion(solution, (0.0, 0.0)).frames[1].displacement_m[-1, 1])

    exact = roof(10)
    errors = np.array([abs(roof(level) - exact) for level in (1, 2, 3, 4)])
    assert np.log2(errors[0] / errors[-1]) / 3.0 > 3.6


def test_the_error_control_keeps_its_word(pair: Any, shaking: Record) -> None:
    rig = ExactRig(pair, [Contact(thesis_law("hertz_damp"), 0.004, 2)])
    peaks = []
    for tolerance in (1e-3, 1e-5, 1e-8):
        solution = rig.solve(shaking.acceleration_m_s2, shaking.step_s, duration_s=0.6, tolerance=tolerance)
        peaks.append(float(solution.forces.max()))
    assert abs(peaks[1] / peaks[2] - 1.0) < 1e-4
    assert abs(peaks[0] / peaks[2] - 1.0) < 1e-2


def test_a_law_of_ones_own_runs_without_a_word_to_the_solver(pair: Any, shaking: Record) -> None:
    @dataclass(frozen=True)
    class Progressive(Law):
        name: ClassVar[str] = "progressive"
        unit: ClassVar[str] = "N/m^2"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            return self.stiffness * xp.power(deformation, 2.0)

    try:
        agree(*both(pair, [Contact(Progressive(5e9), 0.004, 2)], shaking))
    finally:
        LAWS.pop("progressive")


def test_a_law_with_a_branch_is_refused(pair: Any, shaking: Record) -> None:
    @dataclass(frozen=True)
    class Branching(Law):
        name: ClassVar[str] = "branching"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            return self.stiffness * deformation if rate > 0 else 0.0

    try:
        with pytest.raises(ContactError, match="--solver exudyn"):
            Rig(pair, [Contact(Branching(1e5), 0.004, 2)]).run(shaking, solver="exact")
    finally:
        LAWS.pop("branching")


def test_frames_coupled_by_their_damping_are_as_linear(shaking: Record) -> None:
    """A damper between two floors leaves no modal damping; the poles are complex and the run as exact."""
    plain = shear(3, 2.3)
    damper = np.zeros((3, 3))
    damper[0, 0] = 40.0
    damped = dataclasses.replace(plain, damping=plain.damping + damper)
    agree(*both([damped, shear(2, 6.1)], [Contact(thesis_law("hertz"), 0.003, 2)], shaking))


def test_a_frame_whose_stiffness_alone_was_changed_is_not_run_with_its_old_modes(shaking: Record) -> None:
    plain = shear(3, 2.3)
    softer = dataclasses.replace(plain, stiffness=0.9 * plain.stiffness)
    agree(*both([softer, shear(2, 6.1)], [Contact(thesis_law("hertz"), 0.003, 2)], shaking))
    exact, _ = linear_response(softer, shaking.acceleration_m_s2, shaking.step_s)
    engine = Rig([softer]).run(shaking, accuracy=TIGHT).frames[0].sampled(shaking.time_s)[0]
    assert np.abs(exact - engine).max() < 1e-6 * np.abs(exact).max()


def test_a_run_may_end_before_and_after_the_record(pair: Any, shaking: Record) -> None:
    contacts = [Contact(thesis_law("hertz"), 0.004, 2)]
    whole = Rig(pair, contacts).run(shaking, solver="exact")
    for end in (0.7131, 2.0, 4.5):
        motion = Rig(pair, contacts).run(shaking, solver="exact", duration_s=end)
        assert motion.time_s[-1] == pytest.approx(end, abs=1e-12)
        assert np.all(np.diff(motion.time_s) > 0.0)
        until = min(end, 3.0) - 0.01
        mine = motion.frames[0].sampled(until)[0]
        assert mine == pytest.approx(whole.frames[0].sampled(until)[0], rel=1e-6, abs=1e-9)
    assert np.abs(motion.frames[0].table_m_s2[motion.time_s > 3.001]).max() == 0.0


def test_many_runs_at_once_give_what_one_gives(pair: Any, shaking: Record) -> None:
    rigs = [Rig(pair, [Contact(thesis_law(name), 0.004, 2)]) for name in FIVE]
    alone = [rig.run(shaking, solver="exact").frames[0].displacement_m[-1] for rig in rigs]
    with ThreadPoolExecutor(4) as pool:
        at_once = list(
            pool.map(lambda rig: rig.run(shaking, solver="exact").frames[0].displacement_m[-1], rigs)
        )
    np.testing.assert_array_equal(alone, at_once)


def test_progress_is_told_and_the_user_may_stop(pair: Any) -> None:
    long = Record("noise", np.random.default_rng(0).normal(size=60_000), 0.004)
    told: list[float] = []
    Rig(pair).run(long, solver="exact", progress=told.append)
    assert len(told) > 3
    assert told == sorted(told)

    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Rig(pair).run(long, solver="exact", progress=stop)


def test_a_motion_without_bound_is_said(pair: Any, shaking: Record) -> None:
    with pytest.raises(ExperimentError, match=r"stopped at .* s: floor \d of .* more than its height"):
        Rig(pair).run(1e4 * shaking.acceleration_m_s2, shaking.step_s, solver="exact")


def test_a_contact_that_no_step_can_follow_is_said(pair: Any, shaking: Record) -> None:
    with pytest.raises(ExperimentError, match="stiffness or damping"):
        Rig(pair, [Contact(LinearSpring(1e22), 0.004, 2)]).run(shaking, solver="exact")


def test_what_only_the_engine_can_is_refused(pair: Any, shaking: Record) -> None:
    with pytest.raises(ExperimentError, match="takes no additions; run them with exudyn"):
        Rig(pair, additions=[lambda _: None]).run(shaking, solver="exact")
    with pytest.raises(ExperimentError, match="tolerances are exudyn's"):
        Rig(pair).run(shaking, solver="exact", accuracy=TIGHT)


def test_the_longest_step_follows_the_modes_that_sway(pair: Any) -> None:
    assert longest_step(pair) == pytest.approx(1.0 / (20.0 * pair[1].frequencies_hz[1]), rel=1e-12)
    plates = [frames.build(frames.load("5B"))]
    assert 5e-4 < longest_step(plates) < 2e-3


def test_run_exact_is_the_same_run(pair: Any, shaking: Record) -> None:
    contacts = [Contact(thesis_law("hertz"), 0.004, 2)]
    one = run_exact(pair, contacts, shaking.acceleration_m_s2, shaking.step_s)
    other = Rig(pair, contacts).run(shaking, solver="exact")
    np.testing.assert_array_equal(one.time_s, other.time_s)


@pytest.mark.parametrize("seed", range(25))
def test_long_and_short_steps_see_the_same_touches(seed: int) -> None:
    """Frames, gaps, contacts and laws at random: steps of the default length against steps of 20 microseconds."""
    rng = np.random.default_rng(seed)
    row = [
        shear(
            int(rng.integers(1, 6)),
            rng.uniform(0.8, 9.0),
            mass_kg=rng.uniform(1, 20),
            damping=rng.uniform(0.002, 0.1),
        )
        for _ in range(int(rng.integers(2, 4)))
    ]
    laws = [thesis_law(str(name), masses=(5.0, 6.0)) for name in rng.choice(FIVE, len(row) - 1)]
    contacts = [
        Contact(
            law,
            rng.uniform(0.0, 0.01),
            int(rng.integers(1, min(row[i].storeys, row[i + 1].storeys) + 1)),
            pair=i,
        )
        for i, law in enumerate(laws)
    ]
    step = rng.uniform(0.002, 0.02)
    history = np.cumsum(rng.normal(size=200)) * np.hanning(200)
    history *= rng.uniform(0.5, 3.0) / np.abs(history).max()
    rig = ExactRig(row, contacts)
    runs = [
        rig.motion(rig.solve(history, step, longest_s=longest, tolerance=1e-7), (0.0, 0.0))
        for longest in (None, 2e-5)
    ]
    for one, other in zip(runs[0].contacts, runs[1].contacts, strict=True):
        # Later touches may depend on all before: the first five are enough to see that none is missed.
        mine, theirs = one.touches[0][:5], other.touches[0][:5]
        assert len(mine) == len(theirs)
        np.testing.assert_allclose(mine, theirs, atol=2e-5)
    assert max(run.energy.error for run in runs) < 1e-3
