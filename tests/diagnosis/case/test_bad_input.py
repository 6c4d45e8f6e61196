"""Bad input on the command line: real folders with a fault in `case.toml` or a CSV, and what the user reads."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Prior, Run
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.decision.claims import Place
from pounding.diagnosis.design.detectability import threshold
from pounding.diagnosis.design.distinguishing_tests import parting_tests
from pounding.diagnosis.model.first_frequencies import frequency_warnings
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.sensors import screened
from pounding.diagnosis.model.storeys import Structure
from pounding.experiments.command.app import main
from tests.diagnosis.models import STEP_S, measured

FRAME = CaseFrame("bench", 3, storey_height_m=0.2, floor_mass_kg=(6.5, 6.5, 6.5),
                  frequency_hz=(6.806,), damping_ratio=(0.01,))  # fmt: skip
CHANNELS = (
    Channel("table", "table_acceleration", "m/s^2"),
    *(Channel(f"a{i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)),
    *(Channel(f"d{i}", "relative_displacement", "mm", frame="bench", floor=i) for i in (1, 3)),
)
Change = Callable[[list[str], np.ndarray], tuple[list[str], np.ndarray] | None]


def case_of(observed: Observations, frame: CaseFrame = FRAME) -> Case:
    rng = np.random.default_rng(1)
    runs = []
    for run in observed.runs:
        table = run.table + 0.005 * rng.standard_normal(len(run.table))
        runs.append(Run(run.name, None, run.time_s, STEP_S, np.column_stack([table, run.measured])))
    return Case("bench", Path("bench"), (frame,), tuple(runs), CHANNELS)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_case(case_of(measured(samples=1500, runs=2).observed), tmp_path / "case")
    return tmp_path / "case"


def rewrite(file: Path, change: Change) -> None:
    """Change a run as a user's own script would: read the CSV, spoil it, write it."""
    header, *rows = list(csv.reader(file.read_text(encoding="utf-8").splitlines()))
    values = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    header, values = change(header, values) or (header, values)
    lines = [",".join(header)]
    lines += [",".join("" if np.isnan(cell) else f"{cell:.9g}" for cell in row) for row in values]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def reword(folder: Path, old: str, new: str) -> None:
    text = (folder / "case.toml").read_text(encoding="utf-8")
    assert old in text
    (folder / "case.toml").write_text(text.replace(old, new), encoding="utf-8")


