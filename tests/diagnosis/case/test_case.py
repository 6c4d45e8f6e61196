"""Reading a measured case: every rule of the format, and one sentence for everything that breaks it."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.frames import baseline_frames
from tests.diagnosis.case.bench_case import CASE, edit, samples


def test_units_become_si_and_rates_may_differ(folder: Path) -> None:
    case = read_case(folder)
    first, second = case.runs
    assert first.step_s == pytest.approx(0.002)
    assert second.step_s == pytest.approx(1 / 1024, rel=2e-3)
    assert first.time_s[0] == pytest.approx(3.0)
    assert first.values[0] == pytest.approx(
        [9.80665 * np.sin(3), 1e-3 * np.cos(3), 1e3 * np.sin(9)], rel=1e-5
    )
    assert case.prior.table_gain == 0.05
    assert case.prior.storey_stiffness == 0.03
    assert case.contacts[0].gap_m == pytest.approx(0.0095)
    assert [frame.kind for frame in case.frames] == ["thesis", "modal"]
    assert case.frames[0].storeys == 5
    assert case.warnings == ()


def test_dropouts_are_nan_and_said(folder: Path) -> None:
    lines = samples(0.002).splitlines()
    lines[3] = lines[3].rpartition(",")[0] + ","
    lines[4] = lines[4].rpartition(",")[0] + ",NaN"
    (folder / "run1.csv").write_text("\n".join(lines))
    case = read_case(folder)
    assert np.flatnonzero(np.isnan(case.runs[0].values[:, 2])).tolist() == [2, 3]
    assert case.warnings == ("run1.csv: of each channel's 50 samples these dropped out: 2 of 'force'",)


def test_a_channel_without_samples_and_a_dead_one_are_said(folder: Path) -> None:
    rows = [row.split(",") for row in samples(0.002).splitlines()[1:]]
    text = "\n".join(["time_s,table,d2,force", *(f"{t},{a},4.5," for t, a, _, _ in rows)])
    (folder / "run1.csv").write_text(text)
    said = read_case(folder).warnings
    assert "'d2': reads 4.5 mm throughout" in said[0]
    assert "'force': no sample was recorded" in said[1]


def test_a_contact_that_never_closes_is_no_dead_sensor(folder: Path) -> None:
    rows = [row.rpartition(",")[0] for row in samples(0.002).splitlines()[1:]]
    (folder / "run1.csv").write_text("\n".join(["time_s,table,d2,force", *(f"{row},0" for row in rows)]))
    (said,) = read_case(folder).warnings
    assert "'force': reads 0 throughout; the contact never closed" in said


def test_a_last_number_that_may_be_cut_is_said(folder: Path) -> None:
    text = "\n".join(["time_s,table,d2,force", *(f"{0.002 * i:.3f},{i},{i}.5,1.{10 + i}" for i in range(50))])
    (folder / "run1.csv").write_text(text)
    assert read_case(folder).warnings == ()
    (folder / "run1.csv").write_text(text[:-1])
    assert "its last number, '1.5', may be cut" in read_case(folder).warnings[-1]


def test_ten_seconds_of_zeros_are_said(folder: Path) -> None:
    text = "\n".join(["time_s,table,d2,force", *(f"{0.002 * i:.3f},0,0,0" for i in range(5000))])
    (folder / "run1.csv").write_text(text)
    assert read_case(folder).warnings == ("run1.csv: every channel is zero throughout; the run says nothing",)


def test_a_column_too_many_is_said(folder: Path) -> None:
    edit(folder / "run1.csv", "\n", ",1\n", 51)
    edit(folder / "run1.csv", "force,1", "force,extra")
    assert "'extra' is no [[channel]]" in read_case(folder).warnings[0]


def test_a_frame_file_of_the_users_own(folder: Path) -> None:
    stick = 'kind = "stick"\nname = "mine"\nstoreys = 3\nstorey_height_m = 0.1\ndamping_ratio = 0.01\n'
    (folder / "mine.toml").write_text(stick + "floor_mass_kg = [1.0, 1.0, 1.0]\nfrequency_hz = [3.0]\n")
    edit(folder / "case.toml", 'name = "5B"', 'name = "5B"\nfile = "mine.toml"')
    frame = read_case(folder).frames[0]
    assert (frame.kind, frame.name, frame.storeys) == ("file", "5B", 3)


def test_a_frame_without_damping_is_no_baseline(folder: Path) -> None:
    stick = 'kind = "stick"\nname = "mine"\nstoreys = 3\nstorey_height_m = 0.1\ndamping_ratio = 0.0\n'
    (folder / "mine.toml").write_text(stick + "floor_mass_kg = [1.0, 1.0, 1.0]\nfrequency_hz = [3.0]\n")
    edit(folder / "case.toml", 'name = "5B"', 'name = "5B"\nfile = "mine.toml"')
    with pytest.raises(CaseError, match="frame '5B': its damping_ratio is 0"):
        baseline_frames(read_case(folder))


@pytest.mark.parametrize(("written", "meant"), [("m/s2", "m/s^2"), ("gal", "cm/s^2"), ("m/s**2", "m/s^2")])
def test_other_spellings_of_a_unit_are_the_unit(folder: Path, written: str, meant: str) -> None:
    edit(folder / "case.toml", 'unit = "g"', f'unit = "{written}"')
    assert read_case(folder).channels[0].unit == meant


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('unit = "g"', 'unit = "m/s3"', "line 23: channel 'table': unit 'm/s3' .*use one of m/s"),
        (
            '"table_acceleration"',
            '"acceleration"',
            "'acceleration'; say which: table_acceleration, absolute_acceleration",
        ),
        (
            "storeys = 2",
            "storeys = 2\nstorey_stiffness_n_per_m = [1e4, 1e4]",
            "'bench': unknown key 'storey_stiffness_n_per_m'; it belongs into a frame file",
        ),
        ('unit = "mm"', 'unit = "mn"', "channel 'd2': unit 'mn' .*use one of m, cm, mm"),
        ('unit = "mm"', 'unit = "g"', "line 30: channel 'd2': unit 'g' is none of relative_displacement's"),
        ("relative_displacement", "relative_displacment", "'d2': unknown quantity .*'relative_displacement'"),
        (
            "floor = 2\nquantity",
            "floor = 9\nquantity",
            "line 28: channel 'd2': floor 9 is not on 5B, which has 5",
        ),
        ("floor = 2\nquantity", "floor = 0\nquantity", "of floor 0, the table, is zero by definition"),
        ("floor = 2\nquantity", "flor = 2\nquantity", "line 28: channel 'd2': unknown key 'flor'.*'floor'"),
        (
            "floor = 2\nquantity",
            "floor = 2.5\nquantity",
            "channel 'd2': `floor`: expected a whole number, found",
        ),
        ('frame = "5B"\nfloor', 'frame = "5A"\nfloor', "'d2': frame '5A' is not in the case"),
        ('frame = "5B"\nfloor', "floor", "the key 'frame' is missing"),
        ('name = "force"', 'name = "d2"', "channel 'd2' stands there twice"),
        ("contact = 1", "contact = 2", "channel 'force': contact 2 is not there"),
        ('name = "5B"', 'name = "5C"', "line 4: frame '5C': .*did you mean 5"),
        ("storeys = 2", "storeys = 3", "floor_mass_kg has 2 values; give 3"),
        ("[2.1, 6.0]", "[6.0, 2.1]", "line 11: frame 'bench': frequency_hz"),
        ("[0.005, 0.004]", "[0.005]", "damping_ratio holds"),
        ("[0.005, 0.004]", "[0.005, 0.0]", "give a fraction above 0"),
        ("storey_height_m = 0.1\n", "", "'bench': the key 'storey_height_m' is missing"),
        ("gap_mm = 9.5", "gap_mm = -1", "contact 1: gap_mm is -1"),
        ('law = "linear_viscoelastic"', 'law = "herz"', "unknown law 'herz'; did you mean 'hertz'"),
        ('right = "bench"', 'right = "5B"', "cannot touch itself"),
        ("floor = 2\ngap", "floor = 3\ngap", "floor 3 is not on both frames; give one from 1 to 2"),
        (
            "storey_height_m = 0.1\n",
            "storey_height_m = 0.15\n",
            "line 41: contact 1: floor 2 of 5B at 0.2 m and floor 2 of bench at 0.3 m are not level",
        ),
        ("damping_n_s_per_m = 1255.0\n", "", "give one of damping_n_s_per_m and restitution"),
        ("table_gain = 0.05", "table_gian = 0.05", "unknown key 'table_gian'; did you mean 'table_gain'"),
        ("table_gain = 0.05", "table_gain = 0.0", "table_gain is 0; it must be 1e-06 to 100"),
        ('unit = "g"', "", "channel 'table': the key 'unit' is missing"),
        ("[[run]]", "[[rum]]", None),
        ('title = "bench"', 'title = "bench', "case.toml is not TOML: .*line 1"),
        ('file = "run1.csv"', 'file = "run9.csv"', "run9.csv is not there"),
        (
            "[[frame]]",
            'name = "bench"\n[[frame]]',
            r"unknown key 'name'; use one of frame, run, channel, title",
        ),
        ('file = "run1.csv"', 'file = "run1.csv"\nrole = "heldout"', "unknown role 'heldout'; did you mean"),
    ],
)
def test_wrong_description(folder: Path, old: str, new: str, said: str | None) -> None:
    edit(folder / "case.toml", old, new)
    with pytest.raises(CaseError, match=said or "unknown key 'rum'; did you mean 'run'") as caught:
        read_case(folder)
    assert len(str(caught.value).splitlines()) == 1


def test_a_case_needs_a_table_and_a_response(folder: Path) -> None:
    text = CASE.replace(
        'quantity = "table_acceleration"', 'frame = "5B"\nfloor = 1\nquantity = "absolute_acceleration"'
    )
    (folder / "case.toml").write_text(text)
    with pytest.raises(CaseError, match="no channel says how the table moved"):
        read_case(folder)
    start, end = CASE.index('[[channel]]\nname = "d2"'), CASE.index("[[contact]]")
    (folder / "case.toml").write_text(CASE[:start] + CASE[end:])
    with pytest.raises(CaseError, match="no channel measures a frame"):
        read_case(folder)


@pytest.mark.parametrize(
    ("line", "new", "said"),
    [
        (0, "time_s,table,force", "line 1: no column for channel 'd2'"),
        (0, "time_s,table,d_2,force", "no column for channel 'd2'; did you mean 'd_2'"),
        (0, "time_s,d2,d2,force", "column 'd2' stands there twice"),
        (0, "t,table,d2,force", "the first column is 't'"),
        (0, "time_s;table;d2;force", "not separated by commas"),
        (5, "3.008,0.1,abc,0", "run1.csv line 6, channel 'd2': 'abc' is no number"),
        (5, "3.008,0.1,inf,0", "run1.csv line 6, channel 'd2': 'inf' is no number"),
        (5, "3.008,0.1,0", "line 6: 3 cells under 4 columns"),
        (5, ",0.1,0,0", "line 6: time_s is empty"),
        (5, "3.0085,0.1,0,0", "line 6: time steps by 0.0025 s where others step by 0.002 s"),
        (5, "3.006,0.1,0,0", "line 6: time does not go on"),
    ],
)
def test_wrong_run(folder: Path, line: int, new: str, said: str) -> None:
    lines = samples(0.002, digits=4).splitlines()
    lines[line : line + 1] = [new]
    if new == "time_s,table,force":
        lines = [row.rpartition(",")[0] if row != new else row for row in lines]
    (folder / "run1.csv").write_text("\n".join(lines))
    with pytest.raises(CaseError, match=said):
        read_case(folder)


def test_a_column_of_another_channel_is_not_the_one_that_was_meant(folder: Path) -> None:
    edit(folder / "case.toml", 'name = "table"', 'name = "d2_a"')
    edit(folder / "run1.csv", "table,d2", "d2_a,d_2")
    with pytest.raises(CaseError, match="no column for channel 'd2'; did you mean 'd_2'"):
        read_case(folder)
    edit(folder / "run1.csv", "d_2", "other")
    with pytest.raises(CaseError, match="no column for channel 'd2'; add the column"):
        read_case(folder)


@pytest.mark.parametrize(("content", "said"), [(b"", "is empty"), (b"time_s,table\n0,1\n", "has 1 samples")])
def test_empty_run(folder: Path, content: bytes, said: str) -> None:
    (folder / "run1.csv").write_bytes(content)
    with pytest.raises(CaseError, match=said):
        read_case(folder)


def test_not_a_case(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="is not a folder"):
        read_case(tmp_path / "nowhere")
    with pytest.raises(CaseError, match=r"holds no case\.toml"):
        read_case(tmp_path)
    (tmp_path / "case.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CaseError, match="not a text file"):
        read_case(tmp_path)


def test_runs_of_one_name_in_two_folders_stay_two_runs(folder: Path, tmp_path: Path) -> None:
    for number in (1, 2):
        place = folder / f"day{number}" / "run.csv"
        place.parent.mkdir()
        (folder / f"run{number}.csv").rename(place)
        edit(folder / "case.toml", f"run{number}.csv", f"day{number}/run.csv")
    case = read_case(folder)
    assert [run.file for run in case.runs] == ["day1/run.csv", "day2/run.csv"]
    again = read_case(write_case(case, tmp_path / "copy").parent)
    assert [run.file for run in again.runs] == ["day1/run.csv", "day2/run.csv"]
    for one, other in zip(case.runs, again.runs, strict=True):
        assert other.values == pytest.approx(one.values, rel=1e-5, abs=1e-12)


def test_a_copy_is_written_into_its_own_folder_wherever_the_runs_come_from(
    folder: Path, tmp_path: Path
) -> None:
    """Measurements that lie elsewhere are not written over."""
    case = read_case(folder)
    outside = [str(tmp_path / "elsewhere" / "run.csv"), "../run.csv"]
    moved = replace(
        case, runs=tuple(replace(run, file=file) for run, file in zip(case.runs, outside, strict=True))
    )
    copy = read_case(write_case(moved, tmp_path / "new" / "copy").parent)
    assert [run.file for run in copy.runs] == ["run.csv", "2-run.csv"]
    assert not (tmp_path / "elsewhere").exists()
    assert not (tmp_path / "new" / "run.csv").exists()


def test_written_and_read_again(folder: Path, tmp_path: Path) -> None:
    case = read_case(folder)
    case.runs[0].values[4, 1] = np.nan
    write_case(case, tmp_path / "copy")
    again = read_case(tmp_path / "copy")
    assert_same(case, again)


@pytest.mark.parametrize("name", ["open-null", "open-cubic", "open-friction"])
def test_open_cases(name: str, tmp_path: Path, open_cases: Path) -> None:
    """Cases of another simulator, kept beside the records and not in the project."""
    case = read_case(open_cases / name)
    assert case.title == name
    assert [run.values.shape for run in case.runs] == [(3999, 8)] * 3
    assert case.warnings == ()
    write_case(case, tmp_path)
    assert_same(case, read_case(tmp_path))
    # A relative displacement is in mm in the file and in m here.
    assert 1e-3 < np.abs(case.runs[0].values[:, case.channel_index(f"{case.frames[0].name}_d5")]).max() < 1e-2
    shutil.rmtree(tmp_path)


def assert_same(one: Case, other: Case) -> None:
    assert (one.title, one.frames, one.channels, one.prior) == (
        other.title,
        other.frames,
        other.channels,
        other.prior,
    )
    assert one.contacts == other.contacts
    for mine, theirs in zip(one.runs, other.runs, strict=True):
        np.testing.assert_allclose(mine.time_s, theirs.time_s, rtol=1e-7)
        np.testing.assert_allclose(mine.values, theirs.values, rtol=1e-6)
