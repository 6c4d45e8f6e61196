"""Buildings side by side as a small drawing (SVG): heights to scale, the gap between neighbours marked where they meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from pounding.experiments.pictures.palette import BLACK, GREY, ORANGE

WIDTH, BETWEEN, HEIGHT, ABOVE, BELOW = 74.0, 76.0, 190.0, 14.0, 28.0
"""Width of a building, space between two (never to scale), height of the highest, space above and below, in points."""


@dataclass(frozen=True)
class Outline:
    """A building as it is drawn.

    Attributes:
        name: What is written under it.
        heights_m: Heights of its floors above the ground [m], the roof last.
    """

    name: str
    heights_m: Sequence[float]


@dataclass(frozen=True)
class Marked:
    """What is written between two neighbours.

    Attributes:
        pair: Which neighbours, from 0.
        height_m: Height at which they meet [m].
        words: What is written there.
        bad: Whether it is marked as one that is not enough.
    """

    pair: int
    height_m: float
    words: str
    bad: bool = False


def building_sketch(buildings: Sequence[Outline], marks: Sequence[Marked]) -> str:
    """Return the drawing as SVG.

    Args:
        buildings: From left to right.
        marks: What is written between them; of several at one place each gets its own line.
    """
    scale = HEIGHT / max(max(one.heights_m) for one in buildings)
    ground = ABOVE + HEIGHT
    lefts = [14.0 + number * (WIDTH + BETWEEN) for number in range(len(buildings))]
    width = lefts[-1] + WIDTH + 14.0
    shapes = [_line(4, ground, width - 4, ground, GREY, 4.0)]
    for left, building in zip(lefts, buildings, strict=True):
        shapes += _building(left, building, ground, scale)
    for mark in marks:
        shapes += _gap(lefts[mark.pair] + WIDTH, ground - scale * mark.height_m, mark)
    said = "; ".join(f"{mark.words} at {mark.height_m:.3g} m" for mark in marks)
    names = " and ".join(one.name for one in buildings)
    return (
        f'<svg viewBox="0 0 {width:g} {ground + BELOW:g}" role="img" '
        f'aria-label="{escape(f"{names}: {said}", quote=True)}">{"".join(shapes)}</svg>'
    )


def _building(left: float, building: Outline, ground: float, scale: float) -> list[str]:
    roof = ground - scale * max(building.heights_m)
    right = left + WIDTH
    sides = [_line(x, ground, x, roof, BLACK, 1.4) for x in (left, right)]
    floors = [
        _line(left, ground - scale * height, right, ground - scale * height, BLACK, 2.2)
        for height in building.heights_m
    ]
    return [*sides, *floors, _text(left + WIDTH / 2, ground + 20, building.name, BLACK)]


def _gap(left: float, level: float, mark: Marked) -> list[str]:
    colour = ORANGE if mark.bad else BLACK
    right = left + BETWEEN
    heads = [
        f'<path d="M{x:g} {level:g} l{step:g} -3.5 v7 z" fill="{colour}"/>'
        for x, step in ((left + 1, 7.0), (right - 1, -7.0))
    ]
    return [
        _line(left + 6, level, right - 6, level, colour, 1.6),
        *heads,
        _text(left + BETWEEN / 2, level - 6, mark.words, colour),
    ]


def _line(x1: float, y1: float, x2: float, y2: float, colour: str, width: float) -> str:
    return (
        f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" stroke="{colour}" stroke-width="{width:g}"/>'
    )


def _text(x: float, y: float, words: str, colour: str) -> str:
    return (
        f'<text x="{x:g}" y="{y:g}" font-size="11" font-family="sans-serif" text-anchor="middle" '
        f'fill="{colour}">{escape(words)}</text>'
    )
