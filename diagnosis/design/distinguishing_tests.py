"""Which test would tell two effects apart that one set of data cannot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from msgspec import Struct

from pounding.diagnosis.decision.claims import Claim, Place
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue_page import shown

KINDS = {kind.name: kind for kind in kinds() if not kind.rival}
NONLINEAR = {name for name, kind in KINDS.items() if kind.nonlinear}
DISSIPATING = {name for name, kind in KINDS.items() if kind.dissipates}
OF_THE_TABLE = {name for name, kind in KINDS.items() if not kind.where}
OF_A_SENSOR = {name for name, kind in KINDS.items() if kind.where in ("channel", "logger")}

SHOWS = {kind.name: kind.described.told_by for kind in shown(kinds()) if kind.described} | {
    "gap_offset": "A feeler gauge in the gap before and after the shaking.",
    "second_contact": "A force cell or a strip of pressure film at the place in question.",
    "contact_stiffness": "Impacts at several speeds with force cell and drift measured: force over deformation.",
    "contact_damping": "A rebound from rest: the speed after over the speed before.",
    "contact_law": "Impacts at several speeds: the exponent of force over deformation does not depend on the speed.",
}
"""A test that shows one kind of effect and little else; empty where there is none."""


class Distinction(Struct, frozen=True, kw_only=True):
    """Two effects that these data cannot tell apart, and sentences on tests that would."""

    between: tuple[Place, Place]
    tests: tuple[str, ...]


def parting_tests(one: Place, other: Place, measured: Sequence[int]) -> list[str]:
    """Return tests that would tell two places or effects apart, the cheapest first.

    Args:
        one: An effect with its place.
        other: Another.
        measured: Numbers of the floors of the frame that have a channel.
    """
    names = (one.effect, other.effect)
    if names[0] == names[1]:
        return [_places(one, other, measured)]
    found = []
    if sum(name in NONLINEAR for name in names) == 1:
        found.append(
            "The same shaking at half and at twice its amplitude: only one of the two keeps its size."
        )
    if all(name in DISSIPATING for name in names):
        found.append(
            "Free vibration from a pull and release: the amplitude falls along a line with friction, an exponential "
            "with viscous damping, a hyperbola with drag, and stops falling early with yielding."
        )
    found += [SHOWS[name] for name in names if SHOWS.get(name) and name not in _plain(names)]
    return list(dict.fromkeys(found))


def _plain(names: tuple[str, str]) -> tuple[str, ...]:
    """Return which of two effects the other's own test is enough for: structure needs none beside a sensor's."""
    for group in (OF_A_SENSOR, OF_THE_TABLE):
        if (names[0] in group) != (names[1] in group):
            return tuple(name for name in names if name not in group)
    return ()


def _places(one: Place, other: Place, measured: Sequence[int]) -> str:
    keys = ("storey", "floor", "channel", "contact", "frame")
    key = next((key for key in keys if getattr(one, key) != getattr(other, key)), "")
    if key not in ("storey", "floor"):
        return f"The same shaking without {getattr(other, key)}, or with it exchanged." if key else ""
    low, high = sorted((int(getattr(one, key)), int(getattr(other, key))))
    first = low - 1 if key == "storey" else low
    missing = [floor for floor in range(max(first, 1), high + 1) if floor not in measured]
    if missing:
        floors = " and ".join(f"floor {floor}" for floor in missing)
        return f"A sensor on {floors}, where there is none: it parts {key} {low} from {key} {high}."
    return (
        f"A second sensor, better a displacement, on floors {max(first, 1)} to {high}: less noise in the drifts that "
        f"part {key} {low} from {key} {high}."
    )


def distinctions(effects: Sequence[Claim], measured: Mapping[str, Sequence[int]]) -> list[Distinction]:
    """Return what could not be told apart and which tests would tell.

    Args:
        effects: What is claimed, each with its class.
        measured: Numbers of the floors with a channel, by frame.
    """
    found = []
    for effect in effects:
        first, *others = effect.members
        for other in others:
            tests = parting_tests(first, other, measured.get(str(first.frame), ()))
            found.append(Distinction(between=(first, other), tests=tuple(tests)))
    return found
