"""Required gaps of pairs of oscillators over their periods, for one record: how far phase alone carries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.records import Record
from pounding.experiments.rig.required_gap import fine_step
from pounding.frames.response.exact import modal_poles, refine, run

Real = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class GapMap:
    """Required gaps of two oscillators that move alike in everything but their period.

    Attributes:
        ratio: Period of the stiffer over that of the softer one (a,) [-].
        tall_period_s: Period of the softer one (b,) [s].
        gap_m: Equation 4.1 (b, a) [m].
        over_srss: That over the square root of the sum of squares of both peaks (b, a) [-].
        over_abs: That over the sum of both peaks (b, a) [-].
    """

    ratio: Real
    tall_period_s: Real
    gap_m: Real
    over_srss: Real
    over_abs: Real


def gap_map(
    record: Record,
    *,
    damping_ratio: float = 0.005,
    periods: int = 21,
    steps_per_octave: int = 12,
    shortest_s: float = 0.14,
    longest_s: float = 0.65,
) -> GapMap:
    """Return the map of one record.

    Periods lie on one geometric grid, so that every oscillator serves as the softer and as the stiffer one.

    Args:
        record: Table motion at model scale.
        damping_ratio: Of every oscillator, a fraction.
        periods: Number of ratios, from 1 down.
        steps_per_octave: Of the geometric grid.
        shortest_s: Shortest period of the softer frame [s].
        longest_s: Longest period of the softer frame [s]; the defaults reach from the 5 to the 15-storey
            frames with mass added.
    """
    octave = 2.0 ** (1.0 / steps_per_octave)
    soft = shortest_s * octave ** np.arange(int(np.log2(longest_s / shortest_s) * steps_per_octave) + 1)
    ratio = octave ** -np.arange(periods)
    grid = shortest_s * octave ** np.arange(1 - periods, len(soft))
    motions = oscillators(record, grid, damping_ratio)
    peaks = np.abs(motions).max(axis=1)
    gap = np.empty((len(soft), periods))
    srss, absolute = np.empty_like(gap), np.empty_like(gap)
    for row in range(len(soft)):
        softer = row + periods - 1
        stiffer = softer - np.arange(periods)
        gap[row] = np.abs(motions[softer] - motions[stiffer]).max(axis=1)
        srss[row] = np.hypot(peaks[softer], peaks[stiffer])
        absolute[row] = peaks[softer] + peaks[stiffer]
    return GapMap(ratio, soft, gap, gap / srss, gap / absolute)


def oscillators(record: Record, periods_s: Real, damping_ratio: float) -> Real:
    """Return the displacements of oscillators under a record (periods, m) [m], float32 to save memory.

    Args:
        record: The ground motion.
        periods_s: Natural periods (periods,) [s].
        damping_ratio: Damping ratio [-].
    """
    parts = fine_step(record.step_s)
    history, step = refine(record.acceleration_m_s2, parts), record.step_s / parts
    one = np.eye(1)
    found = np.empty((len(periods_s), len(history)), np.float32)
    for index, period in enumerate(periods_s):
        poles = modal_poles([2.0 * np.pi / period], damping_ratio, one, one, np.ones(1))
        weight = (poles.load * poles.output[:, 0])[0]
        states = run(poles.rates, history, step)[0]
        found[index] = states.real * weight.real - states.imag * weight.imag
    return found
