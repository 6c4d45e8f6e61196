"""What a touch must not do if its contact is to be believed: push back more than it took, last long, sink in deep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pounding.experiments.rig.impacts import THRESHOLD_N
from pounding.experiments.rig.motion import ContactHistory, Motion

LONGEST_SHARE = 0.1
"""A touch longer than this share of the shorter first period is part of the sway, not an impact [-]."""

DEEPEST_SHARE = 0.1
"""Floors that overlap by more than this share of the gap are softer than the gap allows [-]."""

SLOWEST_SHARE = 0.05
"""A touch approached slower than this share of the run's fastest has no restitution of its own: the frames' sway parts the
floors [-]."""


@dataclass(frozen=True)
class Touch:
    """One closing and opening of a contact.

    Attributes:
        time_s: Its beginning [s].
        floor: Floor of the left frame.
        duration_s: How long the floors pressed [s].
        approach_m_s: Velocity at its beginning [m/s].
        restitution: Velocity of parting over it [-]; 0 where the run ends in it.
        depth_m: Largest overlap [m].
        gap_m: Gap at rest [m].
    """

    time_s: float
    floor: int
    duration_s: float
    approach_m_s: float
    restitution: float
    depth_m: float
    gap_m: float


def contact_warnings(motion: Motion) -> list[str]:
    """Return a sentence for each limit of an impact that touches pass, with the worst of them.

    Args:
        motion: A run with contacts.
    """
    touches = [touch for history in motion.contacts for touch in touches_of(history)]
    if not touches:
        return []
    period = min(1.0 / float(frame.reduced.frequencies_hz[0]) for frame in motion.frames)
    return [*_bouncing(touches), *_lasting(touches, period), *_sinking(touches)]


def touches_of(history: ContactHistory) -> list[Touch]:
    """Return the touches of a contact whose force reaches what a sensor sees, in time."""
    found = []
    for first, last in history.pulses:
        times, deformation, rate, force = history.pulse(first, last)
        pressed = force > 0.0
        if force.max() < THRESHOLD_N:
            continue
        approach, parting = float(rate[0]), -float(rate[pressed][-1])
        found.append(
            Touch(
                first, history.floor, float(times[pressed][-1] - first), approach,
                parting / approach if approach > 0.0 else 0.0, float(deformation.max()), history.gap_m,
            )
        )  # fmt: skip
    return found


def _bouncing(touches: Sequence[Touch]) -> list[str]:
    fastest = max(touch.approach_m_s for touch in touches)
    above = [
        touch for touch in touches if touch.restitution > 1.0 and touch.approach_m_s > SLOWEST_SHARE * fastest
    ]
    if not above:
        return []
    worst = max(above, key=lambda touch: touch.restitution)
    return [
        f"{_count(above, touches)} a restitution above 1, up to {worst.restitution:.2f} at {worst.time_s:.3f} s on floor "
        f"{worst.floor}: the sway of the frames parts those floors, not the contact, and the law's restitution says "
        "nothing of them"
    ]


def _lasting(touches: Sequence[Touch], period_s: float) -> list[str]:
    long = [touch for touch in touches if touch.duration_s > LONGEST_SHARE * period_s]
    if not long:
        return []
    worst = max(long, key=lambda touch: touch.duration_s)
    return [
        f"{_count(long, touches)} a duration above {LONGEST_SHARE:g} of the shorter first period of {period_s:.3g} s, up to "
        f"{1e3 * worst.duration_s:.3g} ms at {worst.time_s:.3f} s on floor {worst.floor}: the floors lean on each other "
        "there, or the contact is too soft to be an impact"
    ]


def _sinking(touches: Sequence[Touch]) -> list[str]:
    deep = [touch for touch in touches if touch.gap_m > 0.0 and touch.depth_m > DEEPEST_SHARE * touch.gap_m]
    if not deep:
        return []
    worst = max(deep, key=lambda touch: touch.depth_m / touch.gap_m)
    return [
        f"{_count(deep, touches)} an overlap above {DEEPEST_SHARE:g} of the gap, up to {1e3 * worst.depth_m:.3g} mm of "
        f"{1e3 * worst.gap_m:.4g} mm at {worst.time_s:.3f} s on floor {worst.floor}: the contact is too soft for this gap; "
        "give a stiffer one"
    ]


def _count(some: Sequence[Touch], all_of_them: Sequence[Touch]) -> str:
    return f"{len(some)} of {len(all_of_them)} touches {'has' if len(some) == 1 else 'have'}"
