"""Table 4.1 of the thesis: 64 measured peaks of frames that shake alone, beside SAP2000's and ours.

`BLIND` is the baseline model, fixed before any peak was compared: joints calibrated on the frequency of free
vibration and nothing else, gravity's P-Delta on, the damping of the free-vibration tests in every mode, the
records as they are (their peaks are those of section 3.7), positive acceleration towards +x. All other
variants are shown beside it, none is picked. Beside them stand the peaks in the state of strong motion, whose damping is
fitted to this table and which are therefore no test of it. Run it with ``pounding study table-4-1``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

from pounding import frames
from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.published import consistency
from pounding.experiments.records import RECORDS, Record, find
from pounding.experiments.results.dataset import save
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.pounding import built_in
from pounding.experiments.rig.states import State, states_of
from pounding.experiments.studies.table_3_1 import calibrated, thesis_frame
from pounding.experiments.studies.table_4_1_picture import picture
from pounding.frames.definition import PlateFrame
from pounding.frames.response.exact import linear_response
from pounding.scale import THESIS

FITTED = "fitted to this table"
SIDES = ("max", "min")
KEPT_ARIAS = 0.999
"""Records end at this share of their Arias intensity: frames only ring down after it."""
FRAMES = ("15A", "15B", "10", "5A", "5B")
MODEL_STEP_S = 2.5e-4
"""The exact response is looked at this often [s]: 100 times in a period of the third mode of 5B (36 Hz)."""


@dataclass(frozen=True)
class Variant:
    """One way to compute Table 4.1.

    Attributes:
        joints: What the joints are calibrated on, or `rigid`.
        p_delta: Whether gravity's geometric stiffness counts.
        peaks: Peaks of the records, `3.7` (as the records have them) or `7.1` (as Table 7.1 lists them).
        polarity: 1 for positive acceleration towards +x, -1 for the opposite.
        damping: Damping ratio of all modes [-]; None for each frame's own from Table 3.1.
    """

    joints: Literal["free_vibration", "sweep", "rigid"] = "free_vibration"
    p_delta: bool = True
    peaks: Literal["3.7", "7.1"] = "3.7"
    polarity: int = 1
    damping: float | None = None

    def __str__(self) -> str:
        gravity = "P-Delta on" if self.p_delta else "P-Delta off"
        sense = "as recorded" if self.polarity > 0 else "reversed"
        return f"{self.joints.replace('_', ' ')}, {gravity}, peaks of {self.peaks}, {sense}"


BLIND = Variant()
"""The baseline model; fixed before the first comparison was run."""


def variants() -> list[Variant]:
    """Return every variant of joints, P-Delta, peaks and polarity, the blind one first."""
    grid = product(("free_vibration", "sweep", "rigid"), (True, False), ("3.7", "7.1"), (1, -1))
    return [Variant(*settings) for settings in grid]  # type: ignore[arg-type]


def measured(source: str = "experiment") -> xr.DataArray:
    """Return the printed peaks [mm] over place, record and side; `numerical` are SAP2000's."""
    printed = published.table("4.1").xs(source, axis=1, level="source")
    frame, floor = (printed.index.get_level_values(level).to_numpy() for level in ("frame", "floor"))
    values = printed[list(product(RECORDS, SIDES))].to_numpy(dtype=float)
    coords = {"place": [f"{a} floor {b}" for a, b in zip(frame, floor, strict=True)], "record": list(RECORDS)}
    return xr.DataArray(
        values.reshape(-1, len(RECORDS), len(SIDES)),
        coords | {"side": list(SIDES), "frame": ("place", frame), "floor": ("place", floor)},
        ("place", "record", "side"),
        attrs={"units": "mm"},
    )


def build(name: str, variant: Variant) -> frames.ReducedFrame:
    """Return a frame as a variant believes it; without P-Delta the joints are fitted without it."""
    known, p_delta, damping = thesis_frame(name), variant.p_delta, variant.damping
    if variant.joints == "rigid":
        return frames.build(known, joints="rigid", p_delta=p_delta, damping=damping)
    frame = known if p_delta else _fitted_without_gravity(name, variant.joints)
    return frames.build(frame, p_delta=p_delta, damping=damping, calibration=variant.joints)


@cache
def _fitted_without_gravity(name: str, calibration: str) -> PlateFrame:
    return calibrated(thesis_frame(name), calibration, p_delta=False)


