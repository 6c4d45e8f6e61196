"""Motions of the runs of a filtered model, from which signatures are made."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, assembly_of, tangents_of
from pounding.diagnosis.model.kalman import linear_system
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion


def motions(model: Model, filtered: Filtered) -> list[Motion]:
    """Return the motion of each run of a baseline, as predicted and as filtered."""
    return [motion_of(model, filtered, number) for number in range(len(filtered.runs))]


def motion_of(model: Model, filtered: Filtered, number: int) -> Motion:
    """Return the motion of a run of a baseline, as predicted and as filtered.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
    """
    modes, assembly = filtered.run_modes[number], assembly_of(model, filtered, number)
    seen = _Seen.of(model, assembly, filtered.runs[number], filtered.prediction.outputs[number])
    predicted_pushes, pushes, pushing = _pushes(model, filtered, number, assembly, seen)
    start = _motion(model, modes, filtered.prediction.after[number], seen, pushes, pushing)
    predicted = _motion(model, modes, filtered.prediction.before[number], seen, predicted_pushes, pushing)
    if not model.observed.contact_floors:
        # A table hardly moves the modes that are fast against a sample: slopes are as good with straight lines
        # (tests/diagnosis/model/test_signatures.py), and these take a quarter less time.
        return replace(predicted, start=start)
    bent = _bent(model, filtered, number, assembly)
    states = _between(filtered, number, seen.run.step_s)
    between = _motion(model, modes, states, seen, bent, np.zeros_like(bent))
    return replace(predicted, start=start, between=between)


@dataclass(frozen=True)
class _Seen:
    """A run as table and sensors have it, with the gains, offsets, delays and clocks that act.

    Attributes:
        run: The run.
        table: Acceleration of the table at the samples [m/s^2], shape (samples,).
        table_read, table_slope, outputs, reads: Of `Motion`.
    """

    run: RunData
    table: np.ndarray
    table_read: np.ndarray
    table_slope: np.ndarray
    outputs: np.ndarray
    reads: np.ndarray

    @classmethod
    def of(cls, model: Model, assembly: Assembly, number: int, read: np.ndarray) -> _Seen:
        """Return it from what the channels of a run read as predicted, shape (samples, channels)."""
        run = model.observed.runs[number]
        at = np.arange(len(run.table)) * run.step_s
        table = model.table_at(replace(assembly, table_gain=0.0), number, at)
        reads = 1.0 + assembly.channel_gain
        return cls(
            run=run,
            table=(1.0 + assembly.table_gain) * table,
            table_read=table,
            table_slope=model.table_slope(assembly, number, at),
            outputs=(read - assembly.channel_offset) / reads,
            reads=reads,
        )


def _pushes(
    model: Model, filtered: Filtered, number: int, assembly: Assembly, seen: _Seen
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return modal forces of contacts and laws in a run, each (samples, modes): as predicted, as left, and their rate."""
    run, modes, before = filtered.runs[number], filtered.run_modes[number], filtered.prediction.before[number]
    data, n = seen.run, len(modes.omega)
    known, rate = np.zeros((len(before), n)), np.zeros((len(before), n))
    at, near = np.arange(len(before)) * data.step_s, data.step_s / data.substeps
    for column, (left, right) in enumerate(model.observed.contact_floors):
        direction = modes.floors[right] - modes.floors[left]
        late, here, early = (model.contact_force(assembly, run, column, at + by) for by in (near, 0.0, -near))
        known += np.outer(here, direction)
        rate += np.outer((late - early) / (2 * near), direction)
    laws = tangents_of(model, filtered, number)
    if laws is None:
        return known, known, rate
    predicted, left = (known - forces @ laws.rows for forces in (laws.forces[:, 0], laws.left))
    system = model.linear_system(modes)
    faster = before @ system.rate[n : 2 * n].T - np.outer(seen.table, modes.participation) + predicted
    for j, row in enumerate(laws.rows):
        by_drift, by_rate = laws.at_sample[:, j, 0], laws.at_sample[:, j, 1]
        rate -= np.outer(by_drift * (before[:, n : 2 * n] @ row) + by_rate * (faster @ row), row)
    return predicted, left, rate


