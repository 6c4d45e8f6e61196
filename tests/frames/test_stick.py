import numpy as np
import pytest

from pounding import frames
from pounding.frames.errors import FrameError

STICK = {
    "kind": "stick",
    "name": "bench",
    "storeys": 3,
    "storey_height_m": 0.2,
    "floor_mass_kg": [6.5, 6.5, 6.5],
}


def stick(**fields):
    return frames.from_mapping(STICK | {"damping_ratio": 0.005} | fields, "case.toml")


def test_stated_storeys_are_taken_as_they_are():
    reduced = frames.build(stick(storey_stiffness_n_per_m=[20e3, 20e3, 20e3]))
    j = np.arange(1, 4)
    exact = np.sqrt(20e3 / 6.5) * 2 * np.sin((2 * j - 1) * np.pi / (2 * (2 * 3 + 1))) / (2 * np.pi)
    assert reduced.frequencies_hz == pytest.approx(exact)
    assert reduced.roof_stiffness_n_per_m == pytest.approx(20e3 / 3)
    assert reduced.storey_model()[1] == pytest.approx(reduced.stiffness)
    assert reduced.influence == pytest.approx(np.ones(3))


@pytest.mark.parametrize("wanted", [[2.1], [2.1, 6.0], [2.1, 6.0, 8.5]])
def test_stated_frequencies_are_met(wanted):
    reduced = frames.build(stick(frequency_hz=wanted))
    assert reduced.frequencies_hz[: len(wanted)] == pytest.approx(wanted, rel=2e-6)


def test_one_frequency_gives_equal_storeys():
    _, stiffness, _ = frames.build(stick(frequency_hz=[2.1])).storey_model()
    assert -np.diag(stiffness, 1) == pytest.approx(stiffness[2, 2])


def test_damping_ratios_belong_to_their_modes():
    reduced = frames.build(stick(frequency_hz=[2.1, 6.0], damping_ratio=[0.004, 0.01]))
    modal = reduced.shapes.T @ reduced.damping @ reduced.shapes
    ratios = np.diag(modal) / (4 * np.pi * reduced.frequencies_hz)
    assert ratios == pytest.approx([0.004, 0.01, 0.01])
    assert reduced.damping_ratio == pytest.approx(0.004)
    assert frames.build(reduced.definition, damping=0.02).damping_ratios == pytest.approx([0.02] * 3)


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"frequency_hz": [2.1, 30.0]}, "no storeys with these floor masses have the frequencies"),
        ({"frequency_hz": [6.0, 2.1]}, "must rise"),
        ({"frequency_hz": [2.1], "floor_mass_kg": [6.5, -6.5, 6.5]}, "floor 2 is -6.5"),
        ({"frequency_hz": [2.1], "floor_mass_kg": [6.5]}, "one for each of 3 storeys"),
        ({}, "either storey_stiffness_n_per_m or frequency_hz"),
        ({"frequency_hz": [2.1], "storeys": 0}, "storeys is 0"),
        ({"frequency_hz": [2.1], "damping_ratio": 0.5e2}, "0.5 % is 0.005"),
        ({"frequency_khz": [2.1]}, "expected frequency_hz"),
    ],
)
def test_what_is_wrong_is_said(fields, sentence):
    with pytest.raises(FrameError, match=sentence):
        frames.build(stick(**fields))


def test_a_stick_has_no_mesh():
    with pytest.raises(FrameError, match="a stick has no plates"):
        frames.build(stick(frequency_hz=[2.1])).expand(np.zeros(3))
