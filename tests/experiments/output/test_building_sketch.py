"""The drawing of buildings on a report's first page."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from pounding.experiments.output.building_sketch import Marked, Outline, building_sketch

OFFICE, FLATS = Outline("office", [4.0, 7.2, 10.4]), Outline("<flats> & more", [4.0, 8.0, 12.0, 16.0])


def drawn(*marks: Marked) -> ElementTree.Element:
    return ElementTree.fromstring(building_sketch([OFFICE, FLATS], marks))


def test_names_and_gaps_are_written_and_escaped() -> None:
    words = [one.text for one in drawn(Marked(0, 10.4, "60 / 213")).iter("text")]
    assert words == ["office", "<flats> & more", "60 / 213"]


def test_heights_are_to_scale_and_the_gap_is_drawn_where_they_meet() -> None:
    lines = list(drawn(Marked(0, 10.4, "60 mm")).iter("line"))
    ground = float(lines[0].attrib["y1"])
    levels = sorted(
        {ground - float(one.attrib["y1"]) for one in lines if one.attrib["y1"] == one.attrib["y2"]}
    )
    scale = max(levels) / 16.0
    assert [level / scale for level in levels] == pytest.approx(
        [0.0, 4.0, 7.2, 8.0, 10.4, 12.0, 16.0], abs=0.01
    )
    arrow = lines[-1]
    assert (ground - float(arrow.attrib["y1"])) / scale == pytest.approx(10.4, abs=0.01)


def test_what_is_not_enough_has_another_colour() -> None:
    good, bad = (building_sketch([OFFICE, FLATS], [Marked(0, 4.0, "5 mm", bad)]) for bad in (False, True))
    assert len(set(re.findall(r"#[0-9a-f]{6}", bad))) == len(set(re.findall(r"#[0-9a-f]{6}", good))) + 1
