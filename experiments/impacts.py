"""Impacts in a contact's force, found as a laboratory finds them from a force sensor at 10,000 samples a second.

An impact begins where a sample reaches `THRESHOLD_N`. Samples above the threshold that are less than
`MERGING_S` apart belong to one impact: after the first touch two floors often touch again within
milliseconds, while the collision is still going on. What an impact carried (peak, impulse, duration) is then
read from the run's own interpolation between the engine's steps, not from the coarse samples.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.motion import ContactHistory, Motion

SAMPLE_RATE_HZ = 10_000.0
THRESHOLD_N = 10.0
"""About 0.05 % of the range of the thesis' sensor (22.24 kN), above the noise of such a channel [N]."""

MERGING_S = 0.01
"""Shorter than half a period of the fastest sway of these frames (about 40 Hz): no floor can leave and come
back by its frame's motion within it [s]."""


@dataclass(frozen=True)
class Impact:
    """One impact.

    Attributes:
        time_s: First touch [s].
        duration_ms: From the first touch to the last parting [ms].
        peak_force_n: Largest force [N].
        impulse_n_s: Integral of the force [N s].
        approach_velocity_m_s: Velocity of approach at the first touch [m/s].
        restitution: Velocity of parting after the last touch over that of approach; the frames' own motion
            takes part, so it may pass the law's by a little, and by much in a slow impact. None if the floors
            did not approach.
        floor: Floor of the left frame.
        touches: How often the floors touched in it.
    """

    time_s: float
    duration_ms: float
    peak_force_n: float
    impulse_n_s: float
    approach_velocity_m_s: float
    restitution: float | None
    floor: int
    touches: int

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
    return [_impact(history, start, end) for start, end in windows(times, force, threshold_n, merging_s)]


def all_impacts(motion: Motion, **options: float) -> list[Impact]:
    """Return the impacts of all contacts of a run, in time; options as for `impacts`."""
    found: Iterable[Impact] = (impact for history in motion.contacts for impact in impacts(history, **options))
    return sorted(found, key=lambda impact: impact.time_s)


def windows(
    times_s: NDArray[np.float64], force_n: NDArray[np.float64], threshold_n: float, merging_s: float
) -> list[tuple[float, float]]:
    """Return (first, last) time [s] above the threshold of each impact in a sampled force (m,) [N]."""
    above = times_s[force_n >= threshold_n]
    if not above.size:
        return []
    breaks = np.flatnonzero(np.diff(above) >= merging_s)
    starts = np.concatenate([above[:1], above[breaks + 1]])
    ends = np.concatenate([above[breaks], above[-1:]])
    return list(zip(starts.tolist(), ends.tolist(), strict=True))


def _impact(history: ContactHistory, start_s: float, end_s: float) -> Impact:
    first, last = _touching(history, start_s, end_s)
    times, deformation, rate, force = history.fine(first, last)
    touched, rates = history.touches
    inside = (touched >= first - 1e-4) & (touched <= last)
    approach = float(rates[inside][0]) if inside.any() else float(rate[0])
    parting = -float(rate[-1])
    return Impact(
        time_s=float(touched[inside][0]) if inside.any() else first,
        duration_ms=1e3 * (last - first),
        peak_force_n=float(force.max()),
        impulse_n_s=float(np.trapezoid(force, times)),
        approach_velocity_m_s=approach,
        restitution=parting / approach if approach > 0 else None,
        floor=history.floor,
        touches=max(1, int(np.count_nonzero(np.diff(force > 0.0, prepend=False) & (force > 0.0)))),
    )


def _touching(history: ContactHistory, start_s: float, end_s: float) -> tuple[float, float]:
    """Return a window [s] widened to where the force is zero on both sides (at most the merging time)."""
    margin, step = MERGING_S, 1e-5
    before = np.arange(start_s, max(history.time_s[0], start_s - margin), -step)
    after = np.arange(end_s, min(history.time_s[-1], end_s + margin), step)
    return _last_before_zero(history, before, start_s), _last_before_zero(history, after, end_s)


def _last_before_zero(history: ContactHistory, times: NDArray[np.float64], fallback: float) -> float:
    if not times.size:
        return fallback
    free = np.flatnonzero(history.at(times)[2] <= 0.0)
    return float(times[free[0]]) if free.size else float(times[-1])
