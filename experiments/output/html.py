"""The HTML templates of this room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

LOADER = PackageLoader("pounding.experiments.output", "templates")


def worded(value: Any) -> str:
    """Return a parameter of a run as a reader of a report expects it: no braces, quotes or Python words.

    Args:
        value: A number, a text, a truth value, None, or mappings and sequences of them; what a mapping leaves out is left
            out here, too.
    """
    if value is None:
        return "not given"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        # A switch that is off, or a list without an entry, says no more than one that is left out.
        stated = [
            (name, one) for name, one in value.items() if one is not None and one is not False and one != []
        ]
        return ", ".join(f"{name} {worded(one)}" for name, one in stated)
    if isinstance(value, Sequence) and not isinstance(value, str):
        inner = list(map(worded, value))
        nested = any(isinstance(one, Mapping | str) for one in value)
        if nested and len(set(inner)) == 1 < len(inner):
            return f"{inner[0]} (all {len(inner)})"
        return ("; " if nested else ", ").join(inner) or "none"
    return str(value)


def three_digits(value: float) -> str:
    """Return a number with three digits, or all before the point: forces of models and of buildings stand in one table.

    Args:
        value: The number.
    """
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


TEMPLATES = Environment(
    loader=LOADER,
    autoescape=True,
    undefined=StrictUndefined,
)
"""Values are escaped, and one that is missing is an error."""

TEMPLATES.filters.update(worded=worded, three_digits=three_digits)
