"""The tables of docs/diagnosis/catalogue.md, made from what the effects say of themselves."""

from __future__ import annotations

from collections.abc import Sequence

from pounding.diagnosis.effects.catalogue import GROUPS, Effect

ASKED_FOR = "Tried when asked for"
"""Heading of the effects that are not tried by default."""


def shown(kinds: Sequence[type[Effect]]) -> list[type[Effect]]:
    """Return the kinds that the documentation describes: rivals outside the catalogue are never named."""
    return [kind for kind in kinds if kind.described is not None and not kind.rival]


def tables(kinds: Sequence[type[Effect]]) -> dict[str, str]:
    """Return a table in Markdown, without a newline at its end, by the heading under which it stands."""
    described = shown(kinds)
    found = {
        heading: [kind for kind in described if kind.default and kind.where in places]
        for heading, places in GROUPS.items()
    }
    found[ASKED_FOR] = [kind for kind in described if not kind.default]
    return {heading: _table(chosen) for heading, chosen in found.items()}


def _table(kinds: Sequence[type[Effect]]) -> str:
    rows = ["| effect | equation | parameters | easily taken for |", "|---|---|---|---|"]
    for kind in kinds:
        assert kind.described is not None
        said = kind.described
        reported = ", ".join(
            f"`{one.name}` ${one.symbol}$ ({one.unit})" for one in kind.quantities if one.reported
        )
        rows.append(f"| `{kind.name}` | {said.equation} | {reported}{said.remark} | {said.taken_for} |")
    return "\n".join(rows)
