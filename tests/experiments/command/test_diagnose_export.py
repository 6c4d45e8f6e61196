"""`pounding diagnose --export-model`: what it says of the files, and how it ends where there is no corrected model."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec import structs

from pounding.diagnosis import workflow
from pounding.diagnosis.report.report import CorrectedModel
from pounding.experiments.command.app import main
from tests.diagnosis.report.test_report import of_runs

CASE = 'title = "t"\n[[frame]]\nname = "5A"\n[[run]]\nfile = "run1.csv"\n' + "".join(
    f'[[channel]]\nname = "{name}"\n{place}quantity = "{quantity}"\nunit = "m/s^2"\n'
    for name, place, quantity in (
        ("t", "", "table_acceleration"),
        ("a5", "floor = 5\n", "absolute_acceleration"),
    )
)


@pytest.fixture
def case(tmp_path: Path) -> Path:
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    rows = "".join(f"{0.01 * k:.2f},{k % 7},{k % 5}\n" for k in range(100))
    (tmp_path / "run1.csv").write_text("time_s,t,a5\n" + rows, encoding="utf-8")
    return tmp_path


def ended(case: Path, file: str, model: CorrectedModel, monkeypatch: pytest.MonkeyPatch) -> int:
    """Return the exit status of a diagnosis whose corrected model is given."""
    report = structs.replace(of_runs(), model=model)
    monkeypatch.setattr(workflow, "diagnose", lambda *given, **options: report)
    try:
        main(["diagnose", str(case), "--export-model", file])
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def test_the_files_and_what_is_not_in_them_are_said(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = CorrectedModel(
        files=("f.toml", "r.csv"), motions=("r.csv",), beside=("sensor gain",), case="f-case"
    )
    assert ended(case, str(case / "f.toml"), model, monkeypatch) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "the corrected model is f.toml, the table's motion in each run beside it" in said
    assert "not in it, because it is not on a frame or no file can state it: sensor gain" in said
    assert "the measurements without that are the case f-case" in said


def test_without_a_corrected_model_the_report_is_shown_and_the_status_is_2(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = CorrectedModel(files=(), refused="nothing in the catalogue fits")
    assert ended(case, str(case / "f.toml"), model, monkeypatch) == 2
    told = capsys.readouterr()
    assert "Misfit" in told.out
    assert "no corrected model was written" in told.err
    assert "nothing in the catalogue fits" in told.err


@pytest.mark.parametrize(
    ("file", "said"), [("f.csv", "a frame file ends in .toml"), ("folder.toml", "it is a folder")]
)
def test_a_file_that_cannot_be_is_refused_before_the_work(
    case: Path, file: str, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (case / "folder.toml").mkdir()
    assert ended(case, str(case / file), CorrectedModel(files=()), monkeypatch) == 2
    assert said in " ".join(capsys.readouterr().err.split())
