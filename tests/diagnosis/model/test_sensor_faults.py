"""Faults of sensors taken from what they read: what is put on a true series comes off again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.model.sensor_faults import SensorFaults
from pounding.diagnosis.model.shifting import shift
from tests.diagnosis.models import measured


@pytest.mark.parametrize(("delay_s", "clock"), [(0.004, 0.0), (0.0, 0.02), (0.0, -0.02), (0.003, 0.01)])
def test_what_a_late_sensor_and_a_wrong_clock_made_comes_off_again(delay_s: float, clock: float) -> None:
    model = measured()
    run = model.observed.runs[0]
    assembly = model.assemble(np.zeros(len(model.std)))
    assembly.channel_delay_s[0], assembly.channel_clock[0] = delay_s, clock
    time = np.arange(len(run.table)) * run.step_s
    true = np.sin(2 * np.pi * 3.0 * time) * np.sin(np.pi * time / time[-1]) ** 2
    outputs = np.tile(true[:, None], (1, run.measured.shape[1]))
    read = SensorFaults([run]).added(assembly, 0, outputs.copy(), late=True)
    assert read[:, 1] == pytest.approx(true)
    found = SensorFaults([replace(run, measured=read)]).removed(assembly, 0)
    known = np.isfinite(found[:, 0])
    assert found[known, 0] == pytest.approx(true[known], abs=0.01)
    # What a fast clock would have shown at the end was never recorded.
    lost = len(true) - int(np.ceil(len(true) / (1.0 + clock))) if clock > 0.0 else 0
    assert np.flatnonzero(~known).tolist() == list(range(len(true) - lost, len(true)))


def test_a_channel_of_which_little_was_measured_is_left_as_it_was() -> None:
    """A few samples cannot be shifted; they are copied, so that nobody writes into what was measured."""
    few = np.full(50, np.nan)
    few[10:13] = 1.0, 2.0, 3.0
    moved = shift(few, 0.01, 0.005)
    np.testing.assert_array_equal(moved, few)
    moved[:] = 0.0
    assert np.isfinite(few).sum() == 3
