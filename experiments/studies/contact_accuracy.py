"""What the default accuracy of colliding runs leaves: chapter 6's tests against tighter runs.

Each test runs with each law at the same fraction of our own required gap (at 0.9 of it where the laboratory
tested at or beyond it, so that all collide) and is compared, impact by impact, with a run at tolerances a
hundred times tighter, with one that keeps modes up to four times the frequency, and with one whose gap is a
micrometre wider: where that alone moves an impact out of the bar, a finer model cannot bring it back in. A
case has converged if it has the same number of impacts, and all of them agree to 1 % of peak force, 0.1 ms
and 0.5 % of impulse. Run it with ``pounding study contact-accuracy``.
"""

from __future__ import annotations

import json as json_text
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from cyclopts import Parameter

from pounding import frames
from pounding.contact.parameters import thesis_law
from pounding.experiments.campaign.cases import LAWS, chapter_6, frame_of
from pounding.experiments.campaign.tables import label
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.impacts import Impact
from pounding.experiments.rig.pounding import Pounding, floor_masses, pound, shaking
from pounding.experiments.rig.rig import COLLIDING, Accuracy, Solver
from pounding.experiments.studies.shared import Kept, Workers, cell, keyed, write_tables
from pounding.experiments.sweeps.sweep import sweep

REFERENCE = Accuracy(1e-10, 1e-12, 2e-4)
KEEP_HZ = 1200.0
WIDER_MM = 1e-3
COMPARISONS = ("step", "modes", "gap", "exact")
PEAK, TIME_S, IMPULSE = 0.01, 1e-4, 0.005
LARGEST_FRACTION = 0.9


def main(
    *,
    out: options.Out = None,
    records: options.Records = None,
    kept: Kept = None,
    workers: Workers = None,
    duration_s: Annotated[float, Parameter(help="Model time of each run [s].")] = 6.0,
    only: Annotated[
        list[str] | None, Parameter(help="A case as in the tables, repeatable; all if none.")
    ] = None,
    json: options.Json = False,
) -> None:
    """Accuracy of colliding runs, in step and in the number of modes kept.

    Args:
        out: Folder for the tables as CSV.
    """
    result, tables = study(records, kept=kept, workers=workers, duration_s=duration_s, only=only)
    if out is not None:
        write_tables(tables, out)
    emit(result, as_json=json, show=lambda: show(tables))


def study(
    records: Path | None = None,
    *,
    kept: Path | None = None,
    workers: int | None = None,
    duration_s: float = 6.0,
    laws: Iterable[str] = LAWS,
    only: Iterable[str] | None = None,
) -> tuple[dict[str, Any], dict[str, pd.DataFrame]]:
    """Return the stamped result and its tables by name; `only` names cases as in the tables.

    Args:
        records: Folder with ground motions; None for the default.
        kept: Folder for finished cases.
        workers: Processes; one a core when None.
        duration_s: Model time of each run [s].
        laws: Names of the impact laws.
        only: Cases as they are called in the tables; all when None.
    """
    folder = "" if records is None else str(records)
    wanted = None if only is None else set(only)
    tests = [t for t in chapter_6() if wanted is None or label(t.left, t.right, t.record) in wanted]
    cases = []
    for test in tests:
        gap = test.own_gap_mm(folder or None) * min(1.0, LARGEST_FRACTION / test.fraction)
        names = {"left": test.left, "right": test.right, "record": test.record, "gap_mm": gap}
        cases += [names | {"law": law} for law in laws]
    settings = {"duration_s": duration_s, "folder": folder}
    runs = frame_of(sweep(compare, cases, settings=settings, folder=kept, workers=workers))
    runs.insert(0, "case", [label(*row) for row in runs[["left", "right", "record"]].itertuples(index=False)])
    runs = runs.drop(columns=["left", "right", "record"])
    tables = {name: _table(runs, name) for name in COMPARISONS}
    tables["summary"] = summary(tables)
    result = stamp({"reference": list(REFERENCE), "default": list(COLLIDING), "duration_s": duration_s})
    return result | {name: keyed(found) for name, found in tables.items()}, tables


def compare(
    left: str, right: str, record: str, law: str, gap_mm: float, *, duration_s: float, folder: str = ""
) -> dict[str, Any]:
    """Return the comparisons of one case, for `sweep`: each of `COMPARISONS` as JSON text.

    Args:
        left: Name of the frame on the left.
        right: Name of the frame on the right.
        record: Name of the ground motion.
        law: Name of the impact law.
        gap_mm: Gap at rest [mm].
        duration_s: Model time of the run [s].
        folder: Folder with ground motions; empty for the default.
    """
    default, tight = (
        _pounded((left, right), None, record, law, gap_mm, accuracy, duration_s, folder)
        for accuracy in (COLLIDING, REFERENCE)
    )
    modes = _pounded((left, right), KEEP_HZ, record, law, gap_mm, COLLIDING, duration_s, folder)
    wider = _pounded((left, right), None, record, law, gap_mm + WIDER_MM, COLLIDING, duration_s, folder)
    exact = _pounded((left, right), None, record, law, gap_mm, None, duration_s, folder)
    return {
        "step": json_text.dumps(beside(default, tight)),
        "modes": json_text.dumps(beside(default, modes)),
        "gap": json_text.dumps(beside(default, wider)),
        "exact": json_text.dumps(beside(exact, tight)),
    }


