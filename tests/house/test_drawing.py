"""What draws takes and returns axes of matplotlib or a plotter of pyvista, and writes a file only when one is named."""

from __future__ import annotations

import inspect
import pkgutil
import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from pounding.experiments import pictures as of_runs

DOCS = Path(__file__).parents[2] / "docs"
MODULES = [f"{of_runs.__name__}.{one.name}" for one in pkgutil.iter_modules(of_runs.__path__)]
MODULES += ["pounding.frames.drawing.pictures"]
WRITES = {"film", "write_series", "save", "keep", "drawing"}
"""Functions that are given the file: a film and a series for ParaView, what saves a picture, and the context in which a
scene is drawn and then saved."""

RETURNED = {"axes": ("Axes", "list[Axes]"), "scene": ("Any",)}
"""What a drawing function returns, by the keyword with which it is told where to draw; pyvista has no types of its own."""


def _functions() -> list[Callable[..., Any]]:
    """Return the public functions of the drawing modules that can write a file."""
    found = []
    for name in MODULES:
        for word, one in inspect.getmembers(import_module(name), inspect.isfunction):
            if (
                one.__module__ == name
                and not word.startswith("_")
                and "path" in inspect.signature(one).parameters
            ):
                found.append(one)
    return found


DRAWING = [one for one in _functions() if one.__name__ not in WRITES]


@pytest.mark.parametrize(
    "draw", DRAWING, ids=lambda one: f"{one.__module__.rpartition('.')[2]}.{one.__name__}"
)
def test_what_draws_is_told_where_and_saves_only_when_asked(draw: Callable[..., Any]) -> None:
    signature = inspect.signature(draw)
    (where,) = [name for name in RETURNED if name in signature.parameters]
    assert signature.parameters["path"].default is None
    assert signature.parameters[where].default is None
    assert signature.parameters[where].kind is inspect.Parameter.KEYWORD_ONLY
    assert signature.return_annotation in RETURNED[where]


def test_every_picture_function_that_the_pages_name_is_held_to_it() -> None:
    text = "\n".join(page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md"))
    named = set(re.findall(r"(pounding(?:\.\w+)*\.(?:pictures|drawing)(?:\.\w+)*\.\w+)\(", text))
    named |= set(re.findall(r"^\.\. autofunction:: (\S*\.(?:pictures|drawing)\.\S+)$", text, re.MULTILINE))
    held = {f"{one.__module__}.{one.__name__}" for one in _functions()}
    assert "pounding.experiments.pictures.plots.history" in named
    assert "pounding.frames.drawing.pictures.modes_picture" in named
    assert not named - held
