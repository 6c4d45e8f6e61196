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
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.motion import FrameMotion, floor_coordinate
from pounding.frames.floors import LEVEL_SHARE, level_floors

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """A place where two neighbouring frames may touch.

    Attributes:
        law: Impact law with its parameters.
        gap_m: Gap at rest [m]; zero means that the floors lie against each other.
        floor: Floor on both frames, or (left, right) where their numbers differ at the same height. A number between two
            floors of a stick is a place on its columns there: 2.25 is a quarter of the storey above the second floor.
        pair: Which pair: 0 is between the first and the second frame of the row.
        y_m: Place along the floors' edge, from the middle [m].
    """

    law: Law
    gap_m: float
    floor: int | tuple[float, float]
    pair: int = 0
    y_m: float = 0.0

    @property
    def floors(self) -> tuple[float, float]:
        """Floor of the left and of the right frame; a whole number but on columns."""
        return self.floor if isinstance(self.floor, tuple) else (self.floor, self.floor)

    @property
    def whole_floors(self) -> tuple[int, int]:
        """The same of a contact of two floors, not on columns."""
        left, right = self.floors
        return int(left), int(right)

    @property
    def on_columns(self) -> bool:
        """Whether one of the two is a place on columns."""
        return any(not float(floor).is_integer() for floor in self.floors)


def check(contact: Contact, frames: Sequence[ReducedFrame]) -> None:
    """Refuse a contact that the frames of a row cannot have.

    Args:
        contact: The contact.
        frames: Reduced frames, from left to right.

    Raises:
        ExperimentError: A pair or a floor that is not there, or floors at different heights.
        FrameError: A place off the floors, or off the middle of floors that do not turn.
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
        _check_place(frame, floor, contact)
    low, high = (height_of(frame, floor) for frame, floor in zip(pair, contact.floors, strict=True))
    level = (
        abs(low - high) <= LEVEL_SHARE * min(pair[0].heights_m[0], pair[1].heights_m[0])
        if contact.on_columns
        else contact.floors in level_floors(pair[0].heights_m, pair[1].heights_m)
    )
    if not level:
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
    left, right = (Side(body, place_row(frames[body], floor, contact.y_m)) for body, floor in both)
    return left, right


def height_of(frame: ReducedFrame, floor: float) -> float:
    """Return the height of a floor, or of a place on columns, above the table [m].

    Args:
        frame: The frame.
        floor: Number of the floor; 0 is the table, a number between two floors a place on the columns there.
    """
    return float(np.interp(floor, np.arange(frame.storeys + 1), [0.0, *frame.heights_m]))


def _check_place(frame: ReducedFrame, floor: float, contact: Contact) -> None:
    if float(floor).is_integer():
        floor_coordinate(frame, int(floor))
        frame.point_row(int(floor), contact.y_m)
        return
    if not 0.0 < floor < frame.storeys:
        raise ExperimentError(f"{frame.name} has no columns at {floor:g}: its storeys end at {frame.storeys}")
    place_row(frame, floor, contact.y_m)


def place_row(frame: ReducedFrame, floor: float, y_m: float = 0.0) -> Real:
    """Return the displacement in x of a place for a unit of each coordinate of its frame (n,).

    Args:
        frame: The frame.
        floor: Number of the floor; a number between two floors is a place on the columns there.
        y_m: Place along the floor's edge, from the middle [m]; 0 on columns.

    Raises:
        ExperimentError: A place on columns of a frame of plates, or off their middle.
        FrameError: A place off the floors, or off the middle of floors that do not turn.
    """
    if not float(floor).is_integer() and (frame.is_mesh or y_m):
        raise ExperimentError(
            f"{frame.name}: a contact on columns is modelled for sticks, in the middle of the floors' edge"
        )
    if y_m:
        return np.asarray(frame.point_row(int(floor), y_m), float)
    row = np.zeros(len(frame.mass))
    below = int(floor)
    if below == floor:
        row[floor_coordinate(frame, below)] = 1.0
        return row
    # A column between floors that do not turn: the shape that its two ends' sway gives, which is also how a force on
    # it is borne by the two floors.
    lower, upper = column_weights(floor - below)
    if below:
        row[floor_coordinate(frame, below)] = lower
    row[floor_coordinate(frame, below + 1)] = upper
    return row


def column_weights(share: float) -> tuple[float, float]:
    """Return which shares of a force on a column fixed at both ends the lower and the upper end bear [-].

    Args:
        share: Where the force acts: height above the lower end over the column's length [-].
    """
    upper = share**2 * (3.0 - 2.0 * share)
    return 1.0 - upper, upper


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
        apart[0] - contact.gap_m, apart[1], apart[2], contact.floors[1],
    )  # fmt: skip
