"""TOML text as a tree, with one sentence for whatever can be wrong with it."""

from __future__ import annotations

import re
import reprlib
import tomllib
from collections.abc import Sequence
from typing import Any

from pounding.errors import InputError
from pounding.spelling import did_you_mean, either, nearest


def tree_of(content: bytes | str, where: str, error: type[InputError]) -> dict[str, Any]:
    """Return the tree of a TOML file.

    Args:
        content: Its text, or its bytes, with a mark of UTF-8 at the beginning or without.
        where: The file for the message.
        error: What is raised.

    Raises:
        InputError: It is not text in UTF-8, not TOML, or nested beyond what can be read.
    """
    try:
        text = content.decode("utf-8-sig") if isinstance(content, bytes) else content
    except UnicodeDecodeError:
        raise error(f"{where} is not a text file in UTF-8; save it as such") from None
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise error(f"{where} is nested too deeply; a value is a number, a string or a flat list") from None
    except ValueError as wrong:  # of TOML, or of a number with thousands of digits
        raise error(f"{where} is not TOML: {wrong}; correct the file there") from None


_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 100


def shown(value: object) -> str:
    """Return a value for a message, shortened where it is long."""
    return _SHORT.repr(value)


UNITS = r"(_(m|mm|cm|km|kg|g|t|gpa|mpa|pa|n|kn|hz|khz|rad|s|ms|percent|per|m2|m3|mm3))+$"
"""Units at the end of a key."""


CLOSE, CLOSE_OF_THREE = 0.75, 0.6
"""Likeness (difflib's ratio) from which a word is taken for another one mistyped: `name` is no `frame`, `fram` is.
In a word of three letters a single error leaves two thirds."""


def key_meant(word: str, known: Sequence[str]) -> list[str]:
    """Return the known words of which one was meant, in whatever case it is written; none where none is close.

    Args:
        word: A word that is not known.
        known: The words that are.
    """
    close = nearest(word, known, CLOSE if len(word) > 3 else CLOSE_OF_THREE)
    if close:
        return close
    parts = set(word.lower().split("_"))
    of_it = [one for one in known if parts <= set(one.lower().split("_"))]
    return of_it if len(of_it) == 1 else []


def meant(key: str, known: Sequence[str]) -> str:
    """Return the end of a sentence on an unknown key: which one was meant, when only its unit is another, or all.

    Args:
        key: The key.
        known: The keys that there are.
    """
    stem = re.sub(UNITS, "", key)
    same = [one for one in known if re.sub(UNITS, "", one) == stem]
    if same:
        return f"; expected {either(same)} (mind the unit)"
    return f"; {did_you_mean(key_meant(key, known)) or 'known are ' + ', '.join(known)}"


KINDS = {
    "int": "a whole number",
    "float": "a number",
    "str": "a text in quotes",
    "array": "a list in square brackets",
    "object": "a table",
    "bool": "true or false",
}
"""Kinds of values as msgspec calls them, in words."""


def in_words(message: str) -> str:
    """Return what msgspec says of a value of the wrong kind, without its own words.

    Args:
        message: Its message, such as ``Expected `int`, got `float```; another one is returned as it is.
    """
    found = re.fullmatch(r"Expected `([^`]+)`, got `([^`]+)`", message)
    if found is None:
        return message
    wanted = [KINDS.get(kind, kind) for kind in found[1].split(" | ") if kind != "null"]
    got = "a number with a fraction" if found[2] == "float" else KINDS.get(found[2], found[2])
    return f"expected {' or '.join(wanted)}, found {got}"


def plainly(error: Exception) -> str:
    """Return what is wrong with a value and where, of an error of msgspec: ``count of columns of gap 1: expected ...``.

    Args:
        error: What `msgspec.convert` raised.
    """
    message, _, path = str(error).partition(" - at `$")
    # Lists count from 0 there, and from 1 for a person.
    steps = [
        name + (f" {int(number) + 1}" if number else "")
        for name, number in re.findall(r"\.(\w+)(?:\[(\d+)\])?", path)
    ]
    missing = re.fullmatch(r"Object missing required field `(.+)`", message)
    said = f"the key {missing[1]} is missing; add it" if missing else in_words(message)
    return f"{' of '.join(reversed(steps))}: {said}" if steps else said
