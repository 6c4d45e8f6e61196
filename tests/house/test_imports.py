"""The house's rules: which package may import which, and which module may touch which engine."""

from __future__ import annotations

import ast
from functools import cache
from graphlib import CycleError, TopologicalSorter
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
SHARED = {
    "bounds",
    "calling",
    "constants",
    "cores",
    "errors",
    "extras",
    "scale",
    "spelling",
    "toml_text",
    "units",
}
"""Modules of `pounding` itself, which import nothing of the packages."""
COMMAND = "experiments/command/"

ROOMS = {
    "frames": ("drawing", "response", "reduction", "fe"),
    "experiments": (
        "command",
        "studies",
        "configurations",
        "console",
        "campaign",
        "mitigation",
        "fragility",
        "separation",
        "output",
        "sweeps",
        "pictures",
        "results",
        "rig",
        "measurements",
        "published",
        "records",
    ),
    "diagnosis": (
        "studies",
        "benchmark",
        "report",
        "design",
        "decision",
        "contact_force",
        "inference",
        "effects",
        "model",
        "hidden",
        "case",
    ),
}
"""The rooms of each package, the highest first: a room imports from itself and from lower rooms only."""

TOUCHED_ONLY_IN = {
    "exudyn": {
        "frames/response/body.py",
        # The engine's own flexible body, which verifies the one above and is used for nothing else.
        "frames/response/floating_body.py",
        "contact/connector.py",
        "experiments/rig/rig.py",
        # Laws in storeys as connectors: those of yielding frames, and the effects of the diagnosis' twin.
        "experiments/rig/law_connector.py",
        "experiments/rig/watchdog.py",
        "diagnosis/model/twin.py",
    },
    "pyfe3d": {"frames/fe/shells.py"},
    "openseespy": {"diagnosis/hidden/opensees/domain.py"},
    "pyvista": {"frames/drawing/pictures.py", "experiments/pictures/scenes.py"},
}


def sources() -> list[Path]:
    return sorted(path for package in PACKAGES for path in (HOUSE / package).rglob("*.py"))


def name_of(path: Path) -> str:
    """The dotted name of a source, without `pounding.`."""
    return ".".join(path.relative_to(HOUSE).with_suffix("").parts).removesuffix(".__init__")


MODULES = {name_of(path): path for path in sources()}


@cache
def imported(path: Path, types: bool = True) -> frozenset[str]:
    """Every module that a module imports, also inside functions and by name in a string; for `types` alone if asked."""
    found = set()
    tree = ast.parse(path.read_text(encoding="utf-8"))
    if not types:
        tree.body = [
            node
            for node in tree.body
            if not (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test))
        ]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            members = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {one for one in members if one.removeprefix("pounding.") in MODULES} or {node.module}
        elif (
            isinstance(node, ast.Call)
            and getattr(node.func, "attr", getattr(node.func, "id", "")) in ("import_module", "__import__")
            and node.args
            and isinstance(node.args[0], ast.Constant)
        ):
            found.add(str(node.args[0].value))
    return frozenset(found)


def ours(path: Path, types: bool = True) -> set[str]:
    """The modules of the four packages that a module imports, without `pounding.`."""
    return {one.removeprefix("pounding.") for one in imported(path, types) if one.startswith("pounding.")}


def place(path: Path) -> str:
    return path.relative_to(HOUSE).as_posix()


def test_every_package_is_there() -> None:
    assert {path.relative_to(HOUSE).parts[0] for path in sources()} == set(PACKAGES)


def test_every_room_has_a_place_in_the_order() -> None:
    found = {
        package: {path.name for path in (HOUSE / package).iterdir() if (path / "__init__.py").exists()}
        for package in PACKAGES
    }
    assert found == {package: set(ROOMS.get(package, ())) for package in PACKAGES}


@pytest.mark.parametrize("path", sources(), ids=place)
def test_packages_are_imported_by_their_one_name(path: Path) -> None:
    assert not {one.partition(".")[0] for one in imported(path)} & set(PACKAGES)


@pytest.mark.parametrize("path", sources(), ids=place)
def test_data_flows_one_way(path: Path) -> None:
    package = path.relative_to(HOUSE).parts[0]
    allowed = ALLOWED[package] | {package} | SHARED
    if place(path).startswith(COMMAND):
        allowed |= {"diagnosis"}
    assert {one.partition(".")[0] for one in ours(path)} <= allowed


@pytest.mark.parametrize("path", sources(), ids=place)
def test_rooms_import_downward(path: Path) -> None:
    package, *rest = path.relative_to(HOUSE).parts
    order = ROOMS.get(package, ())
    if len(rest) < 2 or rest[0] not in order:
        return
    lower = set(order[order.index(rest[0]) :])
    rooms = {one.split(".")[1] for one in ours(path) if one.startswith(f"{package}.")} & set(order)
    assert rooms <= lower


@pytest.mark.parametrize("name", ["diagnosis.errors", "diagnosis.settings"])
def test_what_every_room_reads_imports_no_package(name: str) -> None:
    assert {one.partition(".")[0] for one in ours(MODULES[name])} <= SHARED


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Also not inside functions: what imports in a circle is one thing in two files."""
    graph = {name: ours(path, types=False) & set(MODULES) - {name} for name, path in MODULES.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


@pytest.mark.parametrize("engine", TOUCHED_ONLY_IN)
def test_engines_are_touched_in_named_modules_only(engine: str) -> None:
    contact_findings = {
        place(path) for path in sources() if engine in {one.partition(".")[0] for one in imported(path)}
    }
    assert contact_findings <= TOUCHED_ONLY_IN[engine]
    assert contact_findings, f"nothing imports {engine}: the rule has lost its object"


def test_no_record_of_the_tests_is_committed() -> None:
    """Their providers do not let everyone redistribute them."""
    names = {"elcentro.csv", "hachinohe.csv", "northridge.csv", "kobe.csv"}
    assert not [
        place(path) for path in HOUSE.rglob("*.csv") if path.name in names and ".venv" not in path.parts
    ]
