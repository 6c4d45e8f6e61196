"""The reference of the Python API: its examples run as they stand, and it has every public name."""

from __future__ import annotations

import doctest
import re
from importlib import import_module
from pathlib import Path

import pytest

API = Path(__file__).parents[2] / "docs" / "api"
EXAMPLE = re.compile(r"```pycon\n(.*?)```", re.DOTALL)


@pytest.mark.parametrize(
    "page", ["frames", "contact", "experiments", pytest.param("diagnosis", marks=pytest.mark.slow)]
)
def test_the_examples_run_as_they_stand(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = "\n".join(EXAMPLE.findall((API / f"{page}.md").read_text(encoding="utf-8")))
    example = doctest.DocTestParser().get_doctest(text, {}, page, f"{page}.md", 0)
    assert example.examples
    ran = doctest.DocTestRunner(optionflags=doctest.REPORT_NDIFF).run(example)
    assert ran.failed == 0, capsys.readouterr().out


@pytest.mark.parametrize("package", ["frames", "contact", "experiments.records", "diagnosis"])
def test_every_public_name_is_on_its_page(package: str) -> None:
    page = (API / f"{package.partition('.')[0]}.md").read_text(encoding="utf-8")
    named = {name.rpartition(".")[2] for name in re.findall(r"^\.\. auto\w+:: (\S+)$", page, re.MULTILINE)}
    named |= set(re.findall(r"`(\w+)`", page))
    assert not set(import_module(f"pounding.{package}").__all__) - named
