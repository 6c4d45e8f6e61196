"""A file of candidates is code: it is executed only for a good case, and only when the user says so."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from pounding.diagnosis.case.writing import write_case
from pounding.experiments.command.app import main
from tests.diagnosis.case.test_bad_input import case_of
from tests.diagnosis.models import measured

CODE = "from pathlib import Path\nPath(__file__).with_suffix('.executed').touch()\n"
"""Leaves a mark, and offers no candidate, so that the diagnosis ends there."""


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def case(tmp_path: Path) -> Path:
    write_case(case_of(measured(samples=50, runs=2).observed), tmp_path / "case")
    (tmp_path / "mine.py").write_text(CODE)
    return tmp_path / "case"


def said(case: Path, capsys: pytest.CaptureFixture[str], *words: str) -> str:
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(case), "--candidates", str(case.parent / "mine.py"), *words])
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    return err


def executed(case: Path) -> bool:
    return (case.parent / "mine.executed").exists()


def test_without_a_terminal_it_is_refused_in_one_sentence(
    case: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    err = said(case, capsys)
    assert "--candidates executes the Python code in" in err
    assert "add --trust if you trust it" in err
    assert err.count("\n") == 1
    assert not executed(case)


@pytest.mark.parametrize(
    ("answer", "runs"), [("y\n", True), ("Yes\n", True), ("n\n", False), ("\n", False), ("", False)]
)
def test_on_a_terminal_it_asks(
    case: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, answer: str, runs: bool
) -> None:
    monkeypatch.setattr(sys, "stdin", Terminal(answer))
    err = said(case, capsys)
    assert "Do you trust this file? [y/N]" in err
    assert ("holds no candidate" in err) == runs
    assert executed(case) == runs


def test_trust_executes_it_and_nothing_is_left_beside_it(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "holds no candidate" in said(case, capsys, "--trust")
    assert executed(case)
    assert {path.name for path in case.parent.iterdir()} == {"case", "mine.py", "mine.executed"}


def test_a_bad_case_is_refused_before_it_is_executed(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (case / "run2.csv").unlink()
    assert "run2.csv is not there" in said(case, capsys, "--trust")
    assert not executed(case)


def test_an_output_that_cannot_be_is_refused_before_it_is_executed(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "cannot be written" in said(case, capsys, "--trust", "--out", str(case.parent / "mine.py" / "x"))
    assert not executed(case)


def test_trust_belongs_to_candidates(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(case), "--trust"])
    assert left.value.code == 2
    assert "--trust belongs to --candidates" in capsys.readouterr().err
