"""The configurations by name, read from the TOML files of this folder."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

import msgspec

from pounding.experiments.configurations.definition import CHAPTERS, AnyExperiment
from pounding.experiments.errors import ExperimentError
from pounding.spelling import did_you_mean, nearest
from pounding.toml_text import shown, tree_of

FILES = tuple(f"chapter-{chapter}.toml" for chapter in CHAPTERS)


@cache
def experiments() -> dict[str, AnyExperiment]:
    """Return every configuration by its name, in the order of the thesis.

    Raises:
        ExperimentError: A file is not what it should be; the sentence names file and entry.
    """
    folder = resources.files(__package__)
    found: dict[str, AnyExperiment] = {}
    for name in FILES:
        for entry in parse((folder / name).read_bytes(), name):
            if entry.name in found:
                raise ExperimentError(f"{name}: experiment '{entry.name}' stands there twice")
            found[entry.name] = entry
    return found


def find(name: str) -> AnyExperiment:
    """Return a configuration by its name.

    Raises:
        ExperimentError: There is none of that name; the sentence says which is near.
    """
    known = experiments()
    if name in known:
        return known[name]
    question = did_you_mean(nearest(name, known, 0.5))
    meant = f"; {question}" if question else ""
    raise ExperimentError(
        f"experiment {shown(name)} is not known{meant} (`pounding experiment list` shows all {len(known)})"
    )


def parse(content: bytes | str, place: str) -> list[AnyExperiment]:
    """Return the configurations in the text of one file.

    Args:
        content: TOML with tables `[[experiment]]`.
        place: What messages call the file.

    Raises:
        ExperimentError: It is not TOML, or an entry is not a configuration.
    """
    tree = tree_of(content, place, ExperimentError)
    entries = tree.get("experiment")
    if not isinstance(entries, list) or set(tree) != {"experiment"}:
        raise ExperimentError(f"{place}: needs tables [[experiment]] and nothing else")
    return [_entry(entry, f"{place}, entry {number}") for number, entry in enumerate(entries, 1)]


def _entry(tree: Any, where: str) -> AnyExperiment:
    named = tree.get("name") if isinstance(tree, dict) else None
    place = f"{where} ({shown(named)})" if named else where
    try:
        entry: AnyExperiment = msgspec.convert(tree, AnyExperiment)
    except msgspec.ValidationError as error:
        raise ExperimentError(f"{place}: {error}") from error
    wanted = 1 if entry.kind in ("free-vibration", "push", "sweep", "alone") else 2
    if len(entry.frames) != wanted:
        raise ExperimentError(f"{place}: a test of kind {entry.kind} has {wanted} frame(s) on the table")
    if not entry.measured or not set(entry.chapters) <= set(CHAPTERS) or not entry.chapters:
        raise ExperimentError(f"{place}: needs chapters between 3 and 6, and rows that were measured")
    return entry
