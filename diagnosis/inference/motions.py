"""Motions of the runs of a filtered model, from which signatures are made."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, tangents_of
from pounding.diagnosis.model.kalman import linear_system
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion


def motions(model: Model, filtered: Filtered) -> list[Motion]:
    """Return the motion of each run of a baseline, as predicted and as filtered."""
    found = []
    for number, run in enumerate(filtered.runs):
        outputs, modes = filtered.prediction.outputs[number], filtered.run_modes[number]
        assembly = model.assemble(filtered.values, filtered.effects if model.acts(run) else ())
        reads = 1.0 + assembly.channel_gain
        with np.errstate(divide="ignore", invalid="ignore"):
            outputs = (outputs - assembly.channel_offset) / reads
        shaken = _Shaken.of(model, assembly, run)
        predicted_pushes, pushes, pushing = _pushes(model, filtered, number, assembly, shaken)
        start = _motion(model, modes, filtered.prediction.after[number], shaken, outputs, pushes, pushing)
        predicted = _motion(
            model, modes, filtered.prediction.before[number], shaken, outputs, predicted_pushes, pushing
        )
        found.append(replace(predicted, start=start, reads=reads))
    return found


@dataclass(frozen=True)
class _Shaken:
    """A run, and how the table shakes it with the gain, delay and clock that act.

    Attributes:
        run: The run.
        table: Acceleration of the table at the samples [m/s^2], shape (samples,). read, slope: Of `Motion`, of that shape.
    """

    run: RunData
    table: np.ndarray
    read: np.ndarray
    slope: np.ndarray

    @classmethod
    def of(cls, model: Model, assembly: Assembly, number: int) -> _Shaken:
        run = model.observed.runs[number]
        at = np.arange(len(run.table)) * run.step_s
        read = model.table_at(replace(assembly, table_gain=0.0), number, at)
        table = (1.0 + assembly.table_gain) * read
        return cls(run, table, read, model.table_slope(assembly, number, at))


def _pushes(
    model: Model, filtered: Filtered, number: int, assembly: Assembly, shaken: _Shaken
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return modal forces of contacts and laws in a run, each (samples, modes): as predicted, as left, and their rate."""
    run, modes, before = filtered.runs[number], filtered.run_modes[number], filtered.prediction.before[number]
    data, n = shaken.run, len(modes.omega)
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
    faster = before @ system.rate[n : 2 * n].T - np.outer(shaken.table, modes.participation) + predicted
    for j, row in enumerate(laws.rows):
        by_drift, by_rate = laws.at_sample[:, j, 0], laws.at_sample[:, j, 1]
        rate -= np.outer(by_drift * (before[:, n : 2 * n] @ row) + by_rate * (faster @ row), row)
    return predicted, left, rate


def _motion(
    model: Model,
    modes: Modes,
    states: np.ndarray,
    shaken: _Shaken,
    outputs: np.ndarray,
    pushes: np.ndarray,
    pushing: np.ndarray,
) -> Motion:
    n = len(modes.omega)
    eta, rate = states[:, :n], states[:, n : 2 * n]
    floor, floor_rate = eta @ modes.floors.T, rate @ modes.floors.T
    drift = model.structure.drift
    return Motion(
        run=shaken.run,
        eta=eta,
        eta_rate=rate,
        floor=floor,
        floor_rate=floor_rate,
        drift=floor @ drift.T,
        drift_rate=floor_rate @ drift.T,
        acceleration=_acceleration(model, modes, states) + pushes @ modes.floors.T,
        table_rate=states[:, -1],
        table_read=shaken.read,
        table_slope=shaken.slope,
        outputs=outputs,
        reads=np.ones(outputs.shape[1]),
        output_rate=_output_rate(model, modes, states, shaken.table, pushes, pushing),
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
