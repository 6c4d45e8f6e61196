"""Rows of buildings of real size: how those at the ends fare, and those between, against standing alone.

Anagnostopoulos (1988, Earthquake Engineering and Structural Dynamics 16, 443-456) asked it of single masses that yield.
Here the buildings have several storeys and stay elastic. Each row is run in all its rotations, so that every building stands
once at every place: what a place does is not mixed with what a building is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Annotated, Any

import numpy as np
import pandas as pd
import xarray as xr
from cyclopts import Parameter
from numpy.typing import NDArray

from pounding import bounds, frames
from pounding.constants import STANDARD_GRAVITY
from pounding.contact.parameters import make_law
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.records import Record
from pounding.experiments.records.code_spectra import FORMS, target
from pounding.experiments.records.sets import record_set
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import run_exact
from pounding.experiments.rig.motion import FrameMotion, Motion
from pounding.experiments.studies.end_and_inner_picture import picture
from pounding.experiments.studies.shared import Kept, Workers, keyed, write_tables
from pounding.experiments.sweeps.sweep import sweep_all
from pounding.frames.definition import Yielding
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.units import LENGTH

Real = NDArray[np.floating[Any]]

ROWS: Mapping[str, tuple[float, ...]] = {
    "five nearly equal": (0.90, 1.05, 0.95, 1.10, 1.00),
    "five unequal": (0.50, 1.10, 0.70, 1.30, 0.90),
    "three nearly equal": (0.90, 1.00, 1.10),
    "three unequal": (0.50, 1.30, 0.90),
}
"""First periods of the buildings of each row [s]."""

STOREY_M, FLOOR_KG, DAMPING, HARDENING = 3.2, 300e3, 0.05, 0.05
CONTACT_N_PER_M, RESTITUTION = 3.75e9, 0.65
"""The strip of the office's slab of docs/full-scale.md, and concrete on concrete."""

STRENGTH = options.bounded(bounds.Bound(0.0, 2.0, "", "no building resists twice its weight"))

QUANTITIES = ("drift", "acceleration")

RAISED = 1.01
"""Ratio from which a quantity counts as raised by the neighbours [-]; where nothing touches it is 1 but for round-off."""


@lru_cache(maxsize=32)
def building(period_s: float, storeys: int, strength: float = 0.0) -> ReducedFrame:
    """Return a building of equal storeys.

    Args:
        period_s: Its first period [s].
        storeys: How many it has.
        strength: Shear over the weight at which its first storey yields [-], the others in proportion to the shear of forces
            that grow with the height; 0: it stays elastic.
    """
    shares = np.cumsum(np.arange(storeys, 0, -1)) / np.arange(1, storeys + 1).sum()
    shear_n = strength * storeys * FLOOR_KG * STANDARD_GRAVITY * shares[::-1]
    return frames.build(
        frames.StickFrame(
            name=f"{period_s:g} s",
            storeys=storeys,
            storey_height_m=STOREY_M,
            floor_mass_kg=[FLOOR_KG] * storeys,
            frequency_hz=[1.0 / period_s],
            damping_ratio=DAMPING,
            yielding=Yielding(storey_shear_n=shear_n.tolist(), hardening_ratio=HARDENING)
            if strength
            else None,
        )
    )


@lru_cache(maxsize=64)
def _shaking(set_name: str, index: int, spectrum: str) -> Record:
    record = _set(set_name)[index]
    periods = [period for row in ROWS.values() for period in row]
    factor = target(spectrum).factor(record, (min(periods), max(periods)))
    return record.scaled(1.0, factor * record.pga_g)


@lru_cache(maxsize=2)
def _set(set_name: str) -> list[Record]:
    return record_set(set_name)


def fare(
    row: str,
    rotation: int,
    record: int,
    *,
    gap_mm: float,
    storeys: int,
    strength: float,
    set_name: str,
    spectrum: str,
) -> dict[str, Any]:
    """Return what each building of a row does beside its neighbours and alone, by its place from the left.

    Args:
        row: Name of the row.
        rotation: By how many places the row is turned.
        record: Number of the ground motion in its set, from 0.
        gap_mm: All gaps [mm]; the roofs touch.
        storeys: Of each building.
        strength: See `building`.
        set_name: See `record_set`.
        spectrum: Design spectrum to which the motion is brought, see `target`.

    Raises:
        ExperimentError: No such set, or a run that grows without bound.
    """
    periods = np.roll(ROWS[row], -rotation)
    buildings = [building(float(period), storeys, strength) for period in periods]
    law = make_law(
        "linear_viscoelastic", stiffness=CONTACT_N_PER_M, restitution=RESTITUTION, masses=(FLOOR_KG, FLOOR_KG)
    )
    contacts = [Contact(law, 1e-3 * gap_mm, storeys, pair) for pair in range(len(buildings) - 1)]
    shaken = _shaking(set_name, record, spectrum)
    together, apart = (
        run_exact(buildings, some, shaken.acceleration_m_s2, shaken.step_s) for some in (contacts, [])
    )
    touches = np.array([len(contact.pulses) for contact in together.contacts])
    found = {
        "period_s": periods,
        "drift": _ratios(together, apart, _drift),
        "acceleration": _ratios(together, apart, _acceleration),
        "drift_alone_percent": np.array([100.0 * _drift(one) for one in apart.frames]),
        "acceleration_alone_g": np.array([_acceleration(one) for one in apart.frames]),
        "touches": np.append(touches, 0) + np.append(0, touches),
    }
    places = {"place": np.arange(len(periods))}
    return {name: xr.DataArray(np.asarray(values, float), places) for name, values in found.items()}


