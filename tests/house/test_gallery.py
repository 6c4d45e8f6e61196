"""The gallery: each folder has its place; each script introduces itself, names its units and takes the palette's colours."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
SCRIPTS = sorted((DOCS / "gallery").rglob("*.py"))
UNIT = re.compile(r"label\w*[=(]f?\"[^\"]*\[[^\"]+\]")


def test_every_folder_of_the_gallery_has_its_place_and_its_words() -> None:
    conf = (DOCS / "conf.py").read_text(encoding="utf-8")
    order = re.search(r"\"subsection_order\": \[(.*?)\]", conf, re.DOTALL)
    assert order is not None
    folders = {f"gallery/{script.parent.name}" for script in SCRIPTS}
    assert set(re.findall(r"\"(gallery/\w+)\"", order[1])) == folders
    assert all((DOCS / folder / "GALLERY_HEADER.rst").exists() for folder in folders)
    assert len(SCRIPTS) >= 20


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_of_the_gallery_introduces_itself_and_names_its_units(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    title, line, blank, *words = (ast.get_docstring(ast.parse(text)) or "").splitlines()
    assert line == "=" * len(title)
    assert blank == ""
    assert len(" ".join(words)) > 80
    assert script.name.startswith("plot_"), "others are shown without being run"
    assert UNIT.search(text) or "imshow" in text
    assert not re.search(r"color=\"(?!black|white)", text), "colours are those of the palette"
