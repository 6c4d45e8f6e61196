"""Runs that end with the shaking while frames still move."""

from __future__ import annotations

import re

import numpy as np
import pytest

from pounding import frames
from pounding.contact import thesis_law
from pounding.experiments.records import Record
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.shaking import shake
from pounding.experiments.separation.gaps.gap import gap_answer

STEP_S = 0.002
FIVE = frames.build(frames.load("5A"))


def pulse(rest_s: float = 0.0) -> Record:
    """Return half a sine that is much shorter than a period of the frame, and some rest."""
    time = np.arange(0.0, 0.03 + STEP_S / 2, STEP_S)
    rest = np.zeros(round(rest_s / STEP_S))
    return Record("pulse", np.append(4.0 * np.sin(np.pi * time / time[-1]), rest), STEP_S)


def test_a_frame_that_goes_farther_after_the_record_is_said_to() -> None:
    (said,) = shake(FIVE, pulse()).warnings
    farther = re.search(r"roof goes to ([0-9.]+) mm, and to ([0-9.]+) mm before", said)
    assert farther is not None
    whole = shake(FIVE, pulse(rest_s=1.0))
    assert not whole.warnings
    roof = whole.motion.frames[0].displacement_m[:, FIVE.floor_x[-1]]
    assert float(farther[1]) == pytest.approx(1e3 * np.abs(roof).max(), rel=0.01)
    assert float(farther[2]) < 0.8 * float(farther[1])


def test_gap_and_collision_say_so_too() -> None:
    other = frames.build(frames.load("5B"))
    cut, whole = (gap_answer(FIVE, other, pulse(rest_s), own_peak=False).warnings for rest_s in (0.0, 1.0))
    assert [one.partition(":")[0] for one in cut if "still moves" in one] == ["5A", "5B"]
    assert not any("still moves" in one for one in whole)
    run = pound(FIVE, other, pulse(), thesis_law("hertz"), 0.05, solver="exact")
    assert sum("still moves" in one for one in run.validity()["warnings"]) == 2
