"""Buildings in a row: the street file, its contacts, and a row of three in both solvers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.contact.parameters import thesis_law
from pounding.errors import InputError
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig import street as streets
from pounding.experiments.rig import street_file
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.pounding import Pounding, built
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.states import states_of
from pounding.experiments.rig.table_scale import table_scale
from pounding.frames import load
from tests.experiments.rig.models import shear, two_sines

ROW = """
[[building]]
frame = "5A"
[[building]]
frame = "10"
[[building]]
frame = "5A"
[[gap]]
gap_mm = 3
[[gap]]
gap_mm = [2, 1.5]
floors = [5, 4]
law = "hertz_damp"
"""


def street(folder: Path, text: str = ROW) -> street_file.Street:
    (folder / "street.toml").write_text(text)
    return street_file.load_street(folder / "street.toml")


def test_contacts_of_a_street_stand_between_its_neighbours(tmp_path: Path) -> None:
    read = street(tmp_path)
    names = [one.frame for one in read.building]
    definitions = [load(name) for name in names]
    chosen = streets.chosen_sets(read, definitions, table_scale(definitions))
    row = streets.named(read, streets.built_row(read, states_of(names)))
    contacts, bases = streets.street_contacts(read, row, chosen)
    assert [frame.name for frame in row] == ["5A", "10", "5A#2"]
    assert [(one.pair, one.floors, round(1e3 * one.gap_m, 6), one.law.name) for one in contacts] == [
        (0, (5, 5), 3.0, "linear_viscoelastic"),
        (1, (5, 5), 2.0, "hertz_damp"),
        (1, (4, 4), 1.5, "hertz_damp"),
    ]
    assert [(basis.pair, basis.floor) for basis in bases] == [(0, 5), (1, 5), (1, 4)]


def test_three_frames_collide_alike_in_both_solvers() -> None:
    law = thesis_law("linear_viscoelastic", "printed", masses=(6.0, 6.0))
    row = [shear(2, hertz) for hertz in (3.0, 6.4, 2.1)]
    rig = Rig(row, [Contact(law, 0.003, 2, 0), Contact(law, 0.001, 2, 1)])
    runs = [rig.run(two_sines(1.2), solver=solver) for solver in ("exudyn", "exact")]
    pulses = [[len(contact.pulses) for contact in run.contacts] for run in runs]
    assert pulses[0] == pulses[1]
    assert min(pulses[0]) > 3
    peaks = [[contact.sampled()[1].max() for contact in run.contacts] for run in runs]
    np.testing.assert_allclose(peaks[0], peaks[1], rtol=2e-3)


def test_a_result_names_each_building_of_a_row() -> None:
    law = thesis_law("linear_viscoelastic", "printed", masses=(6.0, 6.0))
    rig = Rig([shear(2, hertz) for hertz in (3.0, 6.4, 2.1)], [Contact(law, 0.001, 2, 1)])
    record = two_sines(0.5)
    run = Pounding(record, rig.run(record, solver="exact"), [])
    result = run.result() | run.validity()
    names = [frame.name for frame in rig.frames]
    assert list(result["peaks"]) == list(result["ductility"]) == list(result["max_stress_mpa"]) == names
    assert result["buildings"] == names
    assert "left" not in result


def test_a_contact_off_the_middle_twists_the_floors(tmp_path: Path) -> None:
    read = street(tmp_path, ROW.replace("gap_mm = 3", "gap_mm = 3\ny_m = 0.15"))
    row = streets.built_row(read, states_of([one.frame for one in read.building]))
    assert [len(frame.floor_rz) for frame in row] == [5, 10, 0]


HOUSE = 'kind = "stick"\nname = "house"\nstoreys = 1\nstorey_height_m = 3\nfloor_mass_kg = [1e5]\nplan_m = [12, 9]\n'


@pytest.mark.parametrize(
    ("key", "y_m", "sentence"),
    [
        ("", 1, "is a stick whose floors do not turn, as a contact off the middle asks for; state a table"),
        ("torsion = { frequency_ratio = 1.2 }", 5, "y = 5 m is off its floors, which are 9 m wide; correct"),
    ],
)
def test_a_contact_off_the_middle_that_a_stick_cannot_have(
    tmp_path: Path, key: str, y_m: float, sentence: str
) -> None:
    (tmp_path / "house.toml").write_text(HOUSE + f"frequency_hz = [2.0]\ndamping_ratio = 0.05\n{key}\n")
    pair = '[[building]]\nframe = "house.toml"\n' * 2 + f"[[gap]]\ngap_mm = 3\ny_m = {y_m}\nstiffness = 1e9\n"
    read = street(tmp_path, pair)
    names = [one.frame for one in read.building]

    def stand() -> None:
        row = streets.built_row(read, states_of(names))
        Rig(row, streets.street_contacts(read, row, ["floors"])[0])

    with pytest.raises(InputError, match=sentence):
        stand()


def test_several_places_of_an_edge_share_the_strip_of_the_slab(tmp_path: Path) -> None:
    keys = "frequency_hz = [2.0]\ndamping_ratio = 0.05\nslab = { thickness_m = 0.2 }\n"
    (tmp_path / "house.toml").write_text(HOUSE + keys + "torsion = { frequency_ratio = 1.2 }\n")
    found = []
    for places in ("0.0", "[-3, 0, 3]"):
        pair = '[[building]]\nframe = "house.toml"\n' * 2 + f"[[gap]]\ngap_mm = 3\ny_m = {places}\n"
        read = street(tmp_path, pair)
        row = streets.built_row(read, states_of([one.frame for one in read.building]))
        found.append(streets.street_contacts(read, row, ["floors"]))
    ((whole,), _), (shares, bases) = found
    assert [one.y_m for one in shares] == [-3.0, 0.0, 3.0]
    assert [one.law.stiffness for one in shares] == pytest.approx([whole.law.stiffness / 3.0] * 3)
    # The same damping ratio and a third of the stiffness; off the middle, less mass.
    assert shares[1].law.damping == pytest.approx(whole.law.damping / 3.0**0.5)
    assert shares[0].law.damping == shares[2].law.damping < shares[1].law.damping
    assert "one of 3 places that share E A / L of the slab strip" in bases[0].sentence


def test_frame_files_are_found_beside_the_street_file(tmp_path: Path) -> None:
    (tmp_path / "house.toml").write_text("")
    read = street(tmp_path, ROW.replace('"5A"', '"house.toml"'))
    assert [one.frame for one in read.building] == [
        str(tmp_path / "house.toml"),
        "10",
        str(tmp_path / "house.toml"),
    ]


@pytest.mark.parametrize(
    ("wrong", "right", "sentence"),
    [
        ("gap_mm = 3", "gap_mm = -3", "gap_mm is -3 mm; it must be"),
        ("gap_mm = 3", "gap_mm = nan", "gap_mm is nan mm"),
        ("gap_mm = 3", "gap_m = 3", "expected gap_mm (mind the unit)"),
        ("gap_mm = 3", "gap_mm = []", "gap_mm is empty"),
        (
            "gap_mm = 3",
            'gap_mm = "3"',
            "gap_mm of gap 1: expected a number or a list in square brackets, found a text",
        ),
        ('frame = "10"', "name = 'x'", "building 2: the key frame is missing; add it"),
        (
            "gap_mm = 3",
            "gap_mm = 3\ncolumns = { count = 2.5, depth_m = 1, width_m = 1 }",
            "count of columns of gap 1: expected a whole number, found a number with a fraction",
        ),
        ("gap_mm = 3", 'gap_mm = 3\nlaw = "hertzz"', "hertzz"),
        ("gap_mm = 3", "gap_mm = 3\nstiffness = -1", "stiffness is -1"),
        ("[[gap]]\ngap_mm = 3\n", "", "1 [[gap]] for 3 buildings; give 2"),
        ('frame = "10"', 'frame = "10"\nname = "../x"', "files are called after it"),
        ("gap_mm = 3", "gap_mm = 3\nbumper = { thickness_mm = -1, area_m2 = 1 }", "thickness_mm is -1 mm"),
        ("gap_mm = 3", "gap_mm = 3\nbumper = { thickness_mm = 1, area = 1 }", "area"),
        ("gap_mm = 3", "gap_mm = 3\ny_m = [1, 1]", "y_m is [1.0, 1.0]; give one place or several, each once"),
        ("gap_mm = 3", "gap_mm = 3\ny_m = []", "y_m is []; give one place"),
        ("gap_mm = 3", "gap_mm = 3\ny_m = inf", "y_m is larger than any number"),
        ('frame = "10"', 'fram = "10"', "did you mean frame"),
        ("[[building]]", "[building]", ""),
        (ROW, '[[building]]\nframe = "5A"\n', "1 [[building]]; a street has two or more"),
    ],
)
def test_a_street_that_cannot_be(tmp_path: Path, wrong: str, right: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        street(tmp_path, ROW.replace(wrong, right))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("wrong", "right", "sentence"),
    [
        ("floors = [5, 4]", "floors = [5, 5]", "each can be given once"),
        ("floors = [5, 4]", "floors = [5]", "2 gaps for 1 floor"),
        ("floors = [5, 4]", "floors = [6, 5]", "floor 6 cannot meet"),
    ],
)
def test_floors_that_cannot_meet(tmp_path: Path, wrong: str, right: str, sentence: str) -> None:
    read = street(tmp_path, ROW.replace(wrong, right))
    row = [built(one.frame) for one in read.building]
    with pytest.raises(ExperimentError, match=sentence):
        streets.street_contacts(read, row, ["printed", "printed"])


def test_a_bumper_takes_part_of_the_gap_and_the_place_of_the_contact(tmp_path: Path) -> None:
    bumper = "gap_mm = 3\nbumper = { thickness_mm = 2, area_m2 = 1e-4, modulus_mpa = 4 }"
    read = street(tmp_path, ROW.replace("gap_mm = 3", bumper))
    row = [built(one.frame) for one in read.building]
    contacts, bases = streets.street_contacts(read, row, ["floors", "printed"])
    assert contacts[0].gap_m == pytest.approx(0.001)
    assert contacts[0].law.name == "rubber_block"
    assert contacts[0].law.stiffness == pytest.approx(4e6 * 1e-4 / 0.002)
    assert "0.0001 m2 of 2 mm and 4 MPa" in bases[0].sentence
    thick = street(tmp_path, ROW.replace("gap_mm = 3", bumper.replace("= 2", "= 4")))
    with pytest.raises(ExperimentError, match="a bumper of 4 mm does not fit into a gap of 3 mm"):
        streets.street_contacts(thick, row, ["floors", "printed"])


def test_a_frame_file_is_no_street_file(tmp_path: Path) -> None:
    street(tmp_path)
    (tmp_path / "frame.toml").write_text('kind = "stick"\n')
    assert street_file.is_street_file(str(tmp_path / "street.toml"))
    assert not street_file.is_street_file(str(tmp_path / "frame.toml"))
    assert not street_file.is_street_file("5A")
    assert not street_file.is_street_file(str(tmp_path / "nothing.toml"))
