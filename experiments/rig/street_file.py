"""The street file: buildings in a row and the gaps between neighbours."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from pounding import bounds, frames
from pounding.contact.damping import check_restitution
from pounding.contact.laws import law_class
from pounding.contact.rubber import SOFT_PA, RubberBlock
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.column_hits import Columns
from pounding.experiments.rig.contact_choice import ContactWish, Parameters
from pounding.experiments.rig.pounding import one_each
from pounding.toml_text import meant, plainly, shown, tree_of
from pounding.units import LENGTH

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
        y_m: Place of the contacts along the floors' edge, from the middle [m]; or several, each with a contact.
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
    y_m: float | tuple[float, ...] = 0.0
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

    @property
    def places_m(self) -> tuple[float, ...]:
        """Places of the contacts along the edge of each floor [m], one or more."""
        return self.y_m if isinstance(self.y_m, tuple) else (self.y_m,)

    @property
    def is_off_middle(self) -> bool:
        """Whether a contact lies off the middle of the floors' edge."""
        return any(self.places_m)

    def by_floor(self) -> list[tuple[int | None, float | None]]:
        """Return each floor with a contact (None: the lower neighbour's roof) and its gap [mm] (None: not stated)."""
        floors: Sequence[int | None] = self.floors or (None,)
        if not self.gaps_mm:
            return [(floor, None) for floor in floors]
        return list(zip(floors, one_each("gaps", self.gaps_mm, floors), strict=True))

    def free_mm(self, gap_mm: float) -> float:
        """Return what a bumper leaves of a gap [mm].

        Args:
            gap_mm: The gap [mm].

        Raises:
            ExperimentError: The bumper is thicker.
        """
        thickness = self.bumper.thickness_mm if self.bumper is not None else 0.0
        if thickness > gap_mm:
            raise ExperimentError(
                f"a bumper of {thickness:g} mm does not fit into a gap of {gap_mm:g} mm; give a thickness_mm of at most "
                "the gap"
            )
        return gap_mm - thickness

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

    building: tuple[Building, ...] = ()
    gap: tuple[Gap, ...] = ()

    @property
    def off_middle(self) -> set[int]:
        """Numbers of the buildings, from 0, that can be hit off the middle of their floors' edge."""
        return {pair + side for pair, gap in enumerate(self.gap) if gap.is_off_middle for side in (0, 1)}


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
        raise ExperimentError(f"{where}: {plainly(error)}") from error
    _check(street, where)
    beside = Path(path).parent
    return Street(tuple(_found(one, beside) for one in street.building), street.gap)


def _known_keys(tree: dict[str, Any], where: str) -> None:
    _refuse_unknown(tree, Street, where)
    for table, structure in (("building", Building), ("gap", Gap)):
        entries = tree.get(table)
        for number, entry in enumerate(entries if isinstance(entries, list) else [], 1):
            if isinstance(entry, dict):
                _refuse_unknown(entry, structure, f"{where}: [[{table}]] {number}")
                for inside, own in (("columns", Columns), ("bumper", Bumper)):
                    if table == "gap" and isinstance(entry.get(inside), dict):
                        _refuse_unknown(entry[inside], own, f"{where}: [[gap]] {number}: {inside}")


def _refuse_unknown(tree: dict[str, Any], structure: type, where: str) -> None:
    known = list(structure.__struct_fields__)  # type: ignore[attr-defined]
    for key in tree:
        if key not in known:
            raise ExperimentError(f"{where}: {shown(key)} is not a key of a street{meant(key, known)}")


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
        if gap.bumper is not None or gap.places_m != (0.0,):
            raise ExperimentError(
                f"{where}: columns stand without bumper and y_m; leave these out, or the columns"
            )
    if not gap.places_m or len(set(gap.places_m)) != len(gap.places_m):
        raise ExperimentError(f"{where}: y_m is {list(gap.places_m)}; give one place or several, each once")
    for place in gap.places_m:
        bounds.OFFSET.check(place, f"{where}: y_m", ExperimentError)
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
