"""What it costs to start the command: `pounding --help`, `pounding list` and the help of each verb.

Processor seconds (user and system) of a fresh process, which what else runs on the machine does not lengthen
much, and wall seconds; the median of some runs, after one that fills the file cache.

    python tests/benchmarks/start_cost.py --out docs/validation/start-cost.json
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from pounding.experiments.command.app import VERBS

REPEATS = 7
CALLS = [["--help"], ["list"], *([verb, "--help"] for verb in VERBS)]


def started(words: list[str]) -> tuple[float, float]:
    """Return processor and wall seconds of one call of the command."""
    before, began = os.times(), time.perf_counter()
    subprocess.run([sys.executable, "-m", "pounding", *words], check=True, capture_output=True)
    after, wall = os.times(), time.perf_counter() - began
    cpu = after.children_user - before.children_user + after.children_system - before.children_system
    return cpu, wall


def measured(words: list[str], repeats: int) -> dict[str, object]:
    """Return the medians of some calls after a first one."""
    started(words)
    runs = [started(words) for _ in range(repeats)]
    cpu, wall = (statistics.median(column) for column in zip(*runs, strict=True))
    return {"call": " ".join(["pounding", *words]), "cpu_s": round(cpu, 3), "wall_s": round(wall, 3)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="JSON file for the table")
    parser.add_argument("--repeats", type=int, default=REPEATS)
    chosen = parser.parse_args()
    rows = [measured(words, chosen.repeats) for words in CALLS]
    shown = Table(*rows[0])
    for row in rows:
        shown.add_row(*map(str, row.values()))
    Console().print(shown)
    if chosen.out:
        chosen.out.write_text(json.dumps({"runs": chosen.repeats, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
