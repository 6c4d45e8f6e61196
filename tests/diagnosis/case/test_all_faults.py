"""All that is wrong with a case is listed at once, each with its line in the file as it stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.all_faults import all_faults
from pounding.diagnosis.errors import CaseError
from pounding.experiments.command.check_case import check_case

CASE = """\
[[frame]]
name = "5A"

[[run]]
file = "run1.csv"

[[run]]
file = "run2.csv"
rle = "training"

[[channel]]
name = "table"
quantity = "table_acceleration"
unit = "g"

[[channel]]
name = "a3"
floor = 3
quantity = "acceleration"
unit = "g"

[[channel]]
name = "a4"
floor = 9
quantity = "absolute_acceleration"
unit = "g"

[[channel]]
name = "a5"
floor = 5
quantity = "absolute_acceleration"
unit = "furlong"

[[channel]]
name = "d5"
floor = 5
quantity = "relative_displacement"
unit = "mm"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    time = 0.002 * np.arange(64)
    for number, last in ((1, "d5"), (2, "d_5")):
        rows = np.column_stack([time, *[np.sin(time)] * 5])
        header = f"time_s,table,a3,a4,a5,{last}"
        np.savetxt(tmp_path / f"run{number}.csv", rows, delimiter=",", header=header, comments="", fmt="%.6f")
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


def test_all_faults_are_found_with_their_lines(folder: Path):
    said = [
        "case.toml line 9: run 'run2.csv': unknown key 'rle'; did you mean 'role'?",
        "case.toml line 19: channel 'a3': unknown quantity 'acceleration'; say which: table_acceleration, absolute",
        "case.toml line 24: channel 'a4': floor 9 is not on 5A, which has 5",
        "case.toml line 32: channel 'a5': unit 'furlong' is none of absolute_acceleration's; use one of m/s^2, g, cm/s^2",
        "run2.csv line 1: no column for channel 'd5'; did you mean 'd_5'?",
    ]
    found = all_faults(folder)
    assert len(found) == len(said)
    for fault, begins in zip(found, said, strict=True):
        assert fault.startswith(begins)


def test_a_case_that_can_be_read_has_none(folder: Path, capsys: pytest.CaptureFixture[str]):
    text = CASE.replace('rle = "training"\n', "").replace('"acceleration"', '"absolute_acceleration"')
    text = text.replace("floor = 9", "floor = 4").replace("furlong", "g")
    (folder / "case.toml").write_text(text)
    time = 0.002 * np.arange(64)
    for number in (1, 2):
        # As long as the first mode of 5A takes to go to and fro, or longer.
        rows = np.column_stack([time, *[number * np.sin(20 * time)] * 5])
        header = "time_s,table,a3,a4,a5,d5"
        np.savetxt(folder / f"run{number}.csv", rows, delimiter=",", header=header, comments="", fmt="%.6f")
    assert all_faults(folder) == []
    check_case(folder)
    assert "can be read" in capsys.readouterr().out
    (folder / "run2.csv").write_bytes((folder / "run1.csv").read_bytes())
    with pytest.raises(CaseError, match=r"run2\.csv: has the same samples as run1\.csv"):
        check_case(folder)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[frame", "is not TOML"),
        (CASE.replace('"5A"', '"5Z"'), "frame '5Z' is not known"),
        (CASE.replace("table_acceleration", "relative_displacement"), "channel 'table'"),
    ],
)
def test_what_nothing_more_can_be_said_of_ends_the_list(folder: Path, text: str, said: str):
    (folder / "case.toml").write_text(text)
    assert any(said in fault for fault in all_faults(folder))


def test_the_command_numbers_them_and_ends_with_an_error(folder: Path, capsys: pytest.CaptureFixture[str]):
    with pytest.raises(CaseError, match="5 things have to be corrected"):
        check_case(folder)
    assert [line[:2] for line in capsys.readouterr().out.splitlines()] == [f"{n}." for n in range(1, 6)]


