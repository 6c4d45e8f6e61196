import re
from pathlib import Path

import msgspec
import pytest

from pounding import frames
from pounding.frames.errors import FrameError
from pounding.frames.loading import load, parse

PLATE = """
kind = "plate"
name = "mine"
storeys = 3
storey_height_m = 0.1
damping_ratio = 0.005
[plate]
length_m = 0.4
width_m = 0.4
thickness_m = 0.005
[columns]
width_m = 0.04
thickness_m = 0.002
[joints]
default = "guess"
[joints.stiffness_n_m_per_rad]
guess = 900.0
"""


def test_every_shipped_frame_loads():
    assert frames.names() == ["5A", "5B", "10", "15A", "15B", "8", "12"]
    for name in frames.names():
        frame = frames.load(name)
        assert frame.name == name
        assert frame.storeys == int(name.rstrip("AB"))


@pytest.mark.parametrize(("name", "mass"), [("5A", 32.656), ("10", 65.312), ("15B", 97.968)])
def test_mass_is_that_of_the_plates(name, mass):
    assert frames.load(name).moving_mass_kg == pytest.approx(mass, abs=1e-9)


def test_stated_masses_hold_a_base_plate():
    # 10, 15A, 15B, 8 and 12: stated mass less a base plate like a floor is the plates' own within 1 %.
    for name in ("10", "15A", "15B", "8", "12"):
        frame = frames.load(name)
        rest = frame.published.mass_kg - frame.floor_plate_mass_kg
        assert rest == pytest.approx(frame.moving_mass_kg, rel=0.011)


def test_added_masses_of_chapter_7_need_the_plates_mass():
    # Tables 7.2 to 7.4: 20, 30, 40 kg take the 10-storey frame from 3.53 to 3.09, 2.92, 2.78 Hz.
    moving = [added / ((3.53 / f) ** 2 - 1.0) for added, f in ((20.0, 3.09), (30.0, 2.92), (40.0, 2.78))]
    assert moving == pytest.approx([frames.load("10").moving_mass_kg] * 3, rel=0.01)


def test_a_file_is_a_frame(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(PLATE)
    frame = frames.load(path)
    assert (frame.storeys, frame.material.youngs_modulus_gpa) == (3, 200.0)
    assert frame.joint_stiffness() == 900.0


def test_weights_are_those_above_mid_height():
    frame = parse(PLATE, "mine")
    floor, column = 0.4 * 0.4 * 0.005 * 7850.0, 4 * 0.04 * 0.002 * 0.1 * 7850.0
    expected = [9.80665 * (n * floor + (n - 0.5) * column) for n in (3, 2, 1)]
    assert frame.weights_n() == pytest.approx(expected)


WRONG = {
    "thickness_m = 0.005": ("thickness_m = 0.0", "plate.thickness_m is 0 m; it must be 1e-05 to 100 m"),
    "storeys = 3": ("storeys = 0", "storeys is 0"),
    "name = ": ("storey_height_mm = 100.0\nname = ", "expected storey_height_m"),
    "guess = 900.0": ("guess = -1.0", "guess is -1 N m/rad; it must be"),
    'default = "guess"': ('default = "measured"', "not one of guess"),
    "width_m = 0.04\n": ("width_m = 0.04\nplaces_m = [[0.0, 0.0], [0.21, 0.0]]\n", "column 2 at x = 0.21 m"),
    "damping_ratio = 0.005": ("damping_ratio = 1.5", "0.5 % is 0.005"),
    'kind = "plate"': ('kind = "dome"', 'must be "plate" or "stick"'),
    "[plate]": ("colour = 3\n[plate]", "'colour' is not a key of a frame"),
    "length_m = 0.4": ('length_m = "long"', "length_m of plate: expected a number, found a text in quotes"),
    "[columns]": ("[columns", "not TOML"),
    "kind": ("added_mass_kg = [1.0, -2.0, 0.0]\nkind", "added_mass_kg of floor 2 is -2.0"),
    "storeys = 3\n": ("storeys = 3\nnonstructural_mass_kg = -40.0\n", "must stay positive"),
    "width_m = 0.04": ("width_m = 0.04\nthicknes_m = 0.002", "did you mean thickness_m"),
    "damping_ratio = 0.005\n": ("damping_ratio = 0.005\nmass_eccentricity_m = 0.07\n", "below a sixth"),
    "[joints]": ("[material]\nyoungs_modulus_pa = 2e11\n[joints]", "expected youngs_modulus_gpa"),
}


@pytest.mark.parametrize("place", WRONG)
def test_what_is_wrong_is_said_in_one_sentence(place):
    right, sentence = WRONG[place]
    with pytest.raises(FrameError) as failure:
        parse(PLATE.replace(place, right, 1), "mine.toml")
    message = str(failure.value)
    assert sentence in message
    assert "mine.toml" in message
    assert len(message) < 250 or "; known are " in message


def test_a_missing_key_is_named():
    with pytest.raises(FrameError, match="storey_height_m"):
        parse(PLATE.replace("storey_height_m = 0.1", ""), "mine.toml")


@pytest.mark.parametrize(
    ("typed", "near"), [("15C", "15A or 15B"), ("5a", "5A"), ("5-A", "5A"), ("15-b", "15B")]
)
def test_a_wrong_name_suggests_the_near_one(typed, near):
    with pytest.raises(FrameError, match=f"did you mean {near}"):
        load(typed)


def test_a_missing_file_is_said():
    with pytest.raises(FrameError, match=r"nowhere\.toml: No such file"):
        load("nowhere.toml")


def test_changed_checks_again():
    frame = frames.load("5A")
    heavier = frames.changed(frame, added_mass_kg=[2.0] * 5)
    assert heavier.moving_mass_kg == pytest.approx(frame.moving_mass_kg + 10.0)
    with pytest.raises(FrameError, match="needs one for each of 5 storeys"):
        frames.changed(frame, added_mass_kg=[2.0])
    with pytest.raises(FrameError, match="no field weight"):
        frames.changed(frame, weight=1.0)


def test_frames_cannot_be_changed_by_accident():
    with pytest.raises(AttributeError):
        frames.load("5A").storeys = 6


def test_definition_survives_a_round_trip():
    frame = frames.load("15B")
    assert frames.from_mapping(msgspec.to_builtins(frame)) == frame


GUIDE = Path(__file__).parents[2] / "docs" / "your-own-frame.md"


# A table of yielding storeys goes at the end of a frame's file.
@pytest.mark.parametrize(("parts", "first_hz"), [((0,), 4.87), ((0, 1), 4.87), ((2,), 1.1), ((3,), 0.8)])
def test_the_guides_frames_can_be_built(parts, first_hz):
    blocks = re.findall(r"```toml\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 4
    text = "".join(blocks[number] for number in parts)
    assert frames.build(parse(text, "guide")).frequencies_hz[0] == pytest.approx(first_hz, rel=1e-3)
