"""The figures on the page on buildings that turn are those of the commands that stand there."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pounding.experiments.command.app import main
from pounding.experiments.results import dataset

DOCS = Path(__file__).parents[3] / "docs"
RECORD = ["--record", "elcentro-chopra"]
POUND = ["pound", "street.toml", *RECORD, "--solver", "exact"]
PAGE = (DOCS / "torsion.md").read_text(encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (office,) = re.findall(r"^torsion = \{.*\}$", PAGE, re.MULTILINE)
    (flats,) = re.findall(r"`(torsion = \{.*?\})` in `flats.toml`", PAGE)
    for block in re.findall(r"```toml\n(kind.*?)```", (DOCS / "full-scale.md").read_text("utf-8"), re.DOTALL):
        name = re.findall(r'name = "(\w+)"', block)[0]
        (tmp_path / f"{name}.toml").write_text(block + {"office": office, "flats": flats}[name] + "\n")
    (street,) = re.findall(r"```toml\n(\[\[building.*?)```", PAGE, re.DOTALL)
    (tmp_path / "street.toml").write_text(street)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def answer(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    main([*words, "--json"])
    return dict(json.loads(capsys.readouterr().out))


def test_modes_sway_and_gap(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = answer(["modal", "office.toml"], capsys)["modes"][:2]
    assert (
        f"from 1.100 to {first['frequency_hz']:.3f} Hz, and {100 * second['effective_mass_ratio_x']:.0f} %"
        in PAGE
    )
    assert f"first torsion at {second['frequency_hz']:.3f} Hz" in PAGE
    roof = answer(["shake", "office.toml", *RECORD], capsys)["peaks"][-1]
    middle = max(roof["max_mm"], roof["min_mm"])
    assert f"by {middle:.1f} mm in the middle instead of 169.2 mm, and by {roof['edge_mm']:.1f} mm" in PAGE
    gap = answer(["gap", "flats.toml", "office.toml", *RECORD], capsys)
    end = max(gap["edges"], key=lambda one: float(one["required_gap_mm"]))
    assert f"needs {gap['required_gap_mm']:.0f} mm in the middle, and {end['required_gap_mm']:.0f} mm" in PAGE
    assert f"(y = {end['y_m']:g} m)" in PAGE


@pytest.mark.parametrize(
    ("row", "y_m"),
    [
        ("left out: the middle", "0.0"),
        ("one end, -7.5", "-7.5"),
        ("both ends", "[-7.5, 7.5]"),
        ("five", "[-6, -3, 0, 3, 6]"),
        pytest.param("ten, -6.75 to 6.75", str([-6.75 + 1.5 * i for i in range(10)]), marks=pytest.mark.slow),
    ],
)
def test_the_table_of_places(row: str, y_m: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    street = re.sub(r"^y_m = .*$", f"y_m = {y_m}", (folder / "street.toml").read_text(), flags=re.MULTILINE)
    (folder / "street.toml").write_text(street)
    (run,) = answer(POUND, capsys)["runs"]
    flats, office = (run["peaks"][side][-1] for side in ("left", "right"))
    largest = max(impact["peak_force_n"] for impact in run["impacts"]) / 1e6
    said = (
        f"| {flats['max_mm']:.1f} | {flats.get('rotation_mrad', 0.0):.1f} | {office['edge_mm']:.1f} "
        f"| {office['max_acceleration_g']:.1f} |"
    )
    (line,) = re.findall(rf"^\| {row} \|.*$", PAGE, re.MULTILINE)
    assert line.startswith(f"| {row} | {largest:.1f} |")
    assert line.endswith(said)


@pytest.mark.slow
def test_the_force_of_all_places_together(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (run,) = answer([*POUND, "--out", "out"], capsys)["runs"]
    largest = max(impact["peak_force_n"] for impact in run["impacts"]) / 1e6
    together = dataset.load(folder / "out" / "linear_viscoelastic.nc").contact_force.values.sum(axis=0)
    assert f"| five | {largest:.1f} | {np.max(together) / 1e6:.1f} |" in PAGE
