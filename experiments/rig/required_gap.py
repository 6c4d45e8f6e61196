"""The gap that two frames on one table need: the largest closing motion of a run without pounding.

Equation 4.1 of the thesis takes the largest magnitude of ``u_left - u_right``, which counts the frames moving
*apart* as well. Only the closing motion can bring them together, so that is the required gap here; the other
stands beside it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import place_row
from pounding.frames import ReducedFrame
from pounding.frames.floors import level_floors
from pounding.frames.response.exact import Poles, poles, refine, run, select

FINEST_STEP_S = 1e-3
"""Longest step at which a motion is looked at [s]: a peak of a 7 Hz mode is missed by at most 0.03 %."""

NEGLIGIBLE_MODE = 1e-6
"""A mode with less than this share of the largest static part is left out: below any digit shown."""


@dataclass(frozen=True)
class RequiredGap:
    """What a run without pounding says of two frames at one floor, all relative to the table.

    Attributes:
        closing_m: Largest of ``u_left - u_right``, at least 0 [m]: the required gap.
        time_s: When it is reached [s].
        opening_m: Largest of ``u_right - u_left``, at least 0 [m]: the required gap of the frames on swapped
            sides.
        left_peak_m: Largest magnitude of the left frame's motion [m].
        right_peak_m: Largest magnitude of the right frame's motion [m].
    """

    closing_m: float
    time_s: float
    opening_m: float
    left_peak_m: float
    right_peak_m: float

    def __repr__(self) -> str:
        swapped = f"on swapped sides {1e3 * self.opening_m:.2f} mm"
        return f"RequiredGap({1e3 * self.closing_m:.2f} mm at {self.time_s:.3f} s, {swapped})"

    @property
    def equation_4_1_m(self) -> float:
        """Largest magnitude of ``u_left - u_right``, as equation 4.1 has it [m]."""
        return max(self.closing_m, self.opening_m)


def required_gap(
    left_m: NDArray[np.floating[Any]], right_m: NDArray[np.floating[Any]], step_s: float
) -> RequiredGap:
    """Return the required gap of two motions.

    Args:
        left_m: Displacement of the left frame (m,) [m], positive towards the right one.
        right_m: Displacement of the right frame at the same instants (m,) [m].
        step_s: Time between the instants [s].

    Raises:
        ExperimentError: Motions of different length, or not finite.
    """
    if left_m.shape != right_m.shape or left_m.ndim != 1 or left_m.size == 0:
        raise ExperimentError(
            f"two motions of the same length are needed, not {left_m.shape} and {right_m.shape}"
        )
    difference = left_m - right_m
    if not np.isfinite(difference).all():
        raise ExperimentError("a motion is not finite: the run that made it failed")
    first = int(difference.argmax())
    return RequiredGap(
        closing_m=max(0.0, float(difference[first])),
        time_s=first * step_s if difference[first] > 0.0 else 0.0,
        opening_m=max(
            0.0, float(-difference.min())
        ),  # in this order: of two zeros max takes the first, and not -0
        left_peak_m=float(np.abs(left_m).max()),
        right_peak_m=float(np.abs(right_m).max()),
    )


def is_left_lower(left: ReducedFrame, right: ReducedFrame) -> bool:
    """Return whether the left frame is the lower one, whose floors a contact is named by."""
    return bool(left.heights_m[-1] < right.heights_m[-1])


def contact_floors(left: ReducedFrame, right: ReducedFrame, floor: int | None = None) -> tuple[int, int]:
    """Return the numbers of the floors that would meet, of the left and the right frame.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        floor: Floor of the lower frame; its roof when None.

    Raises:
        ExperimentError: A floor that the lower frame does not have, or one that faces no floor of the other.
    """
    lower_is_left = is_left_lower(left, right)
    lower, other = (left, right) if lower_is_left else (right, left)
    wanted = lower.storeys if floor is None else floor
    if not 1 <= wanted <= lower.storeys:
        raise ExperimentError(
            f"floor {wanted} cannot meet: frame {lower.name} has the floors 1 to {lower.storeys} "
            f"beside {other.name}"
        )
    for pair in level_floors(left.heights_m, right.heights_m):
        if pair[0 if lower_is_left else 1] == wanted:
            return pair
    raise ExperimentError(
        f"floor {wanted} of frame {lower.name} at {lower.heights_m[wanted - 1]:.4g} m faces no floor of "
        f"{other.name}: name a floor at a shared height; what a floor does to columns `pounding pound` and `gap` say for "
        "a street whose gap has a table 'columns'"
    )


def fine_step(step_s: float) -> int:
    """Return the number of parts of a record's step, so that a part is at most `FINEST_STEP_S`."""
    return max(1, math.ceil(step_s / FINEST_STEP_S - 1e-9))


def motions(frame: ReducedFrame, record: Record, floors: list[int]) -> NDArray[np.floating[Any]]:
    """Return the exact motion of floors without pounding.

    Args:
        frame: A frame, linear but for storeys that yield and the laws that its file states.
        record: Table motion at the frame's scale.
        floors: Floor numbers, from 1.

    Returns:
        Displacement of their middles relative to the table (m, floors) [m], at steps of at most `FINEST_STEP_S`.
    """
    rows = [place_row(frame, floor) for floor in floors]
    return place_motions(frame, record, np.reshape(rows, (len(floors), frame.size)))


