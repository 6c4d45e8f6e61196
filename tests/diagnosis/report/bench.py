"""The bench of `tests.diagnosis.models` as a case with sensors, for what a report says of findings on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.decision.conclusion import of_frames
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.inference.findings import Findings
from tests.diagnosis.models import STEP_S


def channels() -> tuple[Channel, ...]:
    return (
        Channel("table", "table_acceleration", "m/s^2"),
        *(Channel(f"a{i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)),
        *(Channel(f"d{i}", "relative_displacement", "m", frame="bench", floor=i) for i in (1, 3)),
    )


def diagnosed(found: Findings) -> Diagnosis:
    """Return the diagnosis that rests on findings on the bench."""
    runs = tuple(
        Run(run.name, None, run.time_s, STEP_S, np.column_stack([run.table, run.measured]))
        for run in found.model.observed.runs
    )
    frame = CaseFrame(
        "bench",
        3,
        storey_height_m=0.2,
        floor_mass_kg=(6.5, 6.5, 6.5),
        frequency_hz=(6.806,),
        damping_ratio=(0.01,),
    )
    case = Case("bench", Path("bench"), (frame,), runs, channels())
    decision = decide(found)
    return Diagnosis(case, found, decision, of_frames(case, found, decision))
