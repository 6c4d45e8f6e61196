"""What the documentation names exists: files, modules and what stands in them, tests, verbs and studies."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

from pounding.experiments.command.app import STUDIES, VERBS

HOUSE = Path(__file__).parents[2]
PAGES = [*sorted(HOUSE.glob("*.md")), *sorted((HOUSE / "docs").rglob("*.md"))]

FOLDERS = "frames|contact|experiments|diagnosis|tests|docs|pounding"
A_PATH = re.compile(rf"(?<![\w/.~-])((?:{FOLDERS})/[\w./*-]*[\w*/])(?:::(\w+))?")
A_NAME = re.compile(r"(?<![\w/.-])pounding(?:\.[A-Za-z_]\w*)+")
A_TEST = re.compile(r"(?<![\w/])test_\w+\.py")
A_BARE_IMPORT = re.compile(r"^\s*(?:import|from) (?:frames|contact|experiments|diagnosis)\b", re.MULTILINE)
A_STUDY = re.compile(r"pounding study ([a-z][a-z0-9-]*)")
A_VERB = re.compile(r"^(?:\$ )?(?:\.venv/bin/)?pounding ([a-z]+(?:-[a-z]+)*)\b", re.MULTILINE)
CODE = re.compile(r"^```.*?^```|`[^`\n]+`", re.MULTILINE | re.DOTALL)

GENERATED = ("docs/_build", "docs/examples/")
"""What the build of the documentation writes, and what no clone has."""


def place(page: Path) -> str:
    return page.relative_to(HOUSE).as_posix()


def source(parts: list[str]) -> Path | None:
    """The source of a dotted name, if it is a module or a package."""
    at = HOUSE.joinpath(*parts)
    if (at / "__init__.py").exists():
        return at / "__init__.py"
    return at.with_suffix(".py") if at.with_suffix(".py").exists() else None


def defined(path: Path) -> set[str]:
    """The names that a module binds at its top level, by definition, assignment or import, lazily loaded ones too."""
    found: set[str] = set()
    body = ast.parse(path.read_text(encoding="utf-8")).body
    for node in [*body, *(one for block in body if isinstance(block, ast.If) for one in block.body)]:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Assign):
            found |= {target.id for target in node.targets if isinstance(target, ast.Name)}
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.add(node.target.id)
    return found


def known(name: str) -> bool:
    """Whether a dotted name leads to a module, or to something at the top level of one."""
    parts = name.split(".")
    module = source(parts[:-1])
    return source(parts) is not None or (module is not None and parts[-1] in defined(module))


@pytest.mark.parametrize("page", PAGES, ids=place)
def test_every_path_exists(page: Path) -> None:
    named = {path for path, _ in A_PATH.findall(page.read_text(encoding="utf-8"))}
    pages = {path for path in named if any((page.parent / f"{path}{end}").exists() for end in ("", ".md"))}
    lost = [path for path in named - pages if not path.startswith(GENERATED) and not any(HOUSE.glob(path))]
    assert not lost


@pytest.mark.parametrize("page", PAGES, ids=place)
def test_every_test_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    files = {path.name for path in (HOUSE / "tests").rglob("test_*.py")}
    assert set(A_TEST.findall(text)) <= files
    for path, function in A_PATH.findall(text):
        if function:
            assert function in defined(HOUSE / path)


@pytest.mark.parametrize("page", PAGES, ids=place)
def test_every_module_and_function_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert not [name for name in A_NAME.findall(text) if not known(name)]
    assert not A_BARE_IMPORT.findall(text), "the packages are imported as pounding.frames and so on"


@pytest.mark.parametrize("page", PAGES, ids=place)
def test_every_verb_and_study_exists(page: Path) -> None:
    code = "\n".join(found.strip("`") for found in CODE.findall(page.read_text(encoding="utf-8")))
    assert set(A_STUDY.findall(code)) <= set(STUDIES)
    assert set(A_VERB.findall(code)) <= set(VERBS) | {"study"}


@pytest.mark.parametrize("package", ["frames", "contact", "experiments", "diagnosis"])
def test_the_page_on_the_house_names_every_room(package: str) -> None:
    page = (HOUSE / "docs/house.md").read_text(encoding="utf-8")
    rooms = [path.parent.name for path in (HOUSE / package).glob("*/__init__.py")]
    assert not [room for room in rooms if f"| `{package}/{room}/` |" not in page]


def test_what_is_to_be_cited_is_the_version_that_is_built() -> None:
    built = tomllib.loads((HOUSE / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    cited = re.search(r"^version: (\S+)$", (HOUSE / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert cited is not None
    assert cited[1] == built