def place_motions(
    frame: ReducedFrame, record: Record, rows: NDArray[np.floating[Any]]
) -> NDArray[np.floating[Any]]:
    """Return the exact motion of places without pounding, as `motions` does.

    Args:
        frame: The frame.
        record: Table motion at the frame's scale.
        rows: Displacement of each place for a unit of each coordinate (k, n), see `place_row`.

    Returns:
        Displacement of the places relative to the table (m, k) [m].
    """
    parts = fine_step(record.step_s)
    history = refine(record.acceleration_m_s2, parts)
    if frame.definition.storey_law or frame.definition.yielding is not None:
        return _with_laws(frame, record, rows, record.step_s / parts * np.arange(len(history)))
    return floor_motions(poles(frame), rows, history, record.step_s / parts)


def _with_laws(
    frame: ReducedFrame,
    record: Record,
    rows: NDArray[np.floating[Any]],
    times_s: NDArray[np.floating[Any]],
) -> NDArray[np.floating[Any]]:
    """Return the displacement of places (m, k) [m] at times (m,) [s], by the exact solver with the laws in storeys."""
    # Its compiled loop takes a second to load, which linear frames need not wait for.
    from pounding.experiments.rig.exact import ExactRig

    rig = ExactRig([frame], [])
    solution = rig.solve(record.acceleration_m_s2, record.step_s)
    value, rate = rig.coordinates(solution, 0, rows)
    return np.asarray(CubicHermiteSpline(solution.time_s, value, rate)(times_s))


def detuned(frame: ReducedFrame, factor: float) -> ReducedFrame:
    """Return a frame whose frequencies are all multiplied by a factor; shapes, damping ratios and laws are the same.

    Args:
        frame: The frame.
        factor: The factor [-].
    """
    return replace(
        frame,
        stiffness=factor**2 * frame.stiffness,
        damping=factor * frame.damping,
        frequencies_hz=factor * frame.frequencies_hz,
    )


def floor_motions(
    frame: Poles,
    outputs: list[int] | NDArray[np.floating[Any]],
    history: NDArray[np.floating[Any]],
    step_s: float,
) -> NDArray[np.floating[Any]]:
    """Return the displacement of coordinates or places (m, k) [m] under a table acceleration (m,) [m/s^2].

    `pounding.frames.response.exact.forced` without the velocities, and without the modes whose static part is below a
    millionth of the largest.

    Args:
        frame: Poles of the frame.
        outputs: Indices of the coordinates (k,), or rows that combine coordinates (k, n).
        history: Acceleration of the table (m,) [m/s^2].
        step_s: Sample step [s].
    """
    weights = frame.load[:, None] * select(frame.output, outputs)
    static = np.abs(weights / frame.rates[:, None]).max(axis=1)
    counted = static > NEGLIGIBLE_MODE * static.max()
    states = run(frame.rates[counted], history, step_s)
    weights = weights[counted]
    return np.asarray(states.real.T @ weights.real - states.imag.T @ weights.imag)


def pair_gap(
    left: ReducedFrame, right: ReducedFrame, record: Record, *, floor: int | None = None, y_m: float = 0.0
) -> RequiredGap:
    """Return the required gap of two frames under a record, from an exact run without pounding.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale, see `Record.scaled`.
        floor: Floor of the lower frame; its roof when None.
        y_m: Place along the floors' edge, from the middle [m].

    Raises:
        ExperimentError: See `contact_floors`.
        FrameError: A place off the floors, or off the middle of floors that do not turn.
    """
    return gap_at(left, right, record, contact_floors(left, right, floor), y_m)


def gap_at(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    floors: tuple[float, float],
    y_m: float = 0.0,
) -> RequiredGap:
    """Return the required gap of two frames at any place, as `pair_gap` does.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        floors: Floor of the left and of the right frame; a number between two floors is a place on columns.
        y_m: Place along the floors' edge, from the middle [m].
    """
    one, other = (
        place_motions(frame, record, place_row(frame, floor, y_m)[None, :])[:, 0]
        for frame, floor in zip((left, right), floors, strict=True)
    )
    return required_gap(one, other, record.step_s / fine_step(record.step_s))


def gaps_by_floor(
    left: ReducedFrame, right: ReducedFrame, record: Record, y_m: float = 0.0
) -> list[tuple[int, RequiredGap]]:
    """Return the required gap at every shared floor, each with the floor's number in the lower frame.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        y_m: Place along the floors' edge, from the middle [m].

    Raises:
        ExperimentError: No floors of the two are level.
    """
    pairs = level_floors(left.heights_m, right.heights_m)
    if not pairs:
        raise ExperimentError(f"frames {left.name} and {right.name} have no floor at a shared height")
    step = record.step_s / fine_step(record.step_s)
    moved_left, moved_right = (
        place_motions(frame, record, np.stack([place_row(frame, pair[side], y_m) for pair in pairs]))
        for side, frame in enumerate((left, right))
    )
    of_lower = 0 if is_left_lower(left, right) else 1
    return [
        (pair[of_lower], required_gap(moved_left[:, index], moved_right[:, index], step))
        for index, pair in enumerate(pairs)
    ]
