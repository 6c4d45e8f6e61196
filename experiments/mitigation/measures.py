"""The measures against pounding: what each changes in a street, by which settings, and between which bounds."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding.contact.rubber import SOFT_PA, RubberBlock
from pounding.experiments.mitigation.standing import Link, Standing, changed
from pounding.experiments.rig.column_hits import hardened
from pounding.experiments.rig.street import bumped
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.stick import bending_shear

HARD_SHARE = 100.0
"""A hard link's stiffness over that of the stiffer neighbour's first mode [-]."""


@dataclass(frozen=True)
class Setting:
    """A number that a measure leaves open.

    Attributes:
        name: What it is, with its unit.
        low, high: Bounds of the search.
        is_logarithmic: Whether the search goes in powers.
    """

    name: str
    low: float
    high: float
    is_logarithmic: bool = False

    def at(self, share: float) -> float:
        """Return the value at a share of the way from the lower bound to the upper one.

        Args:
            share: 0 to 1.
        """
        if self.is_logarithmic:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True)
class Measure:
    """A measure.

    Attributes:
        name: Its name, as `--measure` takes it.
        words: What it is, in a sentence.
        settings: What it leaves open; none if there is nothing to choose.
        apply: Returns the street with the measure, from the settings' values in order.
    """

    name: str
    words: str
    settings: tuple[Setting, ...]
    apply: Callable[[Sequence[float]], Standing]


def measures(street: Standing, required_mm: Sequence[float]) -> list[Measure]:
    """Return the measures for a street, nothing done first.

    Args:
        street: The street as it is.
        required_mm: Gap that each contact needs under the records [mm].
    """
    return [
        Measure("none", "the street as it is", (), lambda _: street),
        _wider(street, required_mm),
        *([_bumpers(street)] if _has_room(street) else []),
        _hard_links(street),
        _soft_links(street),
        _dampers(street),
        Measure(
            "damping",
            "more damping in all modes of all buildings",
            (Setting("added damping ratio [-]", 0.0, 0.20),),
            lambda values: _with_frames(
                street, [changed(frame, frame.stiffness, values[0]) for frame in street.frames]
            ),
        ),
        Measure(
            "walls",
            "a wall that bends in every building, without its mass",
            (Setting("stiffness of the walls in the first mode over that of the building [-]", 0.0, 3.0),),
            lambda values: _with_frames(street, [_walled(frame, values[0]) for frame in street.frames]),
        ),
        *([_collision_walls(street)] if street.hits else []),
    ]


NAMES = ("wider-gap", "bumpers", "hard-links", "links", "dampers", "damping", "walls", "collision-walls")
"""Names of the measures."""

SHIELDING = "collision-walls"
"""The one that needs columns that a floor hits."""

LINKING = ("hard-links", "links", "dampers")
"""Those of them that make one body of several buildings."""


def _wider(street: Standing, required_mm: Sequence[float]) -> Measure:
    def apply(values: Sequence[float]) -> Standing:
        contacts = [
            dataclasses.replace(one, gap_m=one.gap_m + values[0] * max(0.0, 1e-3 * needed - one.gap_m))
            for one, needed in zip(street.contacts, required_mm, strict=True)
        ]
        return dataclasses.replace(street, contacts=tuple(contacts))

    words = "gaps widened towards what the records ask for"
    # A hair beyond the required gap: at it the floors just touch.
    return Measure("wider-gap", words, (Setting("share of what is missing [-]", 0.0, 1.001),), apply)


def _bumpers(street: Standing) -> Measure:
    narrowest = min(contact.gap_m for contact in street.contacts)
    stiffest = max(_modal_stiffness(frame) for frame in street.frames)
    # As soft as a hundredth of the stiffer building, or as stiff as a hundred of it, when the block fills half the gap.
    area = stiffest * 0.5 * narrowest / SOFT_PA
    settings = (
        Setting("area of the block [m^2]", 0.01 * area, 100.0 * area, is_logarithmic=True),
        Setting("thickness over the gap [-]", 0.1, 0.95),
    )

    def apply(values: Sequence[float]) -> Standing:
        contacts = [
            bumped(contact, RubberBlock.of(values[0], values[1] * contact.gap_m))
            for contact in street.contacts
        ]
        return dataclasses.replace(street, contacts=tuple(contacts))

    words = f"a block of rubber of {SOFT_PA / 1e6:g} MPa at each contact, fixed to one floor"
    return Measure("bumpers", words, settings, apply)


def _has_room(street: Standing) -> bool:
    """Return whether a block of rubber can be put into every gap: not where another one is."""
    return not any(isinstance(one.law, RubberBlock) for one in street.contacts)


def _hard_links(street: Standing) -> Measure:
    def apply(_: Sequence[float]) -> Standing:
        return _linked(street, lambda pair: (HARD_SHARE * max(map(_modal_stiffness, pair)), 0.0))

    words = f"a strut between the floors, {HARD_SHARE:g} times as stiff as the stiffer neighbour's first mode"
    return Measure("hard-links", words, (), apply)


def _soft_links(street: Standing) -> Measure:
    settings = (
        Setting("stiffness over the lighter neighbour's first mode [-]", 0.01, 10.0, is_logarithmic=True),
        Setting("damping ratio of the lighter neighbour on it [-]", 0.01, 1.0, is_logarithmic=True),
    )

    def apply(values: Sequence[float]) -> Standing:
        def link(pair: Sequence[ReducedFrame]) -> tuple[float, float]:
            lighter = _lighter(pair)
            stiffness = values[0] * _modal_stiffness(lighter)
            return stiffness, 2.0 * values[1] * float(np.sqrt(stiffness * lighter.moving_mass_kg))

        return _linked(street, link)

    return Measure("links", "a spring and a dashpot between the floors", settings, apply)


def _dampers(street: Standing) -> Measure:
    settings = (
        Setting(
            "damping over mass and angular frequency of the lighter neighbour [-]",
            0.01,
            10.0,
            is_logarithmic=True,
        ),
    )

    def apply(values: Sequence[float]) -> Standing:
        def link(pair: Sequence[ReducedFrame]) -> tuple[float, float]:
            lighter = _lighter(pair)
            circular = 2.0 * np.pi * float(lighter.frequencies_hz[0])
            return 0.0, values[0] * lighter.moving_mass_kg * circular

        return _linked(street, link)

    return Measure("dampers", "a viscous damper between the floors", settings, apply)


def _linked(street: Standing, link: Callable[[Sequence[ReducedFrame]], tuple[float, float]]) -> Standing:
    """Return a street with a link at every contact, the contacts left where they are."""
    links = [
        Link(one.pair, one.whole_floors, *link(street.frames[one.pair : one.pair + 2]))
        for one in street.contacts
    ]
    return dataclasses.replace(street, links=tuple(links))


def _collision_walls(street: Standing) -> Measure:
    """Return walls in the place of the columns that are hit: they take the blow and do not bend."""
    contacts = list(street.contacts)
    for hit in street.hits:
        law = hardened(contacts[hit.contact].law, hit.place, hit.columns)
        contacts[hit.contact] = dataclasses.replace(contacts[hit.contact], law=law)
    shielded = tuple(dataclasses.replace(hit, is_shielded=True) for hit in street.hits)
    walled = dataclasses.replace(street, contacts=tuple(contacts), hits=shielded)
    words = "a wall from floor to floor where a floor would hit columns, which does not bend"
    return Measure(SHIELDING, words, (), lambda _: walled)


def _with_frames(street: Standing, frames: Sequence[ReducedFrame]) -> Standing:
    return dataclasses.replace(street, frames=tuple(frames))


def _walled(frame: ReducedFrame, share: float) -> ReducedFrame:
    """Return a frame with a bending cantilever beside it that has a share of its stiffness in its first mode."""
    wall = np.zeros_like(frame.stiffness)
    wall[np.ix_(frame.floor_x, frame.floor_x)] = bending_shear(frame.heights_m, 0.0)
    sway = frame.shapes[:, 0]
    scale = float(sway @ frame.stiffness @ sway) / float(sway @ wall @ sway)
    return changed(frame, frame.stiffness + share * scale * wall)


def _lighter(pair: Sequence[ReducedFrame]) -> ReducedFrame:
    return min(pair, key=lambda frame: frame.moving_mass_kg)


def _modal_stiffness(frame: ReducedFrame) -> float:
    """Return m w^2 of a frame, its whole mass at its first frequency [N/m]."""
    return frame.moving_mass_kg * (2.0 * np.pi * float(frame.frequencies_hz[0])) ** 2


def described(measure: Measure, values: Sequence[float]) -> dict[str, Any]:
    """Return the values of a measure's settings by their names.

    Args:
        measure: The measure.
        values: Its values.
    """
    return {setting.name: value for setting, value in zip(measure.settings, values, strict=True)}
