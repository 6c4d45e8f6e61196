"""What is missing in Table 4.1? Single changes of the model, fitted on two records, judged on two others.

Each change has one physically named parameter, the same for all five frames or one value a frame. It is
fitted to the peaks of two records by the mean of abs(ours - measured) / measured and judged by the same number
on the other two, for all six ways to split four records. Contested peaks are left out of both. Run it with
``pounding study table-4-1-missing``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from itertools import combinations
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import xarray as xr
from cyclopts import Parameter
from numpy.typing import NDArray

from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import RECORDS, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.studies.change_catalogue import CHANGES
from pounding.experiments.studies.shared import Kept, Workers
from pounding.experiments.studies.single_changes import storeys
from pounding.experiments.studies.table_4_1 import (
    BLIND,
    FRAMES,
    KEPT_ARIAS,
    SIDES,
    build,
    measured,
    score,
    trusted,
)
from pounding.experiments.studies.table_4_1_picture import verdict_picture
from pounding.experiments.sweeps.sweep import sweep
from pounding.scale import THESIS

Real = NDArray[np.float64]


def peaks_of(change_name: str, frame: str, record: str, folder: str, samples: str) -> dict[str, xr.DataArray]:
    """Return the peaks [mm] of a frame's floors in the table for all values of a change.

    Args:
        change_name: A key of `CHANGES`.
        frame: Name of the frame.
        record: Name of the record.
        folder: Folder with ground motions; empty for the default.
        samples: Hash of all records, which makes the case another one when a record is another.
    """
    motion = find(record, folder or None).scaled(THESIS.time_factor).trimmed(lower=0.0, upper=KEPT_ARIAS)
    chosen, printed = CHANGES[change_name], measured()
    floors = printed.floor[printed.frame == frame].values
    values = np.array(chosen.values)
    found = 1e3 * chosen.peaks(storeys(build(frame, BLIND)), motion, values)[:, floors - 1]
    coords = {"value": np.arange(len(values)), "floor": floors, "side": list(SIDES)}
    return {"peaks": xr.DataArray(found, coords, ("value", "floor", "side"), attrs={"units": "mm"})}


def all_peaks(
    records: Path | None = None,
    *,
    folder: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> xr.DataArray:
    """Return peaks [mm] over change, value, place, record and side; NaN past a change's last value.

    Args:
        records: Folder with ground motions; None for the default.
        folder: Folder for finished cases.
        workers: Processes; one a core when None.
        scheduler: Address of a dask.distributed scheduler; this machine when None.
    """
    motions = [find(name, records) for name in RECORDS]
    settings = {"folder": str(records or ""), "samples": " ".join(motion.sha256 for motion in motions)}
    grid = {"change_name": list(CHANGES), "frame": list(FRAMES), "record": list(RECORDS)}
    data = sweep(peaks_of, grid, settings=settings, folder=folder, workers=workers, scheduler=scheduler)
    failed = [str(reason) for reason in data.failure.values.ravel() if reason]
    if failed:
        raise ExperimentError(f"{len(failed)} runs failed, the first: {failed[0]}")
    printed = measured()
    at_place: xr.DataArray = data.peaks.sel(frame=printed.frame, floor=printed.floor)
    renamed = at_place.rename(change_name="change")
    return renamed.transpose("change", "value", "place", "record", "side")


@dataclass(frozen=True)
class Verdict:
    """How near a change brings the model to records it was not fitted on.

    Attributes:
        held_out: Mean abs(ours - measured) / measured on the two other records, mean over the splits [-].
        neutral: The same for the baseline model [-].
        fitted: Fitted value of each split (splits,) for one value for all frames; (splits, frames) else.
        all_four: The mean error of one fit to all four records, which flatters [-].
    """

    held_out: float
    neutral: float
    fitted: Real
    all_four: float


def judge(errors: xr.DataArray, values: Real, each: bool) -> Verdict:
    """Return the verdict on one change.

    Args:
        errors: abs(ours - measured) / measured over value, place, record and side, NaN where contested; the
            first value is the neutral one.
        values: The tried values (values,).
        each: One value a frame instead of one for all.
    """
    groups = [errors.frame == name for name in FRAMES] if each else [errors.frame == errors.frame]
    held, neutral, fitted = [], [], []
    for train in combinations(RECORDS, 2):
        test = [name for name in RECORDS if name not in train]
        picked = [_best(errors.isel(place=np.flatnonzero(g)).sel(record=list(train))) for g in groups]
        held.append(_mean_at(errors.sel(record=test), groups, picked))
        neutral.append(float(errors.isel(value=0).sel(record=test).mean()))
        fitted.append([float(values[index]) for index in picked])
    every = [_best(errors.isel(place=np.flatnonzero(g))) for g in groups]
    flattered = _mean_at(errors, groups, every)
    return Verdict(float(np.mean(held)), float(np.mean(neutral)), np.squeeze(np.array(fitted)), flattered)


def _best(errors: xr.DataArray) -> int:
    return int(errors.mean(("place", "record", "side")).argmin("value"))


def _mean_at(errors: xr.DataArray, groups: list[xr.DataArray], picked: list[int]) -> float:
    parts = [
        errors.isel(place=np.flatnonzero(group), value=index).values.ravel()
        for group, index in zip(groups, picked, strict=True)
    ]
    return float(np.nanmean(np.concatenate(parts)))


def verdicts(peaks: xr.DataArray) -> pd.DataFrame:
    """Return a row for each change, the nearest on held-out records first."""
    truth = measured()
    # A model that ran away is infinitely far from the measured.
    errors = (abs(peaks.fillna(np.inf) - truth) / truth).where(trusted())
    rows = []
    for name, chosen in CHANGES.items():
        values = np.array(chosen.values)
        one = errors.sel(change=name).isel(value=slice(len(values)))
        common, each = judge(one, values, each=False), judge(one, values, each=True)
        rows.append(
            {
                "change": name,
                "held_out": common.held_out,
                "neutral": common.neutral,
                "fitted_low": common.fitted.min(),
                "fitted_high": common.fitted.max(),
                "unit": chosen.unit,
                "all_four": common.all_four,
                "held_out_each": each.held_out,
                "all_four_each": each.all_four,
            }
        )
    return pd.DataFrame(rows).set_index("change").sort_values("held_out")


def show(found: pd.DataFrame) -> Iterable[Any]:
    """Return the verdicts as a table for a reader."""
    heads = ["change", "held out", "fitted in the six splits", "fit to all", "held out, each", "fit, each"]
    keys = ("held_out", "all_four", "held_out_each", "all_four_each")
    rows = []
    for name, row in found.iterrows():
        numbers = [f"{100 * row[key]:.1f}" for key in keys]
        values = f"{row['fitted_low']:.3g} to {row['fitted_high']:.3g} {row['unit']}"
        rows.append([str(name), numbers[0], values, *numbers[1:]])
    baseline = f"{100 * found.neutral.iloc[0]:.1f}"
    yield table(
        f"What is missing? |ours - measured| / measured [%], baseline model {baseline} on held-out records;"
        " one value for all frames, or one for each",
        heads,
        rows,
    )


def main(
    *,
    records: options.Records = None,
    keep: Kept = None,
    workers: Workers = None,
    scheduler: Annotated[str | None, Parameter(help="Address of a dask.distributed scheduler.")] = None,
    json: options.Json = False,
    out: options.Out = None,
) -> dict[str, Any]:
    """Find which single physical change brings the model closest to Table 4.1, on records not fitted."""
    found = verdicts(all_peaks(records, folder=keep, workers=workers, scheduler=scheduler))
    settings = {"baseline": asdict(BLIND), "changes": {name: one.what for name, one in CHANGES.items()}}
    result = stamp(settings, [find(name, records) for name in RECORDS])
    result |= {"verdicts": found.reset_index().to_dict("records")}
    if out is not None:
        sap2000 = score(measured("numerical"), trusted()).mean
        verdict_picture(found, sap2000, out / "table-4-1-missing.png")
    emit(result, as_json=json, show=lambda: show(found))
    return result


if __name__ == "__main__":
    run_script(main)
