"""The tutorials run as they are written, and print the numbers that stand in them."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

TUTORIALS = Path(__file__).parents[3] / "docs" / "tutorials"


def _text(page: str) -> str:
    return (TUTORIALS / page).read_text(encoding="utf-8")


def _joined(text: str) -> str:
    return re.sub(r"\s+", " ", text).strip()


def _run(page: str, folder: Path) -> str:
    """Save the files of a page, run all its commands in one shell, and return what they print, blanks and lines joined."""
    text = _text(page)
    for content, name in re.findall(r"```python\n(# (\w+\.py)\n.*?)```", text, re.DOTALL):
        (folder / name).write_text(content, encoding="utf-8")
    return _shell("\n".join(re.findall(r"```shell\n(.*?)```", text, re.DOTALL)), folder)


def _shell(commands: str, folder: Path) -> str:
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
    return _joined(done.stdout)


@pytest.mark.slow
def test_the_building_pair(tmp_path: Path):
    said = _run("building-pair.md", tmp_path)
    page = _text("building-pair.md")
    for printed, written in (
        ("169.19", "169.2 mm"),
        ("177.89", "177.9 mm"),
        ("139.02 to 211.17", "139.0 to 211.2 mm"),
        ("163.19", "163.2 mm"),
        ("│ 22875 │", "22.9 MN"),
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
        ("│ 19010 │", "19.0 MN"),
        ("7.59", "7.59 g"),
        ("0.58", "0.58 g"),
        ("1.05", "1.05 g"),
        ("│ 3706 │", "3.7 MN"),
    ):
        assert printed in said
        assert written in page
    measures = (TUTORIALS.parent / "mitigation.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| ([a-z-]+(?: \| [\d.,]+){6}) \|$", measures, re.MULTILINE)
    assert len(table) == 8
    for row in table:
        assert f"│ {row.replace('|', '│')} │" in said
    for name in (
        "before/collision.png",
        "measures/mitigate.html",
        "measures/trade-offs.png",
        "after/pound.json",
    ):
        assert (tmp_path / name).is_file()
    sheet, behind = (tmp_path / "measures/mitigate.html").read_text(encoding="utf-8").split("</section>")
    assert "As it is, floors touch 50 times" in sheet
    assert "60 / 213" in sheet.split("<svg")[1]
    for row in table:
        assert f"<td>{row.split(' | ')[0]}</td>" in sheet
    assert "a block of rubber" in behind


@pytest.mark.slow
def test_the_measurement(tmp_path: Path):
    said = _run("measurement.md", tmp_path)
    page = _text("measurement.md")
    (ends,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    assert "measured can be read; next: pounding diagnose measured" in said
    assert _joined(ends) in said
    for name in ("report.html", "before.pvd", "after.pvd"):
        assert (tmp_path / "report" / name).is_file()
    html = (tmp_path / "report" / "report.html").read_text(encoding="utf-8")
    assert '<p class="plain">Friction of 0.63 ± 0.01 N in storey 3 of 5A.</p>' in html
    assert '<figure class="sketch"><svg' in html
    assert "the displacement of the fifth floor is off by 0.017 of its rms" in re.sub(r"\s+", " ", page)
    assert "LVDT 5 [mm]: rms of computed - measured is 0.017 of rms of measured" in said


@pytest.mark.slow
def test_the_first_collision(tmp_path: Path):
    said, page = _run("first-collision.md", tmp_path), _text("first-collision.md")
    for printed, written in (
        ("15 │ 15.45 │ 14.75", "15.45 mm and 14.75 mm at the roof"),
        ("time of the record times 0.1826", "(`time of the record times 0.1826`)"),
        ("│ 10.22 │", "at most 10.22 mm"),
        ("6.95 to 13.64", "6.95 to 13.64 mm"),
        ("│ 1.1364 │ 5 │ 1743 │", "1.1364 s after the start with a force of 1743 N"),
        ("│ 1, 1.16 │", "It lasts 1.16 ms"),
        ("│ 15B │ 14.0 │ 14.8 │ 2.10 │ 27.30 │ 1743 │ 3 │", "collide three times"),
    ):
        assert printed in said
        assert written in page
    for name in ("collision.png", "forces.png", "series.pvd"):
        assert (tmp_path / "pair" / name).is_file()


@pytest.mark.slow
def test_the_ground_motion(tmp_path: Path):
    said, page = _run("ground-motion.md", tmp_path), _text("ground-motion.md")
    for printed, written in (
        ("│ 4 │ 62.22 │", "62.22 mm"),
        ("│ 4 │ 15.59 │", "15.59 mm"),
        ("│ motions/quarry.csv │", "`list` now shows `quarry`"),
        ("Frame 5A, quarry, 0.200 g", "pounding shake 5A --record quarry"),
    ):
        assert printed in said
        assert written in page
    (refused,) = re.findall(r"```text\n(.*?)```", page, re.DOTALL)
    (tmp_path / "quarry.csv").write_text("time,acc\n0,0\n0.01,0.1\n")
    command = [sys.executable, "-m", "pounding", "shake", "5A", "--record", "quarry.csv"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stderr == refused


@pytest.mark.slow
def test_the_table_of_the_thesis(tmp_path: Path):
    said, page = _run("thesis-table.md", tmp_path), _text("thesis-table.md")
    assert "thesis, Table 3.1" in said
    rows = re.findall(
        r"^\| [^|]+ \| ([\d.]+) \| ([\d.–]+) \| ([\d.]+) \| ([+-][\d.]+) % \|", page, re.MULTILINE
    )
    assert len(rows) == 4
    for row in rows:
        assert f"│ {' │ '.join(row)} │" in said


@pytest.mark.slow
def test_the_impact_law(tmp_path: Path):
    (printed,) = re.findall(r"```text\n(.*?)```", _text("impact-law.md"), re.DOTALL)
    assert _run("impact-law.md", tmp_path) == _joined(printed)


@pytest.mark.slow
def test_the_effect(tmp_path: Path):
    _, named = _outputs_of_the_effect()
    assert named in _run("effect.md", tmp_path)
    assert (tmp_path / "report" / "force_over_drift.png").is_file()


@pytest.mark.slow
@pytest.mark.guard
def test_the_effect_is_unknown_to_the_catalogue(tmp_path: Path):
    page, truth = _text("effect.md"), tmp_path / "truth.json"
    hide = next(line for line in page.splitlines() if line.startswith("pounding hide"))
    unknown, _ = _outputs_of_the_effect()
    said = _shell(f"{hide} --truth {truth}\npounding diagnose measured", tmp_path)
    assert unknown in said
    hidden = {one["name"]: one["value"] for one in json.loads(truth.read_text())["effects"][0]["parameters"]}
    assert f"{round(hidden['stiffness'], -2):,.0f} N/m and {hidden['reach']:.3f} mm" in page


def _outputs_of_the_effect() -> list[str]:
    return [_joined(block) for block in re.findall(r"```text\n(.*?)```", _text("effect.md"), re.DOTALL)]
