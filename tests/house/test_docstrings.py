"""Public functions say what their arguments are: an Args section, with shapes and units for arrays.

Of an array that is returned the docstring says shape or unit, too. A method that overrides one of a base class does not
repeat what the docstring of that one says.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

HOUSE = Path(__file__).parents[2]
PACKAGES = ("frames", "contact", "experiments", "diagnosis")

FEW = 2
"""A function of so many arguments may describe them in its sentence instead of in an Args section."""

ARRAY = re.compile(r"\b(ndarray|NDArray|ArrayLike|Real|Index|Complex)\b")
"""Annotations of arrays: numpy's own, and the names that modules give them."""

ARGS = re.compile(r"^Args:\n((?:[ \t]+.*(?:\n|$)|\n)*)", re.MULTILINE)
"""The section of a docstring that describes arguments."""

SHAPE_OR_UNIT = re.compile(r"\[[^\[\]]+\]|shape|\((?=[^()]*,)(?:\.\.\.|[\w'*+ ]+)(?:, ?[\w'*+ ]+)*,?\)")
"""`[m]`, `shape (n, 3)`, `(m,)`, `(..., 3)`, `(6 nodes, 6 nodes)`; a single word in brackets is no shape."""

SHARED_SIGNATURES = {
    ("setting", "size", "rng"): ("diagnosis/hidden/setting.py", "Effect"),
    ("p", "state", "d", "v", "t", "new"): ("experiments/rig/laws.py", "Law"),
}
"""Arguments of functions that stand in a table, and the class whose docstring describes them once."""


class Function(NamedTuple):
    """A public function or method with the docstring that describes its arguments."""

    name: str
    node: ast.FunctionDef
    docstring: str


def place(path: Path) -> str:
    return path.relative_to(HOUSE).as_posix()


ALL = [path for package in PACKAGES for path in sorted((HOUSE / package).rglob("*.py"))]


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def public_functions(path: Path) -> Iterator[Function]:
    """Every public function and method; a class' docstring is that of its `__init__`."""
    for node in parsed(path).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield Function(node.name, node, ast.get_docstring(node) or "")
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for item in node.body:
                if not isinstance(item, ast.FunctionDef):
                    continue
                said = ast.get_docstring(item) or ""
                if item.name == "__init__":
                    yield Function(node.name, item, said + "\n" + (ast.get_docstring(node) or ""))
                elif not item.name.startswith("_"):
                    yield Function(f"{node.name}.{item.name}", item, said)


def arguments(function: ast.FunctionDef) -> list[ast.arg]:
    """What a caller gives."""
    named = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    extra = [one for one in (function.args.vararg, function.args.kwarg) if one is not None]
    return [one for one in named if one.arg not in ("self", "cls")] + extra


def described(docstring: str) -> dict[str, str]:
    """What the Args section says of each argument: `name: text`, or `first, second: text` for several."""
    found: dict[str, str] = {}
    for section in ARGS.finditer(docstring):
        for entry in re.split(r"\n(?=    \S)", "\n" + section[1].rstrip()):
            names, _, text = entry.strip().partition(":")
            found |= {name.strip(): text for name in names.split(",")}
    return found


