"""Sweeps and runs on a disk that is really full, interrupted, and on a cluster whose scheduler dies on the way."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps.sweep import sweep

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import sweep_cases as cases  # noqa: E402


@pytest.fixture(autouse=True)
def _workers_find_the_cases(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")]))


@pytest.fixture
def _may_mount():
    """Skip where a sandbox lets nobody mount; test_sweep.py has a full disk without a file system of its own."""
    probe = ["unshare", "--mount", "--map-root-user", "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    if subprocess.run(probe, capture_output=True).returncode:
        pytest.skip("this machine does not let us mount a file system of our own")


def kept(folder):
    return len(list(folder.glob("[0-9a-f]*.json")))


# Runs a sweep, or a verb of the command, on a file system of its own: in a mount namespace (of root, or of a
# user who may have one), so that nothing outside of it is mounted or can be forgotten.
ON_A_SMALL_DISK = """
set -e
mkdir -p "$1"
mount -t tmpfs -o size="$2" tmpfs "$1"
shift 2
exec "$@"
"""

SWEEP = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import subprocess
import sweep_cases
from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps.sweep import sweep

def run():
    return sweep(sweep_cases.bulky, {"x": range(20)}, settings={"log": sys.argv[3]}, folder=folder,
                 workers=int(sys.argv[4]), version="1")

if __name__ == "__main__":
    folder = Path(sys.argv[2])
    try:
        run()
    except ExperimentError as error:
        print(error)
    names = sorted(path.name for path in folder.iterdir())
    print(len(names), sum(name.endswith(".json") and not name.startswith(".") for name in names))
    subprocess.run(["mount", "-o", "remount,size=4m", str(folder)], check=True)
    data = run()
    print(int((data.failure == "").sum()), float(data.numbers.sel(x=19)[7]))
"""


def on_a_small_disk(folder, size, *command):
    """Run a command that finds a file system of `size` at a folder; return what it printed, and its status."""
    words = [
        "unshare",
        "--mount",
        "--map-root-user",
        "sh",
        "-c",
        ON_A_SMALL_DISK,
        "sh",
        str(folder),
        size,
        *command,
    ]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    return " ".join(done.stdout.split("\n")).strip(), " ".join(done.stderr.split()), done.returncode


@pytest.mark.usefixtures("_may_mount")
@pytest.mark.parametrize("workers", [0, 2])
def test_a_file_system_that_is_full_keeps_what_is_finished_and_goes_on_when_there_is_room(tmp_path, workers):
    script, log, disk = tmp_path / "script.py", tmp_path / "log", tmp_path / "disk"
    script.write_text(SWEEP)
    arguments = [sys.executable, str(script), str(HERE), str(disk), str(log), str(workers)]
    printed, errors, status = on_a_small_disk(disk, "300k", *arguments)
    assert status == 0, errors
    assert "No space left on device" in printed
    assert "what is finished is kept: make room and start again to go on" in printed
    _, _, numbers = printed.partition("to go on")
    files, whole, good, value = numbers.split()
    # 300 kB hold some of the 20 cases of 40 kB; nothing half-written lies beside them
    assert 1 <= int(whole) == int(files) < 15
    assert int(good) == 20
    assert float(value) == 19 + 1
    # what was kept was not run again: only cases that found the disk full were
    assert len(log.read_text().split()) <= 20 + 1 + 2 * workers


def test_a_file_that_a_stopped_worker_had_begun_is_removed(tmp_path):
    with pytest.raises(ExperimentError, match="no room"):
        sweep(
            cases.writes_while_the_disk_fills,
            {"x": [0, 1]},
            settings={"folder": str(tmp_path)},
            folder=tmp_path,
            workers=2,
            version="1",
        )
    assert os.listdir(tmp_path) == []


@pytest.mark.usefixtures("_may_mount")
def test_the_command_on_a_full_file_system_leaves_no_half_file(tmp_path, test_records):
    # 200 kB hold a plot and not the histories: one sentence, status 2, and every file there is a whole one
    disk = tmp_path / "disk"
    command = [sys.executable, "-m", "pounding", "shake", "5A", "--record", "elcentro",
               "--records", str(test_records), "--out", str(disk / "run")]  # fmt: skip
    shown = [sys.executable, "-c", LISTED, str(disk), *command]
    printed, errors, status = on_a_small_disk(disk, "200k", *shown)
    assert status == 2
    assert "No space left on device" in errors
    assert "Traceback" not in errors
    assert ".part" not in printed


FULL = {
    "pound": ["pound", "10", "5B", "--gap", "3", "--record", "elcentro-peer180", "--out", "DISK/run"],
    "gap": ["gap", "10", "5B", "--record", "elcentro-peer180", "--report", "DISK/gap.html"],
    "design": ["design", "--tall", "30", "--short", "15", "--pga", "0.3", "--report", "DISK/design.html"],
    "hide": [
        "hide",
        "nothing",
        "--motions",
        "artificial",
        "--out",
        "DISK/case",
        "--truth",
        "DISK/truth.json",
    ],
    "benchmark": ["diagnose", "--benchmark", "1", "--way", "sparse", "--out", "DISK/benchmark"],
}


