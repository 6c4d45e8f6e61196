"""How closely and how fast exudyn integrates a frame on the table, by integrator and step.

The reference is the exact response to the same piecewise linear acceleration (`frames.response.exact`). The error is
the largest difference at any sample of the record over the largest displacement, of the worst floor. Run it
with ``pounding study engine-accuracy``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter
from rich.progress import Progress

from pounding import frames
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.records import Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.rig import Accuracy, Rig
from pounding.frames.files import write_whole
from pounding.frames.response.body import run_alone
from pounding.frames.response.exact import linear_response
from pounding.scale import THESIS

TOLERANCE = 1e-3
"""Largest error that a kept displacement may have."""

FIXED = {
    "RK44": (5e-4, 2.5e-4, 1e-4),
    "DOPRI5": (5e-4, 2.5e-4),
    "ExplicitMidpoint": (1e-4, 5e-5),
    "VelocityVerlet": (1e-4, 5e-5, 2e-5),
    "GeneralizedAlpha": (5e-4, 1e-4, 5e-5),
    "TrapezoidalIndex2": (5e-4, 1e-4, 5e-5),
}
"""Fixed longest steps [s] tried with each integrator; the steps meet the samples of the record."""

ADAPTIVE = (1e-4, 1e-5, 1e-6)
"""Relative tolerances tried with the rig's adaptive integrator; its absolute one is a hundredth."""

MASSES_KG = (1e5, 1e6, 1e7, 1e8, 1e9, 1e10)
"""Masses of the table tried with the best fixed integrator."""

Step = Callable[[], None]


def fixed(reduced: frames.ReducedFrame, record: Record, *, step: Step = lambda: None) -> list[dict[str, Any]]:
    """Return error and cost of each integrator and fixed step of `FIXED`.

    Args:
        reduced: The frame.
        record: Table motion at the frame's scale.
        step: Called after each run.
    """
    rows = []
    for integrator, steps in FIXED.items():
        for longest in steps:
            rows.append(_fixed_row(reduced, record, integrator, longest))
            step()
    return rows


def adaptive(
    reduced: frames.ReducedFrame, record: Record, *, step: Step = lambda: None
) -> list[dict[str, Any]]:
    """Return error and cost of the rig's adaptive integrator at each tolerance of `ADAPTIVE`.

    Args:
        reduced: The frame.
        record: Table motion at the frame's scale.
        step: Called after each run.
    """
    rows = []
    for tolerance in ADAPTIVE:
        accuracy = Accuracy(relative=tolerance, absolute=1e-2 * tolerance)
        motion = Rig([reduced]).run(record, accuracy=accuracy)
        # The engine's clock may end a whisker before the record's.
        moved, _ = motion.frames[0].sampled(record.time_s.clip(max=motion.model_s))
        judged = _judged(reduced, record, moved, motion.steps, motion.wall_s)
        row = {"integrator": "DOPRI5, adaptive", "longest_step_s": accuracy.longest_step_s}
        rows.append(row | {"tolerance": tolerance} | judged)
        step()
    return rows


def table_mass(
    reduced: frames.ReducedFrame, record: Record, *, step: Step = lambda: None
) -> list[dict[str, Any]]:
    """Return the error that the table's finite mass leaves, with the classical Runge-Kutta method.

    Args:
        reduced: The frame.
        record: Table motion at the frame's scale.
        step: Called after each run.
    """
    rows = []
    for mass in MASSES_KG:
        rows.append({"table_mass_kg": mass} | _fixed_row(reduced, record, "RK44", 2.5e-4, table_mass_kg=mass))
        step()
    return rows


