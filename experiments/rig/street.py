"""Buildings in a row: the street file, and the contacts between neighbours that it describes."""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from pounding import bounds, frames
from pounding.contact.damping import check_restitution
from pounding.contact.laws import law_class
from pounding.contact.rubber import SOFT_PA, RubberBlock
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.column_hits import Columns, Place, masses_at, place_of, softened
from pounding.experiments.rig.contact_choice import ContactWish, Parameters, choose_laws, chosen_parameters
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.motion import distinct
from pounding.experiments.rig.pounding import built_in, one_each
from pounding.experiments.rig.required_gap import contact_floors, is_left_lower
from pounding.toml_text import shown, tree_of
from pounding.units import LENGTH

if TYPE_CHECKING:
    from pounding.experiments.rig.states import FrameState
    from pounding.experiments.rig.table_scale import TableScale
    from pounding.frames.definition import Frame
    from pounding.frames.reduction.reduced_frame import ReducedFrame

A_NAME = re.compile(r"\w[\w. -]*")

DEFAULT_LAW = "linear_viscoelastic"


class Building(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A building of a street.

    Attributes:
        frame: A built-in frame's name, or a frame file; a relative path begins at the street file.
        name: What results call it; default: the frame's own name.
    """

    frame: str
    name: str | None = None


class Bumper(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A block of rubber on one floor of each contact of a gap, in the place of the floors' own contact.

    Attributes:
        thickness_mm: Its thickness, part of the gap [mm].
        area_m2: Its area [m^2].
        modulus_mpa: Apparent modulus of the rubber under compression [MPa].
        restitution: Coefficient of restitution [-].
    """

    thickness_mm: float
    area_m2: float
    modulus_mpa: float = SOFT_PA / 1e6
    restitution: float = 0.5

    @property
    def block(self) -> RubberBlock:
        """Its law."""
        return RubberBlock.of(
            self.area_m2, 1e-3 * self.thickness_mm, 1e6 * self.modulus_mpa, self.restitution
        )


class Gap(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What lies between two neighbours.

    Attributes:
        gap_mm: Gap at rest [mm], one for all floors or one a floor.
        floors: Floors of the lower neighbour that can touch; default: its roof.
        y_m: Place of the contacts along the floors' edge, from the middle [m].
        law: Name of the impact law.
        parameters: Where its numbers come from; default: by the scale, see `chosen_parameters`.
        stiffness: Contact stiffness in the law's unit; default: that of the parameters.
        restitution: Coefficient of restitution [-]; default: that of the parameters.
        radius_m: Radius of a Hertz contact [m]; default: of spheres with the floors' masses.
        tension: May the contact pull just before it opens?
        columns: The columns of the higher neighbour that a floor hits, where it faces no floor.
        bumper: A block of rubber at each contact; then the law, its numbers and `tension` are not used.
    """

    gap_mm: float | tuple[float, ...]
    floors: tuple[int, ...] = ()
    y_m: float = 0.0
    law: str = DEFAULT_LAW
    parameters: Parameters | None = None
    stiffness: float | None = None
    restitution: float | None = None
    radius_m: float | None = None
    tension: bool = False
    columns: Columns | None = None
    bumper: Bumper | None = None

    @property
    def gaps_mm(self) -> tuple[float, ...]:
        """Gaps [mm]: one, or one a floor."""
        return self.gap_mm if isinstance(self.gap_mm, tuple) else (self.gap_mm,)

    def by_floor(self) -> list[tuple[int | None, float | None]]:
        """Return each floor with a contact (None: the lower neighbour's roof) and its gap [mm] (None: not stated)."""
        floors: Sequence[int | None] = self.floors or (None,)
        if not self.gaps_mm:
            return [(floor, None) for floor in floors]
        return list(zip(floors, one_each("gaps", self.gaps_mm, floors), strict=True))

    @property
    def wish(self) -> ContactWish:
        """What it says of its contacts."""
        return ContactWish(
            [self.law], self.parameters, self.stiffness, self.restitution, self.radius_m, self.tension
        )


class Street(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Buildings in a row, from left to right along +x, and the gaps between neighbours.

    Attributes:
        building: Two buildings or more.
        gap: One for each pair of neighbours, in the same order.
    """

    building: tuple[Building, ...]
    gap: tuple[Gap, ...]


class Basis(NamedTuple):
    """What a contact's numbers rest on.

    Attributes:
        pair: Which neighbours, from 0.
        floor: Floor of the lower of them.
        sentence: The basis in words, the law's name first.
        hit: Where it is on columns, and on which; None where two floors meet.
    """

    pair: int
    floor: int
    sentence: str
    hit: tuple[Place, Columns] | None = None


def is_street_file(name: str) -> bool:
    """Return whether a name is that of a file with buildings in it, and not of a frame.

    A file that cannot be read is none: the sentence on it is left to who reads it as a frame.

    Args:
        name: Name of a frame, or of a file.
    """
    path = Path(name)
    if path.suffix != ".toml" or name in frames.names():
        return False
    try:
        tree = tree_of(path.read_bytes(), name, ExperimentError)
    except (OSError, ValueError, ExperimentError):
        return False
    return "building" in tree or "gap" in tree


def load_street(path: str | Path) -> Street:
    """Return the street of a street file, its frame files found from where it lies.

    Args:
        path: A TOML file with tables ``[[building]]`` and ``[[gap]]``.

    Raises:
        ExperimentError: It cannot be read, or is no street; the sentence names the file and the key.
    """
    where = f"street file {path}"
    try:
        content = Path(path).read_bytes()
    except (OSError, ValueError) as error:  # a name with a zero byte is no OSError
        reason = getattr(error, "strerror", None) or error
        raise ExperimentError(f"{where}: {reason}") from error
    tree = tree_of(content, where, ExperimentError)
    _known_keys(tree, where)
    try:
        street = msgspec.convert(tree, Street)
    except (msgspec.ValidationError, OverflowError) as error:
        raise ExperimentError(f"{where}: {error}") from error
    _check(street, where)
    beside = Path(path).parent
    return Street(tuple(_found(one, beside) for one in street.building), street.gap)


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
        ExperimentError: A contact off the middle of a stick, which has no twist.
    """
    off_middle = {pair + side for pair, gap in enumerate(street.gap) if gap.y_m for side in (0, 1)}
    row = []
    for place, state in enumerate(states):
        twisting = place in off_middle
        if twisting and isinstance(frames.load(state.frame), frames.StickFrame):
            raise ExperimentError(
                f"{state.frame} is a stick, whose floors do not twist; leave y_m out of the gaps beside it, or describe it "
                "with plates and columns"
            )
        row.append(built_in(state, joints, p_delta, planar=False if twisting else None))
    return row


def chosen_sets(street: Street, definitions: Sequence[Frame], scale: TableScale) -> list[Parameters]:
    """Return the parameter set that each gap uses, before any frame is built.

    Args:
        street: The street.
        definitions: The frames of its buildings.
        scale: Their scale.

    Raises:
        ExperimentError: A contact that is not known.
        ContactError: An unknown law.
    """
    return [
        "floors" if gap.bumper else chosen_parameters(definitions[pair : pair + 2], scale, gap.wish)
        for pair, gap in enumerate(street.gap)
    ]


def street_contacts(
    street: Street, row: Sequence[ReducedFrame], chosen: Sequence[Parameters]
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
        for stated, gap_mm in gap.by_floor():
            floor = lower.storeys if stated is None else stated
            gap_m = 1e-3 * (gap_mm or 0.0)
            if gap.columns is not None:
                place = place_of(*neighbours, floor)
                (law,), (sentence,) = choose_laws(
                    neighbours, floor, parameters, gap.wish, masses_at(*neighbours, place)
                )
                softer = softened(law, place, gap.columns)
                contacts.append(Contact(softer, gap_m, place.floors, pair))
                sentence += f", in series with {gap.columns.count} columns: {softer.stiffness:.4g} N/m"
                bases.append(Basis(pair, floor, sentence, (place, gap.columns)))
                continue
            level = contact_floors(*neighbours, floor)
            if gap.bumper is None:
                (law,), (sentence,) = choose_laws(neighbours, floor, parameters, gap.wish)
                contacts.append(Contact(law, gap_m, level, pair, gap.y_m))
            else:
                free = Contact(gap.bumper.block, gap_m, level, pair, gap.y_m)
                contacts.append(bumped(free, gap.bumper.block))
                sentence = _bumper_basis(gap.bumper)
            bases.append(Basis(pair, floor, sentence))
    return contacts, bases


def refuse_columns(street: Street) -> None:
    """Refuse a street with columns that are hit, for what knows floors alone.

    Args:
        street: The street.

    Raises:
        ExperimentError: One of its gaps has a table `columns`.
    """
    for number, gap in enumerate(street.gap, 1):
        if gap.columns is not None:
            raise ExperimentError(
                f"street: [[gap]] {number} has columns that a floor hits, which `pounding pound` alone knows; leave the "
                "table 'columns' out, and name floors that face each other"
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


def _bumper_basis(bumper: Bumper) -> str:
    return (
        f"{RubberBlock.name}: {bumper.area_m2:g} m2 of {bumper.thickness_mm:g} mm and {bumper.modulus_mpa:g} MPa, "
        f"restitution {bumper.restitution:g}, as stated"
    )


def _known_keys(tree: dict[str, Any], where: str) -> None:
    _refuse_unknown(tree, Street, where)
    for table, structure in (("building", Building), ("gap", Gap)):
        entries = tree.get(table)
        for number, entry in enumerate(entries if isinstance(entries, list) else [], 1):
            if isinstance(entry, dict):
                _refuse_unknown(entry, structure, f"{where}: [[{table}]] {number}")


def _refuse_unknown(tree: dict[str, Any], structure: type, where: str) -> None:
    known = list(structure.__struct_fields__)  # type: ignore[attr-defined]
    for key in tree:
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            meant = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
            raise ExperimentError(f"{where}: {shown(key)} is not a key of a street; {meant}")


def _check(street: Street, where: str) -> None:
    buildings, gaps = len(street.building), len(street.gap)
    if buildings < 2:
        raise ExperimentError(f"{where}: {buildings} [[building]]; a street has two or more")
    if gaps != buildings - 1:
        raise ExperimentError(
            f"{where}: {gaps} [[gap]] for {buildings} buildings; give {buildings - 1}, one for each pair of neighbours"
        )
    for number, building in enumerate(street.building, 1):
        if building.name is not None and not A_NAME.fullmatch(building.name):
            raise ExperimentError(
                f"{where}: [[building]] {number} is called {shown(building.name)}; files are called after it: begin with "
                "a letter or a digit, then use letters, digits, '-', '_', '.' and blanks"
            )
    for number, gap in enumerate(street.gap, 1):
        _check_gap(gap, f"{where}: [[gap]] {number}")


def _check_gap(gap: Gap, where: str) -> None:
    if not gap.gaps_mm:
        raise ExperimentError(f"{where}: gap_mm is empty; give one for all floors, or one a floor")
    for value in gap.gaps_mm:
        bounds.GAP.check(value, f"{where}: gap_mm", ExperimentError, per=LENGTH["mm"], unit="mm")
    if gap.bumper is not None:
        _check_bumper(gap.bumper, f"{where}: bumper")
    if gap.columns is not None:
        gap.columns.check(f"{where}: columns")
        if gap.bumper is not None or gap.y_m:
            raise ExperimentError(
                f"{where}: columns stand without bumper and y_m; leave these out, or the columns"
            )
    bounds.OFFSET.check(gap.y_m, f"{where}: y_m", ExperimentError)
    for key, bound in (("stiffness", bounds.CONTACT_STIFFNESS), ("radius_m", bounds.LENGTH)):
        value = getattr(gap, key)
        if value is not None:
            bound.check(value, f"{where}: {key}", ExperimentError)
    law_class(gap.law)


def _check_bumper(bumper: Bumper, where: str) -> None:
    for key, bound, per, unit in (
        ("thickness_mm", bounds.THICKNESS, LENGTH["mm"], "mm"),
        ("area_m2", bounds.AREA, 1.0, "m^2"),
        ("modulus_mpa", bounds.MODULUS, 1e-3, "MPa"),
    ):
        bound.check(getattr(bumper, key), f"{where}: {key}", ExperimentError, per=per, unit=unit)
    check_restitution(bumper.restitution)


def _found(building: Building, folder: Path) -> Building:
    if building.frame in frames.names():
        return building
    # Beside the street file, with a suffix or without one; a misspelt name is left to the frames' own sentence.
    path = folder / building.frame
    is_file = Path(building.frame).suffix == ".toml" or path.is_file()
    return msgspec.structs.replace(building, frame=str(path)) if is_file else building
