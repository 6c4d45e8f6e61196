"""A campaign that is killed half-way goes on where it was, and ends with what it would have ended with."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pounding.experiments.campaign.cases import run_all, run_case

GAPS_MM = (2.0, 2.5, 3.0, 3.5, 4.0, 4.5)
CASE = {"left": "5A", "right": "5B", "record": "elcentro-chopra", "law": "hertz_damp"}
CASES = [CASE | {"gap_mm": gap} for gap in GAPS_MM]

PROGRAM = f"""
import sys
from pathlib import Path
from pounding.experiments.campaign.cases import run_all
if __name__ == "__main__":
    run_all({CASES!r}, kept=Path(sys.argv[1]), workers=2, solver="exudyn")
"""


def finished(folder: Path) -> dict[Path, int]:
    """Finished cases and when they were written."""
    return {path: path.stat().st_mtime_ns for path in folder.glob("[0-9a-f]*.json")}


@pytest.mark.slow
@pytest.mark.guard
def test_a_killed_campaign_goes_on_and_ends_as_if_it_had_not_been(
    tmp_path: Path, chance: random.Random
) -> None:
    program, kept = tmp_path / "campaign.py", tmp_path / "kept"
    program.write_text(PROGRAM)
    process = subprocess.Popen(
        [sys.executable, str(program), str(kept)], stderr=subprocess.DEVNULL, start_new_session=True
    )
    end = time.monotonic() + 300
    wanted = chance.randint(1, len(CASES) - 2)
    while len(finished(kept)) < wanted and process.poll() is None:
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)
    time.sleep(chance.uniform(0.0, 0.3))
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    before = finished(kept)
    assert len(before) >= wanted

    runs = run_all(CASES, kept=kept, workers=1, solver="exudyn")
    after = finished(kept)
    assert len(after) == len(CASES)
    assert before.items() <= after.items(), "a finished case was run again"
    assert runs["gap_mm"].tolist() == list(GAPS_MM)
    afresh = run_case(**CASES[2], folder="", solver="exudyn")
    assert runs.loc[2, "impacts"] == afresh["impacts"]
    assert runs.loc[2, "count"] == afresh["count"] > 0