def test_a_folder_without_a_case_is_one_sentence(tmp_path: Path):
    assert all_faults(tmp_path) == [
        f"{tmp_path} holds no case.toml; a case is a folder with case.toml and its CSV files"
    ]


def _said(folder: Path, *changes: tuple[str, str]) -> list[str]:
    """Return the faults of the case without its faults, but with some changes."""
    text = CASE.replace('rle = "training"\n', "").replace('"acceleration"', '"absolute_acceleration"')
    text = text.replace("floor = 9", "floor = 4").replace("furlong", "g")
    run = (folder / "run1.csv").read_text()
    (folder / "run2.csv").write_text(run)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "case.toml").write_text(text)
    return all_faults(folder)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('[[frame]]\nname = "5A"', '[[frame]]\nname = "5Z"'), "15B, 8, 12. A frame of your own needs"),
        (('name = "5A"', 'name = "5A"\ncolor = "red"'), "unknown key 'color'"),
        (('name = "5A"', 'name = "5A"\njoints = "soft"'), "joints is 'soft'"),
        (('[[frame]]\nname = "5A"', 'titel = "x"\n[[frame]]\nname = "5A"'), "unknown key 'titel'"),
        (("table_acceleration", "absolute_acceleration"), "channel 'table': the key 'floor' is missing"),
        (('"run1.csv"', '"run1.csv"\nrole = "heldout"'), "unknown role 'heldout'"),
        (('[[frame]]\nname = "5A"', ""), "there is no [[frame]]"),
    ],
)
def test_one_fault_hides_no_other(folder: Path, change: tuple[str, str], said: str):
    found = _said(
        folder, change, ('"mm"\n', '"furlong"\n[prior]\nfloor_mass = -1\n'), ('"run2.csv"', '"run9.csv"')
    )
    assert len(found) == 4
    for words in (said, "unit 'furlong'", "[prior] floor_mass", "run9.csv is not there"):
        assert sum(words in fault for fault in found) == 1


def test_what_only_follows_from_a_fault_is_none(folder: Path):
    assert len(_said(folder, ('[[frame]]\nname = "5A"', '[[frame]]\nname = "5Z"'))) == 1
    held_out = ('"run2.csv"', '"run2.csv"\nrole = "held_out"')
    assert len(_said(folder, held_out, ('"run1.csv"', '"run1.csv"\nrole = "heldout"'))) == 1
    assert len(_said(folder, ('"table_acceleration"', '"acceleration"'))) == 1


def test_of_two_frame_files_that_cannot_be_read_each_is_said_once(folder: Path):
    files = '[[frame]]\nfile = "one.toml"\n\n[[frame]]\nfile = "other.toml"'
    found = _said(folder, ('[[frame]]\nname = "5A"', files))
    assert [name for name in ("one.toml", "other.toml") if any(name in fault for fault in found)] == [
        "one.toml",
        "other.toml",
    ]
    assert not any("twice" in fault for fault in found)


def test_unit_and_floor_of_one_channel(folder: Path):
    found = _said(folder, ('floor = 3\nquantity = "absolute_acceleration"\nunit = "g"', ODD))
    assert len(_said(folder, ('floor = 3\nquantity = "absolute_acceleration"\nunit = "g"', "unit = 3"))) == 1
    assert [words in fault for words, fault in zip(("'furlong'", "floor 9"), found, strict=True)] == [
        True
    ] * 2


ODD = 'floor = 9\nquantity = "absolute_acceleration"\nunit = "furlong"'


def test_each_column_of_a_run_is_read_alone(folder: Path):
    lines = (folder / "run1.csv").read_text().splitlines()
    lines[4] = ",".join([lines[4].split(",")[0], "x", "y", *lines[4].split(",")[3:]])
    (folder / "run1.csv").write_text("\n".join(lines) + "\n")
    found = _said(folder, ('name = "d5"', 'name = "zzz"'))
    begins = [f"run{run}.csv line {line}" for run in (1, 2) for line in (1, 5, 5)]
    assert [fault[: len(begin)] for fault, begin in zip(found, begins, strict=True)] == begins
