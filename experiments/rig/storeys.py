"""Forces within one frame: laws in storeys, which oppose a drift, and known forces; and what they did there in a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pounding.calling import MEMORY, NUMBERS
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.motion import FrameMotion, StoreyHistory

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StoreyLaw:
    """A force within a frame that follows from a drift, its rate, the time and a memory.

    Attributes:
        address: Where its compiled function is (`pounding.calling.entry`, which must be kept alive as long as this).
        row: What the floors' displacements contribute to the drift (storeys,) [-].
        parameters: Its parameters in SI (NUMBERS,); NaN stands for the end of the run [s].
        body: Which frame of the row, from 0.
        in_room: Share of the table's rate in the rate that it sees: one in the room, nothing for that of the drift alone.
        remembers: Whether it has a memory; what remembers sees every turn of the drift.
        memory: What it remembers at the start (MEMORY,); nothing by default.
    """

    address: int
    row: Real
    parameters: Real
    body: int = 0
    in_room: float = 0.0
    remembers: bool = True
    memory: Real = field(default_factory=lambda: np.zeros(MEMORY))


@dataclass(frozen=True, eq=False)
class KnownForce:
    """A force on the floors of a frame that is known beforehand, straight between its samples.

    Attributes:
        row: Its share on each floor (storeys,) [-].
        force_n: The force at the samples of the table's acceleration (m,) [N]; none after the last.
        body: Which frame of the row, from 0.
    """

    row: Real
    force_n: Real
    body: int = 0


def check(storey: StoreyLaw | KnownForce, frames: Sequence[ReducedFrame]) -> None:
    """Refuse a law or a known force that the frames of a row cannot have.

    Args:
        storey: The law or the force.
        frames: Reduced frames, from left to right.

    Raises:
        ExperimentError: A frame that is not there, or a row, parameters or a memory of the wrong length.
    """
    if not 0 <= storey.body < len(frames):
        raise ExperimentError(
            f"a law in frame {storey.body}, but there are {len(frames)} frame(s), counted from 0"
        )
    frame = frames[storey.body]
    _check_length(f"row of floors of {frame.name}", storey.row, frame.storeys)
    if isinstance(storey, StoreyLaw):
        _check_length("parameters", storey.parameters, NUMBERS)
        _check_length("memory", storey.memory, MEMORY)


def _check_length(what: str, values: Real, wanted: int) -> None:
    if np.shape(values) != (wanted,):
        raise ExperimentError(
            f"a law in a storey: the {what} has shape {np.shape(values)}; give {wanted} numbers"
        )


def no_law_twice(
    given: Sequence[StoreyLaw], stated: Sequence[StoreyLaw], frames: Sequence[ReducedFrame]
) -> None:
    """Refuse a law that a frame states itself, and that is in every run of it, beside the frame's.

    Args:
        given: Laws beside those of the frames.
        stated: Laws of the frames themselves.
        frames: Reduced frames, from left to right.

    Raises:
        ExperimentError: A law that is among both.
    """
    for one in given:
        if any(_same(one, other) for other in stated):
            raise ExperimentError(
                f"storeys: a law that frame {frames[one.body].name} states itself would act twice; leave it out, "
                "a frame's own laws are in every run"
            )


def _same(one: StoreyLaw, other: StoreyLaw) -> bool:
    return (
        one.address == other.address
        and one.body == other.body
        and np.array_equal(one.row, other.row)
        and np.array_equal(one.parameters, other.parameters, equal_nan=True)
    )


def coordinate_row(frames: Sequence[ReducedFrame], storey: StoreyLaw | KnownForce) -> Real:
    """Return what the coordinates of its frame contribute to a law's drift (n,) [-].

    Args:
        frames: Reduced frames, from left to right.
        storey: The law, or a known force.
    """
    frame = frames[storey.body]
    row = np.zeros(len(frame.mass))
    row[frame.floor_x] = storey.row
    return row


def history_of(
    frames: Sequence[ReducedFrame],
    motions: Sequence[FrameMotion],
    storey: StoreyLaw | KnownForce,
    force_n: Real,
    middle_n: Real,
) -> StoreyHistory:
    """Return what a law in a storey did.

    Args:
        frames: Reduced frames, from left to right.
        motions: What they did.
        storey: The law, or a known force, whose work is what it takes from the frame.
        force_n: Its force at the steps (m,) [N].
        middle_n: Its force in the middle of the step that ends there (m,) [N]; the first does not count.
    """
    row, motion = coordinate_row(frames, storey), motions[storey.body]
    return StoreyHistory(
        motion.name,
        motion.time_s,
        motion.displacement_m @ row,
        motion.velocity_m_s @ row,
        force_n,
        middle_n[1:],
    )
