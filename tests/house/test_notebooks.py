"""The notebooks run as they stand, print what is kept in them, and are pages of the documentation with it."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import json
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[2] / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


def page(notebook: dict[str, Any]) -> str:
    spec = importlib.util.spec_from_file_location("notebook_pages", DOCS / "notebook_pages.py")
    assert spec is not None
    assert spec.loader is not None
    pages = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pages)
    return str(pages.page(notebook, "one.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_page_of_a_notebook_has_every_cell_and_what_it_printed_and_drew(path: Path) -> None:
    notebook = json.loads(path.read_text(encoding="utf-8"))
    text = page(notebook)
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
    for cell in notebook["cells"]:
        assert "".join(cell["source"]).rstrip() in text
    for output in outputs:
        assert "".join(output.get("text", [])).rstrip() in text
    assert text.count("](data:image/png") == sum("image/png" in output.get("data", {}) for output in outputs)
    assert "{download}`" in text
    assert f"<notebooks/{path.stem}>" in (DOCS / "index.md").read_text(encoding="utf-8")


def test_a_notebook_that_was_kept_with_an_error_is_no_page() -> None:
    cell = {"cell_type": "code", "source": ["1 / 0"], "outputs": [{"output_type": "error"}]}
    with pytest.raises(ValueError, match="run the notebook again"):
        page({"cells": [{"cell_type": "markdown", "source": ["# A title"]}, cell]})


@pytest.mark.slow
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_is_kept_in_it(
    notebook: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    cells = [
        cell
        for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        if cell["cell_type"] == "code"
    ]
    for cell in cells:
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile("".join(cell["source"]), str(notebook), "exec", dont_inherit=True), names)
        kept = "".join(line for output in cell["outputs"] for line in output.get("text", []))
        assert printed.getvalue() == kept
    plt.close("all")
    assert any("image/png" in output.get("data", {}) for cell in cells for output in cell["outputs"])
