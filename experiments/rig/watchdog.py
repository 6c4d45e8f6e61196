"""What is done before each step of a run: contacts latch, and a run that cannot end well is stopped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import exudyn
import numpy as np

from pounding.contact.connector import Latch
from pounding.experiments.rig.motion import unbounded
from pounding.frames.response.body import FrameBody

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

CHECK_EVERY = 64
"""Steps between two looks at whether the motion is still bounded."""

STUCK_CHECKS = 64
STUCK_S = 1e-6
"""Shortest time that 64 times 64 steps must cover [s]."""


class Guard:
    """Called before each step: lets contacts latch, and stops a run that grows without bound or stands still.

    Args:
        frames, bodies: What is watched.
        latches: Called with the system before each step.
        progress: Called now and then with the model time [s].

    Attributes:
        reason: Why it stopped the run, in words; empty if it did not.
        time_s: Time of the last step begun [s].
    """

    def __init__(
        self,
        frames: Sequence[ReducedFrame],
        bodies: Sequence[FrameBody],
        latches: Sequence[Latch],
        progress: Callable[[float], None] | None,
    ) -> None:
        self._latches = latches
        self._watched = list(zip(frames, bodies, strict=True))
        self._progress, self._count, self._milestone = progress, 0, 0.0
        self.reason, self.time_s = "", 0.0

    def __call__(self, mbs: Any, t: float) -> bool:
        """Return whether the run, now at time t [s], goes on."""
        self.time_s = t
        for latch in self._latches:
            latch(mbs)
        self._count += 1
        if self._count % CHECK_EVERY:
            return True
        self.reason = self._unbounded(mbs) or self._stuck(t)
        if self._progress is not None:
            self._progress(t)
        return not self.reason

    def _unbounded(self, mbs: Any) -> str:
        for frame, body in self._watched:
            # The engine gives a single coordinate as a number.
            coordinates = np.atleast_1d(mbs.GetNodeOutput(body.node, exudyn.OutputVariableType.Coordinates))
            reason = unbounded(frame, np.abs(coordinates[frame.floor_x]))
            if reason:
                return reason
        return ""

    def _stuck(self, t: float) -> str:
        if self._count % (CHECK_EVERY * STUCK_CHECKS):
            return ""
        gone, self._milestone = t - self._milestone, t
        if gone > STUCK_S:
            return ""
        return (
            f"{CHECK_EVERY * STUCK_CHECKS} steps have covered {gone:.1g} s only; lower the contact's "
            "stiffness or damping, or loosen the relative and absolute tolerance"
        )
