"""The rig: one frame or several on a table, apart and colliding."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from pounding import frames
from pounding.contact import ContactError, Law, LinearSpring, LinearViscoelastic, make_law, thesis_law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.impacts import all_impacts
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.rig import APART, Accuracy, Rig
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response.exact import linear_response
from tests.experiments.rig.models import FIVE

SHAKEN_S = 2.0
TIGHT = Accuracy(1e-10, 1e-12, 1e-4)


@pytest.fixture(scope="module")
def tall() -> ReducedFrame:
    return frames.build(frames.load("15B"))


@pytest.fixture(scope="module")
def low() -> ReducedFrame:
    return frames.build(frames.load("5B"))


def collide(tall: ReducedFrame, low: ReducedFrame, shaking: Record, law: Law, **options: Any) -> Motion:
    return Rig([tall, low], [Contact(law, options.pop("gap_m", 0.008), 5)]).run(shaking, **options)


@pytest.mark.parametrize("accuracy", [APART, TIGHT])
def test_one_frame_follows_the_exact_response(low: ReducedFrame, shaking: Record, accuracy: Accuracy) -> None:
    motion = Rig([low]).run(shaking, accuracy=accuracy)
    exact, _ = linear_response(low, shaking.acceleration_m_s2, shaking.step_s)
    found, _ = motion.frames[0].sampled(shaking.time_s)
    assert np.abs(found - exact).max() < (2e-4 if accuracy is APART else 5e-5) * np.abs(exact).max()
    assert motion.contacts == ()
    assert motion.model_s == pytest.approx(2.0)
    assert motion.energy.error < 1e-3
    for few in ([0.0], [0.7311, 0.7320], [2.0], [1.2, 0.3]):
        shown = CubicHermiteSpline(
            motion.frames[0].time_s, motion.frames[0].displacement_m, motion.frames[0].velocity_m_s
        )(few)
        np.testing.assert_array_equal(motion.frames[0].sampled(few)[0], shown)


def test_two_frames_that_do_not_touch_move_as_alone(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record
) -> None:
    together = collide(tall, low, shaking, LinearSpring(20e6), gap_m=1.0)
    alone = Rig([low]).run(shaking)
    times = np.linspace(0.0, 2.0, 400)
    difference = together.frames[1].sampled(times)[0] - alone.frames[0].sampled(times)[0]
    assert np.abs(difference).max() < 2e-4 * np.abs(alone.frames[0].displacement_m).max()
    assert all_impacts(together) == []
    assert together.contacts[0].sampled()[1].max() == 0.0


@pytest.mark.parametrize("name", FIVE)
def test_energy_closes_and_none_is_made(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record, name: str
) -> None:
    motion = collide(tall, low, shaking, thesis_law(name))
    assert len(all_impacts(motion)) >= 3
    assert motion.energy.error < 5e-4  # asked for: 5e-3
    lost = motion.energy.contact_j[-1]
    if name in ("linear_spring", "hertz"):
        assert abs(lost) < 1e-4 * motion.energy.input_j.max()
    else:
        assert lost > 0.0


@pytest.mark.parametrize("name", FIVE)
def test_first_impacts_have_converged(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record, name: str
) -> None:
    """Against a hundred times tighter tolerances: 1 % of peak force, 0.1 ms, 0.5 % of impulse."""
    found, fine = (
        all_impacts(collide(tall, low, shaking, thesis_law(name), accuracy=accuracy, duration_s=1.2))
        for accuracy in (None, TIGHT)
    )
    assert len(found) == len(fine) >= 1
    for one, other in zip(found, fine, strict=True):
        assert one.peak_force_n == pytest.approx(other.peak_force_n, rel=0.01)
        assert one.time_s == pytest.approx(other.time_s, abs=1e-4)
        assert one.impulse_n_s == pytest.approx(other.impulse_n_s, rel=0.005)


def test_mirrored_rig_under_the_turned_record_does_the_same(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record
) -> None:
    law = thesis_law("linear_viscoelastic")
    one = all_impacts(collide(tall, low, shaking, law, duration_s=1.0))
    mirrored = Rig([low, tall], [Contact(law, 0.008, 5)]).run(shaking.flipped(), duration_s=1.0)
    other = all_impacts(mirrored)
    assert [i.time_s for i in one] == pytest.approx([i.time_s for i in other], abs=1e-6)
    assert [i.peak_force_n for i in one] == pytest.approx([i.peak_force_n for i in other], rel=1e-4)


def test_lying_against_each_other_is_allowed(tall: ReducedFrame, low: ReducedFrame, shaking: Record) -> None:
    for name in FIVE:
        law = thesis_law(name)
        motion, exact = (
            collide(tall, low, shaking, law, gap_m=0.0, duration_s=0.5, solver=solver)
            for solver in ("exudyn", "exact")
        )
        assert len(all_impacts(motion)) == len(all_impacts(exact)) >= 1
        assert motion.energy.error < 1e-3
        for one, other in zip(motion.frames, exact.frames, strict=True):
            assert one.peaks()[4]["max_mm"] == pytest.approx(other.peaks()[4]["max_mm"], rel=2e-3)


def test_contacts_at_several_floors_and_a_row_of_three(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record
) -> None:
    law = thesis_law("hertz")
    contacts = [Contact(law, 0.006, 3), Contact(law, 0.006, 5), Contact(law, 0.004, 5, pair=1)]
    motion = Rig([tall, low, low], contacts).run(shaking, duration_s=1.5)
    assert [(c.left, c.right, c.floor) for c in motion.contacts] == [
        ("15B", "5B", 3),
        ("15B", "5B", 5),
        ("5B", "5B", 5),
    ]
    assert {impact.floor for impact in all_impacts(motion)} >= {5}
    assert motion.energy.error < 1e-3
    assert motion.contacts[0].deformation_m.max() < motion.contacts[1].deformation_m.max()


def test_two_points_across_a_floor_share_the_force_of_one(low: ReducedFrame, shaking: Record) -> None:
    """Symmetric points with half the stiffness each are the middle point, and keep the frames straight."""
    pair = [frames.build(frames.load(name), planar=False, keep_hz=30.0) for name in ("5A", "5B")]
    half = LinearViscoelastic(10e6, damping=600.0)
    outer = [Contact(half, 1e-3, 5, y_m=y) for y in (-0.15, 0.15)]
    whole = [Contact(LinearViscoelastic(20e6, damping=1200.0), 1e-3, 5)]
    end = 0.6
    two, one = (Rig(pair, contacts).run(shaking, duration_s=end) for contacts in (outer, whole))
    times, force = one.contacts[0].sampled()
    both = [contact.at(times)[2] for contact in two.contacts]
    assert force.max() > 20.0
    np.testing.assert_allclose(both[0], both[1], atol=1e-3 * force.max())
    np.testing.assert_allclose(both[0] + both[1], force, atol=5e-3 * force.max())


def test_an_addition_is_built_in(low: ReducedFrame, shaking: Record) -> None:
    """What a user adds gets the system and the bodies before the run."""
    seen: list[Any] = []
    Rig([low], additions=[seen.append]).run(shaking, duration_s=0.1)
    assert seen[0].bodies[0].reduced is low
    assert seen[0].table.step_s == shaking.step_s


def test_progress_is_told(low: ReducedFrame, shaking: Record) -> None:
    told: list[float] = []
    Rig([low]).run(shaking, duration_s=0.5, progress=told.append)
    assert told == sorted(told)
    assert len(told) >= 2


@pytest.mark.parametrize(
    ("contact", "error", "words"),
    [
        (Contact(LinearSpring(1e7), -1e-3, 5), ContactError, "overlap"),
        (Contact(LinearSpring(1e7), 0.01, 6), ExperimentError, "5B has no floor 6"),
        (Contact(LinearSpring(1e7), 0.01, 0), ExperimentError, "15B has no floor 0"),
        (Contact(LinearSpring(1e7), 0.01, 5, pair=1), ExperimentError, r"pair 1, but 2 frame\(s\)"),
        (Contact(LinearSpring(1e7), 0.01, (4, 5)), ExperimentError, "only floors at one height"),
    ],
)
def test_contacts_that_cannot_be_are_refused(
    tall: ReducedFrame, low: ReducedFrame, contact: Contact, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        Rig([tall, low], [contact])


def test_no_frame_and_no_step_are_refused(low: ReducedFrame) -> None:
    with pytest.raises(ExperimentError, match="at least one frame"):
        Rig([])
    with pytest.raises(ExperimentError, match="without a sample step"):
        Rig([low]).run(np.zeros(10))


@pytest.mark.parametrize("solver", ["exudyn", "exact"])
@pytest.mark.parametrize("duration_s", [0.0, -1.0, float("nan"), float("inf")])
def test_a_run_ends_after_it_has_begun(
    low: ReducedFrame, shaking: Record, solver: Any, duration_s: float
) -> None:
    with pytest.raises(ExperimentError, match="give a duration above 0 s"):
        Rig([low]).run(shaking, duration_s=duration_s, solver=solver)


@pytest.mark.parametrize("solver", ["exudyn", "exact"])
def test_both_solvers_say_when_a_floor_moves_by_more_than_the_height(
    low: ReducedFrame, shaking: Record, solver: Any
) -> None:
    """The one between its steps, the other between the rows that it looks at while it runs."""
    plain = Rig([low]).run(shaking, solver="exact").frames[0]
    moved = np.abs(plain.displacement_m[:, low.floor_x]).max(axis=1)
    times = 1.02 * float(np.max(low.heights_m)) / moved.max()
    with pytest.raises(ExperimentError) as caught:
        Rig([low]).run(times * shaking.acceleration_m_s2, shaking.step_s, solver=solver)
    said = re.search(
        r"stopped at ([0-9.]+) s: floor 5 of 5B has moved by more than its height", str(caught.value)
    )
    assert said is not None
    first = plain.time_s[np.argmax(times * moved > np.max(low.heights_m))]
    assert float(said[1]) == pytest.approx(first, abs=0.02)


@pytest.mark.parametrize("factor", [-0.1, 1.0])
def test_a_run_that_grows_without_bound_says_when_and_why(
    low: ReducedFrame, shaking: Record, factor: float
) -> None:
    unstable = dataclasses.replace(
        low, stiffness=factor * low.stiffness, damping=(5.0 if factor < 0 else -8.0) * low.damping
    )
    with pytest.raises(ExperimentError, match=r"stopped at \d.\d+ s: floor \d of 5B has moved by more"):
        Rig([unstable]).run(shaking, duration_s=2.0)


@pytest.mark.parametrize("stiffness", [1e9, 1e12, 1e15])
def test_any_stiffness_is_resolved(
    tall: ReducedFrame, low: ReducedFrame, shaking: Record, stiffness: float
) -> None:
    """The force grows as the root of the stiffness, as the contact shortens with it."""
    found = [
        all_impacts(collide(tall, low, shaking, make_law("linear_spring", stiffness=k), duration_s=0.75))[0]
        for k in (1e8, stiffness)
    ]
    assert found[1].peak_force_n / found[0].peak_force_n == pytest.approx((stiffness / 1e8) ** 0.5, rel=0.03)
    assert found[1].time_s == pytest.approx(found[0].time_s, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["linear_viscoelastic", "hertz"])
def test_modes_kept_have_converged(shaking: Record, name: str) -> None:
    """The first impacts do not see modes above the default of `frames.build`."""
    found = []
    for keep_hz in (None, 1200.0):
        pair = [frames.build(frames.load(frame), keep_hz=keep_hz) for frame in ("15B", "5B")]
        found.append(all_impacts(collide(*pair, shaking, thesis_law(name), duration_s=0.9))[:2])
    assert len(found[0]) == 2
    for one, other in zip(*found, strict=True):
        assert one.peak_force_n == pytest.approx(other.peak_force_n, rel=0.01)
        assert one.time_s == pytest.approx(other.time_s, abs=1e-4)
        assert one.impulse_n_s == pytest.approx(other.impulse_n_s, rel=0.005)


def one_storey(name: str, first_hz: float) -> ReducedFrame:
    return frames.build(
        frames.StickFrame(
            name=name,
            storeys=1,
            storey_height_m=0.5,
            floor_mass_kg=[6.5],
            damping_ratio=0.01,
            frequency_hz=[first_hz],
        )
    )


def test_a_stick_of_one_storey_is_shaken_and_pounds(shaking: Record) -> None:
    soft, stiff = one_storey("soft", 2.1), one_storey("stiff", 6.5)
    exact, _ = linear_response(soft, shaking.acceleration_m_s2, shaking.step_s)
    found, _ = Rig([soft]).run(shaking).frames[0].sampled(shaking.time_s)
    assert np.abs(found - exact).max() < 2e-4 * np.abs(exact).max()
    motion = Rig([soft, stiff], [Contact(thesis_law("hertz"), 0.008, 1)]).run(shaking)
    assert all_impacts(motion)
    assert motion.energy.error < 5e-3
