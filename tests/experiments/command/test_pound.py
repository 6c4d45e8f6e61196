"""The verb pound: its JSON, its files, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from pounding.experiments.command.app import main
from pounding.experiments.output import collision_folder
from pounding.frames.drawing.rendering import cannot_render

RECORD = "elcentro-chopra"
SHORT = ["pound", "10", "5B", "--gap", "3", "--record", RECORD]


def run(words: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    main(words)
    return capsys.readouterr()


@pytest.fixture(scope="module")
def all_laws(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    folder = tmp_path_factory.mktemp("pound")
    main([*SHORT, "--law", "all", "--out", str(folder)])
    return json.loads((folder / "pound.json").read_text()), folder


def test_json_has_what_is_promised(all_laws: tuple[dict[str, Any], Path]) -> None:
    result, _ = all_laws
    assert [run["law"] for run in result["runs"]] == [
        "linear_spring",
        "linear_viscoelastic",
        "hertz",
        "nonlinear_viscoelastic",
        "hertz_damp",
    ]
    for run in result["runs"]:
        assert {"left", "right", "record", "law", "gap_mm", "impacts", "peaks", "energy_error"} <= set(run)
        assert {"wall_s", "model_s"} <= set(run)
        assert (run["left"], run["right"], run["gap_mm"]) == ("10", "5B", 3.0)
        assert run["energy_error"] < 5e-3
        assert run["impacts"]
        for impact in run["impacts"]:
            assert {
                "time_s",
                "duration_ms",
                "peak_force_n",
                "impulse_n_s",
                "approach_velocity_m_s",
                "restitution",
                "floor",
            } <= set(impact)
            assert impact["floor"] == 5
            assert impact["peak_force_n"] > 10.0
        assert [peak["floor"] for peak in run["peaks"]["left"]] == list(range(1, 11))
        assert {"max_mm", "min_mm", "max_acceleration_g"} <= set(run["peaks"]["right"][0])
    assert result["records"][0]["name"] == RECORD


def test_laws_agree_on_the_first_touch(all_laws: tuple[dict[str, Any], Path]) -> None:
    """Before it they are the same linear run."""
    times = [run["impacts"][0]["time_s"] for run in all_laws[0]["runs"]]
    assert max(times) - min(times) < 1e-4


def test_pictures_are_written(all_laws: tuple[dict[str, Any], Path]) -> None:
    folder = all_laws[1]
    laws = {f"{run['law']}.nc" for run in all_laws[0]["runs"]}
    others = {"forces.png", "loops.png", "pound.json", "series.pvd", "series"}
    assert {path.name for path in folder.iterdir()} - {"collision.png"} == others | laws
    assert all(path.stat().st_size > 5_000 for path in folder.glob("*.png"))
    assert {path.name for path in folder.glob("*.png")} <= set(collision_folder.CAPTIONS)


def test_a_series_lists_files_of_both_frames_around_the_hardest_impact(
    all_laws: tuple[dict[str, Any], Path],
) -> None:
    result, folder = all_laws
    listed = ElementTree.parse(folder / "series.pvd").getroot().iter("DataSet")
    files = {entry.get("file", ""): float(entry.get("timestep", "nan")) for entry in listed}
    assert all((folder / name).is_file() for name in files)
    assert {name.split("/")[1].split("_")[0] for name in files} == {"10", "5B"}
    hardest = max(result["runs"][0]["impacts"], key=lambda impact: impact["peak_force_n"])
    # It is named by its first touch; the largest force may come some milliseconds later.
    assert min(abs(time - hardest["time_s"]) for time in files.values()) < 0.02


def test_tables_for_a_reader(capsys: pytest.CaptureFixture[str]) -> None:
    out, _ = run([*SHORT, "--law", "hertz"], capsys)
    assert "10 beside 5B" in out
    assert "energy closes to" in out
    assert "10,000 samples a second" in out


def test_a_run_that_does_not_touch_leaves_a_picture_of_the_closest_approach_and_a_series(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["pound", "5A", "5B", "--gap", "50", "--record", RECORD, "--json", "--out", str(tmp_path)]
    out, err = run(words, capsys)
    assert json.loads(out)["runs"][0]["impacts"] == []
    assert err == ""
    written = {path.name for path in tmp_path.iterdir()} - {"closest.png"}
    assert written == {"linear_viscoelastic.nc", "pound.json", "series.pvd", "series"}
    assert (tmp_path / "closest.png").is_file() == (cannot_render() is None)


def test_yielding_is_warned_of_as_shake_warns(capsys: pytest.CaptureFixture[str]) -> None:
    out, err = run([*SHORT, "--pga", "2", "--solver", "exact", "--json"], capsys)
    found = json.loads(out)["runs"][0]
    assert found["max_stress_mpa"]["left"] > 280.0
    assert any("above the yield stress of 280 MPa" in sentence for sentence in found["warnings"])
    assert "above the yield stress of 280 MPa" in " ".join(err.split())


def test_a_gap_a_floor(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["pound", "10", "5B", "--gap", "3", "--gap", "2", "--floor", "5", "--floor", "3"]
    out, _ = run([*words, "--record", RECORD, "--json"], capsys)
    found = json.loads(out)["runs"][0]
    assert found["gap_mm"] == [3.0, 2.0]
    assert found["floors"] == [5, 3]


def test_plots_show_the_contact_that_is_hit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "pound",
        "10",
        "5B",
        "--gap",
        "50",
        "--gap",
        "3",
        "--floor",
        "1",
        "--floor",
        "5",
        "--solver",
        "exact",
    ]
    run([*words, "--record", RECORD, "--out", str(tmp_path)], capsys)
    written = {path.name for path in tmp_path.iterdir()}
    assert {"forces.png", "loops.png", "pound.json"} <= written
    impacts = json.loads((tmp_path / "pound.json").read_text())["runs"][0]["impacts"]
    assert {impact["floor"] for impact in impacts} == {5}


HOUSE = """kind = "stick"
name = "{name}"
storeys = 2
storey_height_m = 3.0
floor_mass_kg = [400e3, 100e3]
frequency_hz = [{hz}]
damping_ratio = 0.05
plan_m = [20.0, 10.0]
slab = {{ thickness_m = 0.2 }}
"""


def test_each_floor_has_the_damping_of_its_own_masses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, hz in (("left", 2.0), ("right", 1.0)):
        (tmp_path / f"{name}.toml").write_text(HOUSE.format(name=name, hz=hz))
    pair = [str(tmp_path / "left.toml"), str(tmp_path / "right.toml")]
    words = [
        "pound",
        *pair,
        "--gap",
        "20",
        "--floor",
        "1",
        "--floor",
        "2",
        "--record",
        RECORD,
        "--solver",
        "exact",
    ]
    said = json.loads(run([*words, "--json"], capsys)[0])["parameters"]
    first, second = said["contact"]["linear_viscoelastic"]
    assert first["stiffness"] == second["stiffness"]
    # The damping of a Kelvin-Voigt contact grows with the root of the reduced mass (thesis eq. 2.6).
    assert first["damping"] == pytest.approx(2.0 * second["damping"])


def test_restitution_of_one_is_the_spring_alone_and_any_stiffness_is_resolved(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first = {}
    for name, words in {
        "spring": ["--law", "linear_spring"],
        "elastic": ["--restitution", "1"],
        "stiff": ["--law", "linear_spring", "--stiffness", "1e15"],
    }.items():
        found = json.loads(run([*SHORT, *words, "--json"], capsys)[0])["runs"][0]
        assert found["energy_error"] < 5e-3
        first[name] = found["impacts"][0]
    assert first["elastic"]["peak_force_n"] == pytest.approx(first["spring"]["peak_force_n"], rel=1e-6)
    assert first["stiff"]["time_s"] == pytest.approx(first["spring"]["time_s"], abs=1e-4)
    assert first["stiff"]["peak_force_n"] > 1e3 * first["spring"]["peak_force_n"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([*SHORT[:4], "-1", *SHORT[5:]], "overlap"),
        ([*SHORT, "--floor", "7"], "floor 7"),
        ([*SHORT, "--law", "herz"], "did you mean hertz?"),
        ([*SHORT, "--gap", "2"], "2 gaps for 1 floor"),
        ([*SHORT, "--floor", "5", "--floor", "5"], "given once"),
        ([*SHORT, "--parameters", "guessed"], "guessed"),
        (["pound", "10", "5B", "--gap", "3", "--record", "elcentor"], "elcentor"),
        ([*SHORT, "--restitution", "0"], "restitution of 0 cannot be"),
        ([*SHORT, "--restitution", "1.2"], "restitution of 1.2 cannot be"),
        ([*SHORT, "--restitution", "0.5", "--law", "hertz"], "hertz: restitution is given"),
        ([*SHORT, "--stiffness", "0"], "--stiffness: the value is 0 N/m or N/m^1.5; it must be 1 to 1e+15"),
        ([*SHORT, "--stiffness", "1e25"], "--stiffness: the value is 1e+25"),
        ([*SHORT, "--pga", "90"], "moved by more than its height"),
    ],
)
def test_bad_input_is_one_sentence(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(words)
    assert left.value.code == 2
    out, said = capsys.readouterr()
    assert out == ""
    assert sentence in said
    assert said.count("\n") == 1


def test_the_exact_solver_gives_what_the_engine_gives(
    all_laws: tuple[dict[str, Any], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    printed, _ = run([*SHORT, "--law", "all", "--solver", "exact", "--json"], capsys)
    result = json.loads(printed)
    for mine, theirs in zip(result["runs"], all_laws[0]["runs"], strict=True):
        assert (mine["solver"], theirs["solver"]) == ("exact", "exudyn")
        assert mine["peaks"]["right"][-1]["max_mm"] == pytest.approx(
            theirs["peaks"]["right"][-1]["max_mm"], rel=0.02
        )
        assert mine["impacts"][0]["peak_force_n"] == pytest.approx(
            theirs["impacts"][0]["peak_force_n"], rel=1e-3
        )
        assert mine["energy_error"] < 1e-3


def test_the_exact_solver_writes_the_same_files(
    tmp_path: Path, all_laws: tuple[dict[str, Any], Path]
) -> None:
    main([*SHORT, "--law", "all", "--solver", "exact", "--out", str(tmp_path)])
    _, folder = all_laws
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.name for path in folder.iterdir())


def test_an_unknown_solver_is_one_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([*SHORT, "--solver", "magic"])
    assert left.value.code == 2
