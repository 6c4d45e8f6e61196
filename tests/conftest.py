"""Where the tests find ground motions and measured cases that are not part of the project."""

from __future__ import annotations

import gc
import os
import random
import signal
import subprocess
import sys
from collections.abc import Callable
from datetime import date
from pathlib import Path

import pytest

from tests.compiling import compiled_by
from tests.own_core import on_own_core


def _folder(variable: str, what: str) -> Path:
    named = os.environ.get(variable)
    if not named or not Path(named).is_dir():
        # Where everything must hold, a test that quietly does not run is a failure.
        refuse = pytest.fail if os.environ.get("CI") else pytest.skip
        refuse(f"{what}: set {variable} to a folder that holds them")
    return Path(named)


@pytest.fixture(scope="session")
def test_records() -> Path:
    """Folder with the four motions of the tests: elcentro, hachinohe, northridge, kobe."""
    return _folder("POUNDING_RECORDS", "the four motions of the tests may not be redistributed")


@pytest.fixture(scope="session")
def open_cases() -> Path:
    """Folder with measured cases made by another simulator."""
    return _folder("POUNDING_CASES", "the open cases are not part of the project")


def pytest_configure() -> None:
    """Let Ctrl-C reach the commands that tests start: a shell has what it runs in the background ignore it."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_sessionstart() -> None:
    """Let processes that test side by side compile different parts of what all of them use, each on its own core."""
    worker = os.environ.get("PYTEST_XDIST_WORKER")
    on_own_core(worker)
    compiled_by(worker)


def pytest_collection_finish() -> None:
    """Keep what all tests share, more than a million objects, out of the sight of the garbage collector."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def chance() -> random.Random:
    """Random moments for kills and interruptions: others every day, and again those of a day by its number."""
    seed = int(os.environ.get("POUNDING_SEED", date.today().toordinal()))
    print(f"POUNDING_SEED={seed} gives the same moments again")
    return random.Random(seed)


KILLED_WHILE_WRITING = """
import os, signal, sys
from pounding.frames.files import replacing
with replacing(sys.argv[1]) as part:
    part.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(scope="session")
def killed_while_writing() -> Callable[[Path], Path]:
    """Has a file begun by a process that is then killed; returns what it leaves in the folder."""

    def begin(path: Path) -> Path:
        path.parent.mkdir(parents=True, exist_ok=True)
        before = set(path.parent.iterdir())
        subprocess.run([sys.executable, "-c", KILLED_WHILE_WRITING, str(path)], timeout=60)
        (left,) = set(path.parent.iterdir()) - before
        assert left.read_text() == "half"
        return left

    return begin
