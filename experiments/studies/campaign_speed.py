"""How long the campaign takes: 32 tests with five laws at the laboratory's gaps, 160 runs through the sweep.

Run it with ``pounding study campaign-speed``. Processor time is what the machine's two cores have to give: half
of it is the wall time on a machine that does nothing else.
"""

from __future__ import annotations

import resource
import time
from pathlib import Path
from typing import Any

from pounding.experiments.campaign.cases import LAWS, chapter_5, chapter_6, run_all
from pounding.experiments.campaign.tables import case
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.rig.rig import Solver
from pounding.experiments.studies.shared import Kept, Workers, engine_check, said


def main(
    *,
    records: options.Records = None,
    kept: Kept = None,
    workers: Workers = 2,
    solver: options.Solver = "exact",
    json: options.Json = False,
) -> None:
    """Wall time of the 160 runs on two cores."""
    result = study(records, kept=kept, workers=workers, solver=solver)
    emit(result, as_json=json, show=lambda: [_sentence(result), *said(result["engine_check"])])


def study(
    records: Path | None = None,
    *,
    kept: Path | None = None,
    workers: int | None = 2,
    solver: Solver = "exact",
) -> dict[str, Any]:
    """Return the stamped result: runs, model, wall and processor time, largest energy error.

    `processor_s` is that of all processes, starting them and reading impacts and energies included;
    `integration_s` is the engine's share of it.

    Args:
        records: Folder with ground motions; None for the default.
        kept: Folder for finished cases.
        workers: Processes; one a core when None.
        solver: `exact`, of which exudyn runs a sample again outside the time, or `exudyn`.
    """
    tests = chapter_5() + chapter_6()
    cases = [case(test, test.gap_mm, law) for test in tests for law in LAWS]
    started, worked = time.perf_counter(), _processor_s()
    runs = run_all(cases, folder=records, kept=kept, workers=workers, solver=solver)
    wall_s, processor_s = time.perf_counter() - started, _processor_s() - worked
    folder = None if records is None else str(records)
    shaken = [shaking(name, folder) for name in dict.fromkeys(test.record for test in tests)]
    return stamp({"workers": workers}, shaken) | {
        "runs": len(runs),
        "model_s": float(runs["model_s"].sum()),
        "wall_s": wall_s,
        "processor_s": processor_s,
        "integration_s": float(runs["processor_s"].sum()),
        "energy_error": float(runs["energy_error"].max()),
        "solver": solver,
        "engine_check": engine_check(cases, runs, solver, folder, None, workers),
    }


def _processor_s() -> float:
    """Return the processor time [s] of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _sentence(result: dict[str, Any]) -> str:
    return (
        f"{result['runs']} runs by {result['solver']}, {result['model_s']:.0f} simulated s in {result['wall_s']:.0f} s "
        f"({result['processor_s']:.0f} s of CPU time, {result['integration_s']:.0f} s of it integration); "
        f"energy closes to {result['energy_error']:.1e}"
    )


if __name__ == "__main__":
    run_script(main)
