"""Sweeps: the same result wherever they run, nothing lost and nothing run twice whatever ends them."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import pounding
from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps import store as sweep_store
from pounding.experiments.sweeps.sweep import sweep
from pounding.frames.files import DamageWarning, write_entry

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import sweep_cases as cases  # noqa: E402


@pytest.fixture(autouse=True)
def _workers_find_the_cases(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")]))


def test_a_grid_becomes_dimensions_and_settings_attributes():
    result = sweep(cases.square, {"x": [1, 2, 3], "y": [0.0, 0.5]}, settings={"offset": 10.0}, workers=0)
    assert result["sum"].dims == ("x", "y")
    assert result["sum"].sel(x=3, y=0.5) == 19.5
    assert result["label"].sel(x=2, y=0.0) == "x=2"
    assert (result.failure == "").all()
    assert result.attrs["offset"] == 10.0
    assert {"software", "version", "code"} <= set(result.attrs)


def test_a_list_of_cases_and_a_dataset_of_coordinates_work_too():
    listed = sweep(cases.square, [{"x": 1}, {"x": 5}], workers=0)
    assert listed["sum"].dims == ("case",)
    assert listed["x"].values.tolist() == [1, 5]
    gridded = sweep(cases.square, xr.Dataset(coords={"x": [1, 5]}), workers=0)
    np.testing.assert_array_equal(gridded["sum"], listed["sum"])


def test_arrays_keep_their_axes_and_failures_leave_a_hole(tmp_path):
    for _ in range(2):  # the second time everything comes from the files
        result = sweep(cases.history, {"x": [1, 2, 3]}, folder=tmp_path, workers=0)
        assert result.displacement.dims == ("x", "time")
        assert result.displacement.attrs["units"] == "m"
        np.testing.assert_array_equal(result.displacement.sel(x=3, time=0.2), 3 * 0.2)
        assert np.isnan(result.displacement.sel(x=2)).all()
        assert result.failure.sel(x=2) == "RuntimeError: no motion"
    result.to_netcdf(tmp_path / "all.nc", engine="h5netcdf")


def test_a_case_that_fails_is_recorded_and_does_not_stop_the_rest(tmp_path):
    result = sweep(cases.picky, {"x": range(6)}, folder=tmp_path, workers=2)
    assert result.failure.sel(x=3) == "ValueError: three is not wanted"
    assert np.isnan(result.value.sel(x=3))
    assert np.isfinite(result.value.drop_sel(x=3)).all()


def test_failures_are_run_again_only_when_asked(tmp_path):
    log = tmp_path / "log"
    sweep(
        cases.noted, {"x": [1]}, settings={"log": str(tmp_path)}, folder=tmp_path / "s", workers=0
    )  # a folder
    again = sweep(cases.noted, {"x": [1]}, settings={"log": str(tmp_path)}, folder=tmp_path / "s", workers=0)
    assert "IsADirectoryError" in str(again.failure.item(0))
    retried = sweep(
        cases.noted,
        {"x": [1]},
        settings={"log": str(log)},
        folder=tmp_path / "s",
        workers=0,
        retry_failed=True,
    )
    assert retried.failure.item(0) == ""


def test_a_changed_case_setting_or_code_is_another_case(tmp_path):
    log = tmp_path / "log"
    settings = {"log": str(log)}
    for version in ("a", "a", "b"):
        sweep(
            cases.noted, {"x": [1, 2]}, settings=settings, folder=tmp_path / "s", workers=0, version=version
        )
    assert log.read_text().split() == ["1", "2", "1", "2"]
    assert sweep_store.code_version(cases.square) == sweep_store.code_version(cases.noted)


def test_a_case_depends_on_what_computes_it_and_not_on_what_shows_it():
    house = Path(pounding.__file__).parent
    found = {path.relative_to(house).as_posix() for path in sweep_store.sources()}
    assert {"constants.py", "frames/fe/shells.py", "contact/laws.py", "experiments/rig/rig.py"} <= found
    assert {"frames/library/15B.toml", "experiments/rig/states.toml"} <= found
    assert not [name for name in found if name.startswith(sweep_store.NO_PART_OF_A_CASE)]
    for room in sweep_store.NO_PART_OF_A_CASE:
        assert (house / room / "__init__.py").is_file()


def test_a_case_that_kills_its_worker_every_time_is_named_and_the_rest_is_done(tmp_path):
    result = sweep(cases.deadly, {"x": range(5)}, folder=tmp_path, workers=2)
    assert "worker died every time" in str(result.failure.sel(x=2).item())
    assert np.isfinite(result.value.drop_sel(x=2)).all()


def test_workers_that_are_killed_cost_nothing(tmp_path):
    (tmp_path / "marks").mkdir()
    settings = {"mark": str(tmp_path / "marks")}
    result = sweep(cases.dies_once, {"x": range(8)}, settings=settings, folder=tmp_path / "s", workers=2)
    assert (result.failure == "").all()
    np.testing.assert_array_equal(result.value, np.arange(8.0))


# Long enough that it is still at work after the last of three starts of up to a quarter of a second and their set-up.
MANY = 240
SCRIPT = f"""
import sys
sys.path.insert(0, sys.argv[1])
import sweep_cases
from pounding.experiments.sweeps.sweep import sweep
if __name__ == "__main__":
    settings = {{"log": sys.argv[3], "pause_s": 0.02}}
    sweep(sweep_cases.noted, {{"x": range({MANY})}}, settings=settings, folder=sys.argv[2], workers=2, version="1")
