"""Running configurations: the files and rows of each, resuming all of them, and what goes wrong on the way."""

from __future__ import annotations

import csv
import errno
import json
import os
from pathlib import Path
from xml.etree import ElementTree

import msgspec
import numpy as np
import pytest

from pounding.experiments.command import experiment as verb
from pounding.experiments.command.app import main
from pounding.experiments.configurations import every
from pounding.experiments.configurations import folder as folders
from pounding.experiments.configurations.laboratory_motion import decay_motion, push_motion, sweep_motion
from pounding.experiments.configurations.library import find
from pounding.experiments.configurations.running import Conditions, run
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import find as find_record
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response.laboratory import SAMPLE_HZ, free_vibration_test, push_test, sine_sweep_test

PICTURES = set() if cannot_render() else {"peak.png"}


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A motion of two seconds, half a second at model scale."""
    path = tmp_path_factory.mktemp("record") / "short.csv"
    times = np.arange(0.0, 2.0, 0.02)
    rows = [f"{t:.2f},{0.3 * np.sin(9.0 * t) * np.sin(np.pi * t / 2.0):.6f}" for t in times]
    path.write_text("\n".join(["time_s,acceleration_g", *rows, ""]))
    return str(path)


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def listed(folder: Path) -> list[str]:
    entries = ElementTree.parse(folder / "series.pvd").getroot().iter("DataSet")
    return [entry.get("file", "") for entry in entries]


def test_a_push_leaves_results_a_still_a_series_histories_and_its_measured_row(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["experiment", "push-5A", "--out", str(tmp_path)])
    folder = tmp_path / "push-5A"
    wanted = {"experiment.json", "histories.nc", "measured.csv", "series", "series.pvd", "test.png"}
    assert {path.name for path in folder.iterdir()} == wanted | PICTURES
    assert list(tmp_path.iterdir()) == [folder]
    assert len(listed(folder)) == 6
    assert all((folder / name).is_file() for name in listed(folder))
    (row,) = table(folder / "measured.csv")
    assert (float(row["measured"]), float(row["sap2000"])) == (28.4, 28.7)
    assert float(row["ours"]) == pytest.approx(28.4, rel=0.1)
    result = json.loads((folder / "experiment.json").read_text())
    assert result["software"] == "pounding"
    assert set(result["files"]) | {"series"} == {path.name for path in folder.iterdir()}
    shown = capsys.readouterr().out
    assert "roof stiffness" in shown
    assert "28.4" in shown


def test_a_frame_alone_under_another_motion_is_not_compared(
    tmp_path: Path, short: str, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["experiment", "alone-5A-elcentro", "--record", short, "--out", str(tmp_path), "--json"])
    out, err = capsys.readouterr()
    result = json.loads(out)
    assert "not comparable" in " ".join(err.split())
    assert [row["measured"] for row in result["measured"]] == [None, None]
    assert result["measured"][0]["ours"] == result["result"]["peaks"][4]["max_mm"]
    folder = tmp_path / "alone-5A-elcentro"
    assert {"shake.nc", "shake.json", "history.png", "acceleration.png", "series.pvd"} <= set(
        os.listdir(folder)
    )
    assert result["parameters"]["record"] == "elcentro"
    assert result["records"][0]["name"] == "short"


def test_a_state_reaches_the_frame_and_the_result(short: str) -> None:
    outcome = run(find("alone-5A-elcentro"), Conditions(record=short, state="strong-motion"))
    assert outcome.numbers["damping_ratio"] == pytest.approx(0.0105)
    (said,) = folders.result_of(outcome)["parameters"]["states"]
    assert (said["frame"], said["state"], said["first_frequency_hz"]) == ("5A", "strong-motion", 6.9)
    assert "fitted" in said["source"]


def test_a_pair_stands_at_its_required_gap_and_does_not_touch(tmp_path: Path, short: str) -> None:
    outcome = run(find("apart-5A-5B-kobe"), Conditions(record=short))
    assert outcome.numbers["run"]["impacts"] == []
    assert outcome.numbers["run"]["gap_mm"] == pytest.approx(1.01 * outcome.numbers["required_gap_mm"])
    # The engine, which knows nothing of the exact motion, comes as close.
    folders.keep(outcome, tmp_path)
    names = {path.name for path in (tmp_path / "apart-5A-5B-kobe").iterdir()}
    assert {"gap.png", "series.pvd", "linear_viscoelastic.nc", "pound.json", "measured.csv"} <= names
    assert "closest.png" in names or not PICTURES


def test_each_stiffness_leaves_a_dataset_of_its_own(tmp_path: Path, short: str) -> None:
    """They have the same law, whose name cannot name them all."""
    one = msgspec.structs.replace(find("stiffness-15B-5B-elcentro-8.5mm"), sources=("experiment", "xu"))
    outcome = run(one, Conditions(record=short))
    kept = folders.keep(outcome, tmp_path)
    assert {"experiment.nc", "xu.nc"} <= set(kept.files)
    assert len(outcome.rows) == 10
    touches = {row.quantity: row.ours for row in outcome.rows}
    assert touches["touches in all impacts, xu"] >= touches["impacts (measured: at least), xu"]


def test_a_laboratory_motion_is_the_test_that_was_read(plate: ReducedFrame) -> None:
    sweep = sine_sweep_test(plate, octaves_per_minute=30.0, modes=1)
    motion = sweep_motion(plate, sweep)
    (frame,) = motion.frames
    roof = frame.floor_displacement(plate.storeys)
    largest = float(np.abs(sweep.roof_displacement_m).max())
    start = int(
        np.flatnonzero(np.isclose(sweep.roof_displacement_m, roof[0], rtol=0.0, atol=1e-9 * largest))[0]
    )
    places = start + np.round(frame.time_s * SAMPLE_HZ).astype(int)
    assert roof == pytest.approx(sweep.roof_displacement_m[places], abs=1e-6 * largest)
    assert frame.floor_acceleration(plate.storeys) == pytest.approx(
        sweep.roof_m_s2[places], abs=1e-6 * float(np.abs(sweep.roof_m_s2).max())
    )
    decay = decay_motion(plate).frames[0]
    assert decay.floor_displacement(plate.storeys)[0] == pytest.approx(0.005)
    read = free_vibration_test(plate)
    assert decay.floor_acceleration(plate.storeys) == pytest.approx(
        np.interp(decay.time_s, read.time_s, read.acceleration_m_s2),
        abs=0.01 * np.abs(read.acceleration_m_s2).max(),
    )
    push = push_test(plate)
    assert push_motion(plate, push).frames[0].floor_displacement(plate.storeys) == pytest.approx(
        push.deflection_m
    )


def test_a_test_of_the_laboratory_has_no_ground_motion(short: str) -> None:
    with pytest.raises(ExperimentError, match="'push-5A' has no ground motion"):
        run(find("push-5A"), Conditions(record=short))


def test_what_a_user_put_into_a_folder_stays_and_an_older_picture_goes(tmp_path: Path) -> None:
    outcome = run(find("push-5A"))
    folder = tmp_path / "push-5A"
    folders.keep(outcome, tmp_path)
    (folder / "notes.txt").write_text("mine")
    (folder / "forces.png").write_text("of another run")
    folders.keep(outcome, tmp_path)
    assert (folder / "notes.txt").read_text() == "mine"
    assert not (folder / "forces.png").exists()
    assert all((folder / name).is_file() for name in listed(folder))


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that takes everything but the last file."""

    def no_room(path: Path, content: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(folders, "write_whole", no_room)


@pytest.mark.usefixtures("full")
def test_a_full_disk_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(["experiment", "push-5A", "--out", str(tmp_path / "out")])
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "push-5A: cannot be written (No space left on device)" in err
    assert err.count("\n") == 1
    assert not list(tmp_path.rglob("*.json")) + list(tmp_path.rglob("*.png"))


@pytest.mark.usefixtures("full")
def test_a_full_disk_ends_all_of_them_with_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match=r"No space left on device.*make room and start again"):
        every.run_all([find("push-5A"), find("push-5B")], tmp_path, workers=0)
    assert not (tmp_path / "push-5A").exists()