@cache
def options() -> frozenset[str]:
    """Names of annotations that carry an option's help, which the command shows: `Out`, `Records`, ..."""
    return frozenset(
        target.id
        for path in ALL
        for node in parsed(path).body
        if isinstance(node, ast.Assign) and "help=" in ast.unparse(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    )


def is_option(argument: ast.arg) -> bool:
    """Whether the command's help describes an argument."""
    written = ast.unparse(argument.annotation) if argument.annotation is not None else ""
    return "help=" in written or written.rpartition(".")[2] in options()


@cache
def base_names(path: Path, name: str) -> tuple[str, ...]:
    """The bases of a class of a module, as they are named there; of its private classes, too."""
    for node in parsed(path).body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            return tuple(ast.unparse(base).rpartition(".")[2] for base in node.bases)
    return ()


@cache
def origins(path: Path) -> dict[str, Path]:
    """The modules of the four packages from which a module imports names, by name."""
    return {
        alias.asname or alias.name: HOUSE / (node.module.removeprefix("pounding.").replace(".", "/") + ".py")
        for node in parsed(path).body
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("pounding.")
        for alias in node.names
    }


def overridden(path: Path, owner: str, method: str) -> list[str]:
    """The docstrings of the methods that a class' method overrides, the nearest base's first."""
    found = []
    for base in base_names(path, owner):
        where = origins(path).get(base, path)
        if where.is_file() and (where, base) != (path, owner):
            own = [one for one in public_functions(where) if one.name == f"{base}.{method}"]
            found += [one.docstring for one in own] + overridden(where, base, method)
    return found


def offences(path: Path) -> list[str]:
    found = []
    for function in public_functions(path):
        owner, _, method = function.name.rpartition(".")
        docstrings = [function.docstring, *overridden(path, owner, method)]
        where = f"{place(path)}:{function.node.lineno} {function.name}"
        found += [f"{where}: {said}" for said in silent_arguments(function, docstrings)]
        returned = ast.unparse(function.node.returns) if function.node.returns is not None else ""
        silent = not any(SHAPE_OR_UNIT.search(ARGS.sub("", docstring)) for docstring in docstrings)
        if ARRAY.search(returned) and "Callable" not in returned and silent:
            found.append(f"{where}: neither shape nor unit of the returned array")
    return found


def silent_arguments(function: Function, docstrings: list[str]) -> list[str]:
    """What the docstrings of a function, and of the methods that it overrides, do not say of its arguments."""
    given = [one for one in arguments(function.node) if not is_option(one)]
    said: dict[str, str] = {}
    for docstring in docstrings:
        said = described(docstring) | said
    silent = [one.arg for one in given if one.arg not in said]
    shared = tuple(one.arg for one in given) in SHARED_SIGNATURES
    found = []
    if len(arguments(function.node)) > FEW and silent and not shared:
        found.append(f"Args does not say what {', '.join(silent)} is")
    for one in given:
        if one.annotation is None or not ARRAY.search(ast.unparse(one.annotation)):
            continue
        if not SHAPE_OR_UNIT.search(said.get(one.arg, function.docstring)):
            found.append(f"neither shape nor unit of the array {one.arg}")
    return found


@pytest.mark.parametrize("path", ALL, ids=place)
def test_arguments_are_described(path: Path) -> None:
    assert not offences(path)


@pytest.mark.parametrize("names", SHARED_SIGNATURES)
def test_a_shared_signature_is_described_once(names: tuple[str, ...]) -> None:
    file, owner = SHARED_SIGNATURES[names]
    (docstring,) = (
        ast.get_docstring(node) or ""
        for node in parsed(HOUSE / file).body
        if isinstance(node, ast.ClassDef) and node.name == owner
    )
    assert not [name for name in names if f"`{name}`" not in docstring]


SILENT = '''
def f(first: float, second: Real, third: float):
    """Return something.

    Args:
        first, third: Numbers.
        {}
    """
'''


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("second: Motion (m, 3) [m].", []),
        ("second: Motion [m].", []),
        ("second: Motion, shape (samples,).", []),
        ("second: Motion (a history).", ["neither shape nor unit of the array second"]),
        (
            "other: Motion.",
            ["Args does not say what second is", "neither shape nor unit of the array second"],
        ),
    ],
)
def test_the_rule_finds_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, words: list[str]
) -> None:
    path = tmp_path / "module.py"
    path.write_text(SILENT.format(line))
    monkeypatch.setitem(offences.__globals__, "HOUSE", tmp_path)
    assert [one.partition(": ")[2] for one in offences(path)] == words


OVERRIDING = '''
class Base:
    def act(self, first: float, second: Real, third: float):
        """Act.

        Args:
            first, third: Numbers.
            {}
        """


class _Between(Base):
    pass


class Heir(_Between):
    def act(self, first: float, second: Real, third: float):
        """Act otherwise."""
'''


@pytest.mark.parametrize(("line", "count"), [("second: Motion [m].", 0), ("", 4)])
def test_an_overriding_method_repeats_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, count: int
) -> None:
    path = tmp_path / "module.py"
    path.write_text(OVERRIDING.format(line))
    monkeypatch.setitem(offences.__globals__, "HOUSE", tmp_path)
    assert len(offences(path)) == count


@pytest.mark.parametrize(
    ("said", "count"),
    [("Return motion.", 1), ("Return motion [m].", 0), ("Return motion, (2 * n, 3).", 0), ("", 1)],
)
def test_a_returned_array_has_a_shape_or_a_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, said: str, count: int
) -> None:
    path = tmp_path / "module.py"
    path.write_text(f'def f(x: float) -> Real:\n    """{said}\n\n    Args:\n        x: Time [s].\n    """\n')
    monkeypatch.setitem(offences.__globals__, "HOUSE", tmp_path)
    assert len(offences(path)) == count
