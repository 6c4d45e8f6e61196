"""Impacts found in a contact's history, on motions whose impacts are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.contact import LinearSpring, make_law
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.impacts import MERGING_S, all_impacts, groups, impacts
from pounding.experiments.rig.motion import Motion

SPEED, STIFFNESS, MASS = 0.3, 20e6, 3.1
HALF = np.pi / np.sqrt(STIFFNESS / MASS)  # contact time


def bounce(touches_s: list[float], *, stiffness: float = STIFFNESS, step_s: float = 1e-5) -> ContactHistory:
    """Floors that touch at the given times as two free bodies do, and are apart in between."""
    half = np.pi / np.sqrt(stiffness / MASS)
    rate = np.pi / half
    dense = [np.linspace(t, t + half, 60) for t in touches_s]
    time = np.union1d(np.arange(0.0, touches_s[-1] + 0.1, 5e-4), np.concatenate(dense))
    deformation, velocity = np.full(len(time), -1e-3), np.zeros(len(time))
    for touch in touches_s:
        # Straight in and out for a millisecond on both sides, the half sine in between.
        for sign, edge in ((1.0, touch), (-1.0, touch + half)):
            near = (time - edge) * sign
            side = (near < 0.0) & (near > -1e-3)
            deformation[side] = SPEED * near[side]
            velocity[side] = sign * SPEED
        inside = (time >= touch) & (time <= touch + half)
        deformation[inside] = SPEED / rate * np.sin(rate * (time[inside] - touch))
        velocity[inside] = SPEED * np.cos(rate * (time[inside] - touch))
    change = np.gradient(velocity, time)
    law = LinearSpring(stiffness)
    return ContactHistory(5, "left", "right", 0.01, 0.0, law, time, deformation, velocity, change)


def test_one_touch_is_one_impact_with_its_numbers() -> None:
    found = impacts(bounce([0.5]))
    assert len(found) == 1
    impact = found[0]
    assert impact.time_s == pytest.approx(0.5, abs=1e-5)
    assert impact.duration_ms == pytest.approx(1e3 * HALF, rel=0.02)
    assert impact.peak_force_n == pytest.approx(SPEED * np.sqrt(STIFFNESS * MASS), rel=2e-3)
    assert impact.impulse_n_s == pytest.approx(2 * MASS * SPEED, rel=2e-3)
    assert impact.approach_velocity_m_s == pytest.approx(SPEED, rel=0.01)
    assert impact.restitution == pytest.approx(1.0, abs=0.03)
    assert impact.touches == 1
    assert impact.floor == 5


@pytest.mark.parametrize(
    ("apart_s", "expected"), [(0.5 * MERGING_S, [2]), (MERGING_S - 3e-4, [2]), (MERGING_S + 2e-3, [1, 1])]
)
def test_touches_that_follow_closely_are_one_impact(apart_s: float, expected: list[int]) -> None:
    assert [impact.touches for impact in impacts(bounce([0.5, 0.5 + HALF + apart_s]))] == expected


def test_a_merged_impact_has_the_duration_and_restitution_of_each_touch_beside_its_own() -> None:
    """Two touches of a millisecond ten apart are no contact of twelve, whatever a merged duration says."""
    (impact,) = impacts(bounce([0.5, 0.5 + HALF + 0.01]))
    assert impact.touches == 2
    assert impact.longest_touch_ms == pytest.approx(1e3 * HALF, rel=0.02)
    assert impact.duration_ms == pytest.approx(1e3 * (2.0 * HALF + 0.01), rel=0.01)
    assert impact.touch_restitutions == pytest.approx([1.0, 1.0], abs=0.03)


def test_touches_below_the_threshold_do_not_count() -> None:
    history = bounce([0.5])
    peak = impacts(history)[0].peak_force_n
    assert impacts(history, threshold_n=1.01 * peak) == []
    assert len(impacts(history, threshold_n=0.99 * peak)) == 1


def test_a_contact_too_short_for_the_sample_rate_is_found() -> None:
    """At 1e12 N/m a touch lasts five microseconds, between two samples of a laboratory's 10,000 a second."""
    history = bounce([0.50003], stiffness=1e12)
    assert history.sampled()[1].max() == 0.0
    found = impacts(history)
    assert len(found) == 1
    assert found[0].impulse_n_s == pytest.approx(2 * MASS * SPEED, rel=5e-3)


def test_no_touch_no_impact() -> None:
    history = bounce([0.5])
    apart = replace(history, deformation_m=history.deformation_m - 1.0)
    assert impacts(apart) == []
    assert apart.sampled()[1].max() == 0.0


def test_impacts_of_several_contacts_come_in_time() -> None:
    first, second = bounce([0.5, 0.7]), bounce([0.6])
    motion = Motion((), (first, replace(second, floor=3)), None, 0.0, 0.0, 0)  # type: ignore[arg-type]
    assert [(round(i.time_s, 3), i.floor) for i in all_impacts(motion)] == [(0.5, 5), (0.6, 3), (0.7, 5)]


def test_groups_of_times() -> None:
    assert groups(np.array([]), 1.0) == []
    assert groups(np.array([0.0, 0.5, 2.0]), 1.0) == [(0.0, 0.5), (2.0, 2.0)]


def test_the_approach_of_a_latching_law_is_that_of_its_own_touch() -> None:
    history = replace(bounce([0.5, 0.6]), law=make_law("hertz_damp", stiffness=9.772e8, restitution=0.8))
    _, rates = history.touches
    assert rates == pytest.approx([SPEED, SPEED], rel=0.01)
    deformation, rate, force = history.at(np.array([0.6 + 0.2e-3]))
    assert force == pytest.approx(history.law.force(deformation, rate, rates[1]), rel=1e-9)
