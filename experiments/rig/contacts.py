"""Places where two neighbouring frames may touch, and what they did there in a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pounding.contact.connector import checked_gap
from pounding.contact.laws import Law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.motion import ContactHistory, FrameMotion, floor_coordinate
from pounding.frames.floors import level_floors

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """A place where two neighbouring frames may touch.

    Attributes:
        law: Impact law with its parameters.
        gap_m: Gap at rest [m]; zero means that the floors lie against each other.
        floor: Floor on both frames, or (left, right) where their numbers differ at the same height.
        pair: Which pair: 0 is between the first and the second frame of the row.
        y_m: Place along the floors' edge, from the middle [m].
    """

    law: Law
    gap_m: float
    floor: int | tuple[int, int]
    pair: int = 0
    y_m: float = 0.0

    @property
    def floors(self) -> tuple[int, int]:
        """Floor of the left and of the right frame."""
        return self.floor if isinstance(self.floor, tuple) else (self.floor, self.floor)


def check(contact: Contact, frames: Sequence[ReducedFrame]) -> None:
    """Refuse a contact that the frames of a row cannot have.

    Args:
        contact: The contact.
        frames: Reduced frames, from left to right.

    Raises:
        ExperimentError: A pair or a floor that is not there, or floors at different heights.
        ContactError: A negative gap.
    """
    checked_gap(contact.gap_m)
    if not 0 <= contact.pair < len(frames) - 1:
        raise ExperimentError(
            f"a contact in pair {contact.pair}, but {len(frames)} frame(s) in a row have "
            f"{max(0, len(frames) - 1)} pair(s), counted from 0"
        )
    pair = frames[contact.pair : contact.pair + 2]
    for frame, floor in zip(pair, contact.floors, strict=True):
        floor_coordinate(frame, floor)
    if contact.floors not in level_floors(pair[0].heights_m, pair[1].heights_m):
        low, high = (
            float(frame.heights_m[floor - 1]) for frame, floor in zip(pair, contact.floors, strict=True)
        )
        raise ExperimentError(
            f"floor {contact.floors[0]} of {pair[0].name} is at {low:g} m and floor {contact.floors[1]} "
            f"of {pair[1].name} at {high:g} m: only floors at one height can meet"
        )


@dataclass(frozen=True)
class Within:
    """A place where two floors of one body may touch: of two buildings that are modelled as one.

    Attributes:
        law: Impact law with its parameters.
        gap_m: Gap at rest [m].
        left, right: Floors; the left one moves in +x towards the right one.
        body: Which body of the row, from 0.
    """

    law: Law
    gap_m: float
    left: int
    right: int
    body: int = 0
    y_m: ClassVar[float] = 0.0

    @property
    def floors(self) -> tuple[int, int]:
        """Left and right floor."""
        return self.left, self.right


class Side(NamedTuple):
    """One side of a contact.

    Attributes:
        body: Which frame of the row, from 0.
        row: Displacement in x of the side's point for a unit of each coordinate of that frame (n,).
    """

    body: int
    row: Real


def sides_of(frames: Sequence[ReducedFrame], contact: Contact | Within) -> tuple[Side, Side]:
    """Return the left and the right side of a contact.

    Args:
        frames: Reduced frames, from left to right.
        contact: A contact between two of them, or within one.
    """
    first, second = (contact.body,) * 2 if isinstance(contact, Within) else (contact.pair, contact.pair + 1)
    both = (first, contact.floors[0]), (second, contact.floors[1])
    left, right = (Side(body, _row(frames[body], floor, contact.y_m)) for body, floor in both)
    return left, right


def _row(frame: ReducedFrame, floor: int, y_m: float) -> Real:
    if y_m:
        return np.asarray(frame.point_row(floor, y_m), float)
    row = np.zeros(len(frame.mass))
    row[floor_coordinate(frame, floor)] = 1.0
    return row


def history_of(
    frames: Sequence[ReducedFrame], motions: Sequence[FrameMotion], contact: Contact | Within
) -> ContactHistory:
    """Return what happened at a contact.

    Args:
        frames: Reduced frames, from left to right.
        motions: What they did.
        contact: A contact between two of them, or within one.
    """
    (left, left_row), (right, right_row) = sides_of(frames, contact)
    one, other = motions[left], motions[right]
    apart = [
        first @ left_row - second @ right_row
        for first, second in (
            (one.displacement_m, other.displacement_m),
            (one.velocity_m_s, other.velocity_m_s),
            (one.acceleration_m_s2, other.acceleration_m_s2),
        )
    ]
    return ContactHistory(
        contact.floors[0], one.name, other.name, contact.gap_m, contact.y_m, contact.law, one.time_s,
        apart[0] - contact.gap_m, apart[1], apart[2],
    )  # fmt: skip
