import numpy as np
import pytest

from pounding import frames
from pounding.frames.floors import level_floors


def heights(storey_m, count):
    return storey_m * np.arange(1, count + 1)


def test_floors_of_the_thesis_are_level_at_equal_numbers():
    found = level_floors(frames.load("15B").floor_heights_m, frames.load("10").floor_heights_m)
    assert found == [(number, number) for number in range(1, 11)]


def test_storeys_of_100_and_150_mm_are_level_at_every_third_floor_of_the_one():
    assert level_floors(heights(0.10, 6), heights(0.15, 4)) == [(3, 2), (6, 4)]
    assert level_floors(heights(0.15, 4), heights(0.10, 6)) == [(2, 3), (4, 6)]


@pytest.mark.parametrize("scale", [1.0, 30.0])
@pytest.mark.parametrize(("offset_m", "level"), [(0.0049, True), (-0.0047, True), (0.0051, False)])
def test_a_floor_within_its_thickness_is_level_at_any_scale(scale, offset_m, level):
    other = heights(0.10, 2) + [0.0, offset_m]
    assert ((2, 2) in level_floors(scale * heights(0.10, 2), scale * other)) == level


def test_heights_of_uneven_storeys_are_added_up():
    stick = frames.StickFrame(
        name="s",
        storeys=3,
        storey_height_m=[0.2, 0.1, 0.1],
        floor_mass_kg=[1.0] * 3,
        damping_ratio=0.01,
        storey_stiffness_n_per_m=[1e4] * 3,
    )
    assert stick.floor_heights_m == pytest.approx([0.2, 0.3, 0.4])
    np.testing.assert_array_equal(frames.build(stick).heights_m, stick.floor_heights_m)
    assert level_floors(stick.floor_heights_m, heights(0.1, 3)) == [(1, 2), (2, 3)]