def table_motion(name: str, variant: Variant, folder: Path | None = None) -> Record:
    """Return a record as the table ran it in a variant: time compressed, peak and polarity as wanted.

    Args:
        name: Name of the record.
        variant: What is believed of the test.
        folder: Folder with ground motions; None for the default.
    """
    pga = None if variant.peaks == "3.7" else float(published.table("7.1")["pga_g"][name])
    record = find(name, folder).scaled(THESIS.time_factor, pga_g=pga)
    record = record.resampled(record.step_s / np.ceil(record.step_s / MODEL_STEP_S))
    return record if variant.polarity > 0 else record.flipped()


def floor_peaks(reduced: frames.ReducedFrame, record: Record, floors: Sequence[int]) -> NDArray[np.float64]:
    """Return the largest and the size of the smallest relative displacement of floors (floors, 2) [mm].

    Args:
        reduced: The frame.
        record: Table motion at the frame's scale.
        floors: Floor numbers, from 1.
    """
    columns = [int(reduced.floor_x[floor - 1]) for floor in floors]
    displacement, _ = linear_response(reduced, record.acceleration_m_s2, record.step_s, outputs=columns)
    return 1e3 * np.stack([displacement.max(axis=0), -displacement.min(axis=0)], axis=1)


def predict(variant: Variant, folder: Path | None = None) -> xr.DataArray:
    """Return the 64 peaks of a variant [mm], in the layout of `measured`."""
    motions = {name: table_motion(name, variant, folder) for name in RECORDS}
    peaks = xr.full_like(measured(), np.nan)
    for frame in FRAMES:
        reduced = build(frame, variant)
        rows = np.flatnonzero(peaks.frame == frame)
        for column, name in enumerate(RECORDS):
            peaks[rows, column] = floor_peaks(reduced, motions[name], peaks.floor[rows].values.tolist())
    return peaks


def predict_in(state: State, folder: Path | None = None, damping: float | None = None) -> xr.DataArray:
    """Return the 64 peaks of the frames in a state [mm], in the layout of `measured`.

    Args:
        state: The state.
        folder: Folder with ground motions; None for the default.
        damping: Damping ratio of all modes [-] in the place of the state's.
    """
    peaks = xr.full_like(measured(), np.nan)
    for column, record in enumerate(RECORDS):
        motion = table_motion(record, BLIND, folder)
        for frame in FRAMES:
            (chosen,) = states_of([frame], state, record, damping=damping)
            rows = np.flatnonzero(peaks.frame == frame)
            peaks[rows, column] = floor_peaks(built_in(chosen), motion, peaks.floor[rows].values.tolist())
    return peaks


def trusted() -> xr.DataArray:
    """Return False where the thesis' own tables contradict a peak (`consistency.contested`)."""
    blamed = consistency.contested(consistency.check_published())
    array = measured()
    flags = [[(f, r) not in blamed for r in array.record.values] for f in array.frame.values]
    return xr.DataArray(
        flags, coords={"place": array.place, "record": array.record}, dims=("place", "record")
    )


def errors(computed: xr.DataArray) -> xr.DataArray:
    """Return (computed - measured) / measured for every peak [-]."""
    truth = measured()
    return (computed - truth) / truth


@dataclass(frozen=True)
class Score:
    """How far 64 peaks, or the uncontested of them, are from the measured.

    Attributes:
        mean: Mean of the sizes of the relative errors [-].
        median: Their median [-].
        worst: The largest of them [-].
        bias: Mean of the errors with their sign [-]; positive where the model moves more.
        count: Number of peaks.
    """

    mean: float
    median: float
    worst: float
    bias: float
    count: int


def score(computed: xr.DataArray, where: xr.DataArray | None = None) -> Score:
    """Return how far computed peaks are from the measured, everywhere or where told."""
    error = errors(computed)
    values = (error if where is None else error.where(where)).values.ravel()
    values = values[np.isfinite(values)]
    size = np.abs(values)
    return Score(
        float(size.mean()), float(np.median(size)), float(size.max()), float(values.mean()), len(values)
    )


def noise_of_sides(computed: xr.DataArray, truth: xr.DataArray, where: xr.DataArray) -> float:
    """Return the mean size of the error of a single peak [-] that the two sides of a floor do not share.

    A frame that moves too far does so to both sides, so the ratio of both peaks has little of a model's error, and the
    noise of two measured peaks. What it differs by is the noise and the model's error in that ratio together: an upper
    limit of noise that is independent from peak to peak. Noise that both sides share is not in it.

    Args:
        computed: Peaks by a model [mm], with the sides `max` and `min`.
        truth: The measured peaks [mm].
        where: Which floors and records are used.
    """
    ours, theirs = (peaks.sel(side="max") / peaks.sel(side="min") for peaks in (computed, truth))
    off = np.log((ours / theirs).where(where).values)
    return float(np.nanmean(np.abs(off)) / np.sqrt(2.0))


