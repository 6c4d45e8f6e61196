import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.measurements import history as measured
from pounding.experiments.pictures import plots
from pounding.experiments.results import dataset as results


def write(folder, text, name="run.csv"):
    (folder / name).write_text(text)
    return folder / name


def test_columns_are_known_by_their_names(tmp_path):
    path = write(
        tmp_path,
        "time_s,table_acceleration_g,15B_relative_displacement_floor10_mm,odd\n0,0.1,5,1\n0.1,,6,1\n0.2,0.3,7,1\n",
    )
    table, floor = measured.read(path)
    assert (table.quantity, table.frame, table.floor) == ("table_acceleration", None, None)
    np.testing.assert_allclose(table.values, [0.980665, np.nan, 2.941995])
    assert (floor.quantity, floor.frame, floor.floor) == ("relative_displacement", "15B", 10)
    np.testing.assert_allclose(floor.values, [5e-3, 6e-3, 7e-3])


def test_columns_are_known_by_a_case_beside_the_file(tmp_path):
    write(
        tmp_path,
        '[[channel]]\nname = "5B_a3"\nframe = "5B"\nfloor = 3\n'
        'quantity = "absolute_acceleration"\nunit = "cm/s^2"\n',
        "case.toml",
    )
    (channel,) = measured.read(write(tmp_path, "time_s,5B_a3\n0,100\n1,200\n"))
    assert (channel.frame, channel.floor) == ("5B", 3)
    np.testing.assert_allclose(channel.values, [1.0, 2.0])


@pytest.mark.parametrize(("frames", "known"), [(["5B"], "5B"), (["5A", "5B"], None), ([], None)])
def test_a_case_of_one_frame_need_not_name_it_in_its_channels(tmp_path, frames, known):
    tables = "".join(f'[[frame]]\nname = "{name}"\n' for name in frames)
    floor = '[[channel]]\nname = "acc 3"\nfloor = 3\nquantity = "absolute_acceleration"\nunit = "m/s^2"\n'
    table = '[[channel]]\nname = "table"\nquantity = "table_acceleration"\nunit = "m/s^2"\n'
    write(tmp_path, tables + floor + table, "case.toml")
    one, other = measured.read(write(tmp_path, "time_s,acc 3,table\n0,100,1\n1,200,2\n"))
    assert (one.frame, one.floor) == (known, 3)
    assert other.frame is None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,table_acceleration_g\n0,1\n1,1\n", "first column is time_s"),
        ("time_s,table_acceleration_g\n0,1\n", "two rows"),
        (
            "time_s,table_acceleration_g\n0,1\n1,x\n",
            "line 3, column 'table_acceleration_g': 'x' is no number",
        ),
        ("time_s,table_acceleration_g\n0,1\n1\n", "line 3: 1 cells under 2 columns"),
        ("time_s,table_acceleration_g\n0,1\n0,1\n", "line 3: time_s does not increase"),
        ("time_s,table_acceleration_mm\n0,1\n1,1\n", "unit 'mm'; table_acceleration takes m/s"),
        ("time_s,height\n0,1\n1,1\n", "none of its columns"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, text, words):
    with pytest.raises(ExperimentError, match=words):
        measured.read(write(tmp_path, text))


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(ExperimentError, match=r"no\.csv: cannot be read"):
        measured.read(tmp_path / "no.csv")


def test_our_own_csv_laid_over_its_run_agrees_and_a_late_clock_is_found(shaken_stick, tmp_path):
    data = results.dataset(shaken_stick.motion, shaken_stick.record)
    results.save_csv(data, tmp_path / "run.csv")
    late = [
        measured.replace(channel, time_s=channel.time_s + 3.25)
        for channel in measured.read(tmp_path / "run.csv")
    ]
    channels, shift = measured.aligned(late, data.time.values, data.table_acceleration.values)
    assert shift == pytest.approx(-3.25, abs=1e-3)
    compared = [
        measured.misfit(channel, data.time.values, plots.simulated(data, channel, "stick"))
        for channel in channels
    ]
    assert len(compared) == 2 + 4  # the table's acceleration and displacement; two channels on each floor
    assert all(row["rms_error_ratio"] < 1e-2 for row in compared)


def test_a_channel_of_another_frame_has_no_history(shaken_stick):
    data = results.dataset(shaken_stick.motion, shaken_stick.record)
    none = np.zeros(2)
    for quantity, frame, floor in (
        ("relative_displacement", "5B", 1),
        ("relative_displacement", "stick", 9),
        ("contact_force", None, None),
    ):
        channel = measured.Channel("c", quantity, frame, floor, none, none)
        assert plots.simulated(data, channel, "stick") is None
