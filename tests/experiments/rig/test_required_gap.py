"""Required gaps: closing against opening, equal frames, floors that do not meet, and the engine as judge."""

from __future__ import annotations

import numpy as np
import pytest

from pounding import frames
from pounding.contact import LinearSpring
from pounding.contact.laws import LinearViscoelastic
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.required_gap import (
    contact_floors,
    gaps_by_floor,
    motions,
    pair_gap,
    required_gap,
)
from pounding.experiments.rig.rig import Rig
from pounding.experiments.separation.gaps.confirm import confirm, touches
from pounding.experiments.separation.gaps.maps import gap_map


def pulse(samples: int = 400, step_s: float = 0.004) -> Record:
    """A table motion with both signs that is not symmetric."""
    t = step_s * np.arange(samples)
    return Record(
        "pulse", 3.0 * np.sin(2 * np.pi * 3.1 * t) * np.exp(-1.5 * t) + 0.8 * np.sin(9.0 * t), step_s
    )


@pytest.fixture(scope="module")
def tall() -> frames.ReducedFrame:
    return frames.build(frames.load("10"))


@pytest.fixture(scope="module")
def short() -> frames.ReducedFrame:
    return frames.build(frames.load("5B"))


def test_only_closing_counts() -> None:
    left, right = np.array([0.0, 0.010, -0.030, 0.0]), np.array([0.0, -0.005, 0.020, 0.0])
    found = required_gap(left, right, 0.1)
    assert found.closing_m == pytest.approx(0.015)
    assert found.opening_m == pytest.approx(0.050)
    assert found.equation_4_1_m == pytest.approx(0.050)
    assert found.time_s == pytest.approx(0.1)
    assert (found.left_peak_m, found.right_peak_m) == (pytest.approx(0.030), pytest.approx(0.020))


def test_frames_that_only_part_need_no_gap() -> None:
    found = required_gap(np.array([0.0, -0.01]), np.array([0.0, 0.01]), 0.1)
    assert found.closing_m == 0.0
    assert found.time_s == 0.0
    assert found.opening_m == pytest.approx(0.02)


def test_equal_frames_need_no_gap(short) -> None:
    found = pair_gap(short, short, pulse())
    assert found.closing_m == 0.0
    assert found.equation_4_1_m == 0.0
    assert found.left_peak_m > 1e-3


def test_sides_and_sign_of_the_record_trade_closing_for_opening(tall, short) -> None:
    one, swapped = pair_gap(tall, short, pulse()), pair_gap(short, tall, pulse())
    flipped = pair_gap(tall, short, pulse().flipped())
    assert one.closing_m == pytest.approx(swapped.opening_m, rel=1e-12)
    assert one.opening_m == pytest.approx(swapped.closing_m, rel=1e-12)
    assert one.opening_m == pytest.approx(flipped.closing_m, rel=1e-9)
    assert one.closing_m != pytest.approx(one.opening_m, rel=0.01)


def test_gap_grows_with_the_record(tall, short) -> None:
    once, twice = (
        pair_gap(tall, short, pulse()),
        pair_gap(tall, short, pulse().scaled(1.0, 2 * pulse().pga_g)),
    )
    assert twice.closing_m == pytest.approx(2.0 * once.closing_m, rel=1e-9)


def test_floors_that_meet(tall, short) -> None:
    assert contact_floors(tall, short) == (5, 5)
    assert contact_floors(short, tall, 3) == (3, 3)
    with pytest.raises(ExperimentError, match="floors 1 to 5"):
        contact_floors(tall, short, 6)
    with pytest.raises(ExperimentError, match="floors 1 to 5"):
        contact_floors(tall, short, 0)


def test_floor_against_column_is_refused(tall) -> None:
    stick = frames.StickFrame(
        name="odd",
        storeys=2,
        storey_height_m=[0.13, 0.13],
        floor_mass_kg=[6.0, 6.0],
        frequency_hz=[4.0],
        damping_ratio=0.01,
    )
    with pytest.raises(ExperimentError, match="faces no floor"):
        contact_floors(tall, frames.build(stick))


