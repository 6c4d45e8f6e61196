"""Many runs at once: their few numbers are those of the whole motion, and whatever stops one is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding.contact import LinearSpring, thesis_law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.impacts import all_impacts
from pounding.experiments.rig.many import Case, many
from pounding.experiments.rig.rig import Rig
from tests.experiments.rig.models import FIVE

STEP = 0.004
TIME = np.arange(0.0, 3.0 + STEP / 2, STEP)
HISTORY = 3.0 * np.sin(2 * np.pi * 2.1 * TIME) + 2.0 * np.sin(2 * np.pi * 6.4 * TIME)


def test_the_numbers_are_those_of_the_motion(pair: Any) -> None:
    contacts = [[Contact(thesis_law(name, masses=(6.0, 6.0)), 0.004, 2)] for name in FIVE]
    outcomes = list(many((Case(pair, one, HISTORY, STEP) for one in contacts), workers=2))
    for one, found in zip(contacts, outcomes, strict=True):
        motion = Rig(pair, one).run(HISTORY, STEP, solver="exact")
        for frame, largest in zip(motion.frames, found.displacement_m, strict=True):
            wanted = [max(peak["max_mm"], peak["min_mm"]) for peak in frame.peaks()]
            np.testing.assert_allclose(1e3 * largest, wanted, rtol=1e-9)
        impacts = all_impacts(motion)
        assert found.touches[0] == len(motion.contacts[0].touches[0])
        assert found.first_touch_s[0] == pytest.approx(impacts[0].time_s, abs=1e-4)
        assert found.peak_force_n[0] == pytest.approx(max(i.peak_force_n for i in impacts), rel=5e-3)
        assert found.impulse_n_s[0] == pytest.approx(sum(i.impulse_n_s for i in impacts), rel=5e-3)
        assert found.closest_m[0] == pytest.approx(-motion.contacts[0].deformation_m.max(), rel=1e-9)


def test_drifts_are_differences_of_floors_at_one_time(pair: Any) -> None:
    (found,) = many([Case(pair, [], HISTORY, STEP)])
    motion = Rig(pair).run(HISTORY, STEP, solver="exact")
    at = np.linspace(0.0, 2.99, 60_001)
    for frame, drift in zip(motion.frames, found.drift_m, strict=True):
        floors = frame.sampled(at)[0][:, frame.reduced.floor_x]
        np.testing.assert_allclose(drift, np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0), rtol=1e-4)
    assert found.peak_force_n.size == 0


def test_outcomes_come_in_order_while_cases_are_still_made(pair: Any) -> None:
    gaps = np.linspace(0.002, 0.2, 40)
    made, told = [], []

    def cases() -> Any:
        for gap in gaps:
            made.append(gap)
            yield Case(pair, [Contact(LinearSpring(1e5), gap, 2)], HISTORY, STEP)

    outcomes = many(cases(), workers=2, progress=told.append)
    first = next(outcomes)
    assert len(made) < 20
    rest = list(outcomes)
    assert told[-1] == 40
    widest = rest[-1]
    assert first.touches[0] > 0
    # Frames that never touch keep a clearance that grows with the gap.
    apart = [one.closest_m[0] for one in rest if one.touches[0] == 0]
    assert widest.touches[0] == 0
    assert np.all(np.diff(apart) > 0.0)


def test_a_run_that_cannot_be_is_said(pair: Any) -> None:
    with pytest.raises(ExperimentError, match="no floor 9"):
        list(many([Case(pair, [Contact(LinearSpring(1e5), 0.004, 9)], HISTORY, STEP)]))
    with pytest.raises(ExperimentError, match="more than its height"):
        list(many([Case(pair, [], 1e5 * HISTORY, STEP)] * 3))
