"""Diagnose the fixed set and compare verdicts, places and parameters with those that are kept (`make guard`).

Not part of the tests: it takes over an hour of CPU. Its standard is `expected.json`, of the commits it names; `--accept`
makes what was found now the standard, where a change is meant.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from tests.guard.cases import drawn_names, find_folders, make, open_folders
from tests.guard.comparison import differences, kept

EXPECTED = Path(__file__).with_name("expected.json")


def main() -> None:
    """Run the cases that are asked for; the exit status is 1 where one differs."""
    asked = _arguments()
    find_folders()
    expected = json.loads(EXPECTED.read_text(encoding="utf-8"))
    folders = {name: asked.out / "cases" / name for name in drawn_names()} | open_folders()
    names = [name for name in folders if asked.only in name]
    if not names:
        sys.exit(f"guard: no case has {asked.only!r} in its name; there are {', '.join(folders)}")
    if not asked.resume:
        shutil.rmtree(asked.out / "reports", ignore_errors=True)
    (asked.out / "reports").mkdir(parents=True, exist_ok=True)
    differing, found = 0, {}
    with ThreadPoolExecutor(asked.workers) as pool:
        for name, one in zip(names, pool.map(partial(_one, asked.out, folders), names), strict=True):
            found[name] = one
            told = _told(expected["cases"].get(name), one)
            differing += bool(told)
            print(f"{name}: {'as expected' if not told else '; '.join(told)}", flush=True)
    _summary(expected["cases"], found, differing)
    if asked.accept:
        cases = dict(sorted((expected["cases"] | found).items()))
        text = json.dumps({"made_by": "make guard --accept", "cases": cases}, indent=1)
        EXPECTED.write_text(text + "\n", encoding="utf-8")
    sys.exit(1 if differing and not asked.accept else 0)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.guard", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=Path("results/guard"), help="folder for cases and reports"
    )
    parser.add_argument(
        "--only", default="", help="only cases with this in their name, such as single-0 or open"
    )
    parser.add_argument("--workers", type=int, default=2, help="cases at a time")
    parser.add_argument("--resume", action="store_true", help="keep the reports of an interrupted run")
    parser.add_argument("--accept", action="store_true", help="make what is found the standard")
    return parser.parse_args()


def _one(out: Path, folders: dict[str, Path], name: str) -> dict[str, Any]:
    """Return what is kept of a case's report, with `verdict` None and the last line of the error where there is none."""
    file = out / "reports" / f"{name}.json"
    if file.is_file():
        return dict(json.loads(file.read_text(encoding="utf-8")))
    if name in drawn_names():
        make(name, folders[name])
    command = [sys.executable, "-c", _RUN, str(folders[name])]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | _ONE_THREAD, check=False)
    if done.returncode:
        return {"verdict": None, "effects": [], "error": done.stderr.strip().splitlines()[-1:], "cpu_s": 0.0}
    report, cpu_s = json.loads(done.stdout), float(done.stderr.split()[-1])
    one = kept(report, cpu_s)
    file.write_text(json.dumps(one), encoding="utf-8")
    return one


_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
_RUN = """
import resource, sys
from pounding.experiments.command.app import app
app(["diagnose", sys.argv[1], "--json"])
print(resource.getrusage(resource.RUSAGE_SELF).ru_utime, file=sys.stderr)
"""


def _told(expected: dict[str, Any] | None, found: dict[str, Any]) -> list[str]:
    if found["verdict"] is None:
        return [f"no report: {' '.join(found['error'])}"] if expected and expected["verdict"] else []
    if expected is None or expected["verdict"] is None:
        return [f"verdict {found['verdict']}, nothing was kept for it"]
    return differences(expected, found)


def _summary(expected: dict[str, Any], found: dict[str, Any], differing: int) -> None:
    both = [
        name for name in found if name in expected and found[name]["verdict"] and expected[name]["verdict"]
    ]
    before, now = (sum(kept_[name]["cpu_s"] for name in both) for kept_ in (expected, found))
    print(
        f"{len(found) - differing} of {len(found)} cases are as expected; CPU {now:.0f} s, was {before:.0f} s"
    )


if __name__ == "__main__":
    main()