@pytest.mark.slow
@pytest.mark.usefixtures("_may_mount")
@pytest.mark.parametrize(
    "verb", [verb if verb != "benchmark" else pytest.param(verb, marks=pytest.mark.guard) for verb in FULL]
)
def test_every_verb_on_a_full_disk_is_one_sentence_and_leaves_nothing_begun(tmp_path, verb):
    disk = tmp_path / "disk"
    words = [word.replace("DISK", str(disk)) for word in FULL[verb]]
    command = [sys.executable, "-m", "pounding", *words]
    printed, errors, status = on_a_small_disk(disk, "8k", sys.executable, "-c", LISTED, str(disk), *command)
    assert status == 2, errors
    assert "No space left on device" in errors
    assert "Traceback" not in errors
    assert ".part" not in printed
    assert "case.toml" not in printed, "a case that looks whole"


@pytest.mark.parametrize(
    "words", [["list", "--json"], ["design", "--tall", "30", "--short", "15", "--pga", "0.3"]]
)
def test_standard_output_on_a_full_disk_is_one_sentence(words):
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "pounding", *words]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (2, "pounding: No space left on device\n")


FILM = """
import sys
from pathlib import Path
import numpy as np
from pounding import frames
from pounding.errors import InputError
from pounding.experiments.pictures.films import film
from pounding.experiments.rig.rig import Rig

stick = frames.StickFrame(name="stick", storeys=2, storey_height_m=0.3, floor_mass_kg=[6.0, 5.0],
                          damping_ratio=0.01, frequency_hz=[3.0])
motion = Rig([frames.build(stick)]).run(np.sin(np.arange(300) / 20.0), 0.0036)
for name in ("film.mp4", "film.gif"):
    try:
        film(motion, Path(sys.argv[1]) / name, size=(320, 240))
    except InputError as error:
        print(error, file=sys.stderr)
print(*Path(sys.argv[1]).iterdir())
"""


@pytest.mark.slow
@pytest.mark.usefixtures("_may_mount")
def test_a_film_for_which_the_disk_has_no_room_does_not_look_whole(tmp_path):
    disk = tmp_path / "disk"
    printed, errors, _ = on_a_small_disk(disk, "12k", sys.executable, "-c", FILM, str(disk))
    assert printed == ""
    assert errors.count("cannot be written") == 2
    assert "Traceback" not in errors


LISTED = """
import subprocess, sys
from pathlib import Path
status = subprocess.run(sys.argv[2:]).returncode
print(*(path.name for path in Path(sys.argv[1]).rglob("*")))
sys.exit(status)
"""


def test_the_command_interrupted_says_so_and_leaves_whole_files(tmp_path):
    command = [
        sys.executable,
        "-m",
        "pounding",
        "shake",
        "5A",
        "--record",
        "elcentro-peer180",
    ]
    process = subprocess.Popen(
        [*command, "--out", str(tmp_path / "run"), "--film"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=cases.heeding_ctrl_c,
    )
    end = time.monotonic() + 100.0
    while not (tmp_path / "run" / "shake.nc").exists():
        assert time.monotonic() < end, "the run did not start"
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert "pounding: interrupted" in errors
    assert "Traceback" not in errors
    names = [path.name for path in (tmp_path / "run").iterdir()]
    assert not [name for name in names if ".part" in name or name.startswith(".")]
    assert not [name for name in names if name == "film.mp4"]


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


def started(*words):
    """Start a scheduler or a worker of dask.distributed as a process of its own."""
    command = [sys.executable, "-m", "dask", *words, "--no-dashboard"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for(address, seconds=60.0):
    host, _, port = address.removeprefix("tcp://").partition(":")
    end = time.monotonic() + seconds
    while True:
        try:
            socket.create_connection((host, int(port)), timeout=1.0).close()
            return
        except OSError:
            assert time.monotonic() < end, "the scheduler did not start"
            time.sleep(0.05)


@pytest.mark.slow
def test_a_scheduler_that_dies_on_the_way_is_one_sentence_and_costs_nothing_that_is_finished(tmp_path):
    address, folder, log = f"tcp://127.0.0.1:{free_port()}", tmp_path / "s", tmp_path / "log"
    settings = {"log": str(log), "pause_s": 0.05}
    scheduler = started("scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2])
    worker = started("worker", address, "--nthreads", "1")

    def kill():
        while kept(folder) < 3:
            time.sleep(0.01)
        scheduler.send_signal(signal.SIGKILL)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    try:
        wait_for(address)
        with pytest.raises(ExperimentError, match=f"scheduler {address} was lost; what is finished is kept"):
            sweep(
                cases.noted, {"x": range(60)}, settings=settings, folder=folder, scheduler=address,
                version="1", timeout_s=30.0,
            )  # fmt: skip
    finally:
        for process in (scheduler, worker):
            process.terminate()
            process.wait(timeout=30)
    already = kept(folder)
    assert 3 <= already < 60
    before = log.read_text().split()
    data = sweep(cases.noted, {"x": range(60)}, settings=settings, folder=folder, workers=0, version="1")
    np.testing.assert_array_equal(data.twice, 2.0 * np.arange(60))
    assert len(log.read_text().split()) - len(before) == 60 - already
