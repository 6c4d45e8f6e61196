"""docs/full-scale.md: its files and commands as they stand there, and bad input about scale."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from pounding.experiments.command.app import main

PAGE = (Path(__file__).parents[3] / "docs/full-scale.md").read_text(encoding="utf-8")
BLOCKS = re.compile(r"`(\w+\.toml)`.*?```toml\n(.*?)```", re.DOTALL)
COMMANDS = re.compile(r"^pounding (.*)$", re.MULTILINE)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with the files of the page."""
    for name, text in BLOCKS.findall(PAGE.partition("## A worked example")[2]):
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_worked_example_gives_what_the_page_says(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    commands = [shlex.split(words) for words in COMMANDS.findall(PAGE)]
    assert [words[0] for words in commands] == ["shake", "gap", "pound"]
    commands[2] = commands[2][:-2]  # --out draws pictures, which takes seconds
    answers = []
    for words in commands:
        main([*words, "--json"])
        answers.append(json.loads(capsys.readouterr().out))
    shaken, gap, pounded = answers
    (run,) = pounded["runs"]
    office = shaken["peaks"][-1]
    assert office["max_mm"] == pytest.approx(169.2, abs=0.05)
    assert gap["required_gap_mm"] == pytest.approx(181.0, abs=0.5)
    assert gap["reversed_mm"] == pytest.approx(213.0, abs=0.5)
    assert len(run["impacts"]) == 15
    assert max(impact["peak_force_n"] for impact in run["impacts"]) == pytest.approx(14.4e6, rel=5e-3)
    assert run["peaks"]["right"][-1]["max_mm"] == pytest.approx(117.2, abs=0.05)
    assert run["peaks"]["right"][-1]["max_acceleration_g"] == pytest.approx(5.83, abs=0.01)
    assert run["peaks"]["left"][-1]["max_mm"] == pytest.approx(137.2, abs=0.05)
    assert run["warnings"] == []
    assert pounded["parameters"]["contact"]["linear_viscoelastic"]["stiffness"] == pytest.approx(3750e6)
    assert {answer["parameters"]["time_factor"] for answer in answers} == {1.0}
    for printed in (
        "169.2 mm",
        "181 mm",
        "213 mm",
        "15 times",
        "14.4 MN",
        "117.2 mm",
        "5.83 g",
        "137.2 mm",
        "3,750 kN/mm",
    ):
        assert printed in PAGE


def test_the_storeys_that_yield(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The sharp knee alone and beside the flats, the round knee alone."""
    page = " ".join(PAGE.split())
    (line,) = re.findall(r"^yielding = .*$", PAGE, re.MULTILINE)
    linear = Path("office.toml").read_text()

    def answer(line: str, *words: str) -> dict[str, Any]:
        Path("office.toml").write_text(f"{linear}{line}\n")
        main([*words, *ELCENTRO, "--json"])
        return dict(json.loads(capsys.readouterr().out))

    alone = answer(line, "shake", "office.toml")
    round_knee = answer(line.replace(" }", ", sharpness = 1.0 }"), "shake", "office.toml")
    (pair,) = answer(line, "pound", "flats.toml", "office.toml", "--gap", "50", "--solver", "exact")["runs"]
    sharp, rounded = ([f"{one['ductility']:.2f}" for one in run["ductility"]] for run in (alone, round_knee))
    roof = alone["peaks"][-1]
    for said in (
        f"moves the roof by {max(roof['max_mm'], roof['min_mm']):.1f} mm instead of 169.2 mm, with at most "
        f"{roof['max_acceleration_g']:.2f} g",
        f"of {', '.join(sharp[:3])} and {sharp[3]}, and {alone['ductility'][0]['plastic_drift_mm']:.1f} mm of drift",
        f"ductilities are {', '.join(rounded[:3])} and {rounded[3]}",
        f"has {len(pair['impacts'])} impacts of at most {max(one['peak_force_n'] for one in pair['impacts']) / 1e6:.1f} MN",
    ):
        assert said in page


LOW = 'kind = "stick"\nname = "low"\nstoreys = 1\nstorey_height_m = 0.1\nfloor_mass_kg = [5.0]\ndamping_ratio = 0.01\n'
ELCENTRO = ["--record", "elcentro-chopra"]


TOWERS = ["pound", "flats.toml", "office.toml", "--gap", "50"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["shake", "low.toml"], 'write scale = "1:30"'),
        (["gap", "flats.toml", "low.toml"], 'write scale = "1:30"'),
        (["pound", "flats.toml", "5B", "--gap", "50"], "cannot stand on one table"),
        (["gap", "flats.toml", "5B"], "cannot stand on one table"),
        (["pound", "flats.toml", "office.toml", "--gap", "50", "--parameters", "printed"], "hold at 1:30"),
        (["pound", "flats.toml", "office.toml", "--gap", "-1"], "--gap: the value is -1 mm"),
        (["shake", "office.toml", "--time-factor", "0"], "--time-factor: the value is 0"),
        (["shake", "negative.toml"], "scale is -1"),
        (["pound", "flats.toml", "office.toml", "--gap", "50", "--radius", "0"], "--radius: the value is 0 m"),
        ([*TOWERS, "--radius", "3"], "linear_viscoelastic: a radius is given, and only a Hertz contact"),
        ([*TOWERS, "--law", "hertz", "--restitution", "0.5"], "hertz: restitution is given, for which"),
        ([*TOWERS, "--law", "linear_spring", "--tension"], "linear_spring: tension is given, for which"),
        ([*TOWERS, "--law", "all", "--stiffness", "1e9"], "--law all: one stiffness cannot be that of laws in N/m"),
    ],
)  # fmt: skip
def test_bad_input_about_scale_is_one_sentence_and_status_2(
    here: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    (here / "low.toml").write_text(LOW + "frequency_hz = [3.0]\n")
    (here / "negative.toml").write_text(LOW + "frequency_hz = [3.0]\nscale = -1\n")
    with pytest.raises(SystemExit) as left:
        main([*words, *ELCENTRO])
    out, err = capsys.readouterr()
    assert (left.value.code, out, err.count("\n")) == (2, "", 1)
    assert said in err


def test_a_record_without_a_unit_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "motion.csv").write_text("time_s,acceleration\n0.0,0.1\n0.01,0.2\n")
    with pytest.raises(SystemExit) as left:
        main(["shake", "office.toml", "--record", "motion.csv"])
    out, err = capsys.readouterr()
    assert (left.value.code, out, err.count("\n")) == (2, "", 1)
    assert "no unit of acceleration" in err
