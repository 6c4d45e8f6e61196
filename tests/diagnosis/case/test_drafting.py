"""What a column measures is guessed from its name, and what the name does not say is marked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.drafting import Standing, draft, guess, header_of
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.errors import CaseError
from pounding.experiments.command.new_case import new_case
from pounding.frames.templates import template

FIVE = Standing("5A", 5)


@pytest.mark.parametrize(
    ("name", "quantity", "unit", "floor", "doubts"),
    [
        ("table_acc [g]", "table_acceleration", "g", None, 0),
        ("Base acceleration (m/s2)", "table_acceleration", "m/s^2", None, 0),
        ("acc_floor_3_g", "absolute_acceleration", "g", 3, 0),
        ("a5_m_s2", "absolute_acceleration", "m/s^2", 5, 0),
        ("roof acc (gal)", "absolute_acceleration", "cm/s^2", 5, 1),
        ("rel disp 2 (mm)", "relative_displacement", "mm", 2, 0),
        ("LVDT 4", "relative_displacement", "mm", 4, 2),
        ("table disp [mm]", "table_displacement", "mm", None, 0),
        ("table", "table_acceleration", "m/s^2", None, 1),
        ("acc 9 [g]", "absolute_acceleration", "g", 9, 1),
        ("impact load cell [kN]", "contact_force", "kN", None, 0),
        ("roof acc [ft/s2]", "absolute_acceleration", "m/s^2", 5, 2),
    ],
)
def test_a_column_is_guessed_from_its_name(name, quantity, unit, floor, doubts):
    found = guess(name, [FIVE])
    assert (found.quantity, found.unit, found.floor, len(found.doubts)) == (quantity, unit, floor, doubts)


@pytest.mark.parametrize(
    ("name", "frame", "floor", "doubts"),
    [
        ("acc 15B floor 3 [g]", "15B", 3, 0),
        ("5B_a3_m_s2", "5B", 3, 0),
        ("a5 5B [g]", "5B", 5, 0),
        ("right roof acc [g]", "5B", 5, 1),
        ("left acc 12 [g]", "15B", 12, 0),
        ("acc 4 [g]", "15B", 4, 1),
        ("right acc 7 [g]", "5B", 7, 1),
        ("table acc [g]", None, None, 0),
    ],
)
def test_of_two_frames_the_one_in_the_name_is_taken(name, frame, floor, doubts):
    found = guess(name, [Standing("15B", 15), Standing("5B", 5)])
    assert (found.frame, found.floor, len(found.doubts)) == (frame, floor, doubts)


def test_two_frames_become_a_pair_with_a_contact_that_can_be_read(tmp_path):
    file = _logger(tmp_path / "run1.csv", "Time (s),Table acc [g],15B acc 15 [g],5B acc 5 [g],load cell [N]")
    new_case(file, frame=["15B", "5B"], out=tmp_path / "case")
    case = read_case(tmp_path / "case")
    assert [(c.frame, c.floor, c.contact) for c in case.channels] == [
        (None, None, None),
        ("15B", 15, None),
        ("5B", 5, None),
        (None, None, 1),
    ]
    (contact,) = case.contacts
    assert (contact.left, contact.right, contact.floor) == ("15B", "5B", 5)


def test_frames_that_make_no_pair_are_one_sentence(tmp_path):
    file = _logger(tmp_path / "run1.csv")
    with pytest.raises(CaseError, match="3 frames were given; a case has one, or two that may touch"):
        new_case(file, frame=["5A", "5B", "10"], out=tmp_path / "case")
    with pytest.raises(CaseError, match="both frames are called '5A'"):
        new_case(file, frame=["5A", "5A"], out=tmp_path / "case")


def test_a_name_that_says_nothing_stays_a_comment():
    assert guess("CH07", [FIVE]).quantity is None
    text = draft([FIVE], ["run1.csv"], ["CH07"])
    assert '# column "CH07": its name says nothing' in text
    assert "[[channel]]" not in text


def _logger(path: Path, header: str = "Time (s),Table acc [g],acc floor 5 [g]") -> Path:
    time = 0.002 * np.arange(400)
    shaken = np.sin(30.0 * time)
    rows = np.column_stack([time, *(number * shaken for number in range(1, header.count(",") + 1))])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.6f")
    return path


def test_a_logger_s_files_become_a_case_that_can_be_read(tmp_path, capsys):
    files = [_logger(tmp_path / f"run{number}.csv") for number in (1, 2)]
    new_case(*files, frame=["5A"], out=tmp_path / "case")
    case = read_case(tmp_path / "case")
    assert [(c.name, c.quantity, c.unit, c.floor) for c in case.channels] == [
        ("Table acc [g]", "table_acceleration", "g", None),
        ("acc floor 5 [g]", "absolute_acceleration", "g", 5),
    ]
    assert len(case.runs) == 2
    assert files[0].read_text().startswith("Time (s)")
    assert "guess" in (tmp_path / "case" / "case.toml").read_text()
    assert "can be read" in capsys.readouterr().out


@pytest.mark.parametrize("mark", ["", '"'])
def test_milliseconds_become_seconds_with_the_digits_that_were_written(tmp_path, mark):
    file = tmp_path / "run1.csv"
    rows = [f"{mark}{2.5 * row:.1f}{mark},{np.sin(row):.4f},{np.cos(row):.4f}" for row in range(400)]
    file.write_text("Time (ms),Table acc [g],acc floor 5 [g]\n" + "\n".join(rows) + "\n")
    new_case(file, frame=["5A"], out=tmp_path / "case")
    written = (tmp_path / "case" / "run1.csv").read_text().splitlines()
    assert written[0] == "time_s,Table acc [g],acc floor 5 [g]"
    assert written[2] == f"0.0025,{np.sin(1):.4f},{np.cos(1):.4f}"
    (run,) = read_case(tmp_path / "case").runs
    assert run.step_s == pytest.approx(0.0025)


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("Sample,Table acc [g],acc 5 [g]", "the first column is 'Sample'; it must be the time in s or ms"),
        ("Time (min),Table acc [g],acc 5 [g]", "it must be the time in s or ms"),
        ("time_s;table;a5", "not separated by commas"),
    ],
)
def test_a_header_that_cannot_be_read_is_one_sentence(tmp_path, header, said):
    with pytest.raises(CaseError, match=said):
        header_of(_logger(tmp_path / "run1.csv", header))


def test_what_is_missing_is_said_and_nothing_is_overwritten(tmp_path, capsys):
    file = _logger(tmp_path / "run1.csv", "time_s,CH1,acc floor 5 [g]")
    new_case(file, frame=["5A"], out=tmp_path / "case")
    assert "still to do: " in capsys.readouterr().out
    with pytest.raises(CaseError, match="is there already"):
        new_case(file, frame=["5A"], out=tmp_path / "case")
    other = _logger(tmp_path / "run2.csv")
    with pytest.raises(CaseError, match=r"has no column .CH1. that run1\.csv has"):
        new_case(file, other, frame=["5A"], out=tmp_path / "second")
    assert not (tmp_path / "second").exists()


def test_a_frame_of_one_s_own_is_copied_beside_the_case(tmp_path):
    from pounding.experiments.command.new_frame import new_frame

    new_frame(tmp_path / "office.toml")
    new_case(
        _logger(tmp_path / "run1.csv", "time_s,table acc [g],acc roof [g]"),
        frame=[str(tmp_path / "office.toml")],
        out=tmp_path / "case",
    )
    assert read_case(tmp_path / "case").channels[1].floor == 4


def test_a_file_that_is_there_is_not_changed(tmp_path):
    raw, ready = _logger(tmp_path / "raw.csv"), _logger(tmp_path / "ready.csv", "time_s,table [g],a5 [g]")
    before = raw.read_bytes()
    with pytest.raises(CaseError, match=r"raw\.csv is there already and would be changed"):
        new_case(raw, frame=["5A"], out=tmp_path)
    frame, other = tmp_path / "office.toml", tmp_path / "other" / "office.toml"
    frame.write_bytes(template("stick", "office").encode())
    other.parent.mkdir()
    other.write_text("mine")
    with pytest.raises(CaseError, match=r"office\.toml is there already and would be changed"):
        new_case(ready, frame=[str(frame)], out=other.parent)
    assert (raw.read_bytes(), other.read_text()) == (before, "mine")
    assert [path.name for path in other.parent.iterdir()] == ["office.toml"]
    new_case(ready, frame=["5A"], out=tmp_path)  # A file that can stay as it is stays.
    assert len(read_case(tmp_path).runs) == 1


def test_no_copy_has_the_name_of_the_case(tmp_path):
    with pytest.raises(CaseError, match=r"a file is called case\.toml"):
        new_case(_logger(tmp_path / "case.toml"), frame=["5A"], out=tmp_path / "case")
