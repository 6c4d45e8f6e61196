"""The command as a user meets it: help on every verb, one sentence and status 2 for bad input."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pounding.experiments.command.app import STUDIES, VERBS, described


def pounding(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "pounding.experiments.command", *words],
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.parametrize("words", [[], *([verb] for verb in VERBS), *(["study", name] for name in STUDIES)])
def test_help(words: list[str]) -> None:
    done = pounding(*words, "--help")
    assert done.returncode == 0, done.stderr
    assert "Usage: pounding" in done.stdout


SCRIPTS = [
    *(function.split(":")[0] for function in STUDIES.values()),
    "pounding.diagnosis.benchmark.reliability",
    "pounding.diagnosis.benchmark.fitting",
]


@pytest.mark.parametrize("module", SCRIPTS)
def test_a_script_has_options_and_says_what_is_wrong_as_the_command_does(module: str) -> None:
    script = [sys.executable, "-m", module]
    helped = subprocess.run([*script, "--help"], capture_output=True, text=True, timeout=300)
    assert helped.returncode == 0, helped.stderr
    assert f"Usage: python -m {module}" in helped.stdout
    done = subprocess.run([*script, "--nonsense"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("pounding: ")
    assert done.stderr.count("\n") == 1


def test_a_script_without_its_input_says_so() -> None:
    for module, words in (("reliability", ["/nowhere"]), ("fitting", ["/nowhere", "a note"])):
        script = [sys.executable, "-m", f"pounding.diagnosis.benchmark.{module}", *words]
        done = subprocess.run(script, capture_output=True, text=True, timeout=300)
        assert done.returncode == 2
        assert done.stderr.startswith("pounding: /nowhere: ")
        assert done.stderr.count("\n") == 1


def test_list_as_json() -> None:
    done = pounding("list", "--json")
    assert done.returncode == 0, done.stderr
    listed = json.loads(done.stdout)
    assert {"5A", "5B", "10", "15A", "15B"} <= {frame["name"] for frame in listed["frames"]}
    assert {law["name"] for law in listed["laws"]} >= {
        "linear_spring",
        "linear_viscoelastic",
        "hertz",
        "nonlinear_viscoelastic",
        "hertz_damp",
    }
    assert listed["schema"] == 1
    assert listed["software"] == "pounding"


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["modal", "5C"], "5"),
        (["modal"], "frame"),
        (["modul", "5A"], "modul"),
        (["modal", "5A", "--joints", "soft"], "soft"),
        (["modal", "5A", "--damping", "much"], "much"),
        (["shake", "5A", "--record", "elcentre"], "elcentr"),
        (["shake", "5A", "--record", "elcentro-chopra", "--pga", "-1"], "peak"),
        (["pound", "15B", "5B", "--gap", "-3", "--record", "elcentro-chopra"], "gap"),
        (["study", "table-3-2"], "table-3-2"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(words: list[str], named: str) -> None:
    done = pounding(*words)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert named.lower() in done.stderr.lower()


@pytest.mark.parametrize(
    "words",
    [
        ["shake", "5A", "--record", "elcentre"],
        ["pound", "15B", "5B", "--gap", "-3", "--record", "elcentro-chopra"],
    ],
)
def test_bad_input_leaves_no_folder(words: list[str], tmp_path: Path) -> None:
    assert pounding(*words, "--out", str(tmp_path / "results")).returncode == 2
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("verb", [["shake", "5A"], ["pound", "10", "5B", "--gap", "5"]])
def test_a_folder_that_cannot_be_is_said_before_anything_is_computed(verb: list[str], tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = pounding(*verb, "--record", "elcentro-chopra", "--out", str(tmp_path / "file"))
    assert done.returncode == 2
    assert done.stderr.endswith("file: cannot be made (File exists)\n")


@pytest.mark.parametrize("function", [*VERBS.values(), *STUDIES.values()])
def test_every_verb_and_study_says_in_the_list_what_it_does(function: str) -> None:
    said = described(function)
    assert said.split("\n")[0].endswith(".")
    assert "Args:" not in said
