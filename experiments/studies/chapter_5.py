"""Chapter 5 of the thesis: 15B beside 5B, 20 gaps under four records, five contact stiffnesses.

The linear viscoelastic law with each row of Table 5.1, at the laboratory's gap and at the same fraction of
our own required gap. The thesis judges the five values by measured peak forces, which stood in figures and
are lost; what is left to say is how much the choice matters. Run it with ``pounding study chapter-5``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pounding.contact.laws import BUILT_IN, Law
from pounding.contact.parameters import STIFFNESS_SETS, thesis_law, viscoelastic_of
from pounding.experiments.campaign.cases import Trial, chapter_5, run_all
from pounding.experiments.campaign.one_motion import laser_limits, on_one_motion
from pounding.experiments.campaign.tables import case
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.pictures import contact_plots as plots_contact
from pounding.experiments.records import RECORDS
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.impacts import MERGING_S, SAMPLE_RATE_HZ, THRESHOLD_N
from pounding.experiments.rig.pounding import built, pound, shaking
from pounding.experiments.rig.rig import Solver
from pounding.experiments.studies.shared import Kept, Workers, engine_check, keyed, said, write_tables

SOURCES = tuple(STIFFNESS_SETS)
REFERENCE = "experiment"
SHOWN = ("elcentro", 9.5)
"""Record and gap [mm] of the pictures."""


def main(
    *,
    out: options.Out = None,
    records: options.Records = None,
    kept: Kept = None,
    workers: Workers = None,
    solver: options.Solver = "exact",
    json: options.Json = False,
) -> None:
    """Peak forces of 15B beside 5B for 20 gaps and the five contact stiffnesses of Table 5.1.

    Args:
        out: Folder for tables (CSV) and pictures; none are written without it.
    """
    result, tables = study(records, kept=kept, workers=workers, solver=solver)
    if out is not None:
        write_tables(tables, out)
        pictures(tables, out, records)
    emit(result, as_json=json, show=lambda: [*show(tables), *said(result["engine_check"])])


def study(
    records: Path | None = None,
    *,
    kept: Path | None = None,
    workers: int | None = None,
    solver: Solver = "exact",
    tests: list[Trial] | None = None,
) -> tuple[dict[str, Any], dict[str, pd.DataFrame]]:
    """Return the stamped result and its tables by name.

    Args:
        records: Folder of records; the usual places when None.
        kept: Folder for finished cases.
        workers: Processes.
        solver: `exact`, of which exudyn runs a sample again, or `exudyn`.
        tests: Tests to run; all 20 when None.
    """
    tests = chapter_5() if tests is None else tests
    folder = None if records is None else str(records)
    own = [test.own_gap_mm(folder) for test in tests]
    at_laboratory = [case(t, t.gap_mm, contact=source) for t in tests for source in SOURCES]
    at_fraction = [
        case(t, gap, contact=source) for t, gap in zip(tests, own, strict=True) for source in SOURCES
    ]
    flipped = [case(test, test.gap_mm, flip=True) for test in tests]
    cases = at_laboratory + at_fraction + flipped
    runs = run_all(cases, folder=records, kept=kept, workers=workers, solver=solver)
    first, second = len(at_laboratory), len(at_laboratory) + len(at_fraction)
    parts = {"laboratory_gap": runs.iloc[:first], "same_fraction": runs.iloc[first:second]}
    tables: dict[str, pd.DataFrame] = {}
    for name, part in parts.items():
        tables[f"impacts_{name}"] = _wide(part, "count").astype(int)
        tables[f"peak_force_{name}"] = _wide(part, "peak_force_n")
        tables[f"first_peak_{name}"] = _wide(part, "first_peak_n")
        tables[f"spread_{name}"] = spread(tables[f"first_peak_{name}"], tables[f"peak_force_{name}"])
    tables["laser_limits"] = laser_limits(
        tables["first_peak_same_fraction"][REFERENCE].dropna(), STIFFNESS_SETS[REFERENCE][0]
    )
    tables["one_motion"] = one_motion(records)
    tables["flipped"] = runs.iloc[second:][["record", "gap_mm", "count", "peak_force_n"]].reset_index(
        drop=True
    )
    result = stamp(
        {"threshold_n": THRESHOLD_N, "merging_s": MERGING_S, "sample_rate_hz": SAMPLE_RATE_HZ},
        [shaking(name, folder) for name in dict.fromkeys(test.record for test in tests)],
    )
    result |= {
        "runs": len(runs),
        "model_s": float(runs["model_s"].sum()),
        "wall_s": float(runs["wall_s"].sum()),
        "energy_error": float(runs["energy_error"].max()),
        "engine_check": engine_check(cases, runs, solver, records, kept, workers),
    }
    return result | {name: keyed(frame) for name, frame in tables.items()}, tables


def one_motion(records: Path | None = None) -> pd.DataFrame:
    """Return each stiffness and each law on the motion of one run, beside a run of its own.

    The motion is that of the experiment's stiffness in the test that the pictures show.

    Args:
        records: Folder of records; the usual places when None.
    """
    record, gap = SHOWN
    shaken = shaking(record, None if records is None else str(records))
    pair = built("15B"), built("5B")
    laws: dict[str, Law] = {source: viscoelastic_of(source) for source in SOURCES}
    laws |= {name: thesis_law(name) for name in BUILT_IN}
    runs = {
        name: pound(*pair, shaken, law, 1e-3 * gap, solver="exact").motion.contacts[0]
        for name, law in laws.items()
    }
    own = [on_one_motion(history, {name: laws[name]}) for name, history in runs.items()]
    return on_one_motion(runs[REFERENCE], laws).join(pd.concat(own).add_suffix("_of_its_own_run"))


def spread(first_peak: pd.DataFrame, peak: pd.DataFrame) -> pd.DataFrame:
    """Return, for each stiffness, how its peaks compare with those of the experiment's stiffness.

    Equation 5.1's relative difference, with our run at the experiment's stiffness in the place of the lost
    measurement; beside it, what the square root of the stiffness alone gives for two free bodies.
    """
    rows = {}
    for source in first_peak.columns:
        ratio = (first_peak[source] / first_peak[REFERENCE]).dropna()
        largest = (peak[source] / peak[REFERENCE]).replace([np.inf, -np.inf], np.nan).dropna()
        rows[source] = {
            "stiffness_n_per_mm": STIFFNESS_SETS[source][0] / 1e3,
            "square_root_of_stiffness": np.sqrt(STIFFNESS_SETS[source][0] / STIFFNESS_SETS[REFERENCE][0]),
            "first_peak_mean_ratio": ratio.mean(),
            "first_peak_lowest": ratio.min(),
            "first_peak_highest": ratio.max(),
            "first_peak_percent_error": 100 * (ratio - 1).abs().mean(),
            "largest_peak_lowest": largest.min(),
            "largest_peak_highest": largest.max(),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("stiffness")


def pictures(tables: dict[str, pd.DataFrame], out: Path, records: Path | None = None) -> None:
    """Write the map of the peak force, and histories and loops of one case, into a folder.

    Args:
        tables: The study's tables by name.
        out: Folder for the pictures.
        records: Folder with ground motions; None for the default.
    """
    for name in ("laboratory_gap", "same_fraction"):
        column = tables[f"peak_force_{name}"][REFERENCE]
        rows = {
            record: {f"{gap:.1f}": float(force) for gap, force in column.loc[record].items()}
            for record in RECORDS
            if record in column.index.get_level_values("record")
        }
        title = f"15B beside 5B, linear viscoelastic, {name.replace('_', ' ')}"
        plots_contact.peak_map(rows, out / f"peak_force_{name}.png", title=title)
    record, gap = SHOWN
    shaken = shaking(record, None if records is None else str(records))
    runs = [
        pound(built("15B"), built("5B"), shaken, viscoelastic_of(source), 1e-3 * gap, duration_s=2.0)
        for source in SOURCES
    ]
    labels = [
        f"{source.replace('_', ' ')}, {STIFFNESS_SETS[source][0] / 1e6:.4g} kN/mm" for source in SOURCES
    ]
    plots_contact.force_histories(runs, out / "stiffness_forces.png", labels=labels)
    plots_contact.loops(runs, out / "stiffness_loops.png", labels=labels)


def show(tables: dict[str, pd.DataFrame]) -> Iterable[Any]:
    """Return the tables for a reader."""
    for name, frame in tables.items():
        flat = frame.reset_index()
        rows = [
            [f"{v:.4g}" if isinstance(v, float) else str(v) for v in row]
            for row in flat.itertuples(index=False)
        ]
        yield table(name.replace("_", " "), [str(column) for column in flat.columns], rows)


def _wide(runs: pd.DataFrame, value: str) -> pd.DataFrame:
    wide = runs.pivot(index=["record", "gap_mm"], columns="contact", values=value)
    order = list(dict.fromkeys(zip(runs["record"], runs["gap_mm"], strict=True)))
    return wide.reindex(
        index=pd.MultiIndex.from_tuples(order, names=["record", "gap_mm"]), columns=list(SOURCES)
    )


if __name__ == "__main__":
    run_script(main)
