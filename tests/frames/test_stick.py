import numpy as np
import pytest
from scipy.optimize import brentq

from pounding import frames
from pounding.frames.errors import FrameError
from pounding.frames.loading import from_mapping

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


@pytest.mark.parametrize(("ratio", "second"), [(0.0, 6.267), (1000.0, 3.0)])
def test_a_bending_shear_stick_lies_between_a_cantilever_that_bends_and_one_that_shears(ratio, second):
    # The continuous beams: (4.6941 / 1.8751)^2 and 3.
    tall = stick(storeys=80, floor_mass_kg=[6.5] * 80, frequency_hz=[0.2], stiffness_ratio=ratio)
    frequencies = frames.build(tall).frequencies_hz
    assert frequencies[0] == pytest.approx(0.2)
    assert frequencies[1] / frequencies[0] == pytest.approx(second, rel=0.01)


def _of_the_beam(ratio, count):
    """The lowest frequencies of the continuous beam, EI = m = H = 1, clamped below and free above."""

    def boundary(w):
        half = ratio**2 / 2
        g, b = np.sqrt(np.hypot(half, w) - half), np.sqrt(np.hypot(half, w) + half)
        # Deflection in cos(g x), sin(g x), cosh(b x), sinh(b x): none and no slope below, no moment and no shear above.
        rows = [
            [1, 0, 1, 0],
            [0, g, 0, b],
            [-(g**2) * np.cos(g), -(g**2) * np.sin(g), b**2 * np.cosh(b), b**2 * np.sinh(b)],
            [g * b**2 * np.sin(g), -g * b**2 * np.cos(g), b * g**2 * np.sinh(b), b * g**2 * np.cosh(b)],
        ]
        return np.linalg.det(rows) / np.cosh(b)

    grid = np.linspace(0.5, 400.0, 4000)
    values = [boundary(w) for w in grid]
    signs = np.flatnonzero(np.diff(np.sign(values)))
    return np.array([brentq(boundary, grid[i], grid[i + 1]) for i in signs[:count]])


@pytest.mark.parametrize("ratio", [1.0, 3.0, 8.0])
def test_a_bending_shear_stick_of_many_storeys_is_the_beam(ratio):
    tall = stick(storeys=120, floor_mass_kg=[6.5] * 120, frequency_hz=[0.2], stiffness_ratio=ratio)
    found, exact = frames.build(tall).frequencies_hz[:3], _of_the_beam(ratio, 3)
    assert found / found[0] == pytest.approx(exact / exact[0], rel=0.01)


def test_the_ratios_of_the_docs_are_the_computed_ones():
    printed = {0.0: 6.30, 1.0: 5.54, 2.0: 4.53, 5.0: 3.44, 10.0: 3.15, 30.0: 3.00}
    for ratio, second in printed.items():
        tall = stick(storeys=10, floor_mass_kg=[300e3] * 10, frequency_hz=[0.8], stiffness_ratio=ratio)
        frequencies = frames.build(tall).frequencies_hz
        assert frequencies[1] / frequencies[0] == pytest.approx(second, abs=0.006)


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
        ({"frequency_hz": [2.1], "stiffness_ratio": -1.0}, "stiffness_ratio is -1"),
        ({"frequency_hz": [2.1], "stiffness_ratio": float("nan")}, "stiffness_ratio is "),
        ({"frequency_hz": [2.1, 6.0], "stiffness_ratio": 2.0}, "first frequency alone"),
        (
            {"frequency_hz": [2.1], "stiffness_ratio": 2.0, "yielding": {"storey_shear_n": 1e3}},
            "stiffness_ratio and yielding exclude each other",
        ),
        ({}, "either storey_stiffness_n_per_m or frequency_hz"),
        ({"frequency_hz": [2.1], "storeys": 0}, "storeys is 0"),
        ({"frequency_hz": [2.1], "damping_ratio": 0.5e2}, "0.5 % is 0.005"),
        ({"frequency_khz": [2.1]}, "expected frequency_hz"),
    ],
)
def test_what_is_wrong_is_said(fields, sentence):
    with pytest.raises(FrameError, match=sentence):
        frames.build(stick(**fields))


def test_one_number_stands_for_all_storeys():
    short = {"kind": "stick", "name": "short", "storeys": 3, "storey_height_m": 3.2, "damping_ratio": 0.05}
    one = from_mapping(short | {"floor_mass_kg": 3e5, "frequency_hz": 1.2})
    assert one.floor_mass_kg == [3e5] * 3
    assert one.frequency_hz == [1.2]
    assert (
        from_mapping(short | {"floor_mass_kg": 3e5, "storey_stiffness_n_per_m": 2e8}).storey_stiffness_n_per_m
        == [2e8] * 3
    )


def test_a_stick_has_no_mesh():
    with pytest.raises(FrameError, match="a stick has no plates"):
        frames.build(stick(frequency_hz=[2.1])).expand(np.zeros(3))
