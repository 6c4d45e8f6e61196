"""Frames of any scale on the table: their time factor, their contact, and touches that no impact law describes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding import frames
from pounding.contact.laws import LinearSpring
from pounding.errors import InputError
from pounding.experiments.rig.contact_checks import contact_warnings
from pounding.experiments.rig.contact_choice import ContactWish, choose_laws, chosen_parameters
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.impacts import MERGING_S, merging_s
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.table_scale import table_scale
from pounding.experiments.rig.touches import touches_of
from pounding.scale import FULL_SCALE, THESIS
from tests.experiments.rig.models import shear, two_sines


def house(name: str, first_hz: float, *, slab: bool = True, scale: str | None = None) -> frames.StickFrame:
    return frames.StickFrame(
        name=name, storeys=2, storey_height_m=3.0, floor_mass_kg=[2e5, 2e5], frequency_hz=[first_hz],
        damping_ratio=0.03, plan_m=(20.0, 10.0), scale=scale, slab=frames.Slab(thickness_m=0.2) if slab else None,
    )  # fmt: skip


LEFT, RIGHT = house("left", 1.0), house("right", 2.0)


def test_the_factor_comes_from_the_frames_and_says_so() -> None:
    found = table_scale([frames.load("15B"), frames.load("5B")])
    assert (found.time_factor, found.is_laboratory) == (THESIS.time_factor, True)
    assert str(found) == "time of the record times 0.1826: 15B and 5B: 1:30"
    assert table_scale([LEFT, RIGHT]).as_dict() == {
        "scale": 1.0,
        "time_factor": 1.0,
        "time_factor_basis": "left and right: full scale, by the height of the storeys",
    }


def test_a_stated_factor_wins_and_the_laboratorys_tables_no_longer_compare() -> None:
    found = table_scale([frames.load("15B")], 1.0)
    assert (found.time_factor, found.scale, found.is_laboratory) == (1.0, THESIS, False)
    low = frames.StickFrame(
        name="low", storeys=1, storey_height_m=0.1, floor_mass_kg=[5.0], damping_ratio=0.0, frequency_hz=[3.0]
    )
    assert table_scale([low], THESIS.time_factor).is_laboratory
    assert table_scale([low, frames.load("5A")], 0.5).scale == THESIS


@pytest.mark.parametrize("factor", [None, 0.5])
def test_two_scales_on_one_table_are_refused(factor: float | None) -> None:
    with pytest.raises(
        InputError, match=r"left \(full scale\) and frame 5A \(1:30\) cannot stand on one table"
    ):
        table_scale([LEFT, frames.load("5A")], factor)


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan"), 1e9])
def test_what_is_no_factor_is_refused(factor: float) -> None:
    with pytest.raises(InputError, match="the time factor is"):
        table_scale([LEFT], factor)


def test_touches_merge_by_the_similitude() -> None:
    assert merging_s(THESIS) == MERGING_S
    assert merging_s(FULL_SCALE) == pytest.approx(0.1095, abs=1e-4)


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        (
            ContactWish(["linear_spring"], "printed"),
            "printed.* hold at 1:30, and left and bare stand at full scale",
        ),
        (ContactWish(["linear_spring"], "formula", stiffness=1e9), "formula.* hold at 1:30"),
        (
            ContactWish(["linear_spring"]),
            r"not known; estimate it with a table \[slab\] .* of bare, or give --stiffness",
        ),
        (ContactWish(["springy"], stiffness=1e9), "no impact law is called 'springy'"),
    ],
)
def test_a_contact_of_another_scale_is_refused_with_what_to_give(wish: ContactWish, said: str) -> None:
    pair = [LEFT, house("bare", 2.0, slab=False)]
    with pytest.raises(InputError, match=said):
        chosen_parameters(pair, table_scale(pair), wish)


def test_floors_are_estimated_and_what_is_stated_needs_no_slab() -> None:
    pair = frames.build(LEFT), frames.build(RIGHT)
    wish = ContactWish(["linear_viscoelastic", "hertz"])
    assert chosen_parameters([LEFT, RIGHT], table_scale([LEFT, RIGHT]), wish) == "floors"
    (linear, hertz), said = choose_laws(pair, None, "floors", wish)
    assert linear.stiffness == pytest.approx(30e9 * 0.2 * 10.0 / 20.0)
    assert hertz.stiffness == pytest.approx(2.5e10, rel=0.1)
    assert "E A / L" in said[0]
    bare = [house("bare", 2.0, slab=False)] * 2
    stated = ContactWish(["linear_spring"], stiffness=5e8)
    assert chosen_parameters(bare, table_scale(bare), stated) == "floors"
    (spring,), _ = choose_laws((frames.build(bare[0]),) * 2, None, "floors", stated)
    assert spring.stiffness == 5e8


def test_the_laboratorys_frames_keep_the_laboratorys_contact() -> None:
    pair = [house("left", 1.0, scale="1:30")] * 2
    wish = ContactWish(["linear_viscoelastic"])
    assert chosen_parameters(pair, table_scale(pair), wish) == "printed"
    (law,), said = choose_laws((frames.build(pair[0]),) * 2, None, "printed", wish)
    assert law.stiffness == 20.66e6
    assert said == ["linear_viscoelastic: the laboratory's contact at 1:30, Tables 5.1 and 6.1 of the thesis"]


def test_a_soft_contact_is_warned_of_and_a_stiff_one_is_not() -> None:
    pair = frames.build(LEFT), frames.build(RIGHT)
    soft, stiff = (
        contact_warnings(pound(*pair, two_sines(4.0), LinearSpring(k), 0.05, solver="exact").motion)
        for k in (2e7, 1e11)
    )
    assert any("a duration above 0.1 of the shorter first period of 0.5 s" in one for one in soft)
    assert any("an overlap above 0.1 of the gap" in one for one in soft)
    assert not any("a duration" in one or "an overlap" in one for one in stiff)


def half_sine(share: float) -> ContactHistory:
    """Return a contact whose floors press along half a sine of 10 ms and part with a share of the velocity they met with."""
    time = np.linspace(-0.002, 0.012, 1401)
    phase = np.pi * time / 0.01
    factor = np.where(time > 0.005, share, 1.0) * 1e-3
    depth = factor * np.sin(phase)
    rate = factor * np.pi / 0.01 * np.cos(phase)
    change = -factor * (np.pi / 0.01) ** 2 * np.sin(phase)
    return ContactHistory(1, "a", "b", 0.02, 0.0, LinearSpring(1e8), time, depth, rate, change)


def test_a_touch_is_read_from_its_curve() -> None:
    (touch,) = touches_of(half_sine(0.5))
    assert touch.first_s == pytest.approx(0.0, abs=1e-5)
    assert touch.duration_s == pytest.approx(0.01, rel=1e-2)
    assert touch.restitution == pytest.approx(0.5, rel=1e-2)
    assert touch.depth_m == pytest.approx(1e-3, rel=1e-2)


@pytest.mark.parametrize(("share", "said"), [(0.9, 0), (1.3, 1)])
def test_floors_that_part_faster_than_they_met_are_warned_of(share: float, said: int) -> None:
    slow: Any = SimpleNamespace(
        name="a", reduced=SimpleNamespace(frequencies_hz=np.array([0.5]), turns=False)
    )
    motion: Any = SimpleNamespace(contacts=[half_sine(share)], frames=[slow])
    found = [one for one in contact_warnings(motion) if "1 of 1 touches has a restitution above 1" in one]
    assert len(found) == said


@pytest.mark.parametrize("floor_mass_kg", [6.0, 5e7])
def test_the_table_is_heavy_enough_for_buildings(floor_mass_kg: float) -> None:
    rig = Rig([shear(4, 2.0, mass_kg=floor_mass_kg), shear(3, 3.0, mass_kg=floor_mass_kg)])
    engine, exact = (rig.run(two_sines(3.0), solver=solver) for solver in ("exudyn", "exact"))
    assert engine.energy.error < 1e-5
    for one, other in zip(engine.frames, exact.frames, strict=True):
        peaks = [motion.peaks()[-1]["max_mm"] for motion in (one, other)]
        assert peaks[0] == pytest.approx(peaks[1], rel=1e-4)
