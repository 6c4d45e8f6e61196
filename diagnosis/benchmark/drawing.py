"""Which cases a benchmark consists of: kinds, effects, frames and seeds, all from one number.

Fixed before any classifier was judged by it, and not changed to suit one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.worlds import WORLDS

Card = TypeVar("Card")

NULLS, OUTSIDERS, DOUBLES = 0.2, 0.1, 0.1
"""Shares of the cases without an effect, with one outside the catalogue, and with two; the rest have one."""

SINGLE_FRAMES = (("5A",), ("5B",), ("10",), ("15B",))
SINGLES = {"own": SINGLE_FRAMES, "opensees": (("5A",), ("5B",), ("10",), ("15A",), ("15B",))}
PAIRS = (("15B", "5B"), ("10", "5B"))

NOISES: dict[str, tuple[float | None, ...]] = {"own": (None,), "opensees": (0.005, 0.01, 0.02, 0.05)}
"""Noise of a case by its engine: drawn by the case itself in the own world."""


@dataclass(frozen=True)
class Counts:
    """How many cases of a set have no effect, one outside the catalogue, and two; the rest have one."""

    nulls: int
    outsiders: int
    doubles: int


@dataclass(frozen=True)
class Drawn:
    """One case of a set: its number, what is hidden on which frames, the seed of all else, and the noise asked for.

    `noise` is over each channel's root mean square; the case draws it when None.
    """

    index: int
    effects: tuple[str, ...]
    frames: tuple[str, ...]
    seed: int
    noise: float | None = None


def draw_set(
    count: int, seed: int, *, pairs: bool = False, engine: str = "own", counts: Counts | None = None
) -> list[Drawn]:
    """Draw a set of cases on single frames, or on pairs that may touch.

    On pairs every second effect is one of the contact's.

    Args:
        count: Number of cases.
        seed: Of the set; the same gives the same cases, and a longer set does not begin with a shorter one.
        pairs: Whether two frames stand side by side.
        engine: The world in which effects are hidden: ``own`` or ``opensees``.
        counts: How many cases of each kind; by the shares above when None.

    Raises:
        CaseError: There is no case in it, or fewer than are asked of the kinds.
    """
    if count < 1:
        raise CaseError(f"a benchmark of {count} cases says nothing; give at least 1")
    world = WORLDS[engine]
    rng = np.random.default_rng([seed, count])
    asked = counts or Counts(*(round(share * count) for share in (NULLS, OUTSIDERS, DOUBLES)))
    if asked.nulls + asked.outsiders + asked.doubles > count:
        raise CaseError(f"{count} cases are fewer than the kinds that are asked for: {asked}")
    catalogue, outside = _dealt(rng, list(world.catalogue)), _dealt(rng, list(world.outside))
    if pairs:
        catalogue = _in_turn(_dealt(rng, list(world.contact)), catalogue)
    hidden: list[tuple[str, ...]] = [()] * asked.nulls
    hidden += [(next(outside),) for _ in range(asked.outsiders)]
    hidden += [_pair(catalogue) for _ in range(asked.doubles)]
    hidden += [(next(catalogue),) for _ in range(count - len(hidden))]
    frames = _dealt(rng, list(PAIRS if pairs else SINGLES[engine]))
    order = rng.permutation(count)
    seeds = rng.integers(2**31, size=count)
    # Before the cases are shuffled, so that each kind has every noise as often.
    dealt = _dealt(rng, list(NOISES[engine]))
    noises = [next(dealt) for _ in hidden]
    return [Drawn(i, hidden[at], next(frames), int(seeds[i]), noises[at]) for i, at in enumerate(order)]


def _dealt(rng: np.random.Generator, cards: list[Card]) -> Iterator[Card]:
    """Deal all cards once before any comes again, in a new order each time."""
    while True:
        yield from (cards[i] for i in rng.permutation(len(cards)))


def _in_turn(one: Iterator[str], other: Iterator[str]) -> Iterator[str]:
    while True:
        yield next(one)
        yield next(other)


def _pair(catalogue: Iterator[str]) -> tuple[str, str]:
    first = second = next(catalogue)
    while second == first:
        second = next(catalogue)
    return first, second