"""


def start(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    arguments = [sys.executable, str(script), str(HERE), str(tmp_path / "s"), str(tmp_path / "log")]
    return subprocess.Popen(
        arguments,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        preexec_fn=cases.heeding_ctrl_c,
    )


def finished(tmp_path):
    return len(list((tmp_path / "s").glob("[0-9a-f]*.json"))) if (tmp_path / "s").exists() else 0


def wait_until(condition, seconds=30.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


@pytest.mark.slow
def test_killed_at_random_moments_and_started_again_nothing_is_lost_or_run_twice(tmp_path, chance):
    started = 0
    for _ in range(3):
        before = finished(tmp_path)
        process = start(tmp_path)
        wait_until(lambda before=before: finished(tmp_path) > before)
        time.sleep(chance.uniform(0.0, 0.25))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        started += finished(tmp_path) > before
    time.sleep(0.5)  # the workers notice that their parent is gone
    kept = finished(tmp_path)
    assert started == 3
    assert kept < MANY, "the sweep was not interrupted; make it longer"
    log = tmp_path / "log"
    before = log.read_text().split()
    settings = {"log": str(log), "pause_s": 0.02}
    result = sweep(
        cases.noted, {"x": range(MANY)}, settings=settings, folder=tmp_path / "s", workers=2, version="1"
    )
    np.testing.assert_array_equal(result.twice, 2.0 * np.arange(MANY))
    after = log.read_text().split()[len(before) :]
    assert len(after) == MANY - kept  # not one of the kept cases was run again
    # A case may have been at work, unfinished, in each of the two workers at each of the three kills.
    assert len(before) <= kept + 6


def test_ctrl_c_says_how_far_it_came_and_leaves_no_process(tmp_path):
    process = start(tmp_path)
    wait_until(lambda: finished(tmp_path) > 3)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=20)
    assert f"of {MANY} cases are finished; the same call goes on with the rest" in " ".join(output.split())
    assert process.returncode != 0
    kept = finished(tmp_path)
    time.sleep(0.3)
    assert finished(tmp_path) == kept


def test_a_full_disk_is_one_sentence_and_keeps_what_is_finished(tmp_path, monkeypatch):
    sweep(cases.square, {"x": [1]}, folder=tmp_path, workers=0)

    def full(path, content):
        try:
            Path("/dev/full").write_bytes(content)
        except OSError as error:
            raise sweep_store.FrameError(f"{path}: cannot be written ({error.strerror})") from error

    monkeypatch.setattr(sweep_store, "write_entry", full)
    with pytest.raises(ExperimentError, match=r"No space left on device.*make room and start again"):
        sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)
    monkeypatch.undo()
    assert finished_in(tmp_path) == 1
    assert sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)["sum"].values.tolist() == [1, 4]


def finished_in(folder):
    return len(list(folder.glob("*.json")))


DAMAGED = [
    lambda whole: whole[:20],
    lambda whole: "[]",
    lambda whole: '{"values": [1], "failure": ""}',
    lambda whole: '{"values": {"sum": {"array": [1]}}, "failure": ""}',
    lambda whole: '{"values": {"sum": "seven"}, "failure": ""}',
    lambda whole: '{"values": {"sum": 7.0}, "failure": 3}',
    lambda whole: whole.replace('"sum": 4.0', '"sum": 5.0').replace('"sum": 1.0', '"sum": 5.0'),
]


@pytest.mark.parametrize("damaged", DAMAGED)
def test_a_damaged_file_is_told_and_counts_as_not_finished(tmp_path, damaged):
    sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)
    victim = sorted(tmp_path.glob("*.json"))[0]
    whole = victim.read_text()
    assert damaged(whole) != whole
    victim.write_text(damaged(whole))
    with pytest.warns(DamageWarning, match="is damaged: what it kept is made anew"):
        result = sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)
    assert result["sum"].values.tolist() == [1, 4]
    assert victim.read_text() == whole
    json.loads(whole)


def test_a_file_that_another_program_wrote_with_its_checksum_is_told_too(tmp_path):
    sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)
    victim = sorted(tmp_path.glob("*.json"))[0]
    for other in (
        b"[1]",
        b'{"values": {}}',
        b'{"case": {}, "values": {"sum": {"array": 1}}, "failure": ""}',
        b"{",
    ):
        write_entry(victim, other)
        with pytest.warns(DamageWarning):
            result = sweep(cases.square, {"x": [1, 2]}, folder=tmp_path, workers=0)
        assert result["sum"].values.tolist() == [1, 4]


def test_what_a_killed_sweep_had_begun_is_removed_by_the_next_one(tmp_path, killed_while_writing):
    sweep(cases.square, {"x": [1]}, folder=tmp_path, workers=0)
    killed_while_writing(tmp_path / "0a.json")
    sweep(cases.square, {"x": [1]}, folder=tmp_path, workers=0)
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"x": []}, "no cases"),
        ([], "no cases"),
        ([{"x": 1}, {"y": 2}], "case 2 has not the same names"),
        ([{"x": object()}], "a object cannot be kept"),
    ],
)
def test_bad_cases_are_named(grid, message):
    with pytest.raises(ExperimentError, match=message):
        sweep(cases.square, grid, workers=0)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ExperimentError, match="cannot be written"):
        sweep(cases.square, {"x": [1]}, folder=tmp_path / "file" / "s", workers=0)


def test_a_scheduler_that_accepts_and_stays_silent_is_one_sentence():
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(ExperimentError, match=f"scheduler {address} does not answer within 1 s"):
            sweep(cases.square, {"x": [1]}, scheduler=address, timeout_s=1.0)


def test_a_scheduler_that_is_not_there_is_one_sentence():
    with pytest.raises(ExperimentError, match="does not answer"):
        sweep(cases.square, {"x": [1]}, scheduler="tcp://127.0.0.1:1", timeout_s=1.0)


def test_a_scheduler_with_tls_and_no_certificate_is_one_sentence():
    with pytest.raises(ExperimentError, match="TLS needs a certificate; name it in DASK_DISTRIBUTED__COMM"):
        sweep(cases.square, {"x": [1]}, scheduler="tls://127.0.0.1:1", timeout_s=1.0)


@pytest.mark.slow
def test_a_cluster_gives_the_same_dataset_and_resumes(tmp_path):
    from distributed import LocalCluster

    grid = {"x": [1, 2, 3, 4], "y": [0.1, 0.2]}
    here = sweep(cases.square, grid, workers=2)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        sweep(cases.square, {"x": [1, 2], "y": [0.1, 0.2]}, scheduler=address, folder=tmp_path)
        there = sweep(cases.square, grid, scheduler=address, folder=tmp_path)
        failed = sweep(cases.picky, {"x": [1, 3]}, scheduler=address)
        died = sweep(cases.deadly, {"x": [1, 2, 4]}, scheduler=address)
    xr.testing.assert_identical(here, there)
    assert failed.failure.sel(x=3) == "ValueError: three is not wanted"
    assert "worker died every time" in str(died.failure.sel(x=2).item())
    assert died.value.sel(x=4) == 4.0
    assert finished_in(tmp_path) == 8


@pytest.mark.slow
def test_a_scheduler_without_workers_is_one_sentence():
    from distributed import LocalCluster

    with (
        LocalCluster(n_workers=0, dashboard_address=None) as cluster,
        pytest.raises(ExperimentError, match="has no workers after 1 s"),
    ):
        sweep(cases.square, {"x": [1]}, scheduler=cluster.scheduler_address, timeout_s=1.0)
