"""A benchmark that is killed at a random moment goes on, and ends with what it would have ended with."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from pounding.frames.files import PART, read_entry

WORDS = ["diagnose", "--benchmark", "3", "--seed", "3", "--way", "sparse"]


def run(out: Path, seconds: float) -> int | None:
    """Run the benchmark for at most so many seconds, then kill it and its workers; return its exit status."""
    command = [sys.executable, "-m", "pounding", *WORDS, "--out", str(out)]
    process = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        return process.wait(timeout=seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def judged(out: Path) -> list[dict[str, Any]]:
    cases = json.loads((out / "benchmark.json").read_text())["judged"]
    return [{key: value for key, value in case.items() if key != "seconds"} for case in cases]


def finished(out: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in (out / "cases").glob("[0-9a-f]*.json")}


@pytest.mark.slow
@pytest.mark.guard
def test_a_killed_benchmark_ends_as_one_that_was_not(tmp_path: Path, chance: random.Random) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    begun = time.monotonic()
    assert run(whole, 300.0) == 0
    takes_s = time.monotonic() - begun
    run(killed, chance.uniform(0.1, 0.9) * takes_s)
    kept = finished(killed)
    assert all(read_entry(path) is not None for path in kept), "a finished case that is not whole"
    assert run(killed, 300.0) == 0
    assert kept.items() <= finished(killed).items(), "a finished case was run again"
    assert judged(killed) == judged(whole)
    assert not [path for path in killed.rglob("*") if PART.fullmatch(path.name)]
