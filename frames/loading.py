"""Frame files: the shipped ones by name, any other by its path."""

from __future__ import annotations

import os
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, get_args

import msgspec

from pounding import bounds
from pounding.frames.definition import Frame, PlateFrame, StickFrame
from pounding.frames.errors import FrameError
from pounding.frames.storey_laws import KINDS
from pounding.spelling import did_you_mean, nearest
from pounding.toml_text import meant, plainly, shown, tree_of

ORDER = ["5A", "5B", "10", "15A", "15B", "8", "12"]
"""Order in which the shipped frames are shown: those of Table 3.1 first."""


def names() -> list[str]:
    """Return the names of the shipped frames."""
    found = {path.name.removesuffix(".toml") for path in _library().iterdir() if path.name.endswith(".toml")}
    return [name for name in ORDER if name in found] + sorted(found - set(ORDER))


def load(name_or_path: str | Path) -> Frame:
    """Return a frame by the name of a shipped one, or from a frame file.

    Args:
        name_or_path: A name of `names`, or the path of a TOML file (with a suffix or a folder in it).

    Raises:
        FrameError: There is no such frame, or its file is not a frame; the sentence names file and key.
    """
    text = str(name_or_path)
    if text in names():
        return _shipped(text)
    path = Path(text)
    if path.suffix != ".toml" and not os.path.isfile(path):
        raise FrameError(
            f"frame {shown(text)} is not known{_near(text, names())} Shipped are {', '.join(names())}"
        )
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as error:  # a name with a zero byte is no OSError
        reason = getattr(error, "strerror", None) or error
        raise FrameError(f"frame file {text}: {reason}") from error
    return parse(content, text, path.parent)


def parse(content: bytes | str, place: str, folder: Path | None = None) -> Frame:
    """Return the frame in the text of a frame file.

    Args:
        content: TOML.
        place: What messages call the file.
        folder: Where the paths of modes and matrices begin; the working folder when None.

    Raises:
        FrameError: It is not TOML, or not a frame.
    """
    where = f"frame file {place}"
    return from_mapping(tree_of(content, where, FrameError), where, folder)


def from_mapping(tree: dict[str, Any], place: str = "frame", folder: Path | None = None) -> Frame:
    """Return the frame in a mapping with the keys of a frame file; ``kind`` is ``"plate"`` or ``"stick"``.

    Args:
        tree: The mapping.
        place: What messages call it.
        folder: Where the paths of modes and matrices begin; the working folder when None.

    Raises:
        FrameError: It is not a frame, or a file it names cannot be used; the sentence names either.
    """
    kinds = {"plate": PlateFrame, "stick": StickFrame}
    kind = tree.get("kind")
    if not isinstance(kind, str) or kind not in kinds:
        found = "missing" if kind is None else shown(kind)
        raise FrameError(f'{place}: kind is {found}, must be "plate" or "stick"')
    _known_keys(tree, kinds[kind], place)
    _known_laws(tree.get("storey_law"), place)
    if "torsion" in tree and "plan_m" not in tree:
        raise FrameError(
            f"{place}: torsion needs plan_m, the floors' length along the shaking and their width [m]"
        )
    if "modes" in tree or "matrices" in tree:
        # scipy's sparse matrices take time to import, and most frames need none.
        from pounding.frames.elsewhere import inlined

        tree = inlined(tree, folder or Path(), place)
    if kind == "stick":
        tree = tree | _spread(tree)
    try:
        return msgspec.convert(tree, PlateFrame | StickFrame)
    except (msgspec.ValidationError, OverflowError) as error:
        # A FrameError of our own checks comes wrapped; it is a sentence already.
        cause = error.__cause__
        reason = str(cause) if isinstance(cause, FrameError) else plainly(error)
        raise FrameError(f"{place}: {reason}") from error


def _spread(tree: dict[str, Any]) -> dict[str, list[float]]:
    """Return the lists that single numbers of a stick stand for: one for all storeys, and the first frequency."""
    storeys = tree.get("storeys")
    counts = {"frequency_hz": 1}
    if isinstance(storeys, int) and bounds.STOREYS.low <= storeys <= bounds.STOREYS.high:
        counts |= {"floor_mass_kg": storeys, "storey_stiffness_n_per_m": storeys}
    return {
        key: [tree[key]] * count for key, count in counts.items() if isinstance(tree.get(key), int | float)
    }


def _known_keys(tree: dict[str, Any], structure: type, place: str, inside: str = "") -> None:
    """Refuse unknown keys; say which one was meant when only its unit is another."""
    fields = {field.encode_name: field.type for field in msgspec.structs.fields(structure)}
    for key, value in tree.items():
        if not inside and key == "kind":
            continue
        if key not in fields:
            raise FrameError(
                f"{place}: {inside}{shown(key)} is not a key of a frame{meant(key, list(fields))}"
            )
        for kind in (fields[key], *get_args(fields[key])):
            if isinstance(value, dict) and isinstance(kind, type) and issubclass(kind, msgspec.Struct):
                _known_keys(value, kind, place, f"{inside}{key}.")


def _known_laws(laws: object, place: str) -> None:
    """Refuse an unknown kind of law, or an unknown key of one."""
    tables = laws if isinstance(laws, list) else []
    for number, law in enumerate(tables, 1):
        if isinstance(law, dict):
            kind = law.get("kind")
            if not isinstance(kind, str) or kind not in KINDS:
                found = "missing" if kind is None else shown(kind)
                raise FrameError(
                    f"{place}: storey_law {number}: kind is {found}, must be one of {', '.join(KINDS)}"
                )
            keys = {key: value for key, value in law.items() if key != "kind"}
            _known_keys(keys, KINDS[kind], f"{place}: storey_law {number}")


def _near(name: str, known: list[str]) -> str:
    question = did_you_mean(nearest(name.replace("-", ""), known, 0.5))
    return f"; {question}" if question else "."


@cache
def _shipped(name: str) -> Frame:
    return parse(_library().joinpath(f"{name}.toml").read_bytes(), f"{name}.toml")


def _library() -> Traversable:
    return resources.files("pounding.frames") / "library"