def _bent(model: Model, filtered: Filtered, number: int, assembly: Assembly) -> np.ndarray:
    """Return what modal forces of contacts and laws have in the mean over each step beyond its ends, (samples, modes)."""
    run, modes = filtered.runs[number], filtered.run_modes[number]
    at, middle = model.observed.runs[run].instants
    pushes = np.zeros((len(at), len(modes.omega)))
    for column, (left, right) in enumerate(model.observed.contact_floors):
        mean = model.contact_force(assembly, run, column, middle).mean(axis=1)
        here = model.contact_force(assembly, run, column, at)
        pushes += np.outer(_beyond_ends(mean, here, here), modes.floors[right] - modes.floors[left])
    laws = tangents_of(model, filtered, number)
    if laws is not None:
        forces = _beyond_ends(laws.forces[:, 1:].mean(axis=1), laws.left, laws.forces[:, 0])
        pushes -= forces @ laws.rows
    return pushes


def _beyond_ends(mean: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return what the mean over the step after each sample has beyond that of the step's ends, shape of `mean`; 0 at last.

    Args:
        mean: The mean over the step after each sample, shape (samples, ...).
        start, end: What is at the start of the step after each sample, and at the end of the step before it, of that shape.
    """
    beyond = np.zeros_like(mean)
    beyond[:-1] = mean[:-1] - (start[:-1] + end[1:]) / 2
    return beyond


def _between(filtered: Filtered, number: int, step_s: float) -> np.ndarray:
    """Return what states have in the mean over each step beyond the mean of its ends, shape (samples, states).

    A displacement is a cubic that has the rates at both ends; the mean of a rate is how far it has moved.
    """
    after, before = filtered.prediction.after[number], filtered.prediction.before[number]
    n = len(filtered.run_modes[number].omega)
    moved, rate = slice(0, n), slice(n, 2 * n)
    beyond = np.zeros_like(after)
    beyond[:-1, moved] = step_s / 12 * (after[:-1, rate] - before[1:, rate])
    mean = np.zeros_like(after[:, rate])
    mean[:-1] = (before[1:, moved] - after[:-1, moved]) / step_s
    beyond[:, rate] = _beyond_ends(mean, after[:, rate], before[:, rate])
    return beyond


def _motion(
    model: Model,
    modes: Modes,
    states: np.ndarray,
    seen: _Seen,
    pushes: np.ndarray,
    pushing: np.ndarray,
) -> Motion:
    n = len(modes.omega)
    eta, rate = states[:, :n], states[:, n : 2 * n]
    floor, floor_rate = eta @ modes.floors.T, rate @ modes.floors.T
    drift = model.structure.drift
    return Motion(
        run=seen.run,
        eta=eta,
        eta_rate=rate,
        floor=floor,
        floor_rate=floor_rate,
        drift=floor @ drift.T,
        drift_rate=floor_rate @ drift.T,
        acceleration=_acceleration(model, modes, states) + pushes @ modes.floors.T,
        table_rate=states[:, -1],
        table_read=seen.table_read,
        table_slope=seen.table_slope,
        outputs=seen.outputs,
        reads=seen.reads,
        output_rate=_output_rate(model, modes, states, seen.table, pushes, pushing),
    )


def _acceleration(model: Model, modes: Modes, states: np.ndarray) -> np.ndarray:
    """Return the absolute acceleration of every floor for predicted states, shape (samples, floors)."""
    floors = np.arange(model.structure.floors)
    rows = model.structure.drift @ modes.floors
    system = linear_system(modes, rows, np.full(len(floors), ACCELERATION), floors)
    return np.asarray(states @ system.output.T)


def _output_rate(
    model: Model,
    modes: Modes,
    states: np.ndarray,
    table: np.ndarray,
    pushes: np.ndarray,
    pushing: np.ndarray,
) -> np.ndarray:
    """Return the rate of each channel that follows from state and forces alone, shape (samples, channels).

    A difference between predicted samples would hold the innovation that it is to be compared with.
    """
    system = model.linear_system(modes)
    by_table = system.output @ (system.force[:, :-1] @ modes.participation - system.force[:, -1])
    n = len(modes.omega)
    pushed = pushes @ system.output[:, n : 2 * n].T + pushing @ system.direct.T
    return np.asarray(states @ (system.output @ system.rate).T - np.outer(table, by_table) + pushed)
