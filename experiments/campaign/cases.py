"""The thesis' pounding tests as cases for sweeps: 20 of chapter 5 and 12 of chapter 6.

Each case is given by names and numbers alone, so that processes and clusters can run it. All records keep the
sign they are stored with; `flip` gives the other.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding.contact.laws import BUILT_IN, Law
from pounding.contact.parameters import STIFFNESS_SETS, thesis_law, viscoelastic_of
from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contact_choice import ContactWish, chosen_parameters
from pounding.experiments.rig.impacts import SAMPLE_RATE_HZ, all_impacts
from pounding.experiments.rig.motion import turning_points
from pounding.experiments.rig.pounding import Pounding, built, built_in, floor_masses, pound, shaking
from pounding.experiments.rig.required_gap import contact_floors, pair_gap
from pounding.experiments.rig.rig import Rig, Solver
from pounding.experiments.rig.states import FREE_VIBRATION, State, states_of
from pounding.experiments.rig.table_scale import table_scale
from pounding.experiments.sweeps.sweep import sweep
from pounding.frames.response.stress import largest_stress

if TYPE_CHECKING:
    from pounding.experiments.records import Record
    from pounding.frames.reduction.reduced_frame import ReducedFrame

LAWS = BUILT_IN
OTHER_MERGING_MS = (5, 10, 50)
"""Merging times to show how much the counts depend on it [ms]."""

WINDOW_S = 0.03
"""Length of the interval of figure 6.10 [s]: it holds the first impact."""


@dataclasses.dataclass(frozen=True)
class Trial:
    """One test of the laboratory.

    Attributes:
        left, right: Frames; the left one moves in +x towards the right one.
        record: Ground motion.
        gap_mm: Gap of the test [mm].
        required_mm: Gap that the laboratory found to be required (Table 4.2) [mm].
    """

    left: str
    right: str
    record: str
    gap_mm: float
    required_mm: float

    @property
    def fraction(self) -> float:
        """Gap over the laboratory's required gap; above 1 it should not have pounded."""
        return self.gap_mm / self.required_mm

    def own_gap_mm(self, folder: str | None = None) -> float:
        """Return the same fraction of our own required gap [mm]."""
        return self.fraction * own_required_mm(self.left, self.right, self.record, folder)


def chapter_5() -> list[Trial]:
    """Return the 20 tests of section 5.2.2, each record's widest gap first."""
    rows = published.table("section 5.2.2")["gap_mm"]
    return [_test(left, right, record, gap) for (left, right, record, _), gap in rows.items()]


def chapter_6() -> list[Trial]:
    """Return the 12 tests of section 6.3.2."""
    rows = published.table("section 6.3.2")["gap_mm"]
    return [_test(left, right, record, gap) for (left, right, record), gap in rows.items()]


def _test(left: str, right: str, record: str, gap: float) -> Trial:
    floors = published.table("4.2").sort_index().xs((left, right))
    return Trial(left, right, record, float(gap), float(floors[record, "experiment"].iloc[0]))


@lru_cache(maxsize=64)
def own_required_mm(
    left: str, right: str, record: str, folder: str | None = None, flip: bool = False
) -> float:
    """Return the required gap of our model [mm]: the largest closing motion without pounding.

    Args:
        left: Name of the frame on the left.
        right: Name of the frame on the right.
        record: Name of the ground motion.
        folder: Folder with ground motions.
        flip: Turn the record's sign.
    """
    pair = built(left), built(right)
    return 1e3 * pair_gap(*pair, _shaken(pair, record, folder, flip)).closing_m


