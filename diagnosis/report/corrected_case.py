"""The measurements without the faults that were found in sensors and table, as a case of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.case.case import Case, Run
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.shifting import shift


def corrected_case(case: Case, observed: Observations, faults: Assembly) -> Case | None:
    """Return a case without the gain, offset, delay and clock of its sensors and its table; None where they have none.

    Args:
        case: The case as measured.
        observed: Its observations, whose channels the assembly counts.
        faults: The baseline model with the effects in it and its nuisance parameters at rest.
    """
    channels = {
        case.channel_index(name): number
        for number, name in enumerate(observed.names)
        if _faulty(faults, number)
    }
    if not channels and not (faults.table_gain or faults.table_delay_s or faults.table_clock):
        return None
    runs = tuple(_corrected(case, run, channels, faults) for run in case.runs)
    return replace(case, title=f"{case.title}, sensors and table corrected", runs=runs)


def _faulty(faults: Assembly, channel: int) -> bool:
    each = (faults.channel_gain, faults.channel_offset, faults.channel_delay_s, faults.channel_clock)
    return any(one[channel] != 0.0 for one in each)


def _corrected(case: Case, run: Run, channels: dict[int, int], faults: Assembly) -> Run:
    # A reference run is of the frame, and the sensors, as they were before.
    if run.reference:
        return run
    values = run.values.copy()
    for column, channel in channels.items():
        late, clock = float(faults.channel_delay_s[channel]), float(faults.channel_clock[channel])
        series = shift(values[:, column], run.step_s, late, clock) if late or clock else values[:, column]
        values[:, column] = (series - faults.channel_offset[channel]) / (1.0 + faults.channel_gain[channel])
    table = _table_column(case, run)
    moved = values[:, table]
    if faults.table_delay_s or faults.table_clock:
        moved = shift(moved, run.step_s, -faults.table_delay_s, faults.table_clock)
    values[:, table] = (1.0 + faults.table_gain) * moved
    return replace(run, values=values)


def _table_column(case: Case, run: Run) -> int:
    """Return the column that says how the table moved: its acceleration, or else its displacement."""
    live = np.isfinite(run.values).sum(axis=0) > 10
    accelerations = [i for i, one in enumerate(case.channels) if one.is_table_acceleration and live[i]]
    others = [i for i, one in enumerate(case.channels) if one.is_table and live[i]]
    return [*accelerations, *others][0]
