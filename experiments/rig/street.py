"""Buildings in a row: the frames of a street, and the contacts between neighbours."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from pounding.contact.rubber import RubberBlock
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.column_hits import Columns, Place, masses_at, place_of, softened
from pounding.experiments.rig.contact_choice import Parameters, choose_laws, chosen_parameters
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.motion import distinct
from pounding.experiments.rig.pounding import built_in, floor_masses
from pounding.experiments.rig.required_gap import contact_floors, is_left_lower
from pounding.experiments.rig.street_file import Bumper, Gap, Street

if TYPE_CHECKING:
    from pounding.experiments.rig.states import FrameState
    from pounding.experiments.rig.table_scale import TableScale
    from pounding.frames.definition import Frame
    from pounding.frames.reduction.reduced_frame import ReducedFrame


class Basis(NamedTuple):
    """What a contact's numbers rest on.

    Attributes:
        pair: Which neighbours, from 0.
        floor: Floor of the lower of them.
        sentence: The basis in words, the law's name first.
        hit: Where it is on columns, and on which; None where two floors meet.
        y_m: Place along the floors' edge, from the middle [m].
    """

    pair: int
    floor: int
    sentence: str
    hit: tuple[Place, Columns] | None = None
    y_m: float = 0.0


def named(street: Street, row: Sequence[ReducedFrame]) -> list[ReducedFrame]:
    """Return reduced frames under their buildings' names; of two that have one name, the second is called ``name#2``.

    Args:
        street: The street.
        row: The frames of its buildings, reduced.
    """
    names = distinct([one.name or frame.name for one, frame in zip(street.building, row, strict=True)])
    return [dataclasses.replace(frame, name=name) for frame, name in zip(row, names, strict=True)]


def built_row(
    street: Street, states: Sequence[FrameState], joints: Any = "calibrated", p_delta: bool = True
) -> list[ReducedFrame]:
    """Return the frames of a street in their states, with the floors' twist where a contact lies off the middle.

    Args:
        street: The street.
        states: What `states_of` says of its frames.
        joints: `calibrated` or `rigid`.
        p_delta: Geometric stiffness of gravity.

    Raises:
        FrameError: A contact off the middle of a stick whose file says nothing of torsion.
    """
    return [
        built_in(state, joints, p_delta, planar=False if place in street.off_middle else None)
        for place, state in enumerate(states)
    ]


def chosen_sets(street: Street, definitions: Sequence[Frame], scale: TableScale) -> list[Parameters | None]:
    """Return the parameter set that each gap uses, before any frame is built; None where a bumper is the contact.

    Args:
        street: The street.
        definitions: The frames of its buildings.
        scale: Their scale.

    Raises:
        ExperimentError: A contact that is not known.
        ContactError: An unknown law.
    """
    return [
        None if gap.bumper else chosen_parameters(definitions[pair : pair + 2], scale, gap.wish)
        for pair, gap in enumerate(street.gap)
    ]


def street_contacts(
    street: Street, row: Sequence[ReducedFrame], chosen: Sequence[Parameters | None]
) -> tuple[list[Contact], list[Basis]]:
    """Return the contacts of a street, each with what its numbers rest on.

    Args:
        street: The street.
        row: The frames of its buildings, reduced.
        chosen: The parameter set of each gap.

    Raises:
        ExperimentError: A floor that faces none or is given twice, or a number of gaps that is not that of the floors.
    """
    contacts: list[Contact] = []
    bases = []
    for pair, (gap, parameters) in enumerate(zip(street.gap, chosen, strict=True)):
        neighbours = row[pair], row[pair + 1]
        lower = neighbours[0] if is_left_lower(*neighbours) else neighbours[1]
        for (stated, gap_mm), y_m in product(gap.by_floor(), gap.places_m):
            floor = lower.storeys if stated is None else stated
            at = _Spot(pair, neighbours, floor, 1e-3 * (gap_mm or 0.0), y_m)
            if gap.bumper is not None:
                contact, basis = _on_a_block(at, gap, gap.bumper)
            elif gap.columns is not None:
                contact, basis = _on_columns(at, gap, gap.columns, parameters)
            else:
                contact, basis = _of_floors(at, gap, parameters)
            contacts.append(contact)
            bases.append(basis)
    return contacts, bases


class _Spot(NamedTuple):
    """A floor of the lower of two neighbours, the gap there [m], and the place along its edge [m]."""

    pair: int
    neighbours: tuple[ReducedFrame, ReducedFrame]
    floor: int
    gap_m: float
    y_m: float


def _of_floors(at: _Spot, gap: Gap, parameters: Parameters | None) -> tuple[Contact, Basis]:
    assert parameters is not None
    level = contact_floors(*at.neighbours, at.floor)
    masses = floor_masses(*at.neighbours, at.floor, at.y_m)
    (law,), (sentence,) = choose_laws(
        at.neighbours, at.floor, parameters, gap.wish, masses, len(gap.places_m)
    )
    return Contact(law, at.gap_m, level, at.pair, at.y_m), Basis(at.pair, at.floor, sentence, y_m=at.y_m)


def _on_a_block(at: _Spot, gap: Gap, bumper: Bumper) -> tuple[Contact, Basis]:
    level = contact_floors(*at.neighbours, at.floor)
    free = Contact(bumper.block, at.gap_m, level, at.pair, at.y_m)
    sentence = (
        f"{RubberBlock.name}: {bumper.area_m2:g} m2 of {bumper.thickness_mm:g} mm and {bumper.modulus_mpa:g} MPa, "
        f"restitution {bumper.restitution:g}, as stated"
    )
    return bumped(free, bumper.block), Basis(at.pair, at.floor, sentence, y_m=at.y_m)


def _on_columns(
    at: _Spot, gap: Gap, columns: Columns, parameters: Parameters | None
) -> tuple[Contact, Basis]:
    assert parameters is not None
    place = place_of(*at.neighbours, at.floor)
    masses = masses_at(*at.neighbours, place)
    (law,), (sentence,) = choose_laws(at.neighbours, at.floor, parameters, gap.wish, masses)
    softer = softened(law, place, columns)
    sentence += f", in series with {columns.count} columns: {softer.stiffness:.4g} N/m"
    return Contact(softer, at.gap_m, place.floors, at.pair), Basis(
        at.pair, at.floor, sentence, (place, columns)
    )


def bumped(contact: Contact, block: RubberBlock) -> Contact:
    """Return a contact with a block of rubber in its gap; pressed flat, the block goes on as stiff as it then is.

    Args:
        contact: The contact without it.
        block: The block.

    Raises:
        ExperimentError: The block is thicker than the gap.
    """
    left = contact.gap_m - block.thickness_m
    if left < 0.0:
        raise ExperimentError(
            f"a bumper of {1e3 * block.thickness_m:g} mm does not fit into a gap of {1e3 * contact.gap_m:g} mm; give a "
            "thickness_mm of at most the gap"
        )
    return dataclasses.replace(contact, law=block, gap_m=left)