def test_storeys_of_two_heights_meet_where_they_are_level() -> None:
    low, high = (
        frames.build(
            frames.StickFrame(
                name=name,
                storeys=storeys,
                storey_height_m=height,
                floor_mass_kg=[6.0] * storeys,
                frequency_hz=[4.0],
                damping_ratio=0.01,
            )
        )
        for name, storeys, height in (("low", 6, 0.10), ("high", 5, 0.15))
    )
    assert contact_floors(low, high, 3) == (3, 2)
    Rig([low, high], [Contact(LinearSpring(1e7), 0.01, (3, 2))])
    assert [floor for floor, _ in gaps_by_floor(low, high, pulse())] == [3, 6]
    with pytest.raises(ExperimentError, match="faces no floor"):
        contact_floors(low, high, 2)
    with pytest.raises(ExperimentError, match="only floors at one height can meet"):
        Rig([low, high], [Contact(LinearSpring(1e7), 0.01, 2)])


def test_gaps_by_floor_end_with_the_roof(tall, short) -> None:
    found = gaps_by_floor(tall, short, pulse())
    assert [floor for floor, _ in found] == [1, 2, 3, 4, 5]
    assert found[-1][1] == pair_gap(tall, short, pulse())


def test_motions_must_go_together() -> None:
    with pytest.raises(ExperimentError, match="same length"):
        required_gap(np.zeros(3), np.zeros(4), 0.1)
    with pytest.raises(ExperimentError, match="not finite"):
        required_gap(np.array([0.0, np.nan]), np.zeros(2), 0.1)


def test_exact_recursion_against_the_engine(tall, short) -> None:
    """The engine integrates the same frames with error control; its own steps are compared."""
    record = pulse()
    motion = Rig([tall, short]).run(record)
    apart = motion.frames[0].floor_displacement(5) - motion.frames[1].floor_displacement(5)
    found = pair_gap(tall, short, record)
    assert apart.max() == pytest.approx(found.closing_m, rel=1e-3)
    assert -apart.min() == pytest.approx(found.opening_m, rel=1e-3)


def test_collisions_confirm_the_required_gap(tall, short) -> None:
    found = confirm(tall, short, pulse())
    assert found.impacts_below >= 1
    assert found.impacts_above == 0
    assert found.holds
    assert found.engine_closing_mm == pytest.approx(found.closing_mm, rel=1e-3)


def test_frames_that_need_no_gap_do_not_touch(short) -> None:
    rig = Rig([short, short], [Contact(LinearViscoelastic(stiffness=20.66e6, damping=1255.0), 1e-6, 5)])
    assert touches(rig.run(pulse()).contacts[0].deformation_m) == 0


def test_touches_counts_closures() -> None:
    assert touches([-1.0, 0.5, 0.7, -0.1, 0.2]) == 2
    assert touches([0.5, -1.0]) == 1
    assert touches([-1.0, 0.0]) == 0


def test_motions_are_looked_at_finely(short) -> None:
    coarse = Record("coarse", pulse(100, 0.016).acceleration_m_s2, 0.016)
    assert len(motions(short, coarse, [5])) == 99 * 16 + 1


def test_map_of_equal_oscillators_is_zero_and_never_above_the_sum() -> None:
    found = gap_map(pulse(), periods=7, steps_per_octave=4)
    assert np.all(found.gap_m[:, 0] == 0.0)
    assert found.ratio[0] == 1.0
    assert np.all(found.over_abs <= 1.0 + 1e-6)
    assert np.all(found.over_srss <= np.sqrt(2.0) + 1e-6)
    assert found.over_srss[:, -1].max() > 0.8


def test_frames_that_move_alike_need_no_gap_and_no_negative_zero() -> None:
    alike = np.array([0.0, 0.1, -0.2])
    found = required_gap(alike, alike, 0.1)
    assert np.copysign(1.0, [found.closing_m, found.opening_m]).tolist() == [1.0, 1.0]
