"""Where an effect can sit: drawing a place, and reading one from a word such as ``coulomb_friction:3``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.effects import ASKED_FOR, CATALOGUE
from pounding.diagnosis.hidden.outsiders import OUTSIDE
from pounding.diagnosis.hidden.setting import Effect
from pounding.spelling import did_you_mean, nearest

EFFECTS: dict[str, Effect] = {**CATALOGUE, **ASKED_FOR, **CONTACT, **OUTSIDE}
"""All that can be hidden, in the catalogue and outside it."""

NOTHING = "nothing"
PLACED = ("storey", "floor", "channel", "between")
"""Kinds of places of which one can be chosen, the last a floor between frames; what acts elsewhere has one place only."""


@dataclass(frozen=True)
class Wanted:
    """An effect and, where it was said, its place: a storey or floor number, or a channel's name."""

    name: str
    place: str | None = None


def wanted(word: str, here: Mapping[str, Effect] = EFFECTS, engine: str = "own") -> Wanted | None:
    """Read ``effect`` or ``effect:place``; None for ``nothing``.

    Args:
        word: What was asked for.
        here: What can be hidden in the world of the engine, by name.
        engine: Name of the engine.

    Raises:
        CaseError: There is no such effect, or not in this world, or it has no place to choose.
    """
    name, _, place = word.partition(":")
    if place and (name == NOTHING or (name in here and here[name].place not in PLACED)):
        raise CaseError(f"{word}: {name} has no storey, floor or channel to choose; write {name}")
    if name == NOTHING:
        return None
    if name not in here:
        if name in EFFECTS:
            raise CaseError(
                f"{name} cannot be hidden by the engine {engine}; use another effect or another engine"
            )
        hint = did_you_mean(nearest(name, here), repr) or f"known are {', '.join((NOTHING, *here))}"
        raise CaseError(f"no effect {name!r} can be hidden; {hint}")
    return Wanted(name, place or None)


@dataclass(frozen=True)
class Place:
    """Where an effect sits; what does not apply is None."""

    frame: str | None = None
    storey: int | None = None
    floor: int | None = None
    channel: str | None = None
    contact: int | None = None
    left: str | None = None
    right: str | None = None


def locate(
    rng: np.random.Generator,
    want: Wanted,
    frames: dict[str, Beams],
    channels: tuple[Channel, ...],
    here: Mapping[str, Effect] = EFFECTS,
) -> Place:
    """Return the place of an effect, drawn where it was not said.

    Args:
        rng: Draws what is not said.
        want: The effect and the place that is wanted.
        frames: Frames of the rig by name.
        channels: Channels of the case.
        here: What can be hidden in its world, by name.

    Raises:
        CaseError: The place is not there.
    """
    kind = here[want.name].place
    frame = str(rng.choice(list(frames)))
    if kind == "table":
        return Place()
    if kind == "frame":
        return Place(frame)
    if kind == "channel":
        names = [channel.name for channel in channels if not channel.is_table]
        drawn = str(rng.choice(names))
        if want.place and want.place not in names:
            raise CaseError(f"{want.name}: no channel {want.place!r}; this case has {', '.join(names)}")
        return Place(channel=want.place or drawn)
    if kind in ("contact", "between"):
        if len(frames) < 2:
            raise CaseError(f"{want.name}: nothing touches on a single frame; name two frames")
        return _where_they_touch(rng, want, frames, kind)
    storeys = frames[frame].storeys
    number = int(rng.integers(1, storeys + 1))
    if want.place:
        if not (want.place.isdigit() and 1 <= int(want.place) <= storeys):
            raise CaseError(f"{want.name}: {kind} {want.place!r} is not on {frame}; give 1 to {storeys}")
        number = int(want.place)
    return Place(frame, storey=number) if kind == "storey" else Place(frame, floor=number)


def _where_they_touch(rng: np.random.Generator, want: Wanted, frames: dict[str, Beams], kind: str) -> Place:
    if kind == "contact":
        return Place(contact=1)
    left, right = frames
    listed = min(beams.storeys for beams in frames.values())
    floor = int(rng.integers(1, listed))
    if want.place:
        if not (want.place.isdigit() and 1 <= int(want.place) < listed):
            raise CaseError(f"{want.name}: floor {want.place!r} is not free on both; give 1 to {listed - 1}")
        floor = int(want.place)
    return Place(floor=floor, left=left, right=right)
