"""Every verb, interrupted at a random moment by Ctrl-C as a terminal sends it: to all of its processes."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pounding.experiments.command.app import VERBS
from pounding.frames.files import PART
from pounding.frames.templates import template

pytestmark = pytest.mark.slow

PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from pounding.experiments.command import main
print("begun", file=sys.stderr, flush=True)
main(sys.argv[1:])
print("ended", file=sys.stderr, flush=True)
"""

ELCENTRO = ["--record", "elcentro-peer180"]

WORDS = {
    "list": ["list"],
    "demo": ["demo", "--out", "OUT"],
    "new-frame": ["new-frame", "OUT/mine.toml"],
    "new-street": ["new-street", "OUT/street.toml", "5A", "10"],
    "mitigate": ["mitigate", "STREET", *ELCENTRO, "--out", "OUT"],
    "fragility": ["fragility", "STREET", *ELCENTRO, "--record", "elcentro-chopra", "--out", "OUT"],
    "opensees": ["opensees", "OFFICE", "OUT/office.py"],
    "modal": ["modal", "15B"],
    "shake": ["shake", "5A", *ELCENTRO, "--film", "--out", "OUT"],
    "pound": ["pound", "10", "5B", "--gap", "3", *ELCENTRO, "--law", "all", "--out", "OUT"],
    "experiment": ["experiment", "collision-10-5B-elcentro-6mm", "--out", "OUT"],
    "gap": ["gap", "10", "5B", *ELCENTRO, "--report", "OUT/gap.html"],
    "design": ["design", "--tall", "30", "--short", "15", "--pga", "0.3", "--report", "OUT/design.html"],
    "diagnose": ["diagnose", "CASE", "--out", "OUT"],
    "check-case": ["check-case", "CASE"],
    "new-case": ["new-case", "CASE/run1.csv", "--frame", "5A", "--out", "OUT"],
    "hide": ["hide", "nothing", "--out", "OUT", "--motions", "artificial"],
    "benchmark": ["diagnose", "--benchmark", "4", "--out", "OUT"],
    "calibration": ["diagnose", "CASE", "--calibrate"],
    "study": ["study", "chapter-6", "--kept", "OUT"],
}
"""The words of each verb, and of what else may take long: a benchmark, a calibration, a study in processes."""

USUAL = ("shake", "pound", "experiment", "diagnose", "benchmark", "study")
"""What runs longest, in one process and in several; the others are for `make guard`."""

LONGEST_S = 4.0
"""Random moments lie in so long a time after the start: imports, preparation and work."""


def test_every_verb_is_here() -> None:
    assert set(VERBS) <= set(WORDS)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("case") / "case"
    words = ["hide", "nothing", "--out", str(folder), "--motions", "artificial", "--duration", "4"]
    subprocess.run([sys.executable, "-m", "pounding", *words], check=True, timeout=120)
    return folder


@pytest.mark.parametrize(
    "verb", [verb if verb in USUAL else pytest.param(verb, marks=pytest.mark.guard) for verb in WORDS]
)
def test_an_interrupted_verb_says_so_and_leaves_nothing_half_made(
    verb: str, case: Path, tmp_path: Path, chance: random.Random
) -> None:
    out, scratch = tmp_path / "out", tmp_path / "scratch"
    scratch.mkdir()
    street = tmp_path / "street.toml"
    street.write_text('[[building]]\nframe = "10"\n[[building]]\nframe = "5B"\n[[gap]]\ngap_mm = 3\n')
    office = tmp_path / "office.toml"
    office.write_text(template("stick", "office"))
    places = {"OUT": out, "CASE": case, "STREET": street, "OFFICE": office}
    words = WORDS[verb]
    for name, path in places.items():
        words = [word.replace(name, str(path)) for word in words]
    environment = os.environ | {"TMPDIR": str(scratch), "POUNDING_CACHE": str(tmp_path / "cache")}
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words], start_new_session=True, env=environment, text=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stderr is not None
    assert process.stderr.readline() == "begun\n"
    moment = random.Random(f"{chance.random()} {verb}").uniform(0.02, LONGEST_S)
    time.sleep(moment)
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert "Traceback" not in errors, f"{moment} s: {errors}"
    # What had already shown its result may have ended before the signal came.
    if not errors.endswith("ended\n"):
        assert process.returncode == 130, f"{moment} s: {errors}"
        assert errors.splitlines()[-1].startswith("pounding: interrupted"), f"{moment} s: {errors}"
    left = [path for path in tmp_path.rglob("*") if PART.fullmatch(path.name) or ".part" in path.name]
    assert not left
    assert not out.is_dir() or any(out.iterdir()), "an empty folder is left"
    assert not list(scratch.glob("*pounding*"))
