"""The whole diagnosis of a case with runs of the frame as it was before: what is named, and what the report says of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.model.model import Acting, Model
from pounding.experiments.command.app import main
from tests.diagnosis.models import STEP_S, measured

FRAME = CaseFrame("bench", 3, storey_height_m=0.2, floor_mass_kg=(6.5, 6.5, 6.5),
                  frequency_hz=(6.806,), damping_ratio=(0.01,))  # fmt: skip
CHANNELS = (
    Channel("table", "table_acceleration", "m/s^2"),
    *(Channel(f"a{i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)),
    *(Channel(f"d{i}", "relative_displacement", "mm", frame="bench", floor=i) for i in (1, 3)),
)
LOSS = -0.08
Effects = list[tuple[Acting, np.ndarray]]


def effect(name: str, storey: int) -> Acting:
    return next(
        one for one in candidates(measured(samples=50, runs=1)) if (one.name, one.storey) == (name, storey)
    )


def case_of(since: Effects, always: Effects, runs: int = 4) -> Case:
    """Return a case of two runs from before, in which what acts always acts too, and some since."""
    plain = measured(samples=1500, runs=runs, reference=2)
    model = Model(plain.structure, plain.observed, plain.prior, always)
    rng = np.random.default_rng(3)
    recorded = []
    outputs = model.predict(np.zeros(len(model.std)), None, since).outputs
    for run, shown in zip(model.observed.runs, outputs, strict=True):
        seen = [
            one + share * one.std(axis=0) * rng.standard_normal(one.shape)
            for one, share in ((run.table[:, None], 0.005), (shown, 0.02))
        ]
        role = "reference" if run.reference else None
        recorded.append(Run(run.name, role, run.time_s, STEP_S, np.column_stack(seen)))
    return Case("bench", Path("bench"), (FRAME,), tuple(recorded), CHANNELS)


@pytest.mark.slow
@pytest.mark.guard
def test_a_small_loss_since_is_named_and_the_report_says_from_when(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = case_of([(effect("stiffness_change", 2), np.array([LOSS]))], [])
    write_case(case, tmp_path / "case")
    main(["diagnose", str(tmp_path / "case"), "--out", str(tmp_path / "out")])
    printed = " ".join(capsys.readouterr().out.split())
    assert "Runs run1.csv and run2.csv are of the frame before the change" in printed
    assert "calibrated on them too" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    report = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))
    assert report["origin"]["reference"] == ["run1.csv", "run2.csv"]
    (found,) = report["effects"]
    assert (report["verdict"], found["effect"], found["storey"]) == ("effect_named", "stiffness_change", 2)
    (size,) = found["parameters"]
    assert size["value"] == pytest.approx(LOSS, abs=2 * size["std"])
    assert report["misfit"]["held_out"]["run"] == "run4.csv"
    assert report["misfit"]["training"]["after"] < 1.1 * report["misfit"]["training"]["noise_floor"]
    assert {one["run"] for one in report["where"]} <= {"run3.csv", "run4.csv"}
    told = [one for one in report["smallest_detectable"] if one["effect"] == "stiffness_change"]
    assert told[0]["best"]["parameters"][0]["value"] < 0.01
    assert not report["warnings"]


@pytest.mark.slow
@pytest.mark.guard
def test_what_was_missing_before_is_no_change(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    friction = [(effect("coulomb_friction", 1), np.array([1.0, 10.0, 0.0, 0.3]))]
    write_case(case_of([], friction, runs=3), tmp_path / "case")
    main(["diagnose", str(tmp_path / "case"), "--out", str(tmp_path / "out"), "--json"])
    report = json.loads(capsys.readouterr().out)
    assert report["verdict"] == "nothing_missing"
    (said,) = report["warnings"]
    assert said.startswith("run1.csv, run2.csv: coulomb friction, storey 1 of bench is missing")


def test_all_runs_since_at_rest_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = case_of([], [], runs=3)
    still = [replace(run, values=np.zeros_like(run.values)) if run.role is None else run for run in case.runs]
    write_case(replace(case, runs=tuple(still)), tmp_path / "case")
    with pytest.raises(SystemExit) as ended:
        main(["diagnose", str(tmp_path / "case"), "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert "nothing moves in any run but the references" in " ".join(capsys.readouterr().err.split())
