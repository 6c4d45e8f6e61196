"""What stands on the table when a measure is tried: frames in a row, contacts, and links between floors."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.column_hits import Columns, Place
from pounding.experiments.rig.contacts import Contact, Within
from pounding.frames.reduction.craig_bampton import dense_modes, modal_damping
from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Link:
    """A spring and a dashpot side by side that join two floors and pull as they push.

    Attributes:
        pair: Which neighbours, from 0.
        floors: Floor of the left and of the right one.
        stiffness: Stiffness [N/m].
        damping: Damping [N s/m].
    """

    pair: int
    floors: tuple[int, int]
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Hit:
    """Columns that a floor hits, at one of the contacts.

    Attributes:
        contact: Number of the contact in the row, from 0.
        place: Where on the columns it is.
        columns: The columns.
        is_shielded: Whether a wall takes the blow in their place.
    """

    contact: int
    place: Place
    columns: Columns
    is_shielded: bool = False


@dataclass(frozen=True)
class Standing:
    """Frames in a row with what is between them.

    Attributes:
        frames: Reduced frames, from left to right.
        contacts: Contacts between neighbours.
        links: Links between neighbours.
        hits: The contacts that are on columns.
    """

    frames: tuple[ReducedFrame, ...]
    contacts: tuple[Contact, ...]
    links: tuple[Link, ...] = ()
    hits: tuple[Hit, ...] = ()

    @property
    def first_floors(self) -> list[int]:
        """Number of the floor before each frame's first, if floors are counted through the row; and that of the last."""
        return [int(end) for end in np.cumsum([0, *(frame.storeys for frame in self.frames)])]


def joined(standing: Standing) -> tuple[ReducedFrame, list[Within]]:
    """Return all frames as one body that has the links in its matrices, and the contacts within it.

    Its damping is no longer modal, and the poles of the exact solver are those of the state matrix: linked buildings
    stay linear apart from their contacts.

    Args:
        standing: The frames, contacts and links.
    """
    frames, starts = standing.frames, standing.first_floors
    places = [int(place) for place in np.cumsum([0, *(frame.size for frame in frames)])]
    mass, stiffness, damping = (
        _blocks([getattr(frame, name) for frame in frames]) for name in ("mass", "stiffness", "damping")
    )
    floor_x = np.concatenate([place + frame.floor_x for place, frame in zip(places, frames, strict=False)])
    for link in standing.links:
        row = np.zeros(len(mass))
        row[floor_x[starts[link.pair] + link.floors[0] - 1]] = 1.0
        row[floor_x[starts[link.pair + 1] + link.floors[1] - 1]] = -1.0
        stiffness += link.stiffness * np.outer(row, row)
        damping += link.damping * np.outer(row, row)
    frequencies, shapes = dense_modes(stiffness, mass)
    body = dataclasses.replace(
        frames[0],
        name=" and ".join(frame.name for frame in frames),
        storeys=starts[-1],
        heights_m=np.concatenate([frame.heights_m for frame in frames]),
        mass=mass,
        stiffness=stiffness,
        damping=damping,
        influence=np.concatenate([frame.influence for frame in frames]),
        floor_x=floor_x,
        floor_rz=np.arange(0),
        frequencies_hz=frequencies,
        shapes=shapes,
        damping_ratios=np.diag(shapes.T @ damping @ shapes) / (4.0 * np.pi * frequencies),
        moving_mass_kg=sum(frame.moving_mass_kg for frame in frames),
        basis=np.eye(len(mass)),
    )
    return body, [_within(contact, starts) for contact in standing.contacts]


def changed(frame: ReducedFrame, stiffness: Real, added_ratio: float = 0.0) -> ReducedFrame:
    """Return a frame with another stiffness and more damping in all modes.

    Args:
        frame: The frame.
        stiffness: Its new stiffness (n, n) [N/m].
        added_ratio: What is added to the damping ratio of each mode [-].
    """
    frequencies, shapes = dense_modes(stiffness, frame.mass)
    ratios = frame.damping_ratios + added_ratio
    return dataclasses.replace(
        frame,
        stiffness=stiffness,
        damping=modal_damping(frame.mass, shapes, frequencies, ratios),
        frequencies_hz=frequencies,
        shapes=shapes,
        damping_ratios=ratios,
    )


def _blocks(matrices: Sequence[Real]) -> Real:
    ends = np.cumsum([0, *(len(one) for one in matrices)])
    whole = np.zeros((ends[-1], ends[-1]))
    for (first, last), one in zip(pairwise(ends), matrices, strict=True):
        whole[first:last, first:last] = one
    return whole


def _within(contact: Contact, starts: Sequence[int]) -> Within:
    if contact.y_m:
        raise ExperimentError("a contact off the middle cannot stand beside a link; leave y_m out")
    left, right = (
        start + floor for start, floor in zip(starts[contact.pair :], contact.whole_floors, strict=False)
    )
    return Within(contact.law, contact.gap_m, left, right)
