"""A street in the verbs: new-street, gap, pound and shake take it, and refuse what contradicts it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from pounding.experiments.command.app import main

RECORD = ["--record", "elcentro-chopra"]


@pytest.fixture
def street(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    path = tmp_path / "street.toml"
    main(["new-street", str(path), "5A", "10", "5A", "--gap", "3", "--gap", "2"])
    capsys.readouterr()
    return str(path)


def answer(words: list[str], capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    main([*words, *RECORD, "--json"])
    return dict(json.loads(capsys.readouterr().out))


def test_pound_names_the_neighbours_of_each_impact(
    street: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = answer(["pound", street, "--solver", "exact", "--out", str(tmp_path / "out")], capsys)
    (run,) = found["runs"]
    between = {(impact["left"], impact["right"]) for impact in run["impacts"]}
    assert between == {("5A", "10"), ("10", "5A#2")}
    assert list(run["peaks"]) == ["5A", "10", "5A#2"]
    assert {"linear_viscoelastic.nc", "forces.png", "series.pvd"} <= set(found["files"])


def test_the_gap_of_each_pair_is_that_of_the_pair_alone(
    street: str, capsys: pytest.CaptureFixture[str]
) -> None:
    row = answer(["gap", street], capsys)
    alone = answer(["gap", "10", "5A"], capsys)
    pairs = row["pairs"]
    assert [pair["gap_mm"] for pair in pairs] == [3.0, 2.0]
    assert pairs[1]["required_gap_mm"] == pytest.approx(alone["required_gap_mm"])
    assert "their gap is 2 mm" in " ".join(row["warnings"])


def test_gap_writes_a_report_of_all_pairs(
    street: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["gap", street, *RECORD, "--report", str(tmp_path / "gap.html")])
    text = (tmp_path / "gap.html").read_text()
    assert text.count("<img") == 2
    assert "10 beside 5A#2" in text
    assert "enough" in capsys.readouterr().out


def test_shake_shakes_each_building_alone(street: str, capsys: pytest.CaptureFixture[str]) -> None:
    row = answer(["shake", street], capsys)
    alone = answer(["shake", "10"], capsys)
    buildings = row["buildings"]
    assert list(buildings) == ["5A", "10", "5A#2"]
    assert buildings["10"]["peaks"] == alone["peaks"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["pound", "STREET", "5A"], "give it alone"),
        (["pound", "STREET", "--gap", "3"], "give it alone"),
        (["pound", "STREET", "--law", "hertz"], "give it alone"),
        (["gap", "STREET", "--floor", "3"], "give it alone"),
        (["gap", "5A"], "one frame; give a second one beside it"),
        (["pound", "5A"], "one frame; give a second one beside it"),
        (["pound", "nothere.toml"], "frame file nothere.toml: No such file"),
        (["gap", "5C"], "frame '5C' is not known"),
        (["pound", "5A", "5B"], "give --gap with a length in mm"),
    ],
)
def test_what_contradicts_a_street_is_refused(
    street: str, words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([street if word == "STREET" else word for word in words] + RECORD)
    assert left.value.code == 2
    assert sentence in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["x.txt", "5A", "10"], "ends in .toml"),
        (["x.toml", "5A"], "two or more"),
        (["x.toml", "5A", "10", "--gap", "1", "--gap", "2"], "2 gaps for 1 pair"),
        (["x.toml", "5A", "1O"], "is not known"),
        (["street.toml", "5A", "10"], "is there already"),
    ],
)
def test_new_street_refuses(
    street: str, tmp_path: Path, words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(["new-street", str(tmp_path / words[0]), *words[1:]])
    assert left.value.code == 2
    assert sentence in " ".join(capsys.readouterr().err.split())


def test_frame_files_are_written_relative_to_the_street_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["new-frame", str(tmp_path / "office.toml")])
    (tmp_path / "rows").mkdir()
    main(["new-street", str(tmp_path / "rows" / "row.toml"), str(tmp_path / "office.toml"), "5A"])
    assert 'frame = "5A"' in (tmp_path / "rows" / "row.toml").read_text()
    capsys.readouterr()


def test_gap_counts_the_room_that_a_bumper_leaves(street: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = Path(street).read_text()
    Path(street).write_text(
        text.replace("gap_mm = 3", "gap_mm = 9\nbumper = { thickness_mm = 8, area_m2 = 1e-4 }")
    )
    found = answer(["gap", street], capsys)
    assert found["pairs"][0]["gap_mm"] == pytest.approx(1.0)
    Path(street).write_text(
        text.replace("gap_mm = 3", "gap_mm = 7\nbumper = { thickness_mm = 8, area_m2 = 1e-4 }")
    )
    with pytest.raises(SystemExit):
        main(["gap", street, *RECORD])
    assert "a bumper of 8 mm does not fit into a gap of 7 mm" in " ".join(capsys.readouterr().err.split())
