"""docs/frames-from-elsewhere.md: its table of modes, written by its script, alone and beside the flats of another page."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path
from typing import Any

import pytest

from pounding.experiments.command.app import main

DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "frames-from-elsewhere.md").read_text(encoding="utf-8")
RECORD = ["--record", "elcentro-chopra"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with the table that the page's first script writes, its frame, and the neighbour."""
    monkeypatch.chdir(tmp_path)
    (script, *_), (frame, *_) = (
        re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL) for kind in ("python", "toml")
    )
    Path("table.py").write_text(script)
    runpy.run_path("table.py")
    Path("measured.toml").write_text(frame)
    other = (DOCS / "full-scale.md").read_text(encoding="utf-8")
    (flats,) = re.findall(r"`flats\.toml`.*?```toml\n(.*?)```", other, re.DOTALL)
    Path("flats.toml").write_text(flats)
    return tmp_path


def answer(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    main([*words, "--json"])
    return dict(json.loads(capsys.readouterr().out))


def test_the_table_of_modes_gives_the_frequencies_of_the_page(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["modal", "measured.toml"])
    said = " ".join(capsys.readouterr().out.split())
    assert "1.100" in said
    assert "3.200" in said
    assert "modes 3 to 4 are not in the table; they are put at 5.333 Hz" in said
    page = " ".join(PAGE.split())
    assert "prints 1.100 and 3.200 Hz, and says that modes 3 to 4 are put at 5.333 Hz" in page


def test_the_measured_frame_beside_its_neighbour(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = " ".join(PAGE.split())
    gap = answer(["gap", "flats.toml", "measured.toml", *RECORD], capsys)["required_gap_mm"]
    assert f"the pair needs {gap:.0f} mm" in page
    stated = Path("measured.toml").read_text()
    rows = re.findall(
        r"^\| (left out|\d+)[^|]*\| (\d+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$", PAGE, re.MULTILINE
    )
    assert len(rows) == 4
    for remainder, *numbers in rows:
        if remainder != "left out":
            Path("measured.toml").write_text(
                stated.replace("# remainder_hz = 6.0", f"remainder_hz = {remainder}")
            )
        words = ["pound", "flats.toml", "measured.toml", "--gap", "50", *RECORD, "--solver", "exact"]
        (run,) = answer(words, capsys)["runs"]
        roof, force = run["peaks"]["right"][-1], max(one["peak_force_n"] for one in run["impacts"])
        assert numbers == [
            f"{len(run['impacts'])}",
            f"{force / 1e6:.1f}",
            f"{roof['max_mm']:.1f}",
            f"{roof['max_acceleration_g']:.1f}",
        ]
