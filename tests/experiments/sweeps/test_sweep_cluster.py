"""Sweeps on a dask.distributed cluster whose scheduler and workers die or freeze: as docs/sweeps.md says."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.sweeps.sweep import sweep

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import sweep_cases as cases  # noqa: E402

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def _workers_find_the_cases(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")]))
    # A silent worker, and a case that two workers died with, is given up; by default after 5 minutes, and four deaths.
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL", "1s")
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "1")


class Cluster:
    """A scheduler and two workers, each a process of its own, so that one of them can be killed or frozen."""

    def __init__(self, nanny):
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{port}"
        self.scheduler = self._start("scheduler", "--host", "127.0.0.1", "--port", str(port))
        self._wait(port)
        words = ("worker", self.address, "--nthreads", "1", "--nanny" if nanny else "--no-nanny")
        self.workers = [self._start(*words) for _ in range(2)]

    def _start(self, *words):
        command = [sys.executable, "-m", "dask", *words, "--no-dashboard"]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def _wait(self, port):
        end = time.monotonic() + 60.0
        while True:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
                return
            except OSError:
                assert time.monotonic() < end, "the scheduler did not start"
                time.sleep(0.05)

    def stop(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@contextmanager
def cluster(nanny=False):
    made = Cluster(nanny)
    try:
        yield made
    finally:
        made.stop()


def kept(folder):
    return len(list(folder.glob("[0-9a-f]*.json")))


def once_begun(folder, process, number, after=3):
    """Send a signal to a process when some cases are finished."""

    def send():
        while kept(folder) < after:
            time.sleep(0.005)
        process.send_signal(number)

    threading.Thread(target=send, daemon=True).start()


def run(made, tmp_path, count, pause_s, timeout_s=30.0):
    return sweep(
        cases.noted, {"x": range(count)}, settings={"log": str(tmp_path / "log"), "pause_s": pause_s},
        folder=tmp_path / "s", scheduler=made.address, version="1", timeout_s=timeout_s,
    )  # fmt: skip


def test_a_worker_that_dies_costs_nothing_and_its_cases_run_elsewhere(tmp_path, chance):
    # Quick cases: results wait in the worker when it dies, and are lost with it.
    with cluster() as made:
        once_begun(tmp_path / "s", made.workers[0], signal.SIGKILL, after=chance.randrange(1, 100))
        data = run(made, tmp_path, 400, 0.005)
    assert (data.failure == "").all()
    np.testing.assert_array_equal(data.twice, 2.0 * np.arange(400))


@pytest.mark.guard
def test_a_worker_that_freezes_loses_its_cases_to_another_one(tmp_path):
    with cluster() as made:
        once_begun(tmp_path / "s", made.workers[0], signal.SIGSTOP)
        data = run(made, tmp_path, 30, 0.05)
    np.testing.assert_array_equal(data.twice, 2.0 * np.arange(30))


@pytest.mark.guard
def test_a_scheduler_that_freezes_is_one_sentence_within_its_time(tmp_path, caplog):
    with cluster() as made:
        once_begun(tmp_path / "s", made.scheduler, signal.SIGSTOP)
        begun = time.monotonic()
        with pytest.raises(ExperimentError, match="has been silent for 4 s; what is finished is kept"):
            run(made, tmp_path, 400, 0.05, timeout_s=4.0)
    assert time.monotonic() - begun < 40.0
    assert kept(tmp_path / "s") >= 3
    assert not caplog.records


def test_a_case_that_kills_its_workers_is_named_and_those_beside_it_are_finished(tmp_path):
    with cluster(nanny=True) as made:
        data = sweep(cases.deadly, {"x": range(6)}, folder=tmp_path / "s", scheduler=made.address)
    assert "worker died every time" in str(data.failure.sel(x=2).item())
    others = data.drop_sel(x=2)
    assert (others.failure == "").all(), others.failure.values
    np.testing.assert_array_equal(others.value, [0.0, 1.0, 3.0, 4.0, 5.0])


@pytest.mark.guard
def test_when_no_worker_is_left_the_case_that_killed_them_is_named(tmp_path):
    with cluster() as made, pytest.raises(ExperimentError) as caught:
        sweep(cases.deadly, {"x": range(6)}, folder=tmp_path / "s", scheduler=made.address, timeout_s=8.0)
    # Another case may have waited at both workers: then it is named as well.
    assert "has had no workers for 8 s (more than one died with the case " in str(caught.value)
    assert "{'x': 2}" in str(caught.value)
    assert kept(tmp_path / "s") >= 1
