"""Touches of a contact: each closing and opening, read from the run's own interpolation between the engine's steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.experiments.rig.contact_history import ContactHistory


@dataclass(frozen=True)
class Touch:
    """One closing and opening of a contact.

    Attributes:
        left, right: Names of the frames.
        floor: Floor of the left frame.
        first_s, last_s: Its beginning and the end of its overlap [s].
        duration_s: How long the floors pressed [s].
        peak_force_n: Largest force [N].
        impulse_n_s: Integral of the force [N s].
        approach_m_s: Velocity at its beginning [m/s].
        parting_m_s: Velocity at which the floors part, positive apart [m/s].
        depth_m: Largest overlap [m].
        gap_m: Gap at rest [m].
    """

    left: str
    right: str
    floor: float
    first_s: float
    last_s: float
    duration_s: float
    peak_force_n: float
    impulse_n_s: float
    approach_m_s: float
    parting_m_s: float
    depth_m: float
    gap_m: float

    @property
    def restitution(self) -> float | None:
        """Velocity of parting over that of approach [-]; None if the floors did not approach."""
        return restitution(self, self)


def restitution(first: Touch, last: Touch) -> float | None:
    """Return the velocity of parting after one touch over that of approach before another [-].

    Args:
        first: The touch before which the floors approach; None is returned if they did not.
        last: The touch after which they part.
    """
    return last.parting_m_s / first.approach_m_s if first.approach_m_s > 0.0 else None


def touches_of(history: ContactHistory) -> list[Touch]:
    """Return the touches of a contact in which it pushes, in time.

    Args:
        history: The contact through a run.
    """
    found = []
    for first, last in history.pulses:
        times, deformation, rate, force = history.pulse(first, last)
        pressed = force > 0.0
        if not pressed.any():
            continue
        found.append(
            Touch(
                left=history.left,
                right=history.right,
                floor=history.floor,
                first_s=float(times[0]),
                last_s=last,
                duration_s=float(times[pressed][-1] - times[0]),
                peak_force_n=float(force.max()),
                impulse_n_s=float(np.trapezoid(force, times)),
                approach_m_s=float(rate[0]),
                parting_m_s=-float(rate[pressed][-1]),
                depth_m=float(deformation.max()),
                gap_m=history.gap_m,
            )
        )
    return found
