"""Names that are mistyped: which of the known ones were meant, and how a message asks for them."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Sequence

LIKE = 0.6
"""Likeness (difflib's ratio) from which a word is taken for a name mistyped; whoever knows its names may ask for another."""


def nearest(word: str, known: Iterable[str], likeness: float = LIKE) -> list[str]:
    """Return the known names that a word is most like: all that are equally near, and none where none is like it.

    Args:
        word: A word that is no known name, in whatever case.
        known: The names.
        likeness: Least likeness, between 0 and 1.
    """
    compared = difflib.SequenceMatcher(b=word.strip().lower())
    like: dict[str, float] = {}
    for name in known:
        compared.set_seq1(name.lower())
        like[name] = compared.ratio()
    best = max(like.values(), default=0.0)
    return [name for name, one in like.items() if one == best >= likeness]


def either(names: Sequence[str], shown: Callable[[str], str] = str) -> str:
    """Return names as a sentence lets one choose between them: ``5A``, ``5A or 5B``, ``5A, 5B or 10``.

    Args:
        names: At least one.
        shown: How the sentence writes a name.
    """
    *others, last = map(shown, names)
    return f"{', '.join(others)} or {last}" if others else last


def did_you_mean(names: Sequence[str], shown: Callable[[str], str] = str) -> str:
    """Return the question whether one of some names was meant; empty where there are none.

    Args:
        names: The names.
        shown: How the question writes a name.
    """
    return f"did you mean {either(names, shown)}?" if names else ""
