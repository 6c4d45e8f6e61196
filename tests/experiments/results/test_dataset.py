import json
import os

import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.results import dataset as results
from pounding.experiments.results.provenance import stamp
from pounding.frames import FrameError


@pytest.fixture
def data(shaken_stick):
    return results.dataset(
        shaken_stick.motion, shaken_stick.record, provenance=stamp({"frame": "stick"}, [shaken_stick.record])
    )


def test_every_variable_has_units_and_a_name(data):
    for name, variable in data.data_vars.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name
    assert data.relative_displacement.dims == ("frame", "floor", "time")
    assert data.time.attrs["units"] == "s"
    assert list(data.frame.values) == ["stick"]
    assert list(data.floor.values) == [1, 2]


def test_provenance_goes_with_the_data(data):
    assert data.attrs["software"] == "pounding"
    assert data.attrs["schema"] == 1
    assert json.loads(data.attrs["parameters"]) == {"frame": "stick"}
    assert json.loads(data.attrs["records"])[0]["name"] == "noise"


def test_a_run_states_where_it_comes_from_without_being_told(shaken_stick):
    data = results.dataset(shaken_stick.motion, shaken_stick.record)
    assert data.attrs["version"]
    parameters = json.loads(data.attrs["parameters"])
    assert list(parameters["frames"]) == ["stick"]
    assert parameters["contacts"] == []
    assert json.loads(data.attrs["records"])[0]["sha256"] == shaken_stick.record.sha256


def test_peaks_of_the_data_are_those_of_the_run(shaken_stick, data):
    roof = 1e3 * data.relative_displacement.sel(frame="stick", floor=2)
    peak = shaken_stick.result()["peaks"][-1]
    # Sampled at 1 ms, a 9 Hz motion misses a peak by at most 1 - cos(pi f dt): 0.04 %.
    assert float(roof.max()) == pytest.approx(peak["max_mm"], rel=1e-3)
    assert float(-roof.min()) == pytest.approx(peak["min_mm"], rel=1e-3)


def test_absolute_is_relative_plus_table_and_each_is_the_integral_of_the_next(data):
    for kind in ("displacement", "velocity", "acceleration"):
        whole = data[f"relative_{kind}"] + data[f"table_{kind}"]
        np.testing.assert_allclose(data[f"absolute_{kind}"], whole.transpose("frame", "floor", "time"))
    for low, high in (("displacement", "velocity"), ("velocity", "acceleration")):
        for prefix in ("table", "relative"):
            integral = data[f"{prefix}_{high}"].cumulative_integrate("time")
            exact = data[f"{prefix}_{low}"]
            # The trapezoidal rule at 1 ms, on an acceleration of white noise with corners 3.6 ms apart.
            assert float(abs(integral - exact).max()) < 0.02 * float(abs(exact).max())


def test_the_tables_motion_is_the_exact_integral(noise):
    record = noise(samples=3, step_s=0.1)
    object.__setattr__(record, "acceleration_m_s2", np.array([0.0, 6.0, 0.0]))
    moved = results.table_motion(record, np.array([0.0, 0.1, 0.2, 0.3]))
    np.testing.assert_allclose(moved["velocity"], [0.0, 0.3, 0.6, 0.6])
    np.testing.assert_allclose(moved["displacement"], [0.0, 0.01, 0.06, 0.12])
    np.testing.assert_allclose(moved["acceleration"], [0.0, 6.0, 0.0, 0.0])


def test_netcdf_reads_back_the_same(data, tmp_path):
    results.save(data, tmp_path / "run.nc")
    assert os.listdir(tmp_path) == ["run.nc"]
    back = results.load(tmp_path / "run.nc")
    np.testing.assert_array_equal(back.relative_displacement, data.relative_displacement)
    assert back.relative_displacement.attrs == data.relative_displacement.attrs
    assert back.attrs["parameters"] == data.attrs["parameters"]


def test_a_full_disk_leaves_the_old_file_and_nothing_half_written(data, tmp_path, monkeypatch):
    (tmp_path / "run.nc").write_bytes(b"old")

    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FrameError, match=r"run\.nc: cannot be written \(No space left"):
        results.save(data, tmp_path / "run.nc")
    assert os.listdir(tmp_path) == ["run.nc"]
    assert (tmp_path / "run.nc").read_bytes() == b"old"


def test_csv_has_a_column_a_floor_and_names_its_units(data, tmp_path):
    results.save_csv(data, tmp_path / "run.csv")
    header = (tmp_path / "run.csv").read_text().partition("\n")[0].split(",")
    assert header[0] == "time_s"
    assert "table_acceleration_m_s2" in header
    assert "stick_relative_displacement_floor2_m" in header
    table = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    column = table[:, header.index("stick_relative_displacement_floor2_m")]
    expected = data.relative_displacement.sel(frame="stick", floor=2)
    np.testing.assert_allclose(column, expected, rtol=1e-5, atol=1e-12)


def test_something_else_is_not_read(tmp_path):
    (tmp_path / "no.nc").write_text("no")
    with pytest.raises(ExperimentError, match=r"no\.nc: not a NetCDF"):
        results.load(tmp_path / "no.nc")
