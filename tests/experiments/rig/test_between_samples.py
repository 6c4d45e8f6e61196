"""What is worked out between samples: work from a power and its slopes, the top of a force from its largest samples."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.experiments.rig.energy import _integrated
from pounding.experiments.rig.many import _peak

TIMES = np.array([0.0, 0.1, 0.25, 0.3, 0.5, 0.9, 1.0])
"""Steps of many lengths [s]."""


def test_work_is_exact_where_a_power_is_a_cubic_over_time() -> None:
    power, slope = TIMES**3 - 2.0 * TIMES, 3.0 * TIMES**2 - 2.0
    work = _integrated(np.diff(TIMES), power, slope[:-1], slope[1:])
    np.testing.assert_allclose(work, TIMES**4 / 4.0 - TIMES**2, atol=1e-15)


@pytest.mark.parametrize("top", [0.27, 0.35])
def test_the_top_of_a_parabola_is_found_between_its_samples(top: float) -> None:
    force = 50.0 - 400.0 * (TIMES - top) ** 2
    assert force.max() < 49.9
    assert _peak(TIMES, force) == pytest.approx(50.0)


def test_a_force_that_begins_or_ends_at_its_largest_sample_has_no_other_top() -> None:
    assert _peak(TIMES, np.array([0.0, 0.0, 30.0, 20.0, 0.0, 0.0, 0.0])) == 30.0
    assert _peak(TIMES, np.array([9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0])) == 9.0
