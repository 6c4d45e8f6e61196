"""The tests of the laboratory as motions of the whole frame, to draw and to look at in ParaView.

`pounding.frames.response.laboratory` reads the roof alone. Here all coordinates of the frame are computed in a short
window, by the same formulas.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.energy import balance
from pounding.experiments.rig.motion import FrameMotion, Motion
from pounding.frames.response.exact import absolute_acceleration, free_response, poles, run
from pounding.frames.response.laboratory import SAMPLE_HZ, PushTest, SineSweep, pushed

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

PERIODS = 5.0
"""Length of a window in periods of the first mode."""

STATES_A_PERIOD = 20
"""States of a window in a period of the first mode."""

RELEASE_M = 0.005
"""Displacement of the roof before it is released, as in the laboratory's test of the model [m]."""


def push_motion(reduced: ReducedFrame, test: PushTest) -> Motion:
    """Return the loads one after the other, one in a second of the clock, each at rest.

    Args:
        reduced: The frame.
        test: Its push test.
    """
    moved = np.multiply.outer(test.force_n, pushed(reduced))
    none = np.zeros_like(moved)
    return _motion(reduced, np.arange(float(len(moved))), moved, none, none, np.zeros(len(moved)))


def decay_motion(reduced: ReducedFrame) -> Motion:
    """Return the first periods after the roof is released."""
    period = 1.0 / float(reduced.frequencies_hz[0])
    times = np.arange(0.0, PERIODS * period, period / STATES_A_PERIOD)
    start = pushed(reduced)
    start *= RELEASE_M / start[reduced.floor_x[-1]]
    moved, rates = free_response(reduced, start, np.zeros_like(start), times)
    room = absolute_acceleration(reduced, moved, rates)
    return _motion(reduced, times, moved, rates, room, np.zeros(len(times)))


def sweep_motion(reduced: ReducedFrame, test: SineSweep) -> Motion:
    """Return the periods around the largest displacement of the roof in a sweep.

    Args:
        reduced: The frame.
        test: Its sweep.
    """
    samples_a_period = SAMPLE_HZ / float(reduced.frequencies_hz[0])
    half = round(0.5 * PERIODS * samples_a_period)
    middle = int(np.abs(test.roof_displacement_m).argmax())
    last = min(middle + half, len(test.time_s))
    every = max(1, round(samples_a_period / STATES_A_PERIOD))
    chosen = np.arange(max(0, middle - half), last, every)
    frame = poles(reduced)
    moved, rates = (np.zeros((len(chosen), reduced.size)) for _ in range(2))
    # One pole after the other: all of them at once over a sweep of minutes are hundreds of megabytes.
    for rate, output, load in zip(frame.rates, frame.output, frame.load, strict=True):
        state = run(np.array([rate]), test.table_m_s2[:last], 1.0 / SAMPLE_HZ)[0, chosen]
        moved += np.multiply.outer(state, load * output).real
        rates += np.multiply.outer(state, rate * load * output).real
    room = absolute_acceleration(reduced, moved, rates)
    return _motion(reduced, test.time_s[chosen], moved, rates, room, test.table_m_s2[chosen])


def _motion(
    reduced: ReducedFrame, times_s: Real, moved: Real, rates: Real, room: Real, table_m_s2: Real
) -> Motion:
    """Return a window as a motion whose clock begins at zero."""
    relative = room - np.multiply.outer(table_m_s2, reduced.influence)
    frame = FrameMotion(reduced, times_s - times_s[0], moved, rates, relative, table_m_s2)
    return Motion((frame,), (), balance((frame,), ()), 0.0, 0.0, len(times_s), solver="exact")
