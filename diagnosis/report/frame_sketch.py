"""The frames of a case as a small drawing (SVG) with the sensors on them and what was found marked at its place."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import Claim
from pounding.diagnosis.report.plain_words import description
from pounding.experiments.pictures.palette import BLACK, GREY, ORANGE

WIDTH, GAP, HEIGHT, ABOVE, BELOW = 70.0, 34.0, 190.0, 16.0, 26.0
"""Width of a frame, space between two, height of the highest one, space above and below it, in points of the drawing."""


class _Drawing:
    """A frame: where its floors are, and its lines."""

    def __init__(self, name: str, storeys: int, left: float, storey: float, ground: float) -> None:
        self.name, self.storeys, self.left, self.ground = name, storeys, left, ground
        self.level = [ground - storey * floor for floor in range(storeys + 1)]
        self.columns = dict.fromkeys(range(1, storeys + 1), (BLACK, 1.2))
        self.floors = dict.fromkeys(range(1, storeys + 1), (BLACK, 2.6))

    def shapes(self) -> list[str]:
        right = self.left + WIDTH
        found = []
        for storey, (colour, width) in self.columns.items():
            ends = self.level[storey - 1], self.level[storey]
            for x in (self.left + 5, right - 5):
                found.append(_line(x, ends[0], x, ends[1], colour, width))
        for floor, (colour, width) in self.floors.items():
            found.append(_line(self.left, self.level[floor], right, self.level[floor], colour, width))
        found.append(_text(self.left + WIDTH / 2, self.ground + 20, self.name, "middle"))
        return found


def frame_sketch(case: Case, effects: Sequence[Claim], floors: Sequence[tuple[str, int]] = ()) -> str:
    """Return the drawing as SVG: frames in black, floors with a sensor with a dot, what was found in orange.

    Args:
        case: The case, whose frames stand from left to right.
        effects: What was found.
        floors: Frame and floor of each channel, from 1.
    """
    storey = HEIGHT / max(frame.storeys for frame in case.frames)
    ground = ABOVE + HEIGHT
    frames = {
        frame.name: _Drawing(frame.name, frame.storeys, 20 + number * (WIDTH + GAP), storey, ground)
        for number, frame in enumerate(case.frames)
    }
    over: list[str] = []
    table = GREY
    for effect in effects:
        if _of_table(effect):
            table = ORANGE
        over += _marked(case, frames, effect)
    width = 20 + len(frames) * (WIDTH + GAP) + 10
    shapes = [_line(6, ground + 4, width - 24, ground + 4, table, 5.0)]
    for frame in frames.values():
        shapes += frame.shapes()
    for name, floor in dict.fromkeys(floors):
        shapes.append(_dot(frames[name].left + WIDTH - 14, frames[name].level[floor] - 4, BLACK))
    said = "; ".join(effect.words() for effect in effects) or "nothing is marked"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {ground + BELOW:g}" role="img" '
        f'aria-label="The frames: {escape(said, quote=True)}">{"".join([*shapes, *over])}</svg>'
    )


def _of_table(effect: Claim) -> bool:
    places = (effect.frame, effect.channel, effect.contact, effect.left)
    return all(place is None for place in places)


def _marked(case: Case, frames: dict[str, _Drawing], effect: Claim) -> list[str]:
    """Colour what an effect is on, and return what lies over it."""
    if effect.channel is not None:
        return [_sensor(case, frames, name) for name in effect.channel.split(", ")]
    if effect.left is not None and effect.right is not None:
        return [_between(frames[effect.left], frames[effect.right], effect.floor)]
    if effect.contact is not None:
        contact = case.contacts[effect.contact - 1]
        return [_between(frames[contact.left], frames[contact.right], contact.floor)]
    if effect.frame is None:
        return []
    frame = frames[effect.frame]
    if effect.storey is not None:
        frame.columns[effect.storey] = (ORANGE, 4.5)
        middle = 0.5 * (frame.level[effect.storey] + frame.level[effect.storey - 1])
        return [_text(frame.left + WIDTH / 2, middle + 3.5, f"storey {effect.storey}", "middle", ORANGE)]
    if effect.floor is not None:
        frame.floors[effect.floor] = (ORANGE, 6.0)
        return [
            _text(
                frame.left + WIDTH / 2,
                frame.level[effect.floor] - 6,
                f"floor {effect.floor}",
                "middle",
                ORANGE,
            )
        ]
    described = description(effect.effect)
    mark = "frame" if described is None else described.sketch.mark
    if mark == "floors":
        frame.floors = dict.fromkeys(frame.floors, (ORANGE, 3.4))
    elif mark == "joints":
        sides = (frame.left + 5, frame.left + WIDTH - 5)
        return [_dot(x, level, ORANGE, 4.0) for level in frame.level[1:] for x in sides]
    elif mark == "rock":
        return [_line(frame.left, frame.ground, frame.left + WIDTH, frame.ground - 7, ORANGE, 4.0)]
    else:
        frame.columns = dict.fromkeys(frame.columns, (ORANGE, 3.4))
    return []


def _sensor(case: Case, frames: dict[str, _Drawing], name: str) -> str:
    channel = case.channels[case.channel_index(name)]
    frame = frames.get(channel.frame or "", next(iter(frames.values())))
    floor = channel.floor or 0
    return _dot(frame.left + WIDTH - 14, frame.level[floor] - 4, ORANGE, 5.5)


def _between(left: _Drawing, right: _Drawing, floor: int | None) -> str:
    lowest = min(left.storeys, right.storeys)
    level = left.level[min(floor or lowest, left.storeys)]
    return _line(left.left + WIDTH, level, right.left, level, ORANGE, 4.0)


def _line(x0: float, y0: float, x1: float, y1: float, colour: str, width: float) -> str:
    return (
        f'<line x1="{x0:g}" y1="{y0:g}" x2="{x1:g}" y2="{y1:g}" stroke="{colour}" stroke-width="{width:g}"/>'
    )


def _dot(x: float, y: float, colour: str, radius: float = 3.0) -> str:
    return f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="{colour}"/>'


def _text(x: float, y: float, said: str, anchor: str, colour: str = BLACK) -> str:
    return (
        f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" font-size="11" font-weight="600" fill="{colour}" '
        f'stroke="white" stroke-width="3" paint-order="stroke">{escape(said)}</text>'
    )
