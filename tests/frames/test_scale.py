"""The scale of a frame: what a file may state, what follows from the storeys, and what follows from the scale."""

from __future__ import annotations

import math

import pytest

from pounding import frames
from pounding.frames import FrameError
from pounding.frames.cache import key
from pounding.frames.loading import parse
from pounding.frames.scale import known_scale, required_scale
from pounding.scale import FULL_SCALE, THESIS, Scale, of_time_factor

STICK = """
kind = "stick"
name = "mine"
storeys = 2
storey_height_m = [{lower}, 3.0]
floor_mass_kg = [5.0, 5.0]
damping_ratio = 0.01
frequency_hz = [2.0]
"""


def stick(lower: float = 3.0, more: str = "") -> frames.Frame:
    return parse(STICK.format(lower=lower) + more, "mine.toml")


def test_the_thesis_records_are_compressed_by_0_182() -> None:
    """Section 3.7 prints the factor with three decimals; equation 7.15 the frequencies' with three digits."""
    assert f"{THESIS.time_factor:.4f}" == "0.1826"
    assert math.floor(1e3 * THESIS.time_factor) == 182
    assert 1.0 / THESIS.time_factor == pytest.approx(5.48, rel=1e-3)
    assert pytest.approx(1.0 / 27000.0) == THESIS.force
    assert of_time_factor(THESIS.time_factor).is_near(THESIS)
    assert Scale(0.0333).is_near(THESIS)
    assert not Scale(0.033).is_near(THESIS)
    assert (str(THESIS), str(FULL_SCALE)) == ("1:30", "full scale")


@pytest.mark.parametrize("name", frames.names())
def test_every_shipped_frame_says_that_it_is_a_thirtieth(name: str) -> None:
    assert known_scale(frames.load(name)) == THESIS


@pytest.mark.parametrize(
    ("lower", "more", "scale"),
    [
        (3.0, "", FULL_SCALE),
        (2.0, "", FULL_SCALE),
        (3.0, 'scale = "1:10"', Scale(0.1)),
        (0.1, "scale = 0.05", Scale(0.05)),
        (0.1, "scale = 1", FULL_SCALE),
        (1.99, "", None),
    ],
)
def test_a_scale_is_stated_or_follows_from_the_lowest_storey(
    lower: float, more: str, scale: Scale | None
) -> None:
    assert known_scale(stick(lower, more)) == scale


def test_a_low_frame_without_a_scale_says_what_to_write() -> None:
    with pytest.raises(FrameError, match=r'frame mine: a storey of 0\.1 m .* write scale = "1:30"'):
        required_scale(stick(0.1))


@pytest.mark.parametrize(
    "stated", ["0", "-1", "30", "nan", '"30"', '"1:0"', '"1:-30"', '""', "[1]", '"1:1e9"', "1e-9"]
)
def test_what_is_no_scale_is_refused_when_the_file_is_read(stated: str) -> None:
    with pytest.raises(FrameError, match="scale"):
        stick(3.0, f"scale = {stated}")


def test_a_scale_does_not_change_the_reduced_frame() -> None:
    frame = frames.load("5A")
    settings = {"joints": "calibrated", "calibration": None}
    assert key(frames.changed(frame, scale="1:15"), settings) == key(frame, settings)


@pytest.mark.parametrize(
    "slab", ["thickness_m = 0.0", "thickness_m = 0.2, poissons_ratio = 0.6", "thickness = 0.2", ""]
)
def test_what_is_no_slab_is_refused(slab: str) -> None:
    with pytest.raises(FrameError, match=r"slab|thickness"):
        stick(3.0, f"slab = {{ {slab} }}")
