"""What is said of effects: where they are, how large, how likely. The entries of a report are made of these.

Each is a `msgspec.Struct`: it is written to JSON, and read from there, by the names of docs/diagnosis/case-format.md.
"""

from __future__ import annotations

import math
from typing import Any

from msgspec import UNSET, Struct, UnsetType, field

from pounding.diagnosis.case.place import KEYS, in_words
from pounding.diagnosis.effects.catalogue import Effect


def finite(value: float) -> float | None:
    """Return a number as reports hold it: None where it is not finite, as JSON has no other word for it."""
    return float(value) if math.isfinite(value) else None


JOINTS = {"channel": "of ", "floor": "on ", "storey": "in ", "contact": "in ", "left": ""}
"""What joins an effect to the words of its place, by the first key that it has."""


class Place(Struct, frozen=True, kw_only=True):
    """An effect and where it is; None where it has no such place. Storeys and floors count from 1, contacts too.

    Attributes:
        effect: Its name in the catalogue, or in the user's own candidates.
        test: Name of the only modal test in which it acts; unset where it acts in all.
    """

    effect: str
    frame: str | None = None
    storey: int | None = None
    floor: int | None = None
    channel: str | None = None
    contact: int | None = None
    left: str | None = None
    right: str | None = None
    test: str | UnsetType = UNSET

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.words()})"

    @property
    def place(self) -> Place:
        """Effect and place alone, without what else is said of it."""
        return Place(**fields(self))

    def words(self) -> str:
        """Return what and where, in words: `coulomb friction in storey 3 of 5B`."""
        place = self._place()
        joints = [word for key, word in JOINTS.items() if getattr(self, key) is not None] or ["of "]
        said = self.effect.replace("_", " ") + (f" {joints[0]}{place}" if place else "")
        return said if self.test is UNSET else f"{said}, {self._tested()}"

    def where(self) -> str:
        """Return where it is, for a table's cell: `storey 3 of 5B`."""
        words = [self._place()] if self._place() else []
        words += [] if self.test is UNSET else [self._tested()]
        return ", ".join(words) or "the table"

    def _place(self) -> str:
        return in_words(**{key: getattr(self, key) for key in KEYS})

    def _tested(self) -> str:
        return f"only in the {str(self.test).replace('_', ' ')}"


def place_of(effect: Effect) -> Place:
    """Return an effect of the catalogue and its place."""
    return Place(**effect.place())


def places_of(effect: Effect) -> list[Place]:
    """Return the places under which an effect is reported; more than one where it stands for several."""
    return [Place(**entry) for entry in effect.entries()]


class Parameter(Struct, frozen=True, kw_only=True):
    """A parameter of an effect: a number in `unit` with its standard error, or the name of a law, which has none."""

    name: str
    value: float | str | None
    std: float | UnsetType | None = UNSET
    unit: str

    def __repr__(self) -> str:
        return f"Parameter({self.words()})"

    def words(self, digits: int = 3) -> str:
        """Return it in words: `friction force 12.1 ± 0.4 N`.

        Args:
            digits: Significant digits of the value.
        """
        name = self.name.replace("_", " ")
        if self.value is None or isinstance(self.value, str):
            return f"{name} {self.value or 'unknown'}"
        known = isinstance(self.std, float)
        said = f"{name} {self.value:.{digits}g}" + (f" ± {self.std:.2g}" if known else "")
        return f"{said} {self.shown_unit}".rstrip()

    @property
    def shown_unit(self) -> str:
        """The unit as it is read: none for a pure number, and µm for um."""
        return "" if self.unit in ("1", "-") else self.unit.replace("um", "µm")


def parameter(name: str, value: float | str, std: float | None, unit: str) -> Parameter:
    """Return a parameter; numbers that are not finite become None.

    Args:
        name: Its name.
        value: Its value in `unit`, or the name of a law.
        std: Its standard error in `unit`; None for a law.
        unit: Its unit as reported.
    """
    number = value if isinstance(value, str) else finite(value)
    return Parameter(name=name, value=number, std=None if std is None else finite(std), unit=unit)


class Candidate(Place, frozen=True, kw_only=True):
    """An effect that was tried.

    Attributes:
        log_evidence: The ln Bayes factor against 'nothing missing'.
        parameters: How large it would be; unset where it was only scored and not refined.
    """

    log_evidence: float
    parameters: tuple[Parameter, ...] | UnsetType = UNSET

    def __repr__(self) -> str:
        return f"Candidate({self.words()}, log_evidence {self.log_evidence:.4g})"

    def sized(self) -> str:
        """Return what, where and, if it is known, how large, in words."""
        values = ", ".join(one.words() for one in self.parameters or ())
        return f"{self.words()} ({values})" if values else self.words()


class Claim(Candidate, frozen=True, kw_only=True):
    """An effect that is said to be missing from the model.

    Attributes:
        parameters: How large it is.
        members: What these data cannot tell apart, itself first; `class` in JSON.
    """

    parameters: tuple[Parameter, ...]
    members: tuple[Place, ...] = field(name="class", default=())

    def __repr__(self) -> str:
        alike = f", one of a class of {len(self.members)}" if len(self.members) > 1 else ""
        return f"Claim({self.sized()}, log_evidence {self.log_evidence:.4g}{alike})"


def candidate(
    place: Place, log_evidence: float, parameters: tuple[Parameter, ...] | UnsetType = UNSET
) -> Candidate:
    """Return a candidate at a place.

    Args:
        place: The effect and its place.
        log_evidence: Its ln Bayes factor against 'nothing missing'.
        parameters: How large it would be; unset where it was only scored.
    """
    return Candidate(**fields(place), log_evidence=float(log_evidence), parameters=parameters)


def claim(
    place: Place, parameters: list[Parameter], log_evidence: float, members: list[Place] | None = None
) -> Claim:
    """Return a claim at a place; alone in its class where no members are given.

    Args:
        place: The effect and its place.
        parameters: How large it is.
        log_evidence: Its ln Bayes factor against 'nothing missing'.
        members: Effects that the data cannot tell from it, itself first.
    """
    alike = tuple(members or [place])
    return Claim(
        **fields(place), parameters=tuple(parameters), log_evidence=float(log_evidence), members=alike
    )


def fields(place: Place) -> dict[str, Any]:
    """Return effect and place as the arguments of what is said at that place."""
    return {key: getattr(place, key) for key in Place.__struct_fields__}