def main(
    *,
    names: Annotated[list[str] | None, Parameter(name="--frame", help="Frame, repeatable.")] = None,
    record: Annotated[str, Parameter(help="Ground motion by name or file.")] = "elcentro-peer180",
    records: options.Records = None,
    out: options.Out = None,
    json: options.Json = False,
) -> dict[str, Any]:
    """Measure error and cost of exudyn's integrators on a shaken frame, against the exact solution."""
    names = names or ["5A", "15B"]
    shaking = find(record, records).scaled(THESIS.time_factor)
    rows, masses = [], []
    count = len(names) * (sum(map(len, FIXED.values())) + len(ADAPTIVE) + len(MASSES_KG))
    with Progress(console=progress_console(), transient=True) as progress:
        task = progress.add_task("integrating", total=count)

        def step() -> None:
            progress.advance(task)

        for name in names:
            reduced = frames.build(frames.load(name))
            label = {"frame": name, "highest_hz": float(reduced.frequencies_hz.max())}
            found = fixed(reduced, shaking, step=step) + adaptive(reduced, shaking, step=step)
            rows += [label | row for row in found]
            masses += [{"frame": name} | row for row in table_mass(reduced, shaking, step=step)]
    result = stamp({"frames": names, "record": record, "tolerance": TOLERANCE}, [shaking])
    result |= {"integrators": rows, "table_masses": masses}
    if out is not None:
        write_whole(out / "engine_accuracy.csv", pd.DataFrame(rows).to_csv(index=False).encode())
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the tables of a result of `main` for a reader."""
    heads = ["integrator", "step or tolerance", "steps", "us a step", "wall s a model s", "error"]
    for name in result["parameters"]["frames"]:
        rows = [_cells(row) for row in result["integrators"] if row["frame"] == name]
        yield table(f"{name}: error of the worst floor displacement against the exact solution", heads, rows)
        masses = [row for row in result["table_masses"] if row["frame"] == name]
        cells = [[f"{row['table_mass_kg']:.0e}", _error(row["error"])] for row in masses]
        yield table(f"{name}: mass of the table (RK44, 0.25 ms)", ["mass kg", "error"], cells)
    yield f"asked for: at most {TOLERANCE:g} on every kept displacement"


def _fixed_row(
    reduced: frames.ReducedFrame,
    record: Record,
    integrator: str,
    longest_s: float,
    *,
    table_mass_kg: float | None = None,
) -> dict[str, Any]:
    row: dict[str, Any] = {"integrator": integrator, "longest_step_s": longest_s, "tolerance": None}
    try:
        done = run_alone(
            reduced,
            record.acceleration_m_s2,
            record.step_s,
            integrator=integrator,
            longest_step_s=longest_s,
            table_mass_kg=table_mass_kg,
        )
    except frames.FrameError as error:
        return row | {
            "steps": None,
            "wall_s": None,
            "wall_per_model_s": None,
            "error": None,
            "note": str(error),
        }
    return row | _judged(reduced, record, done.history.displacement, done.steps, done.wall_s)


def _judged(
    reduced: frames.ReducedFrame, record: Record, moved: Any, steps: int, wall_s: float
) -> dict[str, Any]:
    expected, _ = linear_response(reduced, record.acceleration_m_s2, record.step_s, outputs=reduced.floor_x)
    error = np.abs(moved[:, reduced.floor_x] - expected).max(axis=0) / np.abs(expected).max(axis=0)
    return {
        "steps": steps,
        "wall_s": wall_s,
        "wall_per_model_s": wall_s / record.duration_s,
        "error": float(error.max()),
    }


def _cells(row: dict[str, Any]) -> list[Any]:
    setting = f"{1e3 * row['longest_step_s']:g} ms" if row["tolerance"] is None else f"{row['tolerance']:.0e}"
    if row["error"] is None or row["error"] > 1.0:
        return [row["integrator"], setting, "-", "-", "-", "grew without bound"]
    return [
        row["integrator"],
        setting,
        f"{row['steps']}",
        f"{1e6 * row['wall_s'] / row['steps']:.1f}",
        f"{row['wall_per_model_s']:.3f}",
        _error(row["error"]),
    ]


def _error(error: float | None) -> str:
    if error is None:
        return "grew without bound"
    return f"{error:.1e}"


if __name__ == "__main__":
    run_script(main)
