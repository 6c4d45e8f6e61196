import os
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures.series import write_series
from pounding.frames import FrameError
from pounding.frames.drawing import vtk
from pounding.frames.response.stress import stress_map


def test_the_pvd_lists_files_that_hold_the_motion(shaken_plate, tmp_path):
    times = [0.3, 0.6]
    write_series(shaken_plate.motion, times, tmp_path / "run.pvd")
    entries = ElementTree.parse(tmp_path / "run.pvd").getroot().findall("Collection/DataSet")
    assert [float(entry.get("timestep")) for entry in entries] == times
    reduced, frame = shaken_plate.reduced, shaken_plate.motion.frames[0]
    for entry, time in zip(entries, times, strict=True):
        state = meshio.read(tmp_path / entry.get("file"))
        q, v = (values[0] for values in frame.sampled([time]))
        np.testing.assert_allclose(state.point_data["displacement [m]"], reduced.expand(q), atol=1e-8)
        np.testing.assert_allclose(state.point_data["velocity [m/s]"], reduced.expand(v), atol=1e-6)
        stress = stress_map(reduced).von_mises(q)
        np.testing.assert_allclose(state.cell_data["von Mises stress [Pa]"][0], stress, rtol=1e-5)
        assert "acceleration [m/s^2]" in state.point_data


def test_a_new_series_replaces_the_old_one(shaken_stick, tmp_path):
    write_series(shaken_stick.motion, [0.1, 0.2, 0.3], tmp_path / "run.pvd")
    write_series(shaken_stick.motion, [0.1], tmp_path / "run.pvd")
    assert sorted(os.listdir(tmp_path)) == ["run", "run.pvd"]
    assert os.listdir(tmp_path / "run") == ["stick_00000.vtu"]


def test_a_disk_that_fills_up_keeps_the_old_series_and_leaves_nothing_half_written(
    shaken_stick, tmp_path, monkeypatch
):
    write_series(shaken_stick.motion, [0.1], tmp_path / "run.pvd")
    before = (tmp_path / "run.pvd").read_bytes()
    write, written = vtk.meshio.write, []

    def fills_up(path, *args, **options):
        if len(written) == 2:
            raise OSError(28, "No space left on device")
        written.append(path)
        write(path, *args, **options)

    monkeypatch.setattr(vtk.meshio, "write", fills_up)
    with pytest.raises(FrameError, match="No space left"):
        write_series(shaken_stick.motion, [0.1, 0.2, 0.3], tmp_path / "run.pvd")
    assert sorted(os.listdir(tmp_path)) == ["run", "run.pvd"]
    assert os.listdir(tmp_path / "run") == ["stick_00000.vtu"]
    assert (tmp_path / "run.pvd").read_bytes() == before


def test_times_outside_the_run_and_folders_that_are_files_are_told(shaken_stick, tmp_path):
    with pytest.raises(ExperimentError, match="must lie in the run"):
        write_series(shaken_stick.motion, [99.0], tmp_path / "run.pvd")
    (tmp_path / "file").write_text("")
    with pytest.raises(FrameError, match="cannot be written"):
        write_series(shaken_stick.motion, [0.1], tmp_path / "file" / "run.pvd")
