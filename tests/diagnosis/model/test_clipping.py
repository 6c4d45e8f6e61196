"""One rule tells what is clipped, channels and force cells alike; cells need fewer samples, for impacts have few."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.contact_force import force_cell
from pounding.diagnosis.model import sensors
from pounding.diagnosis.settings import SETTINGS

QUIET = [0.0] * 50
RUN: Any = None
"""What is clipped is told by the channel alone."""


def impacts(*each: list[float]) -> np.ndarray:
    return np.concatenate([[*QUIET, *one, *QUIET] for one in each])


@pytest.mark.parametrize(
    ("flat", "of_a_cell", "of_a_channel"), [(2, False, False), (3, True, False), (6, True, True)]
)
def test_samples_at_the_largest_force_are_clipped(flat: int, of_a_cell: bool, of_a_channel: bool) -> None:
    force = impacts([20.0, *[50.0] * flat, 30.0])
    assert force_cell._clipped([force, impacts([10.0])]) == of_a_cell
    assert sensors._clipped(force, RUN).any() == of_a_channel
    # A channel clips below, too.
    np.testing.assert_array_equal(sensors._clipped(-force, RUN), sensors._clipped(force, RUN))


def test_samples_that_clip_one_at_a_time_are_clipped() -> None:
    """Impacts so short that each has a single sample at the cell's limit."""
    force = impacts(*[[20.0, 50.0, 10.0]] * 3)
    assert force_cell._clipped([force])


def test_equal_peaks_of_a_coarse_logger_are_not_clipped() -> None:
    """Five impacts that end at one value by chance, with many others as strong."""
    strong = [
        impacts([20.0, 48.0, peak, 47.0, 10.0]) for peak in (50.0, 49.0, 50.0, 48.0, 50.0, 49.5, 50.0, 50.0)
    ]
    assert not force_cell._clipped(strong)
    assert not sensors._clipped(np.concatenate(strong), RUN).any()


def test_what_clips_is_found_in_all_runs_together() -> None:
    """Two samples at the cell's limit in each run, which none shows alone."""
    runs = [impacts([20.0, 50.0, 50.0, 10.0]) for _ in range(2)]
    assert force_cell._clipped(runs)
    assert not force_cell._clipped(runs[:1])


def test_what_is_missing_or_never_pushes_is_not_clipped() -> None:
    nothing = np.zeros(100)
    assert not sensors.at_its_top(nothing, SETTINGS.force_cell.clipped_samples).any()
    assert not sensors.at_its_top(np.full(100, np.nan), 1).any()
    gaps = impacts([20.0, *[50.0] * 6, 30.0])
    gaps[52] = np.nan
    assert sensors.at_its_top(gaps, 5).sum() == 5
