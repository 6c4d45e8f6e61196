"""The house's rules: which package may import which, and which module may touch which engine."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[2]
PACKAGES = ("frames", "contact", "experiments", "diagnosis")

ALLOWED = {
    "frames": set(),
    "contact": set(),
    "experiments": {"frames", "contact"},
    "diagnosis": {"frames", "contact", "experiments"},
}
COMMAND = "experiments/command/"

TOUCHED_ONLY_IN = {
    "exudyn": {
        "frames/body.py",
        "contact/connector.py",
        "experiments/rig.py",
        "experiments/guard.py",
        "diagnosis/engine.py",
    },
    "pyfe3d": {"frames/shells.py"},
    "pyvista": {"frames/pictures.py", "experiments/scenes.py"},
}


def sources() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (HOUSE / package).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Every top-level package that a module imports, also inside functions and by name in a string."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.partition(".")[0])
        elif (
            isinstance(node, ast.Call)
            and getattr(node.func, "attr", getattr(node.func, "id", "")) in ("import_module", "__import__")
            and node.args
            and isinstance(node.args[0], ast.Constant)
        ):
            found.add(str(node.args[0].value).partition(".")[0])
    return found


def place(path: Path) -> str:
    return path.relative_to(HOUSE).as_posix()


def test_every_package_is_there() -> None:
    assert {path.relative_to(HOUSE).parts[0] for path in sources()} == set(PACKAGES)


@pytest.mark.parametrize("path", sources(), ids=place)
def test_data_flows_one_way(path: Path) -> None:
    package = path.relative_to(HOUSE).parts[0]
    allowed = ALLOWED[package] | {package}
    if place(path).startswith(COMMAND):
        allowed |= {"diagnosis"}
    assert imported(path) & set(PACKAGES) <= allowed


@pytest.mark.parametrize("engine", TOUCHED_ONLY_IN)
def test_engines_are_touched_in_named_modules_only(engine: str) -> None:
    touched = {place(path) for path in sources() if engine in imported(path)}
    assert touched <= TOUCHED_ONLY_IN[engine]
    assert touched, f"nothing imports {engine}: the rule has lost its object"


def test_no_record_of_the_tests_is_committed() -> None:
    """Their providers do not let everyone redistribute them."""
    names = {"elcentro.csv", "hachinohe.csv", "northridge.csv", "kobe.csv"}
    assert not [
        place(path) for path in HOUSE.rglob("*.csv") if path.name in names and ".venv" not in path.parts
    ]
