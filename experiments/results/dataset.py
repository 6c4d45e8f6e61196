"""A run as a labelled dataset with units, kept as NetCDF and, on request, as CSV.

Dimensions are ``time``, ``frame`` and ``floor`` (from 1; the table has variables of its own), and with
contacts ``contact`` and ``contact_time``. A floor that a frame does not have is NaN.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicHermiteSpline

from pounding.experiments.errors import ExperimentError
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.motion import distinct
from pounding.frames.files import replacing, write_whole

if TYPE_CHECKING:
    from pounding.experiments.records import Record
    from pounding.experiments.rig.motion import FrameMotion, Motion

Real = NDArray[np.floating[Any]]

STEP_S = 1e-3
"""Default step of the stored histories [s]; floors under an earthquake move below some 60 Hz."""

FORCE_HZ = 10_000.0
"""Sampling rate of the stored contact forces [Hz]: an impact lasts a millisecond or two."""

UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}


def dataset(
    motion: Motion, record: Record, *, step_s: float = STEP_S, provenance: Mapping[str, Any] | None = None
) -> xr.Dataset:
    """Return a run as a labelled dataset.

    Args:
        motion: The run.
        record: The shaking at model scale that it was run with.
        step_s: Step of the stored histories [s].
        provenance: Where it comes from, as `pounding.experiments.results.provenance.stamp` gives it; by default the
            software's version, the record, and how the frames and contacts were made.

    Returns:
        ``relative_`` and ``absolute_`` ``displacement``, ``velocity`` and ``acceleration`` (frame, floor,
        time), ``table_displacement``, ``table_velocity`` and ``table_acceleration`` (time), ``height``
        (frame, floor), ``rotation`` (frame, floor, time) where floors turn and, with contacts, ``contact_force``
        (contact, contact_time). Each variable has ``units`` and ``long_name``. Absolute displacement and velocity
        hold the plain integral of the record's acceleration, with whatever drift the record has.
    """
    times = np.arange(0.0, motion.model_s + 1e-9 * step_s, step_s)
    table = table_motion(record, times)
    data: dict[str, Any] = {
        f"table_{kind}": ("time", values, _label(f"{kind} of the table in the room", UNITS[kind]))
        for kind, values in table.items()
    }
    relative = _floors(motion, times)
    for kind, values in relative.items():
        data[f"relative_{kind}"] = (
            ("frame", "floor", "time"), values, _label(f"{kind} relative to the table", UNITS[kind])
        )  # fmt: skip
        data[f"absolute_{kind}"] = (
            ("frame", "floor", "time"), values + table[kind], _label(f"{kind} in the room", UNITS[kind])
        )  # fmt: skip
    if any(frame.reduced.turns for frame in motion.frames):
        turned = _rotations(motion, times)
        data["rotation"] = (("frame", "floor", "time"), turned, _label("rotation about the vertical", "rad"))
    data["height"] = (("frame", "floor"), _heights(motion), _label("height above the table", "m"))
    coordinates: dict[str, Any] = {
        "time": ("time", times, _label("time on the model's clock", "s")),
        "frame": ("frame", labels(motion), {"long_name": "frame, from left to right along +x"}),
        "floor": ("floor", np.arange(1, relative["displacement"].shape[1] + 1), {"long_name": "floor"}),
    }
    if motion.contacts:
        _add_contacts(motion, data, coordinates)
    known = made_of(motion, record) if provenance is None else provenance
    return xr.Dataset(data, coordinates, _attributes(motion, known))


def made_of(motion: Motion, record: Record) -> dict[str, Any]:
    """Return the provenance of a run as far as the run itself knows it.

    Args:
        motion: The run.
        record: The shaking at model scale that it was run with.
    """
    contacts = [
        {"left": one.left, "right": one.right, "floor": one.floor, "gap_m": one.gap_m, "law": one.law.name}
        | {f"law_{name}": value for name, value in vars(one.law).items()}
        for one in motion.contacts
    ]
    frames = {frame.name: frame.reduced.options for frame in motion.frames}
    return stamp({"frames": frames, "contacts": contacts, "solver": motion.solver}, [record])


def table_motion(record: Record, times_s: Real) -> dict[str, Real]:
    """Return the table's displacement [m], velocity [m/s] and acceleration [m/s^2] at some times [s].

    The acceleration is straight between samples and integrated exactly, from rest at the origin, without any
    baseline correction; after the record it is zero.
    """
    samples, step, grid = record.acceleration_m_s2, record.step_s, record.time_s
    velocity = cumulative_trapezoid(samples, dx=step, initial=0)
    rise = step * velocity[:-1] + step**2 * (samples[:-1] / 3.0 + samples[1:] / 6.0)
    displacement = np.concatenate([[0.0], np.cumsum(rise)])
    inside = np.minimum(times_s, grid[-1])
    coasting = (times_s - inside) * velocity[-1]
    return {
        "displacement": CubicHermiteSpline(grid, displacement, velocity)(inside) + coasting,
        "velocity": CubicHermiteSpline(grid, velocity, samples)(inside),
        "acceleration": np.interp(times_s, grid, samples, right=0.0),
    }


def labels(motion: Motion) -> list[str]:
    """Return a distinct label for each frame: its name, with ``#2`` and so on where a name repeats."""
    return distinct([frame.name for frame in motion.frames])


