"""Laws on one motion, and how finely a laser resolves the deformation of an impact."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from pounding.contact import LinearSpring, make_law
from pounding.experiments.campaign.one_motion import laser_limits, on_one_motion
from pounding.experiments.rig.contact_history import ContactHistory

STIFFNESS = 20e6


def bounce() -> ContactHistory:
    """Two touches of a millisecond, 10 ms apart, by 60 micrometres."""
    time = np.arange(0.0, 0.03, 2e-5)
    deformation = np.full(len(time), -1e-3)
    for start in (0.005, 0.016):
        inside = (time > start) & (time < start + 1e-3)
        deformation[inside] = 60e-6 * np.sin(np.pi * (time[inside] - start) / 1e-3)
    rate = np.gradient(deformation, time)
    change = np.gradient(rate, time)
    return ContactHistory(
        5, "left", "right", 0.01, 0.0, LinearSpring(STIFFNESS), time, deformation, rate, change
    )


def test_on_one_motion_every_law_has_the_same_impacts_and_the_force_goes_with_the_stiffness() -> None:
    """So that their agreement in number and time shows nothing about the laws."""
    laws = {
        "soft": LinearSpring(STIFFNESS),
        "stiff": LinearSpring(10.0 * STIFFNESS),
        "hertz": make_law("hertz", stiffness=1e9),
    }
    found = on_one_motion(bounce(), laws)
    assert found["impacts"].tolist() == [1, 1, 1]
    assert found["touches"].tolist() == [2, 2, 2]
    assert found["first_touch_s"].nunique() == 1
    # A run of its own would have the root of ten.
    assert found.loc["stiff", "first_peak_n"] == pytest.approx(10.0 * found.loc["soft", "first_peak_n"])


def test_a_laser_that_reads_in_steps_of_30_micrometres_hardly_sees_an_impact() -> None:
    found = laser_limits(pd.Series({"gentle": 600.0, "hard": 4000.0}), STIFFNESS)
    assert found["deformation_um"].tolist() == pytest.approx([30.0, 200.0])
    assert found["steps"].tolist() == pytest.approx([1.0, 200.0 / 30.0])
    readings = np.random.default_rng(1).uniform(0.0, 100.0, (4, 100_000))
    lost = 30.0 * (np.round(readings) - readings)
    spread = np.std(lost[0] - lost[1] + lost[2] - lost[3])
    assert found.loc["gentle", "standard_error_percent"] == pytest.approx(100.0 * spread / 30.0, rel=0.02)
