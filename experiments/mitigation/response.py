"""What a street under a record does: forces, drifts, floor accelerations, and the gap that it would need."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.constants import STANDARD_GRAVITY
from pounding.contact.rubber import RubberBlock
from pounding.experiments.mitigation.standing import Standing, joined
from pounding.experiments.records import Record
from pounding.experiments.rig.column_hits import borne
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.contacts import Contact, sides_of
from pounding.experiments.rig.exact import run_exact
from pounding.experiments.rig.impacts import THRESHOLD_N
from pounding.experiments.rig.motion import FrameMotion, Motion
from pounding.experiments.rig.touches import touches_of

Real = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Response:
    """The worst of a street under one record, or under several.

    Attributes:
        peak_force_n: Largest contact force [N].
        touches: How often floors touched with 10 N and more.
        link_force_n: Largest force of a link [N]; 0 without links.
        drift: Largest storey drift over its height [-].
        acceleration_g: Largest acceleration of a floor in the room [g].
        required_gap_mm: Gap at each contact that would have kept the floors apart [mm].
        compression: Largest compression of a bumper over its thickness [-]; 0 without bumpers.
        column_shear_kn: Largest shear of one column where floors hit columns [kN]; 0 where none does.
        column_moment_kn_m: Largest moment there [kN m].
    """

    peak_force_n: float
    touches: int
    link_force_n: float
    drift: float
    acceleration_g: float
    required_gap_mm: tuple[float, ...]
    compression: float = 0.0
    column_shear_kn: float = 0.0
    column_moment_kn_m: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return it with the names above as keys."""
        return asdict(self)


def response(standing: Standing, record: Record) -> Response:
    """Return what a street does under a record, by the exact solver.

    Args:
        standing: Frames, contacts and links.
        record: The shaking at their scale.

    Raises:
        ExperimentError: A run that grows without bound.
    """
    motion, apart = _run(standing, record), _run(standing, record, apart=True)
    floors = _Floors(standing, motion)
    touches = [touch for contact in motion.contacts for touch in touches_of(contact)]
    forces = [touch.peak_force_n for touch in touches]
    columns = [
        borne(
            motion,
            standing.contacts[one.contact],
            one.place,
            one.columns,
            one.contact,
            is_shielded=one.is_shielded,
        )
        for one in standing.hits
    ]
    return Response(
        peak_force_n=max(forces, default=0.0),
        touches=sum(force >= THRESHOLD_N for force in forces),
        link_force_n=max((floors.link_force_n(place) for place in range(len(standing.links))), default=0.0),
        drift=floors.drift(),
        acceleration_g=floors.acceleration_g(),
        required_gap_mm=tuple(1e3 * max(0.0, float(value)) for value in _Floors(standing, apart).closing_m()),
        compression=max((_compression(contact) for contact in motion.contacts), default=0.0),
        column_shear_kn=max((one["shear_kn"] for one in columns), default=0.0),
        column_moment_kn_m=max((one["moment_kn_m"] for one in columns), default=0.0),
    )


def worst(responses: Iterable[Response]) -> Response:
    """Return the largest of each quantity over several records.

    Args:
        responses: One a record.
    """
    each = list(responses)
    return Response(
        peak_force_n=max(one.peak_force_n for one in each),
        touches=max(one.touches for one in each),
        link_force_n=max(one.link_force_n for one in each),
        drift=max(one.drift for one in each),
        acceleration_g=max(one.acceleration_g for one in each),
        required_gap_mm=tuple(map(max, zip(*(one.required_gap_mm for one in each), strict=True))),
        compression=max(one.compression for one in each),
        column_shear_kn=max(one.column_shear_kn for one in each),
        column_moment_kn_m=max(one.column_moment_kn_m for one in each),
    )


def _run(standing: Standing, record: Record, *, apart: bool = False) -> Motion:
    if standing.links:
        body, within = joined(standing)
        return run_exact([body], [] if apart else within, record.acceleration_m_s2, record.step_s)
    contacts = () if apart else standing.contacts
    return run_exact(standing.frames, contacts, record.acceleration_m_s2, record.step_s)


def _compression(contact: ContactHistory) -> float:
    if not isinstance(contact.law, RubberBlock):
        return 0.0
    return max(0.0, float(contact.deformation_m.max())) / contact.law.thickness_m


class _Floors:
    """The floors of a row through a run, whether its frames were one body or several."""

    def __init__(self, standing: Standing, motion: Motion) -> None:
        self._standing, self._motion = standing, motion
        starts = standing.first_floors
        self._places = [
            self._place(index, slice(first, last)) for index, (first, last) in enumerate(pairwise(starts))
        ]

    def _place(self, index: int, floors: slice) -> tuple[FrameMotion, NDArray[np.int64]]:
        """Return the body that a frame is in, and its floors' coordinates there."""
        if len(self._motion.frames) == len(self._standing.frames):
            own = self._motion.frames[index]
            return own, own.reduced.floor_x
        body = self._motion.frames[0]
        return body, body.reduced.floor_x[floors]

    def drift(self) -> float:
        found = []
        for frame, (body, floors) in zip(self._standing.frames, self._places, strict=True):
            drifts = np.diff(body.displacement_m[:, floors], prepend=0.0, axis=1)
            found.append(np.abs(drifts / np.diff(frame.heights_m, prepend=0.0)).max())
        return float(max(found))

    def acceleration_g(self) -> float:
        return float(
            max(
                np.abs(body.acceleration_m_s2[:, floors] + body.table_m_s2[:, None]).max()
                for body, floors in self._places
            )
            / STANDARD_GRAVITY
        )

    def closing_m(self) -> list[float]:
        return [float(self._closing(contact).max()) for contact in self._standing.contacts]

    def _closing(self, contact: Contact) -> Real:
        if not contact.y_m and not contact.on_columns:
            return self._apart("displacement_m", contact.pair, contact.whole_floors)
        # No frames are joined then: contacts off the middle or on columns stand without links.
        left, right = sides_of(self._standing.frames, contact)
        moved = [self._motion.frames[side.body].displacement_m @ side.row for side in (left, right)]
        return np.asarray(moved[0] - moved[1])

    def link_force_n(self, place: int) -> float:
        link = self._standing.links[place]
        stretched, rate = (
            self._apart(name, link.pair, link.floors) for name in ("displacement_m", "velocity_m_s")
        )
        return float(np.abs(link.stiffness * stretched + link.damping * rate).max())

    def _apart(self, name: str, pair: int, numbers: Sequence[int]) -> Real:
        """Return a quantity of the left floor less that of the right one (m,); both bodies have the same steps."""
        left, right = (
            getattr(body, name)[:, floors[number - 1]]
            for (body, floors), number in zip(self._places[pair : pair + 2], numbers, strict=True)
        )
        return np.asarray(left - right)