def _ratios(together: Motion, apart: Motion, what: Any) -> list[float]:
    return [what(one) / what(other) for one, other in zip(together.frames, apart.frames, strict=True)]


def _drift(motion: FrameMotion) -> float:
    """Return the largest storey drift over the height [-]."""
    floors = motion.displacement_m[:, motion.reduced.floor_x]
    return float(np.abs(np.diff(floors, prepend=0.0, axis=1)).max()) / STOREY_M


def _acceleration(motion: FrameMotion) -> float:
    """Return the largest acceleration of a floor in the room [g]."""
    floors = motion.acceleration_m_s2[:, motion.reduced.floor_x] + motion.table_m_s2[:, None]
    return float(np.abs(floors).max()) / STANDARD_GRAVITY


def long_table(data: xr.Dataset) -> pd.DataFrame:
    """Return one line for each building of each run, with `end` where it stands at an end.

    Args:
        data: What the sweep returned, cases of several rows; places that a row does not have are NaN.
    """
    lines = data.to_dataframe().reset_index().dropna(subset=["period_s"])
    order = list(ROWS)
    last = lines["row"].map({name: len(periods) - 1 for name, periods in ROWS.items()})
    lines = lines.assign(
        end=(lines["place"] == 0) | (lines["place"] == last), row_number=lines["row"].map(order.index)
    )
    return lines.sort_values(["row_number", "end", "period_s"], ascending=[True, False, True], kind="stable")


def summary(lines: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return medians, 16 and 84 % quantiles of the ratios and the share of raised ones, for each group of lines.

    Args:
        lines: See `long_table`.
        by: Columns that make a group.
    """
    rows = {}
    for group, some in lines.groupby(by, sort=False):
        found: dict[str, float] = {"touches": float(some["touches"].median())}
        for name in QUANTITIES:
            low, middle, high = some[name].quantile([0.16, 0.5, 0.84])
            found |= {f"{name}_median": middle, f"{name}_16": low, f"{name}_84": high}
            found[f"{name}_raised"] = float((some[name] > RAISED).mean())
        rows[group] = found
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(by)


def main(
    *,
    gap: Annotated[
        float,
        Parameter(
            help="Gap of all neighbours [mm].",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ] = 20.0,
    storeys: Annotated[
        int,
        Parameter(
            help="Storeys of each building; 1 is a single mass.", validator=options.bounded(bounds.STOREYS)
        ),
    ] = 6,
    strength: Annotated[
        float,
        Parameter(help="Shear over weight at which storeys yield; 0: they stay elastic.", validator=STRENGTH),
    ] = 0.0,
    set_: Annotated[str, Parameter(name="--set", help="Set of ground motions.")] = "fema-p695-farfield",
    spectrum: Annotated[
        str, Parameter(name="--target", help=f"Design spectrum of the motions: {'; '.join(FORMS.values())}.")
    ] = "ec8-1:0.25:B",
    kept: Kept = None,
    workers: Workers = None,
    scheduler: Annotated[str | None, Parameter(help="Address of a dask.distributed scheduler.")] = None,
    json: options.Json = False,
    out: options.Out = None,
) -> dict[str, Any]:
    """Compare buildings at the ends of a row and inside it with the same buildings alone, over many records."""
    shakings = [_shaking(set_, index, spectrum) for index in range(len(_set(set_)))]
    if out is not None:
        keeping.prepare(out)
    data = sweep_all(
        fare,
        [
            {"row": row, "rotation": rotation, "record": record}
            for row, periods in ROWS.items()
            for rotation in range(len(periods))
            for record in range(len(shakings))
        ],
        settings={
            "gap_mm": gap,
            "storeys": storeys,
            "strength": strength,
            "set_name": set_,
            "spectrum": spectrum,
        },
        folder=kept,
        workers=workers,
        scheduler=scheduler,
    )
    lines = long_table(data)
    tables = {
        "end-and-inner": summary(lines, ["row", "end"]),
        "end-and-inner-buildings": summary(lines, ["row", "period_s", "end"]),
    }
    asked = {
        "gap_mm": gap,
        "storeys": storeys,
        "strength": strength,
        "set": set_,
        "target": target(spectrum).words,
        "rows": dict(ROWS),
        "runs": data.sizes["case"],
    }
    result = stamp(asked, shakings) | {name.replace("-", "_"): keyed(one) for name, one in tables.items()}
    if out is not None:
        write_tables(tables, out)
        picture(tables["end-and-inner-buildings"], out / "end-and-inner.png")
        result["files"] = [*(f"{name}.csv" for name in tables), "end-and-inner.png"]
    emit(result, as_json=json, show=lambda: show(tables, result))
    return result


def show(tables: Mapping[str, pd.DataFrame], result: dict[str, Any]) -> Iterable[Any]:
    """Return the table of places for a reader; that of single buildings is written only.

    Args:
        tables: By name.
        result: For the files that were written.
    """
    heads = [
        "row",
        "place",
        "touches",
        "drift",
        "16 to 84 %",
        "raised",
        "acceleration",
        "16 to 84 %",
        "raised",
    ]
    lines = [_row(one) for _, one in tables["end-and-inner"].reset_index().iterrows()]
    yield table("in the row over alone", heads, lines)
    yield from keeping.written(result)


def _row(one: Any) -> list[str]:
    cells = [str(one["row"]), "end" if one["end"] else "inner", f"{one['touches']:.0f}"]
    for name in QUANTITIES:
        cells += [f"{one[f'{name}_median']:.2f}", f"{one[f'{name}_16']:.2f} to {one[f'{name}_84']:.2f}"]
        cells.append(f"{100 * one[f'{name}_raised']:.0f} %")
    return cells


if __name__ == "__main__":
    run_script(main)