def save(data: xr.Dataset, path: str | Path) -> None:
    """Write a dataset as NetCDF 4, compressed; the file is there whole or not at all.

    Raises:
        FrameError: The file cannot be written.
    """
    encoding = {str(name): {"zlib": True, "complevel": 4} for name in data.data_vars}
    # Through memory: HDF5 reports a full disk late, and in words nobody understands.
    write_whole(path, bytes(data.to_netcdf(engine="h5netcdf", encoding=encoding)))


def load(path: str | Path) -> xr.Dataset:
    """Read a dataset that `save` wrote.

    Raises:
        ExperimentError: The file is not there or is not NetCDF.
    """
    try:
        return xr.load_dataset(path, engine="h5netcdf")
    except (OSError, ValueError) as error:
        raise ExperimentError(f"{path}: not a NetCDF file of results ({error})") from error


def save_csv(data: xr.Dataset, path: str | Path) -> None:
    """Write the histories as CSV: ``time_s``, the table, then a column a frame, floor and quantity.

    A column is called like ``15B_relative_displacement_floor10_m``; `experiments.measurements.history` reads such names.

    Raises:
        FrameError: The file cannot be written.
    """
    columns = {"time_s": data.time.values}
    columns |= {f"table_{kind}_{_suffix(unit)}": data[f"table_{kind}"].values for kind, unit in UNITS.items()}
    for frame in data.frame.values:
        for floor in data.floor.values[np.isfinite(data.height.sel(frame=frame).values)]:
            for name, unit in (("relative_displacement", "m"), ("absolute_acceleration", "m/s^2")):
                column = f"{frame}_{name}_floor{floor}_{_suffix(unit)}"
                columns[column] = data[name].sel(frame=frame, floor=floor).values
    with replacing(path) as part:
        np.savetxt(
            part, np.column_stack(list(columns.values())), "%.7g", ",", header=",".join(columns), comments=""
        )


def _suffix(unit: str) -> str:
    return unit.replace("/", "_").replace("^", "")


def _floors(motion: Motion, times: Real) -> dict[str, Real]:
    """Return relative displacement, velocity and acceleration (frame, floor, time)."""
    shape = (len(motion.frames), max(frame.reduced.storeys for frame in motion.frames), len(times))
    found = {kind: np.full(shape, np.nan) for kind in UNITS}
    for place, frame in enumerate(motion.frames):
        for kind, values in zip(UNITS, sampled_floors(frame, times), strict=True):
            found[kind][place, : frame.reduced.storeys] = values.T
    return found


def _rotations(motion: Motion, times: Real) -> Real:
    """Return the floors' rotations (frame, floor, time) [rad]; NaN for a frame whose floors do not turn."""
    found = np.full(
        (len(motion.frames), max(one.reduced.storeys for one in motion.frames), len(times)), np.nan
    )
    for place, frame in enumerate(motion.frames):
        if frame.reduced.turns:
            found[place, : frame.reduced.storeys] = frame.sampled(times)[0][:, frame.reduced.floor_rz].T
    return found


def sampled_floors(frame: FrameMotion, times: Real) -> Sequence[Real]:
    """Return the floors' relative displacement, velocity and acceleration (times, storeys) at times [s]."""
    columns = frame.reduced.floor_x
    moved, rate = frame.displacement_m[:, columns], frame.velocity_m_s[:, columns]
    # Acceleration has corners where the table's has, and jumps at an impact: straight lines do not overshoot.
    absolute = frame.acceleration_m_s2[:, columns] + frame.table_m_s2[:, None]
    between = np.column_stack([np.interp(times, frame.time_s, column) for column in absolute.T])
    table = np.interp(times, frame.time_s, frame.table_m_s2)
    return (
        CubicHermiteSpline(frame.time_s, moved, rate)(times),
        CubicHermiteSpline(frame.time_s, rate, frame.acceleration_m_s2[:, columns])(times),
        between - table[:, None],
    )


def _heights(motion: Motion) -> Real:
    floors = max(frame.reduced.storeys for frame in motion.frames)
    heights = np.full((len(motion.frames), floors), np.nan)
    for place, frame in enumerate(motion.frames):
        heights[place, : frame.reduced.storeys] = frame.reduced.heights_m
    return heights


def _add_contacts(motion: Motion, data: dict[str, Any], coordinates: dict[str, Any]) -> None:
    histories = [contact.sampled(FORCE_HZ) for contact in motion.contacts]
    data["contact_force"] = (
        ("contact", "contact_time"),
        np.array([force for _, force in histories]),
        _label("contact force, compression positive", "N"),
    )
    coordinates["contact"] = ("contact", np.arange(1, len(histories) + 1), {"long_name": "contact"})
    coordinates["contact_time"] = ("contact_time", histories[0][0], _label("time of the forces", "s"))
    for name in ("left", "right", "floor"):
        coordinates[f"contact_{name}"] = ("contact", [getattr(c, name) for c in motion.contacts])
    coordinates["contact_gap"] = (
        "contact", [c.gap_m for c in motion.contacts], _label("gap at rest", "m")
    )  # fmt: skip


def _attributes(motion: Motion, provenance: Mapping[str, Any]) -> dict[str, Any]:
    known = dict(provenance)
    attributes: dict[str, Any] = {k: known[k] for k in ("schema", "software", "version") if k in known}
    attributes |= {key: json.dumps(known[key]) for key in ("parameters", "records") if key in known}
    return attributes | {"wall_s": motion.wall_s, "model_s": motion.model_s, "steps": motion.steps}


def _label(long_name: str, units: str) -> dict[str, str]:
    return {"long_name": long_name, "units": units}
