"""Runs with contact as the cases of a sweep, one a record: kept in a folder, on this machine or on a Dask cluster.

A case is names and numbers alone. The buildings travel as the text of their definitions; a worker reads the ground motion
itself, from the installed package or from a folder that it shares with the others, and its hash must be the one asked for.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from pounding import frames
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import Limit, passing
from pounding.experiments.records import Record, find
from pounding.experiments.records.sets import record_set
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.states import FrameState
from pounding.experiments.rig.street import named, street_contacts
from pounding.experiments.rig.street_file import Street
from pounding.experiments.sweeps.sweep import sweep_all
from pounding.frames.definition import Frame, PlateFrame, StickFrame

if TYPE_CHECKING:
    from pounding.experiments.rig.contact_choice import Parameters
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


class Motions(msgspec.Struct, frozen=True):
    """Which ground motions there are.

    Attributes:
        names: Single motions, by name or file.
        set_name: A set, or None.
        folder: Folder with ground motions; None for the default.
        time_factor: What their time is multiplied by [-].
        unit: Unit of acceleration of files that name none.
    """

    names: tuple[str, ...] = ()
    set_name: str | None = None
    folder: str | None = None
    time_factor: float = 1.0
    unit: str | None = None

    def read(self) -> list[Record]:
        """Return the motions at the scale of the buildings.

        Raises:
            ExperimentError: There is no such motion or set.
        """
        found = [find(name, self.folder, unit=self.unit) for name in self.names]
        found += record_set(self.set_name, self.unit) if self.set_name else []
        return [one.scaled(self.time_factor) for one in found]


class _Standing(msgspec.Struct, frozen=True):
    """Buildings in a row as text can hold them."""

    street: Street
    definitions: tuple[PlateFrame | StickFrame, ...]
    damping: tuple[float | None, ...]
    calibrations: tuple[str | None, ...]
    parameters: tuple[str | None, ...]


def street_text(street: Street, states: Sequence[FrameState], parameters: Sequence[Parameters | None]) -> str:
    """Return all that the runs need of a street as text; no file is needed to build it from that.

    Args:
        street: The street, with its gaps.
        states: The states of its buildings.
        parameters: The parameter set of each gap.
    """
    definitions: tuple[Frame, ...] = tuple(frames.load(state.frame) for state in states)
    # Where the files lay does not matter: the same row elsewhere is the same case.
    buildings = tuple(
        msgspec.structs.replace(building, frame=definition.name)
        for building, definition in zip(street.building, definitions, strict=True)
    )
    standing = _Standing(
        msgspec.structs.replace(street, building=buildings),
        definitions,
        tuple(state.damping_ratio for state in states),
        tuple(state.calibration for state in states),
        tuple(parameters),
    )
    return msgspec.json.encode(standing).decode()


@lru_cache(maxsize=4)
def _built(text: str) -> tuple[tuple[ReducedFrame, ...], tuple[Contact, ...]]:
    standing = msgspec.json.decode(text, type=_Standing)
    off_middle = standing.street.off_middle
    row = [
        frames.build(
            definition, damping=ratio, calibration=calibration, planar=False if place in off_middle else None
        )
        for place, (definition, ratio, calibration) in enumerate(
            zip(standing.definitions, standing.damping, standing.calibrations, strict=True)
        )
    ]
    row = named(standing.street, row)
    contacts, _ = street_contacts(standing.street, row, standing.parameters)  # type: ignore[arg-type]
    return tuple(row), tuple(contacts)


@lru_cache(maxsize=2)
def _motions(text: str) -> dict[str, Record]:
    return {one.sha256: one for one in msgspec.json.decode(text, type=Motions).read()}


def passes_of(
    record: str, sha256: str, intensity_g: float, *, motions: str, street: str, limits: str, levels: str
) -> dict[str, Any]:
    """Return whether one record passes each limit at each level (limit, level), 1 or 0.

    Args:
        record: Its name.
        sha256: Hash of its samples.
        intensity_g: Its intensity as it is [g].
        motions: `Motions` as JSON.
        street: See `street_text`.
        limits: The limits as JSON, a list of their fields.
        levels: The levels [g] as JSON.

    Raises:
        ExperimentError: The record that is found here is another one, or a run that grows without bound.
    """
    known = _motions(motions)
    if sha256 not in known:
        raise ExperimentError(
            f"record {record} is another one here than where the sweep was started; give all workers the same files"
        )
    row, contacts = _built(street)
    factors = np.array([json.loads(levels)]) / intensity_g
    asked = [Limit(**one) for one in json.loads(limits)]
    found = passing(row, contacts, [known[sha256]], factors, asked, workers=1)[:, 0]
    return {"passed": xr.DataArray(found.astype(float), dims=("limit", "level"))}


def passing_by_sweep(
    motions: Motions,
    records: Sequence[Record],
    strengths_g: Real,
    levels_g: Real,
    limits: Sequence[Limit],
    street: str,
    *,
    folder: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> NDArray[np.bool_]:
    """Return whether each record at each level passes each limit (limits, records, levels), as `passing` does.

    Args:
        motions: Where the records come from.
        records: The records.
        strengths_g: The intensity of each record as it is (n,) [g].
        levels_g: The levels (m,) [g].
        limits: The limits.
        street: See `street_text`.
        folder: Where finished records are kept; an interrupted call goes on from it.
        workers: Processes of this machine; one a core when None.
        scheduler: Address of a dask.distributed scheduler to run on instead.

    Raises:
        ExperimentError: A record failed; says which and why, when all others are finished. Or as `sweep`.
    """
    data = sweep_all(
        passes_of,
        [
            {"record": one.name, "sha256": one.sha256, "intensity_g": float(strength)}
            for one, strength in zip(records, strengths_g, strict=True)
        ],
        settings={
            "motions": msgspec.json.encode(motions).decode(),
            "street": street,
            "limits": json.dumps([asdict(one) for one in limits]),
            "levels": json.dumps([float(one) for one in levels_g]),
        },
        folder=folder,
        workers=workers,
        scheduler=scheduler,
    )
    return np.asarray(data.passed.transpose("limit", "case", "level").values > 0.5)
