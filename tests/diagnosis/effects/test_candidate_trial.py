"""A file of candidates that never ends, or that ends Python, is told in one sentence before the diagnosis."""

from __future__ import annotations

import os
from pathlib import Path
from time import monotonic

import pytest

from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.effects import candidate_trial
from pounding.diagnosis.effects.candidate_trial import try_out
from pounding.diagnosis.errors import CaseError
from pounding.experiments.command.app import main
from tests.diagnosis.case.test_bad_input import case_of
from tests.diagnosis.models import measured

LIMIT_S = 8.0
GOOD = 'def spring(d, v, t, k: "N/m" = 2.0): return k * d\n'
COMPILED = """
def winding(d, v, t, k: "N/m" = 2.0):
    while d < 100.0:
        d = 0.5 * d
    return k * d
"""
NUMBERED = "import os\nopen(__file__ + '.process', 'w').write(str(os.getpid()))\n"


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of candidates to be, in a place where a trial takes no more than 8 s, of which a good one takes two."""
    monkeypatch.setattr(candidate_trial, "TRIAL_S", LIMIT_S)
    return tmp_path / "own.py"


def test_compiled_code_that_never_ends_is_given_up_with_status_2(
    own: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own.write_text(GOOD + COMPILED)
    write_case(case_of(measured(samples=50, runs=2).observed), own.parent / "case")
    began = monotonic()
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(own.parent / "case"), "--candidates", str(own), "--trust"])
    assert monotonic() - began < LIMIT_S + 20.0
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[-1] == (
        f"pounding: {own} line 3: winding was given up after 8 s: its code does not come to an end; "
        "look for a loop that never stops"
    )


@pytest.mark.slow
@pytest.mark.guard
def test_no_process_is_left_of_what_never_ends(own: Path) -> None:
    own.write_text(NUMBERED + "while True: pass")
    with pytest.raises(CaseError, match=r"own.py was given up after 8 s"):
        try_out(own)
    process = int(Path(f"{own}.process").read_text())
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_code_that_ends_python_is_told(own: Path) -> None:
    own.write_text(GOOD + "import os\nos._exit(0)")
    with pytest.raises(CaseError, match=r"own.py ends Python itself when it is tried"):
        try_out(own)


@pytest.mark.parametrize("text", [GOOD + "print('trying: nothing')", "assert False", "def a(:"])
def test_what_comes_to_an_end_is_left_to_be_read(
    own: Path, capfd: pytest.CaptureFixture[str], text: str
) -> None:
    own.write_text(text)
    try_out(own)
    assert capfd.readouterr() == ("", "")
