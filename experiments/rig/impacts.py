"""Impacts in a contact's force, found as a laboratory does from a force sensor at 10,000 samples a second.

An impact begins where a sample reaches `THRESHOLD_N`. Samples above the threshold that are less than
`MERGING_S` apart belong to one impact: after the first touch two floors often touch again within
milliseconds, while the collision is still going on. Such an impact is merged from several touches, and its duration
and restitution are those of the whole, the time apart included; each touch has its own beside them. What an impact
carried (peak, impulse, duration) is then read from the run's own interpolation between the engine's steps, not from
the coarse samples.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.touches import Touch, restitution, touches_of
from pounding.scale import THESIS, Scale

Real = NDArray[np.floating]

SAMPLE_RATE_HZ = 10_000.0
THRESHOLD_N = 10.0
"""About 0.05 % of the range of the thesis' sensor (22.24 kN), above the noise of such a channel [N]."""

MERGING_S = 0.02
"""A period of the fastest sways of these frames (about 50 Hz): touches that follow each other faster are the
floors' rattle within one collision [s]. docs/validation/chapters-5-6.md shows the counts for other values."""


def merging_s(scale: Scale) -> float:
    """Return the merging time of frames of a scale [s]: `MERGING_S` of the laboratory's frames by the similitude."""
    return MERGING_S * (scale.time_factor / THESIS.time_factor)


@dataclass(frozen=True)
class Impact:
    """One impact.

    Attributes:
        time_s: First touch [s].
        duration_ms: From the first touch to the last parting, the time apart between touches included [ms].
        peak_force_n: Largest force [N].
        impulse_n_s: Integral of the force [N s].
        approach_velocity_m_s: Velocity of approach at the first touch [m/s].
        restitution: Velocity of parting after the last touch over that of approach at the first. Of several
            touches it is no property of the contact: the frames have moved on between them. None if the floors
            did not approach.
        left, right: Names of the frames that touched.
        floor: Floor of the left frame.
        touches: How often the floors touched in it; the impact is merged if more than once.
        longest_touch_ms: Duration of the longest touch [ms].
        touch_restitutions: Restitution of each touch, in time; the frames' own motion takes part, so it may pass
            the law's by a little, and by much in a slow touch.
        y_m: Place along the floors' edge, from the middle [m].
    """

    time_s: float
    duration_ms: float
    peak_force_n: float
    impulse_n_s: float
    approach_velocity_m_s: float
    restitution: float | None
    left: str
    right: str
    floor: float
    touches: int
    longest_touch_ms: float
    touch_restitutions: list[float | None]
    y_m: float = 0.0

    def __repr__(self) -> str:
        return (
            f"Impact(at {self.time_s:.4f} s, floor {self.floor:g} of {self.left!r} beside {self.right!r}, "
            f"{self.peak_force_n:.4g} N, approach {self.approach_velocity_m_s:.3g} m/s, {self.touches} "
            f"touch{'es' * (self.touches != 1)})"
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the impact as a dictionary, in the order above."""
        return asdict(self)


def impacts(
    history: ContactHistory, *, threshold_n: float = THRESHOLD_N, merging_s: float = MERGING_S
) -> list[Impact]:
    """Return the impacts of one contact, in time.

    Args:
        history: The contact.
        threshold_n: Force from which a sample counts [N].
        merging_s: Samples closer than this belong to one impact [s].
    """
    times, force = history.sampled(SAMPLE_RATE_HZ)
    sampled = times[force >= threshold_n]
    above = np.union1d(sampled, _unseen(history, threshold_n))
    touches = touches_of(history)
    return [_impact(touches, start, end, history.y_m) for start, end in groups(above, merging_s)]


def all_impacts(motion: Motion, **options: float) -> list[Impact]:
    """Return the impacts of all contacts of a run, in time; options as for `impacts`."""
    found = [impact for history in motion.contacts for impact in impacts(history, **options)]
    return sorted(found, key=lambda impact: impact.time_s)


def groups(above_s: Real, merging_s: float) -> list[tuple[float, float]]:
    """Return (first, last) time [s] of each group of times (k,) [s] less than `merging_s` apart."""
    if not above_s.size:
        return []
    breaks = np.flatnonzero(np.diff(above_s) >= merging_s)
    starts = np.concatenate([above_s[:1], above_s[breaks + 1]])
    ends = np.concatenate([above_s[breaks], above_s[-1:]])
    return list(zip(starts.tolist(), ends.tolist(), strict=True))


def _unseen(history: ContactHistory, threshold_n: float) -> Real:
    """Return times [s] above the threshold in touches too short for the sample rate to be sure to see them.

    A contact of 1e9 N/m lasts half a sample. The engine's steps resolve it, a laboratory would miss it.
    """
    found = []
    for pulse in history.pulses:
        times, _, _, force = history.pulse(*pulse)
        if times[-1] - times[0] < 2.0 / SAMPLE_RATE_HZ:
            found.append(times[force >= threshold_n])
    return np.concatenate(found) if found else np.empty(0)


def _impact(touches: list[Touch], start_s: float, end_s: float, y_m: float) -> Impact:
    whisker = 1.0 / SAMPLE_RATE_HZ
    inside = [one for one in touches if one.last_s >= start_s - whisker and one.first_s <= end_s + whisker]
    first, last = inside[0], inside[-1]
    return Impact(
        time_s=first.first_s,
        duration_ms=1e3 * (last.first_s + last.duration_s - first.first_s),
        peak_force_n=max(one.peak_force_n for one in inside),
        impulse_n_s=sum(one.impulse_n_s for one in inside),
        approach_velocity_m_s=first.approach_m_s,
        restitution=restitution(first, last),
        left=first.left,
        right=first.right,
        floor=first.floor,
        touches=len(inside),
        longest_touch_ms=1e3 * max(one.duration_s for one in inside),
        touch_restitutions=[one.restitution for one in inside],
        y_m=y_m,
    )
