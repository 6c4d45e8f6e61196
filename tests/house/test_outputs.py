"""What cannot be written is said before anything is computed, whichever verb, study or script was asked."""

from __future__ import annotations

import inspect
import time
import typing
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from cyclopts import Parameter

from pounding.experiments.command.app import STUDIES, VERBS, main
from pounding.experiments.console import options
from pounding.frames.errors import FrameError
from pounding.frames.files import tried_file, tried_folder

READ_ONLY = {"files", "case", "cases", "records", "measured_file", "candidates", "folder", "pairs"}
"""Paths that are read."""
SCRIPTS = ("pounding.diagnosis.benchmark.fitting:main", "pounding.diagnosis.benchmark.reliability:main")
RECORD = ["--record", "elcentro-chopra"]


def paths(function: str) -> dict[str, Any]:
    """The parameters of a verb or study that are paths, with what cyclopts is told of them."""
    module, name = function.split(":")
    called = getattr(import_module(module), name)
    hints = typing.get_type_hints(called, include_extras=True)
    return {
        one: hints[one]
        for one in inspect.signature(called).parameters
        if Path in (typing.get_args(hints[one]) or ()) or Path in flat(hints[one])
    }


def flat(hint: Any) -> set[Any]:
    parts = typing.get_args(hint)
    return {hint} if not parts else set().union(*(flat(one) for one in parts if one.__hash__))


@pytest.mark.parametrize("function", [*VERBS.values(), *STUDIES.values(), *SCRIPTS])
def test_every_path_that_is_written_is_tried_when_the_words_are_read(function: str) -> None:
    for name, hint in paths(function).items():
        if name in READ_ONLY:
            continue
        told = [one for one in typing.get_args(hint) if isinstance(one, Parameter)]
        tried = {check for one in told for check in one.validator or ()}
        assert tried & {options.writable_folder, options.writable_file, options.report_file}, (
            f"{function}: {name}"
        )


@pytest.mark.parametrize("below", ["", "x", "x/y"])
@pytest.mark.parametrize(
    "words",
    [
        ["demo", "--out"],
        ["shake", "5A", *RECORD, "--out"],
        ["pound", "10", "5B", "--gap", "5", *RECORD, "--out"],
        ["gap", "10", "5B", *RECORD, "--report"],
        ["design", "--tall", "30", "--short", "10", "--pga", "0.2", "--report"],
        ["hide", "nothing", "--out"],
        ["hide", "nothing", "--out", "new", "--truth"],
        ["diagnose", "case", "--out"],
        ["diagnose", "--benchmark", "2", "--out"],
        ["study", "chapter-4", "--out"],
    ],
)
def test_what_cannot_be_written_is_one_sentence_at_once(
    words: list[str],
    below: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    taken = tmp_path / "taken"
    taken.write_text("mine")
    target = taken / below
    if words[-1] in ("--report", "--truth") and not below:
        target = tmp_path / "folder.html"
        target.mkdir()
    elif words[-1] == "--report":
        target = target.with_suffix(".html")
    before = sorted(tmp_path.rglob("*"))
    started = time.perf_counter()
    with pytest.raises(SystemExit) as left:
        main([*words, str(target)])
    assert time.perf_counter() - started < 10.0
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "cannot be written" in err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "words", [["gap", "10", "5B", *RECORD], ["design", "--tall", "30", "--short", "10", "--pga", "0.2"]]
)
def test_a_report_is_no_file_of_another_kind(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A frame file that is named there by mistake stays."""
    mine = tmp_path / "mine.toml"
    mine.write_text("mine")
    with pytest.raises(SystemExit) as left:
        main([*words, "--report", str(mine)])
    assert left.value.code == 2
    assert "a report is an HTML file; call it mine.html" in capsys.readouterr().err
    assert mine.read_text() == "mine"


def test_a_trial_leaves_nothing_and_may_be_done_twice(tmp_path: Path) -> None:
    for _ in range(2):
        tried_folder(tmp_path / "a" / "b")
        tried_file(tmp_path / "a" / "b" / "c.html")
    assert not list(tmp_path.iterdir())
    for name in ("zero\0byte", "n" * 300):
        with pytest.raises(FrameError, match="cannot be written"):
            tried_folder(tmp_path / name)
    assert not list(tmp_path.iterdir())
