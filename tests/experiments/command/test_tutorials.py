"""The tutorials run as they are written, and print the numbers that stand in them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

TUTORIALS = Path(__file__).parents[3] / "docs" / "tutorials"


def _run(page: str, folder: Path) -> str:
    """Run all commands of a page in one shell and return what they print, blanks and lines joined."""
    text = (TUTORIALS / page).read_text(encoding="utf-8")
    commands = "\n".join(re.findall(r"```shell\n(.*?)```", text, re.DOTALL))
    environment = os.environ | {
        "COLUMNS": "250",
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
    }
    done = subprocess.run(
        ["bash", "-e", "-c", commands],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return re.sub(r"\s+", " ", done.stdout)


@pytest.mark.slow
def test_the_building_pair(tmp_path: Path):
    said = _run("building-pair.md", tmp_path)
    page = (TUTORIALS / "building-pair.md").read_text(encoding="utf-8")
    for printed, written in (
        ("169.37", "169.4 mm"),
        ("177.89", "177.9 mm"),
        ("138.84 to 211.33", "138.8 to 211.3 mm"),
        ("163.19", "163.2 mm"),
        ("22874543", "22.9 MN"),
        ("full scale, by the height of the storeys", "storeys are higher than 2 m"),
    ):
        assert printed in said
        assert written in page
    assert said.count(" │ 3 │ ") >= 8
    for name in ("forces.png", "collision.png", "pound.json"):
        assert (tmp_path / "pair" / name).is_file()


@pytest.mark.slow
def test_what_to_do(tmp_path: Path):
    said = _run("what-to-do.md", tmp_path)
    page = (TUTORIALS / "what-to-do.md").read_text(encoding="utf-8")
    for printed, written in (
        ("213.39", "213.39"),
        ("180.86", "180.86 mm"),
        ("19009504", "19.0 MN"),
        ("7.59", "7.59 g"),
        ("0.58", "0.58 g"),
        ("1.05", "1.05 g"),
        ("3705546", "3.7 MN"),
    ):
        assert printed in said
        assert written in page
    for name in (
        "before/collision.png",
        "measures/mitigate.html",
        "measures/trade-offs.png",
        "after/pound.json",
    ):
        assert (tmp_path / name).is_file()


@pytest.mark.slow
def test_the_measurement(tmp_path: Path):
    said = _run("measurement.md", tmp_path)
    page = (TUTORIALS / "measurement.md").read_text(encoding="utf-8")
    (ends,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    assert "measured can be read; next: pounding diagnose measured" in said
    assert re.sub(r"\s+", " ", ends).strip() in said
    for name in ("report.html", "before.pvd", "after.pvd"):
        assert (tmp_path / "report" / name).is_file()