def compare(folder: Path | None = None, console: Console | None = None) -> xr.Dataset:
    """Return all variants' peaks [mm] and those in strong motion beside the measured and SAP2000's, with what is trusted.

    Args:
        folder: Folder with ground motions; None for the default.
        console: Where progress is shown; nowhere when None.
    """
    chosen = variants()
    shown = track(chosen, "variants of the model", console=console, transient=True, disable=console is None)
    computed = xr.concat([predict(variant, folder) for variant in shown], dim="variant", join="exact")
    settings = pd.DataFrame([asdict(variant) | {"name": str(variant)} for variant in chosen])
    extra = {key: ("variant", settings[key].astype(str).to_numpy()) for key in settings if key != "damping"}
    return xr.Dataset(
        {
            "computed": computed.assign_coords(extra),
            "strong_motion": predict_in("strong-motion", folder),
            "measured": measured(),
            "sap2000": measured("numerical"),
            "trusted": trusted(),
        }
    )


def scores(data: xr.Dataset) -> pd.DataFrame:
    """Return the score of SAP2000, of strong motion and of every variant, with and without the contested peaks."""
    rows = {"SAP2000 (printed)": data.sap2000, f"strong motion, {FITTED}": data.strong_motion}
    rows |= {str(name): data.computed[index] for index, name in enumerate(data.name.values)}
    found = {}
    for name, computed in rows.items():
        every, some = score(computed), score(computed, data.trusted)
        sides = noise_of_sides(computed, data.measured, data.trusted)
        found[name] = {f"{k}_all": v for k, v in asdict(every).items()} | asdict(some) | {"sides": sides}
    return pd.DataFrame(found).T


def peaks_table(data: xr.Dataset) -> pd.DataFrame:
    """Return a row for each of the 64 peaks: measured, SAP2000's, the blind model's and strong motion's with errors."""
    blind = data.computed[0]
    columns = {
        "measured_mm": data.measured,
        "sap2000_mm": data.sap2000,
        "computed_mm": blind,
        "error": errors(blind),
        "strong_motion_mm": data.strong_motion,
        "strong_motion_error": errors(data.strong_motion),
    }
    frame = xr.Dataset(columns).assign(trusted=data.trusted).to_dataframe()
    return frame[[*columns, "trusted"]].reset_index()


def show(data: xr.Dataset) -> Iterable[Any]:
    """Return the tables for a reader: the blind model's 64 peaks, then the scores of all variants."""
    rows = [
        [
            *(row[key] for key in ("place", "record", "side")),
            *(f"{row[key]:.1f}" for key in ("measured_mm", "sap2000_mm", "computed_mm")),
            f"{100 * row['error']:+.0f}",
            f"{row['strong_motion_mm']:.1f}",
            f"{100 * row['strong_motion_error']:+.0f}",
            "" if row["trusted"] else "contested",
        ]
        for row in peaks_table(data).to_dict("records")
    ]
    yield table(
        f"Table 4.1 [mm], ours: {BLIND} (blind); strong motion is {FITTED}",
        ["place", "record", "side", "measured", "SAP2000", "ours", "%", "strong", "%", ""],
        rows,
    )
    keys = ("mean_all", "worst_all", "bias_all", "mean", "worst", "bias", "sides")
    lines = [[str(name), *(f"{100 * row[key]:.1f}" for key in keys)] for name, row in scores(data).iterrows()]
    heads = ["variant", "mean", "worst", "bias", "mean*", "worst*", "bias*", "not shared*"]
    title = "|ours - measured| / measured [%], of all 64 peaks; * without the contested; not shared by both sides of a floor"
    yield table(title, heads, lines)


def main(
    *, records: options.Records = None, json: options.Json = False, out: options.Out = None
) -> dict[str, Any]:
    """Compare 64 peaks of frames that shake alone with Table 4.1, in all variants."""
    data = compare(records, progress_console())
    strong = [states_of([name], "strong-motion")[0].as_dict() for name in FRAMES]
    settings = {
        "blind": asdict(BLIND),
        "variants": [str(name) for name in data.name.values],
        "states": strong,
    }
    result = stamp(settings, [find(name, records) for name in RECORDS])
    result |= {"peaks": peaks_table(data).to_dict("records")}
    result |= {"scores": [{"variant": name} | dict(row) for name, row in scores(data).iterrows()]}
    if out is not None:
        save(data, out / "table_4_1.nc")
        picture(data, out / "table-4-1.png")
    emit(result, as_json=json, show=lambda: show(data))
    return result


if __name__ == "__main__":
    run_script(main)
