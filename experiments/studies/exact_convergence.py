"""How the exact solver's steps in contact converge, for each law: 15B beside 5B through their first collision.

All steps in contact are of one length, without error control, and halved from row to row; the finest is the reference.
Run it with ``pounding study exact-convergence``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd

from pounding.contact.parameters import PRINTED, thesis_law
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import ExactRig
from pounding.experiments.rig.pounding import built, floor_masses, shaking
from pounding.experiments.studies.shared import cell, keyed, write_tables

mpl.use("Agg")
from matplotlib import pyplot as plt

RECORD, GAP_M, FLOOR = "elcentro", 9.5e-3, 5
LEVELS = range(4, 10)
REFERENCE_LEVEL = 13
AFTER_S = 0.05
"""Model time after the first touch at which the runs are compared [s]."""


def main(*, out: options.Out = None, records: options.Records = None, json: options.Json = False) -> None:
    """Convergence of the exact solver's steps in contact, law by law.

    Args:
        out: Folder for the table as CSV and its picture; none are written without it.
    """
    result, found = study(records)
    if out is not None:
        write_tables({"convergence": found}, out)
        picture(found, out / "exact-convergence.png")
    emit(result, as_json=json, show=lambda: show(found))


def study(records: Path | None = None) -> tuple[dict[str, Any], pd.DataFrame]:
    """Return the stamped result and its table: error of a velocity and the order, for each law and step.

    Args:
        records: Folder with ground motions; None for the default.
    """
    pair = built("15B"), built("5B")
    shaken = shaking(RECORD, None if records is None else str(records))
    rows = []
    for name in PRINTED:
        law = thesis_law(name, masses=floor_masses(*pair, FLOOR))
        rig = ExactRig(pair, [Contact(law, GAP_M, FLOOR)])
        first = rig.solve(shaken.acceleration_m_s2, shaken.step_s)
        end = float(first.time_s[np.flatnonzero(first.forces[:, 0] > 0.0)[0]]) + AFTER_S

        def run(level: int, rig: ExactRig = rig, end: float = end) -> tuple[float, float]:
            solution = rig.solve(shaken.acceleration_m_s2, shaken.step_s, duration_s=end, contact_level=level)
            touching = solution.forces[:, 0] > 0.0
            step = float(np.median(np.diff(solution.time_s)[touching[:-1]]))
            _, rate = rig.coordinates(solution, 1, [pair[1].floor_x[FLOOR - 1]])
            return step, float(rate[-1, 0])

        _, velocity = run(REFERENCE_LEVEL)
        before = np.nan
        for level in LEVELS:
            step, found_velocity = run(level)
            error = abs(found_velocity / velocity - 1.0)
            rows.append(
                {
                    "law": name,
                    "step_us": 1e6 * step,
                    "velocity_error": error,
                    "order": np.log2(before / error),
                }
            )
            before = error
    found = pd.DataFrame(rows)
    return stamp({"record": RECORD, "gap_m": GAP_M, "after_s": AFTER_S}, [shaken]) | {
        "convergence": keyed(found)
    }, found


def picture(found: pd.DataFrame, path: Path) -> None:
    """Draw the error over the step, with a line of fourth order.

    Args:
        found: Table of `study`.
        path: PNG file.
    """
    figure, place = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
    for marker, (name, rows) in zip("osd^v", found.groupby("law", sort=False), strict=False):
        place.loglog(rows["step_us"], rows["velocity_error"], marker + "-", label=str(name).replace("_", " "))
    steps = np.array([found["step_us"].min(), found["step_us"].max()])
    place.loglog(steps, 1e-6 * (steps / steps[1]) ** 4, "k--", label="fourth order")
    place.set_xlabel("step in contact, microseconds")
    place.set_ylabel(f"relative error of a velocity {1e3 * AFTER_S:.0f} ms after the touch")
    ticks = sorted({round(float(step), 1) for step in found["step_us"]})
    place.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    place.minorticks_off()
    place.grid(alpha=0.3)
    figure.legend(loc="outside right upper")
    figure.savefig(path, dpi=120)
    plt.close(figure)


def show(found: pd.DataFrame) -> Iterable[Any]:
    """Return the table for a reader."""
    rows = [[cell(value) for value in row] for row in found.to_numpy()]
    yield table("Steps in contact of the exact solver", [str(column) for column in found], rows)


if __name__ == "__main__":
    run_script(main)
