"""Measurements with the faults of loggers and cables: a sane verdict, what is wrong in a sentence, and no wrong name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.workflow import diagnose
from tests.diagnosis.models import STEP_S, measured

FRAME = CaseFrame("bench", 3, storey_height_m=0.2, floor_mass_kg=(6.5, 6.5, 6.5),
                  frequency_hz=(6.806,), damping_ratio=(0.01,))  # fmt: skip
CHANNELS = (
    Channel("table", "table_acceleration", "m/s^2"),
    *(Channel(f"a{i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)),
    *(Channel(f"d{i}", "relative_displacement", "mm", frame="bench", floor=i) for i in (1, 3)),
)
TABLE, A3 = 0, 3
SELDOM = (pytest.mark.slow, pytest.mark.guard)
Change = Callable[[int, np.ndarray, np.random.Generator], None]


def bench(noise: float = 0.02) -> Case:
    rng = np.random.default_rng(1)
    runs = []
    for run in measured(samples=1500, runs=3, noise=noise).observed.runs:
        table = run.table + 0.25 * noise * rng.standard_normal(len(run.table))
        runs.append(Run(run.name, None, run.time_s, STEP_S, np.column_stack([table, run.measured])))
    return Case("bench", Path("bench"), (FRAME,), tuple(runs), CHANNELS)


def changed(change: Change) -> Case:
    """Return the bench with each run's values, (samples, channels) in SI, changed in place."""
    case, rng = bench(), np.random.default_rng(5)
    runs = []
    for number, run in enumerate(case.runs):
        values = run.values.copy()
        change(number, values, rng)
        runs.append(replace(run, values=values))
    return replace(case, runs=tuple(runs))


def report_on(case: Case, folder: Path) -> Report:
    """Return the report on a case that went through its files."""
    write_case(case, folder)
    return diagnose(read_case(folder))


def warned(report: Report, words: str) -> bool:
    return any(words in warning for warning in report.warnings)


def hum(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    time = STEP_S * np.arange(len(values))
    for column in range(1, values.shape[1]):
        values[:, column] += 0.1 * values[:, column].std() * np.sin(2 * np.pi * 50.0 * time + column)


def dropped(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[rng.random(values.shape) < 0.02] = np.nan


def stuck(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:500, A3] = values[500, A3]


def nearly_stuck(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    size = values[:, A3].std()
    values[:500, A3] = 0.7 * size + 1e-3 * size * rng.standard_normal(500)


def constant(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, A3] = 1.7


def nearly_constant(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, A3] = 1.7 + 1e-6 * rng.standard_normal(len(values))


def nothing_recorded(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, A3] = np.nan


def inverted(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, A3] *= -1


def inverted_table(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, TABLE] *= -1


def still(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[:, TABLE] = 0.001 * rng.standard_normal(len(values))


def still_in_one(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    if number == 1:
        still(number, values, rng)


def spikes(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    values[rng.integers(0, len(values), 4), A3] += 20 * values[:, A3].std()


def coarse(number: int, values: np.ndarray, rng: np.random.Generator) -> None:
    bits = 0.05 * values.std(axis=0)
    values[:] = np.rint(values / bits) * bits


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (hum, "run1.csv, run2.csv and run3.csv: hum of the mains (50 Hz) in a1, a2, a3, d1, d3; subtracted"),
        (dropped, "dropouts of the table's motion were interpolated"),
        (stuck, "a3 repeats one value between 0 and 1 s"),
        (constant, "a3 repeats one value between 0 and 2.998 s"),
        (nothing_recorded, "channel 'a3': no sample was recorded"),
        (still_in_one, "run2.csv: the table's channel reads 0.00098 m/s^2 (rms) while floors move"),
        (spikes, ""),
        (coarse, ""),
    ],
)
def test_nothing_is_missing_but_what_is_said(fault: Change, said: str, tmp_path: Path) -> None:
    report = report_on(changed(fault), tmp_path)
    assert report.verdict == "nothing_missing"
    assert not said or warned(report, said)
    assert not warned(report, "clipped")
    assert not warned(report, "first frequency")


def test_simulated_data_without_noise_is_read(tmp_path: Path) -> None:
    assert report_on(bench(noise=0.0), tmp_path).verdict == "nothing_missing"


def test_steps_that_are_one_per_cent_off_make_no_structural_effect(tmp_path: Path) -> None:
    case = bench()
    runs = [replace(run, step_s=1.01 * run.step_s, time_s=1.01 * run.time_s) for run in case.runs]
    report = report_on(replace(case, runs=tuple(runs)), tmp_path)
    assert all(effect.storey is None and effect.floor is None for effect in report.effects)


@pytest.mark.parametrize(
    ("fault", "effect", "channel"),
    [
        (inverted, "sensor_gain", "a3"),
        (nearly_stuck, "sensor_offset", "a3"),
        pytest.param(nearly_constant, "sensor_gain", "a3", marks=SELDOM),
        pytest.param(inverted_table, "table_gain", None, marks=SELDOM),
    ],
)
def test_a_wrong_sensor_is_named_and_no_structure(
    fault: Change, effect: str, channel: str | None, tmp_path: Path
) -> None:
    report = report_on(changed(fault), tmp_path)
    assert (effect, channel) in [(one.effect, one.channel) for one in report.effects]
    assert {one.channel for one in report.effects} == {channel}
    assert report.effects[0].parameters[0].value == pytest.approx(-2.0, abs=0.05) or fault not in (
        inverted,
        inverted_table,
    )
    assert not warned(report, "first frequency")


def test_a_table_that_is_still_in_all_runs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="while floors move: its sensor is dead, or the table was at rest"):
        report_on(changed(still), tmp_path)


@pytest.mark.slow
def test_a_run_of_another_frame_is_said_and_makes_no_name(tmp_path: Path) -> None:
    case = bench()
    other = replace(case, frames=(replace(FRAME, frequency_hz=(9.0,)),))
    structure = Structure(baseline_frames(other))
    model = Model(structure, observe(other, structure), other.prior)
    answers = model.predict(np.zeros(len(model.std))).outputs[1]
    noise = 0.02 * answers.std(axis=0) * np.random.default_rng(0).standard_normal(answers.shape)
    values = np.column_stack([case.runs[1].values[:, TABLE], answers + noise])
    runs = (case.runs[0], replace(case.runs[1], values=values), case.runs[2])
    report = report_on(replace(case, runs=runs), tmp_path)
    assert report.verdict == "unknown_effect"
    assert warned(
        report, "the first frequency is 9.04 Hz in run2.csv and 6.70 Hz in run1.csv; are both of one frame?"
    )