@lru_cache(maxsize=16)
def _built(name: str, keep_hz: float | None) -> frames.ReducedFrame:
    return frames.build(frames.load(name), keep_hz=keep_hz)


def _pounded(
    names: tuple[str, str],
    keep_hz: float | None,
    record: str,
    law: str,
    gap_mm: float,
    accuracy: Accuracy | None,
    duration_s: float,
    folder: str,
) -> Pounding:
    """Return a run by exudyn at an accuracy, or by the exact solver where that is None."""
    pair = _built(names[0], keep_hz), _built(names[1], keep_hz)
    masses = floor_masses(_built(names[0], None), _built(names[1], None))
    chosen = thesis_law(law, masses=masses)
    shaken = shaking(record, folder or None)
    end = min(duration_s, shaken.duration_s)
    solver: Solver = "exact" if accuracy is None else "exudyn"
    return pound(*pair, shaken, chosen, 1e-3 * gap_mm, accuracy=accuracy, duration_s=end, solver=solver)


def beside(run: Pounding, tighter: Pounding) -> dict[str, Any]:
    """Return how the impacts, the touches and the floors' peaks of two runs agree, and the first one's energy error."""
    return compared(run.impacts, tighter.impacts) | {
        "displacement": _displaced(run, tighter),
        "touches": sum(one.touches for one in run.impacts),
        "touches_reference": sum(one.touches for one in tighter.impacts),
        "energy": run.motion.energy.error,
    }


def compared(found: list[Impact], reference: list[Impact]) -> dict[str, Any]:
    """Return how impacts agree, in order, as far as both runs have them."""
    peak, time, impulse, good = [], [], [], 0
    for one, other in zip(found, reference, strict=False):
        peak.append(abs(one.peak_force_n / other.peak_force_n - 1))
        time.append(abs(one.time_s - other.time_s))
        impulse.append(abs(one.impulse_n_s / other.impulse_n_s - 1))
        within = peak[-1] <= PEAK and time[-1] <= TIME_S and impulse[-1] <= IMPULSE
        good += within and good == len(peak) - 1
    return {
        "impacts": len(found),
        "impacts_reference": len(reference),
        "agree": int(good),
        "peak": max(peak, default=0.0),
        "time_ms": 1e3 * max(time, default=0.0),
        "impulse": max(impulse, default=0.0),
        "first_peak": peak[0] if peak else 0.0,
        "first_impulse": impulse[0] if impulse else 0.0,
        "converged": bool(good == len(found) == len(reference)),
    }


def _displaced(run: Pounding, tighter: Pounding) -> float:
    """Return the largest relative difference of a floor's largest displacement, either way."""
    worst = 0.0
    for frame, other in zip(run.motion.frames, tighter.motion.frames, strict=True):
        for mine, theirs in zip(frame.peaks(), other.peaks(), strict=True):
            worst = max(worst, *(abs(mine[key] / theirs[key] - 1.0) for key in ("max_mm", "min_mm")))
    return worst


def _table(runs: pd.DataFrame, name: str) -> pd.DataFrame:
    found = pd.DataFrame([json_text.loads(text) for text in runs[name]])
    return pd.concat([runs[["case", "law"]].reset_index(drop=True), found], axis=1)


def summary(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Return counts and largest errors of each comparison's table."""
    rows = {}
    for name, found in tables.items():
        good = found[found["converged"]]
        rows[name] = {
            "cases": len(found),
            "converged": int(found["converged"].sum()),
            "impacts": int(found["impacts"].sum()),
            "impacts that agree": int(found["agree"].sum()),
            "largest peak error of the converged": max(good["peak"], default=0.0),
            "largest time error of the converged [ms]": max(good["time_ms"], default=0.0),
            "largest impulse error of the converged": max(good["impulse"], default=0.0),
            "largest peak error of a first impact": max(found["first_peak"], default=0.0),
            "largest impulse error of a first impact": max(found["first_impulse"], default=0.0),
            "largest displacement error of the converged": max(good["displacement"], default=0.0),
            "converged with the same number of touches": int(
                (good["touches"] == good["touches_reference"]).sum()
            ),
            "largest energy error": max(found["energy"], default=0.0),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("against")


def show(tables: dict[str, pd.DataFrame]) -> Iterable[Any]:
    """Return the summary, and the cases that did not converge by name, for a reader."""
    summary = tables["summary"].reset_index()
    yield table("summary", [str(c) for c in summary], [[cell(v) for v in row] for row in summary.to_numpy()])
    for name in COMPARISONS:
        rest = tables[name][~tables[name]["converged"]]
        rows = [[cell(value) for value in row] for row in rest.to_numpy()]
        yield table(f"{name}: cases that did not converge", [str(column) for column in rest], rows)


if __name__ == "__main__":
    run_script(main)