def run_case(
    left: str,
    right: str,
    record: str,
    law: str,
    gap_mm: float,
    *,
    contact: str = "printed",
    contact_stiffness: float = 1.0,
    frame_stiffness: float = 1.0,
    frame_damping: float = 1.0,
    flip: bool = False,
    tension: bool = False,
    state: State = FREE_VIBRATION,
    folder: str = "",
    solver: Solver = "exact",
) -> dict[str, Any]:
    """Run one case, for `pounding.experiments.sweeps.sweep.sweep`.

    Args:
        left, right, record, law: Names.
        gap_mm: Gap at the lower frame's roof [mm].
        contact: Parameter set of the law, or a row of Table 5.1 for the linear viscoelastic law.
        contact_stiffness, frame_stiffness, frame_damping: Factors on the contact's stiffness, on both
            frames' stiffness and on both frames' damping.
        flip: Turn the record's sign.
        tension: May the contact pull?
        state: State of the frames, see `states_of`.
        folder: Folder of records; the usual places when empty.
        solver: `exact` or `exudyn`, see `Rig.run`.

    Returns:
        `count` and `touches`; `merged_5_ms` and its like, counts at other merging times; `peak_force_n`,
        `first_peak_n`, `first_time_s` (NaN without an impact); `closest_mm`, the smallest gap left (negative:
        the deepest overlap); `energy_error`, `wall_s`, `processor_s`, `model_s`; `impacts` and `peaks` as JSON text; and
        `first_force` (sample,) [N], the first impact at 10,000 samples a second.
    """
    first_frame, second_frame = (
        _changed(built_in(one), frame_stiffness, frame_damping)
        for one in states_of([left, right], state, record)
    )
    defined = [frame.definition for frame in (first_frame, second_frame)]
    chosen_parameters(defined, table_scale(defined), ContactWish([law], "printed"))  # refuses another scale
    chosen = _law(law, contact, floor_masses(first_frame, second_frame), tension)
    chosen = dataclasses.replace(chosen, stiffness=contact_stiffness * chosen.stiffness)
    shaken = _shaken((first_frame, second_frame), record, folder, flip)
    found = pound(first_frame, second_frame, shaken, chosen, 1e-3 * gap_mm, solver=solver)
    first = found.impacts[0] if found.impacts else None
    return {
        "count": len(found.impacts),
        "touches": sum(impact.touches for impact in found.impacts),
        **{f"merged_{ms}_ms": len(all_impacts(found.motion, merging_s=1e-3 * ms)) for ms in OTHER_MERGING_MS},
        "peak_force_n": max((impact.peak_force_n for impact in found.impacts), default=0.0),
        "first_peak_n": first.peak_force_n if first else np.nan,
        "first_time_s": first.time_s if first else np.nan,
        "closest_mm": -1e3 * float(found.motion.contacts[0].deformation_m.max()),
        "energy_error": found.motion.energy.error,
        "wall_s": found.motion.wall_s,
        "processor_s": found.motion.processor_s,
        "model_s": found.motion.model_s,
        "impacts": json.dumps([impact.as_dict() for impact in found.impacts]),
        "peaks": json.dumps(found.result()["peaks"]),
        "first_force": _first_force(found),
    }


def run_apart(
    left: str,
    right: str,
    record: str,
    *,
    flip: bool = False,
    state: State = FREE_VIBRATION,
    folder: str = "",
    solver: Solver = "exact",
) -> dict[str, Any]:
    """Run two frames without contact, for sweeps.

    Args:
        left: Name of the frame on the left.
        right: Name of the frame on the right.
        record: Name of the ground motion.
        flip: Turn the record's sign.
        state: State of the frames, see `states_of`.
        folder: Folder with ground motions; empty for the default.
        solver: `exact` or `exudyn`, see `Rig.run`.

    Returns:
        `peaks` as JSON text, and the largest motions towards each other (`closing_mm`, the required gap) and away from
        each other (`opening_mm`) of the floors that can meet.
    """
    one, other = (built_in(chosen) for chosen in states_of([left, right], state, record))
    at_left, at_right = contact_floors(one, other)
    first, second = Rig([one, other]).run(_shaken((one, other), record, folder, flip), solver=solver).frames
    closing = first.floor_displacement(at_left) - second.floor_displacement(at_right)
    rate = first.velocity_m_s[:, first.floor(at_left)] - second.velocity_m_s[:, second.floor(at_right)]
    apart = turning_points(first.time_s, closing, rate)
    return {
        "peaks": json.dumps({"left": first.peaks(), "right": second.peaks()}),
        "closing_mm": 1e3 * max(0.0, float(apart.max())),
        "opening_mm": 1e3 * max(0.0, -float(apart.min())),
    }


