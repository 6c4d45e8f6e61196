"""Reduced frames on disk, by the hash of all that goes into them.

The folder is ``POUNDING_CACHE``, or ``pounding`` in the user's cache folder. A folder that cannot be written
costs one warning sentence a run, never the run.
"""

from __future__ import annotations

import hashlib
import io
import os
import warnings
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import msgspec
import numpy as np
from numpy.typing import NDArray

from pounding.frames.definition import PlateFrame
from pounding.frames.errors import FrameError
from pounding.frames.files import read_entry, tell_damage, write_entry

VERSION = 5
"""Raised whenever the same inputs would give other arrays, so that old files are not found."""

LARGEST_BYTES = 1_000_000_000
"""Files used longest ago are deleted beyond this size of the folder."""

IGNORED = ("name", "title", "published", "damping_ratio", "yielding", "storey_law", "scale")
"""Fields of a frame that the arrays do not depend on."""

Arrays = dict[str, NDArray[Any]]


class CacheWarning(UserWarning):
    """The cache folder cannot be used; results are right, but are computed again next time."""


def folder() -> Path:
    """Return the cache folder; it need not exist."""
    stated = os.environ.get("POUNDING_CACHE")
    if stated:
        return Path(stated)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pounding"


def key(frame: PlateFrame, settings: Mapping[str, Any]) -> str:
    """Return the hash of all inputs: the frame but for its labels, the options, and the codes' versions."""
    data = msgspec.structs.asdict(frame)
    for name in IGNORED:
        del data[name]
    # Only the stiffness that a calibration's name stands for counts, not the others beside it.
    calibrated = settings["joints"] == "calibrated"
    data["joints"] = frame.joint_stiffness(settings["calibration"]) if calibrated else None
    settings = {name: value for name, value in settings.items() if name != "calibration"}
    text = msgspec.json.encode([VERSION, _codes(), data, settings], order="sorted")
    return hashlib.sha256(text).hexdigest()[:32]


def load(frame: PlateFrame, settings: Mapping[str, Any]) -> Arrays | None:
    """Return the arrays of an earlier run with the same inputs, or None."""
    path = _entry(frame, settings)
    content = read_entry(path)
    if content is None:
        return None
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (ValueError, EOFError, BadZipFile, KeyError):
        tell_damage(path)
        return None
    with suppress(OSError):  # a folder that others keep for us may not be ours to write
        path.touch()
    return arrays


def save(frame: PlateFrame, settings: Mapping[str, Any], arrays: Arrays) -> None:
    """Keep arrays for later runs; warn when the folder cannot be written.

    Args:
        frame: The frame.
        settings: Options of the build.
        arrays: What is kept, by name.
    """
    target = folder()
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **arrays)
    try:
        _make_room(target)
        write_entry(_entry(frame, settings), content.getvalue())
    except FrameError as error:
        reason = error.__cause__
        _warn_once(str(target), getattr(reason, "strerror", None) or str(error))


def _entry(frame: PlateFrame, settings: Mapping[str, Any]) -> Path:
    return folder() / f"{key(frame, settings)}.entry"


@cache
def _warn_once(place: str, reason: str) -> None:
    warnings.warn(
        f"cache folder {place}: {reason}; the run goes on without it (set POUNDING_CACHE to another folder)",
        CacheWarning,
        stacklevel=2,
    )


def _make_room(target: Path) -> None:
    """Delete the files used longest ago until the folder is small enough."""
    with suppress(OSError):  # another process may be making room at the same time
        files = sorted(
            ((path.stat(), path) for path in target.glob("*.entry")),
            key=lambda item: item[0].st_mtime,
        )
        excess = sum(stat.st_size for stat, _ in files) - LARGEST_BYTES
        for stat, path in files:
            if excess <= 0:
                return
            path.unlink(missing_ok=True)
            excess -= stat.st_size


@cache
def _codes() -> list[str]:
    from importlib.metadata import version

    return [f"{name} {version(name)}" for name in ("pounding", "pyfe3d", "numpy", "scipy")]
