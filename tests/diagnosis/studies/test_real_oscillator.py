"""The study of a measured oscillator: its variants, and its words where the case is missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.studies.real_oscillator import CASE, VARIANTS, case_folder, rewrite


def test_without_a_folder_the_sentence_names_the_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("POUNDING_CASES", raising=False)
    with pytest.raises(CaseError, match="name the folder that holds it with --cases or POUNDING_CASES"):
        case_folder(None)


def test_a_folder_without_the_case_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"real-oscillator/case\.toml is missing"):
        case_folder(tmp_path)


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("as it is", "0.0016384,-12.7852769934,0.187209544284"),
        ("time to 1e-6 s", "0.001638,-12.7852769934,0.187209544284"),
        ("8 decimals", "0.0016384,-12.78527699,0.18720954"),
        ("table gain x 1.2", "0.0016384,-15.3423323921,0.187209544284"),
    ],
)
def test_a_variant_changes_what_it_says(name: str, row: str, tmp_path: Path) -> None:
    source = tmp_path / CASE
    source.mkdir()
    (source / "case.toml").write_text("title = 'one'\n")
    (source / "run1.csv").write_text("time_s,table,d1\n0.0016384,-12.7852769934,0.187209544284\n")
    rewrite(source, tmp_path / "new", VARIANTS[name])
    assert (tmp_path / "new" / "case.toml").read_text() == "title = 'one'\n"
    assert (tmp_path / "new" / "run1.csv").read_text() == f"time_s,table,d1\n{row}\n"