def run_alone(
    frame: str, record: str, *, state: State = FREE_VIBRATION, folder: str = "", solver: Solver = "exact"
) -> dict[str, Any]:
    """Run one frame, for sweeps; returns `peaks` as JSON text and `max_stress_mpa` (von Mises, without gravity).

    Args:
        frame: Name of the frame.
        record: Name of the ground motion.
        state: State of the frame, see `states_of`.
        folder: Folder with ground motions; empty for the default.
        solver: `exact` or `exudyn`, see `Rig.run`.
    """
    (chosen,) = states_of([frame], state, record)
    reduced = built_in(chosen)
    (moved,) = Rig([reduced]).run(_shaken((reduced,), record, folder), solver=solver).frames
    stress = largest_stress(reduced, moved.displacement_m)
    return {"peaks": json.dumps(moved.peaks()), "max_stress_mpa": stress.stress_pa / 1e6}


def run_all(
    cases: Iterable[dict[str, Any]],
    *,
    folder: Path | str | None = None,
    kept: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    solver: Solver = "exact",
) -> pd.DataFrame:
    """Run cases of `run_case` in processes and return one row a case, its arguments and its results.

    Args:
        cases: Arguments of `run_case`; those left out have their defaults.
        folder: Records.
        kept: Folder for finished cases, from which an interrupted campaign goes on.
        workers, scheduler: See `sweep`.
        solver: `exact` or `exudyn`; `engine_check` runs a sample of the former by the latter.

    Raises:
        ExperimentError: A case failed; says which and why, when all others are finished.
    """
    rows = [DEFAULTS | case for case in cases]
    data = sweep(
        run_case,
        rows,
        settings={"folder": "" if folder is None else str(folder), "solver": solver},
        folder=kept,
        workers=workers,
        scheduler=scheduler,
    )
    return frame_of(data)


DEFAULTS: dict[str, Any] = {
    "contact": "printed",
    "contact_stiffness": 1.0,
    "frame_stiffness": 1.0,
    "frame_damping": 1.0,
    "flip": False,
    "tension": False,
    "state": FREE_VIBRATION,
}


def frame_of(data: xr.Dataset) -> pd.DataFrame:
    """Return a sweep over cases as one row a case; raises `ExperimentError` if one of them failed."""
    failed = [str(reason) for reason in data["failure"].values if reason]
    if failed:
        raise ExperimentError(f"{len(failed)} of {data.sizes['case']} runs failed; the first: {failed[0]}")
    flat = data[[name for name in data.data_vars if data[name].dims == ("case",)]]
    table = flat.to_dataframe().reset_index(drop=True)
    if "first_force" in data:
        table["first_force"] = list(data["first_force"].values)
    return table


def peaks_table(text: str) -> pd.DataFrame:
    """Return the peaks of a case (JSON text) indexed by side and floor."""
    sides = json.loads(text)
    found = pd.concat({side: pd.DataFrame(rows).set_index("floor") for side, rows in sides.items()})
    found.index.names = ["side", "floor"]
    found["displacement_mm"] = found[["max_mm", "min_mm"]].max(axis=1)
    return found


def _shaken(frames: Sequence[ReducedFrame], record: str, folder: str | None, flip: bool = False) -> Record:
    factor = table_scale([frame.definition for frame in frames]).time_factor
    return shaking(record, folder or None, time_factor=factor, flip=flip)


def _law(name: str, contact: str, masses: tuple[float, float], tension: bool) -> Law:
    if contact in STIFFNESS_SETS:
        return viscoelastic_of(contact, tension=tension)
    return thesis_law(name, contact, masses=masses, tension=tension)


def _changed(frame: ReducedFrame, stiffness: float, damping: float) -> ReducedFrame:
    if stiffness == 1.0 and damping == 1.0:
        return frame
    return dataclasses.replace(frame, stiffness=stiffness * frame.stiffness, damping=damping * frame.damping)


def _first_force(found: Pounding) -> xr.DataArray:
    samples = np.arange(round(WINDOW_S * SAMPLE_RATE_HZ))
    force = np.zeros(len(samples))
    if found.impacts:
        history = found.motion.contacts[0]
        times = found.impacts[0].time_s - 1e-3 + samples / SAMPLE_RATE_HZ
        force = history.at(np.clip(times, history.time_s[0], history.time_s[-1]))[2].astype(np.float64)
    return xr.DataArray(force, {"sample": samples}, ("sample",))