def diagnose(folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """Return the report of the command, which must be what it wrote."""
    out = folder.parent / "out"
    main(["diagnose", str(folder), "--out", str(out), "--json"])
    printed = json.loads(capsys.readouterr().out)
    assert json.loads((out / "report.json").read_text(encoding="utf-8")) == printed
    return dict(printed)


def refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one sentence with which the command refuses; nothing may be left behind."""
    out = folder.parent / "out"
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(folder), "--out", str(out)])
    assert left.value.code == 2
    assert not out.exists()
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    return said.err


def test_a_missing_column_is_named_with_file_and_channel(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rewrite(folder / "run2.csv", lambda h, v: ([n for n in h if n != "a3"], np.delete(v, h.index("a3"), 1)))
    said = refused(folder, capsys)
    assert "run2.csv" in said
    assert "'a3'" in said


def test_an_unknown_unit_is_named_with_its_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    reword(folder, 'unit = "mm"', 'unit = "milimetre"')
    said = refused(folder, capsys)
    assert "case.toml line" in said
    assert "'milimetre'" in said
    assert "mm" in said


def test_a_folder_without_a_case_is_one_sentence(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "case.toml").unlink()
    assert "case.toml" in refused(folder, capsys)


def test_out_that_is_a_file_is_refused_and_kept(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = folder.parent / "taken"
    out.write_text("mine")
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(folder), "--out", str(out)])
    assert left.value.code == 2
    assert "cannot be written (Not a directory)" in capsys.readouterr().err
    assert out.read_text() == "mine"


@pytest.mark.slow
@pytest.mark.guard
def test_a_single_run_says_that_nothing_was_held_out(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reword(folder, '[[run]]\nfile = "run2.csv"\n', "")
    report = diagnose(folder, capsys)
    assert report["verdict"] == "nothing_missing"
    assert report["misfit"]["held_out"] is None
    page = (folder.parent / "out" / "report.html").read_text(encoding="utf-8")
    assert "none could be held out" in page
    assert "A second run would allow" in page


@pytest.mark.slow
@pytest.mark.guard
def test_a_unit_typed_wrong_is_read_off_the_gain(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (folder / "case.toml").read_text(encoding="utf-8")
    before, after = text.split('name = "a2"')
    changed = after.replace('unit = "m/s^2"', 'unit = "g"', 1)
    (folder / "case.toml").write_text(f'{before}name = "a2"{changed}', encoding="utf-8")
    report = diagnose(folder, capsys)
    gain = next(effect for effect in report["effects"] if effect["effect"] == "sensor_gain")
    assert gain["channel"] == "a2"
    assert gain["parameters"][0]["value"] == pytest.approx(9.80665 - 1, rel=0.01)
    said = "channel a2 reads as if it were in m/s^2; case.toml says g"
    assert said in report["warnings"]
    assert said in (folder.parent / "out" / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.guard
def test_ten_seconds_of_zeros_at_the_end_do_no_harm(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def still(header: list[str], values: np.ndarray) -> tuple[list[str], np.ndarray]:
        zeros = np.zeros((int(10 / STEP_S), len(header)))
        zeros[:, 0] = values[-1, 0] + STEP_S * np.arange(1, len(zeros) + 1)
        return header, np.vstack([values, zeros])

    for file in ("run1.csv", "run2.csv"):
        rewrite(folder / file, still)
    assert diagnose(folder, capsys)["verdict"] == "nothing_missing"


@pytest.mark.slow
@pytest.mark.guard
def test_another_frame_is_said_by_its_first_frequency(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reword(folder, "frequency_hz = [6.806]", "frequency_hz = [12.0]")
    report = diagnose(folder, capsys)
    assert any("check that this is the frame" in warning for warning in report["warnings"])
    assert report["verdict"] == "effect_class"
    assert {one["effect"] for one in report["effects"][0]["class"]} == {
        "all_stiffness_change",
        "all_added_mass",
    }


def test_columns_that_no_channel_names_are_all_listed(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / "case.toml").read_text(encoding="utf-8")
    parts = text.split("[[channel]]")
    kept = [part for part in parts[1:] if '"table"' in part or '"a3"' in part]
    (folder / "case.toml").write_text("[[channel]]".join([parts[0], *kept]), encoding="utf-8")
    report = diagnose(folder, capsys)
    assert report["verdict"] == "nothing_missing"
    assert "'a1', 'a2', 'd1', 'd3'" in report["warnings"][0]
    assert len(report["channels"]) == 1


@pytest.mark.parametrize("words", [["--seed", "3"], ["--pairs"], ["--way", "refit"], ["--benchmark", "2"]])
def test_options_that_do_not_belong_together_are_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main(["diagnose", str(folder), *words])
    assert left.value.code == 2
    assert "benchmark" in capsys.readouterr().err


def test_an_end_at_which_nothing_is_recorded_is_cut_off() -> None:
    plain = measured(samples=1500, runs=1).observed
    (run,) = plain.runs
    still = replace(
        run,
        time_s=STEP_S * np.arange(2500),
        table=np.pad(run.table, (0, 1000)),
        measured=np.pad(run.measured, ((0, 1000), (0, 0))),
        contact=np.zeros((2500, 0)),
    )
    found = screened(replace(plain, runs=(still,), warnings=[]))
    assert len(found.runs[0].table) == len(found.runs[0].measured) == len(found.runs[0].time_s) == 1500
    assert "every channel repeats one value after" in found.warnings[0]
    assert screened(replace(plain, warnings=[])).warnings == []


@pytest.mark.parametrize(("believed_hz", "said"), [(6.806, 0), (7.3, 0), (12.0, 1), (3.6, 1)])
def test_a_first_frequency_that_is_unlikely_is_said(believed_hz: float, said: int) -> None:
    observed = measured(samples=3000, runs=2).observed
    frames = baseline_frames(case_of(observed, replace(FRAME, frequency_hz=(believed_hz,))))
    model = Model(Structure(frames), observed, Prior())
    assert len(frequency_warnings(model)) == said


EVIDENCE = 30.0
"""Some ln Bayes factor that a verdict may need."""


def test_a_smallest_effect_has_the_evidence_that_a_verdict_needs() -> None:
    information = np.array([1e-3, 1.0, 1e3, 1e7])
    amplitude = threshold(information, EVIDENCE)
    # The expected evidence as `pounding.diagnosis.inference.evidence` has it, for a pull of information times amplitude.
    ln_bayes = 0.5 * (information * amplitude) ** 2 / (1 + information) - 0.5 * np.log1p(information)
    np.testing.assert_allclose(ln_bayes, EVIDENCE)


@pytest.mark.parametrize(
    ("one", "other", "said"),
    [
        (
            Place(effect="stiffness_change", storey=2),
            Place(effect="stiffness_change", storey=3),
            "floor 1 and floor 3, where there is none",
        ),
        (Place(effect="stiffness_change", storey=2), Place(effect="p_delta"), "known weights"),
        (
            Place(effect="coulomb_friction", storey=2),
            Place(effect="damping_change", storey=2),
            "Free vibration",
        ),
        (
            Place(effect="cubic_stiffness", storey=2),
            Place(effect="stiffness_change", storey=2),
            "half and at twice",
        ),
        (
            Place(effect="sensor_gain", channel="a5"),
            Place(effect="stiffness_change", storey=2),
            "exchanged with its neighbour",
        ),
    ],
)
def test_what_looks_alike_gets_a_test_that_tells(one: Place, other: Place, said: str) -> None:
    assert said in " ".join(parting_tests(one, other, measured=[2, 5]))
