"""The exact solver says when it is compiled: to a user at a terminal, not to a program."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pounding.experiments.console import remarks
from pounding.experiments.rig.compiling import COMPILING

RUN = """
from pounding.experiments.console import exit_status, remarks
{show}
import sys
sys.stderr.isatty = lambda: {terminal}
from pounding.experiments.rig import exact_loop, exact
import numpy as np
exact_loop.crossing(-1.0, 1.0, 1.0, 1.0)
exact_loop.fill(np.array([-1.0 + 5.0j]), 0.1, np.empty((8, 1)))
"""


def said(cache: Path, show: bool, terminal: bool) -> str:
    code = RUN.format(show="remarks.show()" if show else "", terminal=terminal)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=environment, timeout=300, check=True
    )
    assert run.stdout == ""
    return run.stderr


@pytest.mark.slow
@pytest.mark.guard
def test_it_is_said_once_on_a_machine_and_only_at_a_terminal(tmp_path: Path) -> None:
    assert said(tmp_path / "library", show=False, terminal=True) == ""
    assert said(tmp_path / "file", show=True, terminal=False) == ""
    assert said(tmp_path / "command", show=True, terminal=True) == f"{COMPILING}\n"
    # The second time it comes from the cache.
    assert said(tmp_path / "command", show=True, terminal=True) == ""


def test_a_remark_is_shown_once_however_often_it_is_asked_for(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    remarks.show()
    remarks.show()
    logging.getLogger("pounding.anything").info("a remark")
    assert capsys.readouterr().err.count("a remark") == 1
