"""Bad input, on a frame of one's own: each fault is said, and none makes a structural effect of itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from threadpoolctl import threadpool_info, threadpool_limits

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.decision import objections
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.diagnosis import Diagnosis, conclude
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.model_checks import stray_tones
from pounding.diagnosis.report.making import report_on
from pounding.diagnosis.report.reading import read_report
from pounding.diagnosis.report.tables import tables
from pounding.diagnosis.report.writing import write_report
from pounding.diagnosis.workflow import find, prepared
from tests.diagnosis.models import STEP_S, measured

FRAME = CaseFrame("bench", 3, storey_height_m=0.2, floor_mass_kg=(6.5, 6.5, 6.5),
                  frequency_hz=(6.806,), damping_ratio=(0.01,))  # fmt: skip
CHANNELS = (
    Channel("table", "table_acceleration", "m/s^2"),
    *(Channel(f"a{i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)),
    *(Channel(f"d{i}", "relative_displacement", "mm", frame="bench", floor=i) for i in (1, 3)),
)


@pytest.fixture(scope="module")
def plain() -> Case:
    model = measured(samples=1500, runs=2)
    rng = np.random.default_rng(1)
    runs = []
    for run in model.observed.runs:
        table = run.table + 0.005 * rng.standard_normal(len(run.table))
        runs.append(Run(run.name, None, run.time_s, STEP_S, np.column_stack([table, run.measured])))
    return Case("bench", Path("bench"), (FRAME,), tuple(runs), CHANNELS)


def with_values(case: Case, change: Any) -> Case:
    runs = []
    for number, run in enumerate(case.runs):
        values = run.values.copy()
        changed = change(number, values)
        runs.append(replace(run, values=values if changed is None else changed))
    return replace(case, runs=tuple(runs))


def diagnosis(case: Case) -> Diagnosis:
    return conclude(case, *find(case, lambda what, share: None))


def diagnosed(case: Case) -> Conclusion:
    return diagnosis(case).conclusion


def test_the_linear_algebra_has_no_threads_of_its_own(plain: Case) -> None:
    """Whoever calls it from Python sets no variables of the environment first."""
    threads = []

    def told(what: str, share: float) -> None:
        threads.extend(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")
        raise InterruptedError

    with threadpool_limits(2, user_api="blas"), pytest.raises(InterruptedError):
        find(plain, told)
    assert set(threads) == {1}


def test_nothing_is_missing_in_the_plain_case(plain: Case) -> None:
    report = report_on(diagnosis(plain)).report
    assert report.verdict == "nothing_missing"
    assert report.misfit.held_out is not None
    assert report.misfit.held_out.before == pytest.approx(0.02, rel=0.15)
    assert report.confidence is not None
    assert report.confidence > 0.5


def test_a_clipped_channel_is_said_and_left_out(plain: Case) -> None:
    top = 0.5 * np.abs(plain.runs[0].values[:, 3]).max()

    def clip(number: int, values: np.ndarray) -> None:
        values[:, 3] = np.clip(values[:, 3], -top, top)

    report = diagnosed(with_values(plain, clip))
    assert report.verdict == "nothing_missing"
    assert any("a3 is clipped" in warning for warning in report.warnings)


def test_swapped_channels_are_said_and_put_right(plain: Case) -> None:
    def swap(number: int, values: np.ndarray) -> None:
        values[:, [1, 3]] = values[:, [3, 1]]

    report = diagnosed(with_values(plain, swap))
    assert any("a1 and a3 are swapped" in warning for warning in report.warnings)
    assert report.verdict == "nothing_missing"


def test_a_second_logger_that_is_late_is_a_delay_of_its_channels(plain: Case) -> None:
    def late(number: int, values: np.ndarray) -> None:
        at = np.arange(len(values)) * STEP_S
        for column in (4, 5):
            values[:, column] = np.interp(at - 0.003, at, values[:, column])

    report = diagnosed(with_values(plain, late))
    assert report.verdict == "effect_named"
    assert {(e.effect, e.channel) for e in report.effects} == {
        ("sensor_delay", "d1"),
        ("sensor_delay", "d3"),
    }
    assert report.effects[0].parameters[0].value == pytest.approx(3.0, abs=0.1)


def slowed(columns: tuple[int, ...], rate: float) -> Any:
    """Return a change by which a clock at (1 + rate) times the true rate recorded the columns."""

    def change(number: int, values: np.ndarray) -> None:
        at = np.arange(len(values)) * STEP_S
        for column in columns:
            values[:, column] = CubicSpline(at, values[:, column])(np.clip(at / (1 + rate), 0, at[-1]))

    return change


SELDOM = (pytest.mark.slow, pytest.mark.guard)


@pytest.mark.parametrize(
    ("columns", "names", "rate"),
    [
        ((2,), {"a2"}, -0.01),
        pytest.param((4, 5), {"d1", "d3"}, -0.01, marks=SELDOM),
        pytest.param((5,), {"d3"}, 0.008, marks=pytest.mark.slow),
        pytest.param((5,), {"d3"}, -0.01, marks=SELDOM),
        pytest.param((2,), {"a2"}, 0.008, marks=SELDOM),
        pytest.param((4, 5), {"d1", "d3"}, 0.008, marks=SELDOM),
    ],
)
def test_a_logger_whose_clock_is_slow_or_fast_is_named(
    plain: Case, columns: tuple[int, ...], names: set[str], rate: float
) -> None:
    report = diagnosed(with_values(plain, slowed(columns, rate)))
    assert report.verdict == "effect_named"
    assert {(e.effect, e.channel) for e in report.effects} == {("clock_rate", name) for name in names}
    assert report.effects[0].parameters[0].value == pytest.approx(rate, abs=1e-4)


@pytest.mark.slow
def test_a_table_whose_clock_is_slow_is_named(plain: Case) -> None:
    report = diagnosed(with_values(plain, slowed((0,), -0.01)))
    assert [e.effect for e in report.effects] == ["table_clock_rate"]
    assert report.effects[0].parameters[0].value == pytest.approx(-0.01, abs=2e-4)


@pytest.mark.parametrize(("factor", "change"), [(-1.0, -2.0), (9.80665, 8.80665)])
def test_a_wrong_polarity_or_unit_is_a_sensors_gain(plain: Case, factor: float, change: float) -> None:
    def scaled(number: int, values: np.ndarray) -> None:
        values[:, 2] *= factor

    report = diagnosed(with_values(plain, scaled))
    assert [(e.effect, e.channel) for e in report.effects] == [("sensor_gain", "a2")]
    assert report.effects[0].parameters[0].value == pytest.approx(change, rel=0.01)


def test_dropouts_are_no_effect(plain: Case) -> None:
    def dropped(number: int, values: np.ndarray) -> None:
        values[400:450, 1] = np.nan
        values[700, 0] = np.nan
        values[900:1000, 5] = values[899, 5]

    report = diagnosed(with_values(plain, dropped))
    assert report.verdict == "nothing_missing"
    assert any("d3 repeats one value" in warning for warning in report.warnings)
    assert any("dropouts of the table's motion" in warning for warning in report.warnings)


def test_a_single_run_has_no_held_out(plain: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case = replace(plain, runs=plain.runs[:1])
    asked = []
    monkeypatch.setattr(objections, "stray_tones", lambda *given: asked.append(given) or stray_tones(*given))
    whole = diagnosis(case)
    report = write_report(whole, report_on(whole), tmp_path)
    # What speaks against the model is looked for once, whatever is made of it.
    assert len(asked) == 1
    assert report.misfit.held_out is None
    assert read_report(tmp_path) == report
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "none could be held out" in page
    assert {path.name for path in tmp_path.iterdir()} == {
        "report.json", "report.html", "before_after.png", "where.png", "residual_force.png", "evidence.png",
        "first_page.png", "transmissibility.png", "on_the_frame.png", "before", "before.pvd",
    }  # fmt: skip
    assert any("second run" in str(item) for item in [page])
    assert list(tables(report))


def test_runs_may_differ_in_rate(plain: Case) -> None:
    slower = plain.runs[0]
    slower = replace(slower, time_s=slower.time_s[::2], step_s=2 * STEP_S, values=slower.values[::2])
    report = diagnosed(replace(plain, runs=(slower, plain.runs[1])))
    assert report.verdict == "nothing_missing"


def test_one_channel_is_enough_to_say_something(plain: Case) -> None:
    case = replace(plain, channels=(CHANNELS[0], CHANNELS[3]))
    report = diagnosed(with_values(case, lambda n, v: v[:, [0, 3]]))
    assert report.verdict == "nothing_missing"


def test_a_run_of_zeros_is_left_out(plain: Case) -> None:
    zeros = replace(plain.runs[0], file="zeros.csv", values=np.zeros_like(plain.runs[0].values))
    report = diagnosed(replace(plain, runs=(zeros, *plain.runs)))
    assert any("zeros.csv: nothing moves" in warning for warning in report.warnings)
    assert report.verdict == "nothing_missing"


def test_seconds_of_zeros_before_the_shaking_do_no_harm(plain: Case) -> None:
    def padded(number: int, values: np.ndarray) -> np.ndarray:
        return np.vstack([np.zeros((1000, values.shape[1])), values])

    case = with_values(plain, padded)
    case = replace(
        case,
        runs=tuple(replace(run, time_s=STEP_S * np.arange(len(run.values))) for run in case.runs),
    )
    assert diagnosed(case).verdict == "nothing_missing"


def test_a_dead_table_is_said_where_floors_move(plain: Case) -> None:
    def dead(number: int, values: np.ndarray) -> None:
        values[:, 0] = 0.3

    with pytest.raises(
        CaseError, match=r"run1\.csv: the table's channel reads 0\.3 m/s\^2 throughout while floors"
    ):
        diagnosed(with_values(plain, dead))


def test_a_run_with_a_dead_table_is_left_out(plain: Case) -> None:
    dead = replace(plain.runs[0], file="dead.csv", values=plain.runs[0].values * np.array([0, 1, 1, 1, 1, 1]))
    report = diagnosed(replace(plain, runs=(*plain.runs, dead)))
    assert any(
        "dead.csv: the table's channel reads 0 m/s^2 throughout while floors move" in said
        for said in report.warnings
    )
    assert not any("dead.csv: nothing moves" in said for said in report.warnings)
    assert report.verdict == "nothing_missing"


def test_nothing_but_zeros_is_refused_in_one_sentence(plain: Case) -> None:
    with pytest.raises(CaseError, match="nothing moves in any run"):
        diagnosed(with_values(plain, lambda n, v: np.zeros_like(v)))


def test_noise_alone_is_refused_in_one_sentence(plain: Case) -> None:
    rng = np.random.default_rng(3)
    with pytest.raises(CaseError, match="nothing moves in any run, or no more than noise"):
        prepared(with_values(plain, lambda n, v: 0.003 * rng.standard_normal(v.shape)))


def test_runs_of_noise_that_are_too_short_for_a_spectrum_are_reported_on(plain: Case, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    few = with_values(plain, lambda n, v: 0.003 * rng.standard_normal((33, v.shape[1])))
    few = replace(few, runs=tuple(replace(run, time_s=STEP_S * np.arange(33)) for run in few.runs))
    found = diagnosis(few)
    write_report(found, report_on(found), tmp_path)
    assert (tmp_path / "report.json").is_file()


def test_a_run_that_begins_in_motion_is_said(plain: Case) -> None:
    assert not [one for one in prepared(plain).observed.warnings if "at the first sample" in one]
    strong = int(np.argmax(np.abs(plain.runs[0].values[:, 3])))
    cut = with_values(plain, lambda n, v: v[strong:])
    cut = replace(
        cut, runs=tuple(replace(run, time_s=STEP_S * np.arange(len(run.values))) for run in cut.runs)
    )
    said = [one for one in prepared(cut).observed.warnings if "at the first sample" in one]
    assert said
    assert said[0].startswith("run1.csv: ")
    assert "floors are moving at the first sample already, and the model starts at rest" in said[0]


def test_another_frame_than_believed_is_a_softer_or_a_heavier_one(plain: Case) -> None:
    """Whose stiffness over mass is (6.806 / 12)^2 of the believed one's: which of the two, a shaken table cannot tell."""
    other = replace(FRAME, frequency_hz=(12.0,))
    concluded = diagnosed(replace(plain, frames=(other,)))
    assert concluded.verdict == "effect_class"
    (claim,) = concluded.effects
    assert {one.effect for one in claim.members} == {"all_stiffness_change", "all_added_mass"}
    change = 1 + next(one.value for one in claim.parameters if one.name == "relative_change")
    softer = change if claim.effect == "all_stiffness_change" else 1 / change
    assert softer == pytest.approx((6.806 / 12) ** 2, abs=0.02)
    assert any("6.7" in warning and "12.00 Hz" in warning for warning in concluded.warnings)


@pytest.mark.parametrize("hertz", [8.5, pytest.param(8.9, marks=[pytest.mark.slow, pytest.mark.guard])])
def test_a_frame_a_little_beyond_its_priors_is_a_softer_or_heavier_one(plain: Case, hertz: float) -> None:
    """The calibration takes the whole of it, with a stiffness that is more than three prior standard deviations off."""
    other = replace(FRAME, frequency_hz=(hertz,))
    concluded = diagnosed(replace(plain, frames=(other,)))
    assert concluded.verdict == "effect_class"
    (claim,) = concluded.effects
    assert {one.effect for one in claim.members} >= {"all_stiffness_change", "all_added_mass"}
