"""The case without the faults of its sensors and its table shows what was measured without them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case, Channel, Run
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.report.corrected_case import corrected_case
from tests.diagnosis.models import STEP_S, measured

QUIET = measured(samples=800, runs=2, noise=0.0, reference=1)
NAMES = QUIET.observed.names


def case_of(model: Model) -> Case:
    """Return the runs of a model as a case whose table comes last."""
    channels = [Channel(name, "absolute_acceleration", "m/s^2", frame="bench", floor=1) for name in NAMES]
    channels.append(Channel("table", "table_acceleration", "m/s^2"))
    runs = tuple(
        Run(run.name, "reference" if run.reference else None, run.time_s, STEP_S,
            np.column_stack([run.measured, run.table]))
        for run in model.observed.runs
    )  # fmt: skip
    return Case("bench", Path("bench"), (), runs, tuple(channels))


def effect(name: str) -> Effect:
    return list(places(next(kind for kind in kinds() if kind.name == name and kind.described), QUIET))[-1]


@pytest.mark.parametrize(
    ("name", "value", "close"),
    [
        ("sensor_gain", -1.7, 1e-12),
        ("sensor_offset", 0.02, 1e-12),
        ("sensor_delay", 0.0034, 0.01),
        ("clock_rate", 0.004, 0.01),
    ],
)
def test_a_sensor_is_put_right(name: str, value: float, close: float) -> None:
    fault = effect(name)
    acting = [(fault, np.array([value]))]
    wrong = measured(acting, samples=800, runs=2, noise=0.0, reference=1)
    whole, without = (case_of(model) for model in (wrong, QUIET))
    right = corrected_case(whole, wrong.observed, wrong.assemble(np.zeros(len(wrong.std)), acting))
    assert right is not None
    for before, after, true in zip(whole.runs, right.runs, without.runs, strict=True):
        inner = slice(50, -50)
        scale = np.abs(true.values).max(axis=0)
        assert np.abs((after.values - true.values) / scale)[inner].max() < close
        if not before.reference:
            assert np.abs((before.values - true.values) / scale)[inner].max() > 10 * close


def test_the_table_is_what_shook_the_frame() -> None:
    """Gain and delay of the table: the frame moves under the corrected record as it did under the true one."""
    acting = [(effect("table_gain"), np.array([0.25])), (effect("table_delay"), np.array([0.004]))]
    faults = QUIET.assemble(np.zeros(len(QUIET.std)), acting)
    right = corrected_case(case_of(QUIET), QUIET.observed, faults)
    assert right is not None
    run = QUIET.observed.runs[1]
    true = QUIET.table_at(faults, 1, run.time_s)
    inner = slice(50, -50)
    assert np.abs(right.runs[1].values[inner, -1] - true[inner]).max() < 0.01 * np.abs(true).max()
    assert np.array_equal(right.runs[0].values, case_of(QUIET).runs[0].values)


def test_without_a_fault_there_is_no_other_case() -> None:
    faults = QUIET.assemble(np.zeros(len(QUIET.std)), [(effect("stiffness_change"), np.array([-0.2]))])
    assert corrected_case(case_of(QUIET), QUIET.observed, faults) is None
