"""One small file for each finished case of a sweep, so that nothing is lost and nothing is run twice."""

from __future__ import annotations

import hashlib
import inspect
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import xarray as xr

import pounding
from pounding.experiments.errors import ExperimentError
from pounding.frames.errors import FrameError
from pounding.frames.files import read_entry, tell_damage, write_entry

Case = Mapping[str, Any]
Run = Callable[..., Mapping[str, Any]]


class StoreError(ExperimentError):
    """The folder of finished cases cannot be written: the sweep has to stop."""


@dataclass(frozen=True)
class Outcome:
    """What became of one case.

    Attributes:
        values: Name to number, text or labelled array; empty if it failed.
        failure: Why it failed, empty if it did not.
    """

    values: Mapping[str, Any]
    failure: str = ""


class _Kept(msgspec.Struct, forbid_unknown_fields=True):
    """The file of a finished case."""

    case: dict[str, Any]
    values: dict[str, Any]
    failure: str


NO_PART_OF_A_CASE = (
    "frames/drawing",
    "experiments/command",
    "experiments/console",
    "experiments/pictures",
    "experiments/records",
    "experiments/studies",
)
"""Rooms that change no result: what draws and asks. A record enters a case by its own hash."""


def sources() -> set[Path]:
    """Return the files that a case depends on: those of frames, contact and experiments but `NO_PART_OF_A_CASE`."""
    house = Path(pounding.__file__).parent
    files = set(house.glob("*.py"))
    for package in ("frames", "contact", "experiments"):
        # Frames and their states are data beside the code.
        files.update(*((house / package).rglob(kind) for kind in ("*.py", "*.toml")))
    left_out = tuple(house / room for room in NO_PART_OF_A_CASE)
    return {file for file in files if not any(room in file.parents for room in left_out)}


def code_version(run: Run) -> str:
    """Return a hash of the source that a case depends on: see `sources`, and `run`'s own module."""
    files = sources()
    own = inspect.getsourcefile(inspect.unwrap(run))
    if own is not None:
        files.add(Path(own))
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def case_key(run: Run, case: Case, settings: Case, version: str) -> str:
    """Return the hash by which a finished case is found again.

    Args:
        run: What is run.
        case: Arguments of the case.
        settings: Arguments that all cases share.
        version: Version of the code, see `code_version`.

    Raises:
        ExperimentError: A case or setting that is no number, text, truth value, None, or list of these.
    """
    identity = {
        "run": f"{run.__module__}.{run.__qualname__}",
        "case": dict(case),
        "settings": dict(settings),
        "version": version,
    }
    return hashlib.sha256(_json(identity, f"case {dict(case)}").encode()).hexdigest()[:32]


class Store:
    """A folder of finished cases; `None` keeps them in memory only."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._memory: dict[str, Outcome] = {}

    def get(self, key: str) -> Outcome | None:
        """Return what became of a case, or None if it is not finished; a damaged file is told, and is as good as none."""
        if self.folder is None:
            return self._memory.get(key)
        path = self.folder / f"{key}.json"
        kept = read_entry(path)
        if kept is None:
            return None
        try:
            content = msgspec.convert(json.loads(kept), _Kept)
            return Outcome(
                {name: _unpacked(value) for name, value in content.values.items()}, content.failure
            )
        except (ValueError, KeyError, TypeError, AttributeError):
            tell_damage(path)
            return None

    def put(self, key: str, case: Case, outcome: Outcome) -> None:
        """Keep a finished case, whole or not at all.

        Args:
            key: See `case_key`.
            case: Arguments of the case.
            outcome: What the run returned.

        Raises:
            StoreError: The folder cannot be written, a full disk among other reasons.
            ExperimentError: The case gave something other than numbers, text and labelled arrays.
        """
        if self.folder is None:
            self._memory[key] = outcome
            return
        values = {name: _packed(value, name) for name, value in outcome.values.items()}
        text = _json({"case": dict(case), "values": values, "failure": outcome.failure}, "result")
        try:
            write_entry(self.folder / f"{key}.json", text.encode())
        except FrameError as error:
            raise StoreError(
                f"{error}; what is finished is kept: make room and start again to go on"
            ) from None

    def forget_failures(self, keys: Iterable[str]) -> None:
        """Drop the failed among these cases, so that they run again."""
        for key in keys:
            outcome = self.get(key)
            if outcome is None or not outcome.failure:
                continue
            self._memory.pop(key, None)
            if self.folder is not None:
                (self.folder / f"{key}.json").unlink(missing_ok=True)


def _json(content: Any, what: str) -> str:
    try:
        return json.dumps(content, sort_keys=True, default=_plain)
    except TypeError as error:
        raise ExperimentError(
            f"{what}: {error}; use numbers, text, truth values, None or lists of them"
        ) from None


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a {type(value).__name__} cannot be kept")


def _packed(value: Any, name: str) -> Any:
    """Return a value as JSON has it; floats keep all their digits."""
    if isinstance(value, xr.DataArray):
        return {"array": value.to_dict(data="list")}
    if isinstance(value, np.ndarray) and value.ndim:
        raise ExperimentError(f"result '{name}': return arrays as xarray.DataArray, whose axes have names")
    return value


def _unpacked(value: Any) -> Any:
    return xr.DataArray.from_dict(value["array"]) if isinstance(value, dict) else value
