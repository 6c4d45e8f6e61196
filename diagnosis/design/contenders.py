"""Two explanations that data hardly tell apart, and what a further measurement is expected to say about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from pounding.diagnosis.settings import SETTINGS

Explanation = TypeVar("Explanation")


STRONG, DECISIVE = 3.0, 5.0
"""ln Bayes factors above which evidence is called so (bounds of Kass and Raftery 1995)."""


@dataclass(frozen=True)
class Gain:
    """A further measurement in words, and the ln Bayes factor by which it is expected to tell two explanations apart."""

    what: str
    ln_bayes: float


@dataclass(frozen=True)
class Advice:
    """A sentence on a further measurement, and the ln Bayes factor by which it is expected to tell more."""

    sentence: str
    ln_bayes: float


def contenders(
    first: tuple[float, Explanation],
    others: Sequence[tuple[float, Explanation]],
    null: Explanation,
    claimed: bool,
) -> tuple[Explanation, Explanation] | None:
    """Return an explanation and the one that is hardest to tell from it, or None where the data are clear.

    Args:
        first: The best explanation, with its ln Bayes factor against `null`.
        others: Explanations of another kind, the likeliest first.
        null: The baseline model.
        claimed: Whether the best is claimed; if not, the question is whether it is there at all.
    """
    ln_bayes, best = first
    if not claimed:
        return (best, null) if ln_bayes > 0 else None
    if not others or others[0][0] <= ln_bayes - SETTINGS.design.weak:
        return None
    return best, others[0][1]


def advised(
    pair: tuple[Explanation, Explanation] | None,
    name: Callable[[Explanation], str],
    expected: Callable[[Explanation, Explanation], Sequence[Gain]],
) -> list[Advice]:
    """Return what to say of the further measurements that would tell two explanations apart, the best first.

    Args:
        pair: The explanations; None where the data are clear, which needs no advice.
        name: Says an explanation in words.
        expected: Returns what each further measurement is expected to bring, most first, the first being true.
    """
    if pair is None:
        return []
    first, second = pair
    return sentences(expected(first, second), (name(first), name(second)))


def sentences(gains: Sequence[Gain], names: tuple[str, str]) -> list[Advice]:
    """Return what to say of further measurements: those that would tell, or that none would.

    Args:
        gains: What each is expected to bring, most first.
        names: The two explanations in words.
    """
    useful = [one for one in gains if one.ln_bayes >= SETTINGS.design.enough][: SETTINGS.design.listed]
    if not useful and gains:
        best = gains[0]
        said = (
            f"None of the further measurements tried would decide between {names[0]} and {names[1]}; "
            f"the best, {best.what}, is expected to bring {strength(best.ln_bayes)} evidence."
        )
        return [Advice(said, max(best.ln_bayes, 0.0))]
    return [
        Advice(
            f"{one.what[0].upper()}{one.what[1:]} is expected to decide between {names[0]} and {names[1]}.",
            one.ln_bayes,
        )
        for one in useful
    ]


def strength(ln_bayes: float) -> str:
    """Return what evidence of that ln Bayes factor is called: `decisive`, `strong` or `weak`."""
    return "decisive" if ln_bayes > DECISIVE else "strong" if ln_bayes > STRONG else "weak"
