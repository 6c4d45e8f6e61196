"""Worker processes: they work at the same time, share what is said to be shared, and never outlive who waits for them."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.forked import FORKS, forked, meanwhile
from pounding.diagnosis.model.side_by_side import cores
from tests.benchmarks.diagnosis_cost import BASE, LONG, made, modelled

pytestmark = pytest.mark.skipif(not FORKS, reason="no workers may be forked on this system")


@pytest.fixture(autouse=True)
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)


def test_pieces_run_at_the_same_time_in_two_processes_without_further_threads() -> None:
    both = multiprocessing.get_context("fork").Barrier(2)

    def met(_: int) -> tuple[int, int]:
        both.wait(timeout=10.0)
        return os.getpid(), cores()

    (one, its_cores), (other, _) = forked(met, [0, 1])
    assert len({one, other, os.getpid()}) == 3
    assert its_cores == 1
    assert cores() == 2


def test_what_is_shared_comes_back_as_the_same_object_and_all_else_as_a_copy() -> None:
    class Nameless:
        """It cannot be imported, as a user's effect cannot."""

    model, own = Nameless(), [1.0]
    results = forked(lambda _: (model, Nameless, own), [0, 1], shared=(model, Nameless))
    for same, kind, copied in results:
        assert same is model
        assert kind is Nameless
        assert copied == own
        assert copied is not own


def test_an_error_in_a_piece_is_the_callers_and_no_process_stays() -> None:
    def fails(piece: int) -> int:
        raise ValueError(f"piece {piece}")

    with pytest.raises(ValueError, match=r"piece [01]"):
        forked(fails, [0, 1])
    assert not multiprocessing.active_children()


class Wayward(Exception):
    """An error that cannot be made again from what it says."""

    def __init__(self, what: str, where: str) -> None:
        super().__init__(f"{what} at {where}")


def test_an_error_that_cannot_be_sent_says_the_same_all_the_same() -> None:
    def fails(piece: int) -> int:
        raise Wayward("nothing", f"piece {piece}")

    # A library that is loaded beside this may have taught pickle to send it as it is.
    with pytest.raises((RuntimeError, Wayward), match=r"nothing at piece [01]"):
        forked(fails, [0, 1])


def test_a_process_that_is_ended_from_outside_is_said_to_be() -> None:
    with pytest.raises(CaseError, match="status -9, as when memory runs out; free some memory"):
        forked(lambda _: os.kill(os.getpid(), signal.SIGKILL), [0, 1])


def test_a_worker_works_meanwhile() -> None:
    both = multiprocessing.get_context("fork").Barrier(2)
    with meanwhile(lambda: (both.wait(timeout=10.0), os.getpid())) as result:
        both.wait(timeout=10.0)
        assert result()[1] != os.getpid()
    assert not multiprocessing.active_children()


def test_on_one_core_the_work_is_done_here_and_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0}, raising=False)
    assert forked(lambda _: os.getpid(), [0, 1]) == [os.getpid()] * 2
    with meanwhile(os.getpid) as result:
        assert result() == os.getpid()


def test_where_memory_is_short_the_work_is_done_here_and_in_turn() -> None:
    assert forked(lambda _: os.getpid(), [0, 1], at_once=False) == [os.getpid()] * 2
    with meanwhile(os.getpid, at_once=False) as result:
        assert result() == os.getpid()


def test_long_runs_are_no_light_work() -> None:
    runs = [0, 1, 2]
    assert modelled(made(BASE)).is_light(runs)
    assert not modelled(made(LONG)).is_light(runs)


WAITING = """
import os, time
os.sched_getaffinity = lambda _: {0, 1}
from pounding.diagnosis.model.forked import forked
def wait(piece):
    os.write(1, f"{os.getpid()}\\n".encode())  # at once: the lines of two workers are not to mix
    time.sleep(60)
forked(wait, [0, 1])
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_workers_end_with_the_process_that_waits_for_them(how: signal.Signals, tmp_path: Path) -> None:
    code = WAITING if how is signal.SIGINT else WAITING.replace("time.sleep(60)", "time.sleep(1)")
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    ) as process:
        assert process.stdout is not None
        workers = [int(process.stdout.readline()) for _ in range(2)]
        process.send_signal(how)
        _, errors = process.communicate(timeout=30)
    assert process.returncode != 0
    assert errors.count("Traceback") <= 1  # the one of who waits
    deadline = time.monotonic() + 10.0
    while any(Path(f"/proc/{worker}").exists() for worker in workers):
        assert time.monotonic() < deadline
        time.sleep(0.05)


HEEDING = """
import os, sys, time
os.sched_getaffinity = lambda _: {0, 1}
from pounding.diagnosis.model.forked import meanwhile
from pounding.experiments.console.interruption import heeding
def wait():
    os.write(1, b"here\\n")
    time.sleep(60)
with heeding(), meanwhile(wait):
    time.sleep(float(sys.argv[1]))
"""


def begun(seconds: float, tmp_path: Path) -> subprocess.Popen[str]:
    """Return a command whose worker is at work."""
    process = subprocess.Popen(
        [sys.executable, "-c", HEEDING, str(seconds)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stdout.readline() == "here\n"
    return process


def test_a_worker_that_is_needed_no_more_says_nothing(tmp_path: Path) -> None:
    with begun(0.5, tmp_path) as process:
        assert process.communicate(timeout=30)[1] == ""
    assert process.returncode == 0


def test_who_asks_all_processes_to_end_gets_one_answer(tmp_path: Path) -> None:
    with begun(60.0, tmp_path) as process:
        os.killpg(process.pid, signal.SIGTERM)
        assert process.communicate(timeout=30)[1] == "pounding: terminated\n"
    assert process.returncode == 128 + signal.SIGTERM
