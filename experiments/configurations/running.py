"""Running one configuration: what the verbs `modal`, `shake`, `pound` and `gap` would do, with what the entry says.

Each kind of test gives the same thing: numbers, rows beside what was measured, warnings, and a function that writes
its files.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from pounding.contact.laws import Law
from pounding.contact.parameters import thesis_law, viscoelastic_of
from pounding.experiments.configurations import laboratory_motion, measured
from pounding.experiments.configurations.definition import (
    Alone,
    AnyExperiment,
    Apart,
    Collision,
    ContactStiffness,
    Experiment,
    FreeVibration,
    Push,
    Shaken,
    SineSweep,
)
from pounding.experiments.configurations.measured import Row
from pounding.experiments.errors import ExperimentError
from pounding.experiments.output import collision_folder, result_folder
from pounding.experiments.output.result_folder import Kept
from pounding.experiments.pictures import laboratory_plots, plots, scenes
from pounding.experiments.pictures.series import write_series
from pounding.experiments.records import Record
from pounding.experiments.results import dataset as results
from pounding.experiments.rig.impacts import Impact
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.pounding import Pounding, built_in, floor_masses, pound, shaking
from pounding.experiments.rig.required_gap import contact_floors, pair_gap
from pounding.experiments.rig.shaking import shake
from pounding.experiments.rig.states import FrameState, State, states_of
from pounding.experiments.separation import pictures as gap_pictures
from pounding.experiments.separation.gaps.gap import history
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response import laboratory

JUST_APART = 1.01
"""Gap of a pair that shall not touch, over the gap that it needs."""

Told = Callable[[str, float], None]


def _nobody(_what: str, _share: float) -> None:
    """Tell nobody how far it is."""


@dataclass(frozen=True)
class Conditions:
    """With what a configuration is run, beside its entry.

    Attributes:
        records: Folder with ground motions; None for the default.
        record: Ground motion in the place of the entry's.
        state: State of the frames, see `states_of`; None for free vibration.
        progress: Called with what is being done and the share of it that is done.
        unit: Unit of acceleration of a ground motion's file that names none.
    """

    records: str | None = None
    record: str | None = None
    state: State | None = None
    progress: Told = _nobody
    unit: str | None = None


@dataclass(frozen=True)
class Outcome:
    """What a configuration gave.

    Attributes:
        experiment: The configuration.
        numbers: Results, units in the keys.
        rows: What was measured, beside ours.
        warnings: Sentences on what the model leaves its validity by, and on what cannot be compared.
        motions: The ground motions at model scale.
        states: The states of the frames, from left to right.
        write: Writes files into a folder, given the whole result.
    """

    experiment: AnyExperiment
    numbers: dict[str, Any]
    rows: list[Row]
    warnings: list[str]
    motions: list[Record]
    states: tuple[FrameState, ...]
    write: Callable[[dict[str, Any], Path], Kept]


def run(experiment: AnyExperiment, conditions: Conditions = Conditions()) -> Outcome:
    """Run a configuration.

    Args:
        experiment: The configuration.
        conditions: With what.

    Raises:
        ExperimentError: Its record is not there, or it has none and one is asked for; or its frames have no such state.
        FrameError: A frame cannot be built.
    """
    if conditions.record is not None and not isinstance(experiment, Shaken):
        raise ExperimentError(f"experiment '{experiment.name}' has no ground motion; leave out the record")
    if conditions.state == "strong-motion" and not isinstance(experiment, Shaken):
        raise ExperimentError(
            f"experiment '{experiment.name}' has no ground motion, and so no strong-motion state; "
            "take --state sweep or free-vibration"
        )
    outcome = _KINDS[type(experiment)](experiment, conditions)
    if conditions.record in (None, experiment.motion):
        return outcome
    said = f"what was measured under '{experiment.motion}' is not comparable with a run under '{conditions.record}'"
    rows = [row.without_measured() for row in outcome.rows]
    return replace(outcome, rows=rows, warnings=[*outcome.warnings, said])


def motion_of(experiment: Shaken, conditions: Conditions) -> Record:
    """Return the ground motion of a configuration at model scale.

    Args:
        experiment: The configuration.
        conditions: May name another one, and a folder.
    """
    return shaking(conditions.record or experiment.record, conditions.records, unit=conditions.unit)


def states(experiment: Experiment, conditions: Conditions) -> tuple[FrameState, ...]:
    """Return the states of the frames of a configuration, from left to right.

    Args:
        experiment: The configuration.
        conditions: May name a state and another ground motion.
    """
    return states_of(experiment.frame_names, conditions.state, conditions.record or experiment.motion)


def _free_vibration(experiment: FreeVibration, conditions: Conditions) -> Outcome:
    reduced = _only_frame(experiment, conditions)
    test = laboratory.free_vibration_test(reduced, displacement_m=laboratory_motion.RELEASE_M)
    frequency, damping = test.reading
    histories = {"roof_acceleration": (test.acceleration_m_s2, "m/s^2")}
    return _laboratory(
        experiment,
        conditions,
        {"frequency_hz": frequency, "damping_ratio": damping},
        measured.free_vibration(experiment, frequency, damping),
        _histories("time", test.time_s, "s", histories),
        laboratory_motion.decay_motion(reduced),
        partial(laboratory_plots.free_vibration, reduced.name, test),
    )


def _push(experiment: Push, conditions: Conditions) -> Outcome:
    reduced = _only_frame(experiment, conditions)
    test = laboratory.push_test(reduced)
    return _laboratory(
        experiment,
        conditions,
        {"roof_stiffness_n_per_mm": test.stiffness_n_per_m / 1e3},
        measured.push(experiment, test.stiffness_n_per_m),
        _histories("load", test.force_n, "N", {"roof_deflection": (test.deflection_m, "m")}),
        laboratory_motion.push_motion(reduced, test),
        partial(laboratory_plots.push, reduced.name, test),
    )


def _sweep(experiment: SineSweep, conditions: Conditions) -> Outcome:
    reduced = _only_frame(experiment, conditions)
    test = laboratory.sine_sweep_test(reduced)
    frequencies = [reading.frequency_hz for reading in test.readings]
    histories = {
        "table_acceleration": (test.table_m_s2, "m/s^2"),
        "roof_acceleration": (test.roof_m_s2, "m/s^2"),
        "roof_displacement": (test.roof_displacement_m, "m"),
    }
    return _laboratory(
        experiment,
        conditions,
        {
            "frequencies_hz": frequencies,
            "damping_ratios": [reading.damping_ratio for reading in test.readings],
        },
        measured.sine_sweep(experiment, frequencies),
        _histories("time", test.time_s, "s", histories),
        laboratory_motion.sweep_motion(reduced, test),
        partial(laboratory_plots.sine_sweep, reduced.name, test),
    )


def _laboratory(
    experiment: AnyExperiment,
    conditions: Conditions,
    numbers: dict[str, Any],
    rows: list[Row],
    data: xr.Dataset,
    motion: Motion,
    plot: Callable[[Path], object],
) -> Outcome:
    """Return the outcome of a test whose frame is drawn where its roof has moved most."""

    def write(_result: dict[str, Any], folder: Path) -> Kept:
        conditions.progress("writing", 0.0)
        results.save(data, folder / "histories.nc")
        plot(folder / "test.png")
        write_series(motion, motion.time_s, folder / "series.pvd")
        reason = cannot_render()
        if reason is None:
            scenes.picture(motion, folder / "peak.png", title=experiment.title)
        pictures = [] if reason else ["peak.png"]
        return Kept(["histories.nc", "test.png", "series.pvd", *pictures], [reason] if reason else [])

    return Outcome(experiment, numbers, rows, [], [], states(experiment, conditions), write)


def _alone(experiment: Alone, conditions: Conditions) -> Outcome:
    reduced, record = _only_frame(experiment, conditions), motion_of(experiment, conditions)
    done = shake(reduced, record, progress=_clock("shaking", record, conditions))
    numbers = done.result()
    title = f"Frame {reduced.name}, {record.name}, {record.pga_g:.3f} g"

    def write(result: dict[str, Any], folder: Path) -> Kept:
        data = results.dataset(done.motion, record, provenance=result)
        kept = result_folder.keep(
            done,
            data,
            _stamped(result) | result["result"],
            folder,
            progress=conditions.progress,
        )
        plots.roof_acceleration(data, folder / "acceleration.png", frame=reduced.name, title=title)
        return Kept([*kept.files, "acceleration.png"], kept.notes)

    rows = measured.alone(experiment, experiment.record, numbers["peaks"])
    return Outcome(
        experiment, numbers, rows, list(done.warnings), [record], states(experiment, conditions), write
    )


def _apart(experiment: Apart, conditions: Conditions) -> Outcome:
    left, right = _pair(experiment, conditions)
    record = motion_of(experiment, conditions)
    needed = pair_gap(left, right, record)
    gap_m = JUST_APART * needed.closing_m
    law = thesis_law("linear_viscoelastic")
    done = pound(left, right, record, law, gap_m, progress=_clock("shaking", record, conditions))
    peaks = {"left": 1e3 * needed.left_peak_m, "right": 1e3 * needed.right_peak_m}
    ours = {
        "gap": 1e3 * needed.closing_m,
        "equation 4.1": 1e3 * needed.equation_4_1_m,
        "ABS": sum(peaks.values()),
        "SRSS": math.hypot(*peaks.values()),
    }
    numbers: dict[str, Any] = {
        "left": left.name,
        "right": right.name,
        "record": record.name,
        "floor": min(contact_floors(left, right)),
        "required_gap_mm": ours["gap"],
        "reversed_mm": 1e3 * needed.opening_m,
        "equation_4_1_mm": ours["equation 4.1"],
        "time_s": needed.time_s,
        "peak_mm": peaks,
        "run": done.result() | done.validity(),
    }
    touched = [f"at {JUST_APART:g} times the required gap the floors touched"] if done.impacts else []

    def write(result: dict[str, Any], folder: Path) -> Kept:
        conditions.progress("writing", 0.0)
        kept = collision_folder.keep([done], _stamped(result) | {"runs": [result["result"]["run"]]}, folder)
        figure = gap_pictures.gap_history(*history(left, right, record), numbers)
        gap_pictures.save(figure, folder / "gap.png")
        return Kept([*kept.files, "gap.png"], kept.notes)

    rows = measured.apart(experiment, experiment.record, ours)
    warnings = [*numbers["run"]["warnings"], *touched]
    return Outcome(experiment, numbers, rows, warnings, [record], states(experiment, conditions), write)


def _collision(experiment: Collision, conditions: Conditions) -> Outcome:
    masses = floor_masses(*_pair(experiment, conditions))
    return _collided(
        experiment, {name: thesis_law(name, masses=masses) for name in experiment.laws}, conditions
    )


def _stiffness(experiment: ContactStiffness, conditions: Conditions) -> Outcome:
    return _collided(
        experiment, {source: viscoelastic_of(source) for source in experiment.sources}, conditions
    )


def _collided(
    experiment: Collision | ContactStiffness, laws: Mapping[str, Law], conditions: Conditions
) -> Outcome:
    """Return the outcome of the same collision with several laws, by what they are called."""
    left, right = _pair(experiment, conditions)
    record = motion_of(experiment, conditions)
    runs: dict[str, Pounding] = {}
    for name, law in laws.items():
        told = _clock(name, record, conditions)
        runs[name] = pound(left, right, record, law, 1e-3 * experiment.gap_mm, progress=told)
    numbers = {name: done.result() | done.validity() for name, done in runs.items()}
    short = {name: _of_impacts(done.impacts) for name, done in runs.items()}

    def write(result: dict[str, Any], folder: Path) -> Kept:
        conditions.progress("writing", 0.0)
        whole = _stamped(result) | {"runs": list(result["result"]["runs"].values())}
        return collision_folder.keep(list(runs.values()), whole, folder, labels=list(runs))

    warnings = [f"{name}: {one}" for name, found in numbers.items() for one in found["warnings"]]
    rows = measured.collision(experiment, experiment.record, short)
    return Outcome(
        experiment, {"runs": numbers}, rows, warnings, [record], states(experiment, conditions), write
    )


def _of_impacts(impacts: list[Impact]) -> dict[str, Any]:
    """Return what `measured.collision` asks of a run; restitution and duration of its single touches."""
    ratios = [ratio for one in impacts for ratio in one.touch_restitutions if ratio is not None]
    return {
        "impacts": len(impacts),
        "peak_force_n": max((one.peak_force_n for one in impacts), default=0.0),
        "touches": float(sum(one.touches for one in impacts)),
        "longest_touch_ms": max((one.longest_touch_ms for one in impacts), default=0.0),
        "touch_restitution": float(np.median(ratios)) if ratios else None,
    }


def _stamped(result: dict[str, Any]) -> dict[str, Any]:
    """Return the stamp of a result, with which the files of `pounding shake` and `pounding pound` begin."""
    return {key: result[key] for key in ("schema", "software", "version", "parameters", "records")}


def _clock(what: str, record: Record, conditions: Conditions) -> Callable[[float], None]:
    """Return what a run calls with its model time [s]."""
    return lambda time_s: conditions.progress(what, time_s / record.duration_s)


def _only_frame(experiment: Experiment, conditions: Conditions) -> ReducedFrame:
    return built_in(states(experiment, conditions)[0])


def _pair(experiment: Experiment, conditions: Conditions) -> tuple[ReducedFrame, ReducedFrame]:
    left, right = states(experiment, conditions)
    return built_in(left), built_in(right)


def _histories(
    axis: str, values: np.ndarray, unit: str, columns: Mapping[str, tuple[np.ndarray, str]]
) -> xr.Dataset:
    """Return histories over one axis with their units."""
    return xr.Dataset(
        {name: (axis, column, {"units": its}) for name, (column, its) in columns.items()},
        {axis: (axis, values, {"units": unit})},
    )


_KINDS: dict[type[Experiment], Callable[[Any, Conditions], Outcome]] = {
    FreeVibration: _free_vibration,
    Push: _push,
    SineSweep: _sweep,
    Alone: _alone,
    Apart: _apart,
    Collision: _collision,
    ContactStiffness: _stiffness,
}