def test_a_folder_that_is_a_file_is_said_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "push-5A").write_text("mine")
    with pytest.raises(SystemExit) as left:
        main(["experiment", "push-5A", "--out", str(tmp_path)])
    assert left.value.code == 2
    assert "cannot be written" in capsys.readouterr().err
    assert (tmp_path / "push-5A").read_text() == "mine"


def test_all_of_them_report_a_missing_record_at_the_end_go_on_and_resume(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = {name: find(name) for name in ("push-5A", "alone-5A-kobe", "push-5B")}
    monkeypatch.setattr(verb, "experiments", lambda: chosen)
    (tmp_path / "records").mkdir()
    out = tmp_path / "out"
    words = [
        "experiment",
        "--all",
        "--records",
        str(tmp_path / "records"),
        "--out",
        str(out),
        "--workers",
        "0",
    ]
    with pytest.raises(SystemExit) as left:
        main(words)
    assert left.value.code == 2
    shown, err = capsys.readouterr()
    said = " ".join(err.split())
    assert "warning: alone-5A-kobe: " in said
    assert "pounding: 1 of 3 experiments failed" in said
    assert "2 experiments are in" in " ".join(shown.split())
    assert {path.name for path in out.iterdir()} == {".finished", "push-5A", "push-5B", "measured.csv"}
    names = [row["experiment"] for row in table(out / "measured.csv")]
    assert names == ["push-5A", "push-5B"]
    finished = {name: (out / name / "experiment.json").stat().st_mtime_ns for name in names}

    # Again: what is there stays, what somebody has damaged or removed is made anew.
    (out / "push-5B" / "experiment.json").unlink()
    with pytest.raises(SystemExit):
        main(words)
    again = {name: (out / name / "experiment.json").stat().st_mtime_ns for name in names}
    assert again["push-5A"] == finished["push-5A"]
    assert again["push-5B"] > finished["push-5B"]


def test_a_motion_enters_a_case_by_its_hash(tmp_path: Path, short: str) -> None:
    """So that one that is found later, or that has changed, is run."""
    one = find("alone-5A-kobe")
    assert every.motion_hash(one, str(tmp_path)) == ""
    assert every.motion_hash(find("push-5A"), None) == ""
    assert every.motion_hash(msgspec.structs.replace(one, record=short), None) == find_record(short).sha256


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--all"], "--all needs a folder"),
        (["--all", "--out", "x", "--record", "kobe"], "--record and --record-unit belong to one experiment"),
        (
            ["--all", "--out", "x", "--records", "nowhere"],
            "folder of records 'nowhere' (from --records) is not there",
        ),
        (["push-5A", "--all", "--out", "x"], "name one experiment"),
        (["push-5A", "--record", "kobe"], "has no ground motion"),
        (["alone-5A-kobe", "--record", "kobee"], "kobee"),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_no_folder(
    words: list[str],
    sentence: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as left:
        main(["experiment", *words])
    assert left.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert sentence in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "collision-10-5B-elcentro-6mm",
        pytest.param("stiffness-15B-5B-elcentro-9.5mm", marks=pytest.mark.guard),
    ],
)
def test_a_collision_with_pictures(name: str, tmp_path: Path, test_records: Path) -> None:
    main(["experiment", name, "--records", str(test_records), "--out", str(tmp_path)])
    folder = tmp_path / name
    names = {path.name for path in folder.iterdir()}
    assert {"forces.png", "loops.png", "series.pvd", "pound.json", "measured.csv", "experiment.json"} <= names
    assert "collision.png" in names or not PICTURES
    assert all((folder / file).is_file() for file in listed(folder))
    rows = table(folder / "measured.csv")
    assert len(rows) == 25
    assert all(float(row["ours"]) >= 1.0 for row in rows[:5])
    result = json.loads((folder / "experiment.json").read_text())
    assert set(result["result"]["runs"]) == set(
        getattr(find(name), "laws", None) or getattr(find(name), "sources", ())
    )
