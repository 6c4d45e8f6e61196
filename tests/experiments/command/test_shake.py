import json
import os

import numpy as np
import pytest

from pounding.experiments.command import main
from pounding.experiments.measurements.history import read
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.results import dataset as results
from pounding.frames.drawing import rendering

STICK = """
kind = "stick"
name = "shop"
scale = "1:30"
storeys = 2
storey_height_m = 0.3
floor_mass_kg = [6.0, 5.0]
damping_ratio = 0.01
frequency_hz = [3.0]
"""


@pytest.fixture
def inputs(tmp_path, noise):
    """A frame file and a record file of a user's own, in a folder."""
    record = noise()
    (tmp_path / "shop.toml").write_text(STICK)
    rows = np.column_stack([record.time_s * np.sqrt(30.0), record.acceleration_m_s2])
    np.savetxt(tmp_path / "noise.csv", rows, "%.10g", ",", header="time_s,acceleration_m_s2", comments="")
    return tmp_path


def run(capsys, *words):
    """Run the command; return its exit status, output and errors."""
    status = 0
    try:
        main([str(word) for word in words])
    except SystemExit as error:
        status = error.code
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_json_is_one_object_with_the_promised_keys(inputs, capsys, shaken_stick):
    status, out, _ = run(capsys, "shake", inputs / "shop.toml", "--record", inputs / "noise.csv", "--json")
    assert status == 0
    result = json.loads(out)
    keys = {"frame", "record", "pga_g", "damping_ratio", "peaks", "max_stress_mpa", "wall_s", "model_s"}
    assert keys <= set(result)
    assert result["frame"] == "shop"
    assert result["schema"] == 1
    assert len(result["records"][0]["sha256"]) == 64
    # The fixture's stick and record are the same as this file's.
    for ours, theirs in zip(result["peaks"], shaken_stick.result()["peaks"], strict=True):
        assert ours["max_mm"] == pytest.approx(theirs["max_mm"], rel=1e-3)
        assert ours["max_acceleration_g"] == pytest.approx(theirs["max_acceleration_g"], rel=1e-3)


def test_pga_and_damping_are_taken(inputs, capsys):
    words = ["shake", inputs / "shop.toml", "--record", inputs / "noise.csv", "--json"]
    single = json.loads(run(capsys, *words)[1])
    double = json.loads(run(capsys, *words, "--pga", "0.6", "--damping", "0.01")[1])
    assert double["pga_g"] == pytest.approx(0.6)
    assert double["peaks"][0]["max_mm"] == pytest.approx(2 * single["peaks"][0]["max_mm"], rel=1e-3)
    damped = json.loads(run(capsys, *words, "--damping", "0.2")[1])
    assert damped["damping_ratio"] == 0.2
    assert damped["peaks"][-1]["max_mm"] < single["peaks"][-1]["max_mm"]


def test_a_folder_gets_everything_and_a_measured_history_is_laid_over(inputs, capsys):
    words = ["shake", inputs / "shop.toml", "--record", inputs / "noise.csv"]
    status, _, errors = run(capsys, *words, "--out", inputs / "first", "--csv")
    assert status == 0
    drawn = {"peak.png"} if rendering.cannot_render() is None else set()
    wanted = {"shake.nc", "shake.csv", "shake.json", "history.png", "spectra.png"}
    assert set(os.listdir(inputs / "first")) == wanted | drawn
    assert bool(drawn) == ("cannot render" not in errors)
    assert json.loads((inputs / "first" / "shake.json").read_text())["frame"] == "shop"
    data = results.load(inputs / "first" / "shake.nc")
    assert json.loads(data.attrs["parameters"])["frame"].endswith("shop.toml")
    status, out, _ = run(
        capsys, *words, "--measured", inputs / "first" / "shake.csv", "--out", inputs / "second", "--json"
    )
    result = json.loads(out)
    assert status == 0
    assert "measured.png" in result["files"]
    assert {path.name for path in (inputs / "second").glob("*.png")} - {"peak.png"} == set(
        keeping.CAPTIONS
    ) - {"peak.png"}
    assert len(result["measured"]) == len(read(inputs / "first" / "shake.csv"))
    assert all(row["rms_error_ratio"] < 1e-2 for row in result["measured"])


def test_a_machine_that_cannot_render_says_so_once_and_finishes(inputs, capsys, monkeypatch):
    monkeypatch.setattr(keeping, "cannot_render", lambda: "no pictures: this machine cannot render")
    words = ["shake", inputs / "shop.toml", "--record", inputs / "noise.csv", "--film"]
    status, _, errors = run(capsys, *words, "--out", inputs / "out")
    assert status == 0
    assert errors.count("cannot render") == 1
    assert "shake.nc" in os.listdir(inputs / "out")
    assert "film.mp4" not in os.listdir(inputs / "out")


def test_the_published_peaks_stand_beside_ours(capsys, test_records):
    status, out, _ = run(capsys, "shake", "5A", "--record", "elcentro", "--records", test_records)
    assert status == 0
    assert "Table 4.1" in out
    assert keeping.published_peaks("15B", "elcentro")[15] == (12.9, 12.0)
    assert keeping.published_peaks("8", "elcentro") == {}
    assert keeping.published_peaks("15B", "elcentro-chopra") == {}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (["--pga", "0"], "--pga: the value is 0 g; it must be 1e-06 to 100 g"),
        (["--damping", "5"], "give a fraction from 0"),
        (["--measured", "no.csv"], "cannot be read"),
        (["--out", "shop.toml"], "--out: folder shop.toml: cannot be written (Not a directory)"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(inputs, capsys, monkeypatch, change, words):
    monkeypatch.chdir(inputs)
    status, out, errors = run(capsys, "shake", "shop.toml", "--record", "noise.csv", *change)
    assert status == 2
    assert out == ""
    assert words in " ".join(errors.split())
    assert sorted(os.listdir(inputs)) == ["noise.csv", "shop.toml"]


@pytest.mark.parametrize(
    ("rows", "words"), [("0,1\n0.1,nan\n0.2,1\n", "nan"), ("0,1\n", "sample"), ("0,0\n0.1,0\n", "zero")]
)
def test_bad_records_are_one_sentence_and_status_2(inputs, capsys, rows, words):
    (inputs / "bad.csv").write_text(f"time_s,acceleration_m_s2\n{rows}")
    command = ["shake", inputs / "shop.toml", "--record", inputs / "bad.csv", "--pga", "0.3"]
    status, _, errors = run(capsys, *command)
    assert status == 2
    assert words in " ".join(errors.split())
