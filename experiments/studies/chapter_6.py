"""Chapter 6 of the thesis: three pairs under four records with five impact laws, beside Table 6.2.

Each of the 12 tests runs at the laboratory's gap and at the same fraction of our own required gap, because a
model that needs another gap than the laboratory's shows no impact, or many, for that reason alone. The
measured force histories were figures and are lost; what is left of them are the counts behind Table 6.2.
Run it with ``pounding study chapter-6``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from pounding.experiments.campaign.cases import (
    LAWS,
    OTHER_MERGING_MS,
    Trial,
    chapter_6,
    frame_of,
    run_all,
    run_apart,
)
from pounding.experiments.campaign.dissimilarity import printed_values, rank_sums, ranking_table
from pounding.experiments.campaign.tables import (
    DEFAULT_LAW,
    KEY,
    agreement,
    band_cases,
    bands,
    by_law,
    case,
    counted,
    effect,
    effect_summary,
    first_impact_dissimilarity,
    ranking,
    requirements,
)
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.impacts import MERGING_S, SAMPLE_RATE_HZ, THRESHOLD_N
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.rig.rig import Solver
from pounding.experiments.studies.shared import Kept, Workers, cell, engine_check, keyed, said, write_tables
from pounding.experiments.sweeps.sweep import sweep


def main(
    *,
    out: options.Out = None,
    records: options.Records = None,
    kept: Kept = None,
    workers: Workers = None,
    solver: options.Solver = "exact",
    with_bands: bool = True,
    json: options.Json = False,
) -> None:
    """Impacts and forces of the 12 tests with five laws, beside the 40 impacts of Table 6.2.

    Args:
        out: Folder for the tables as CSV; none are written without it.
        with_bands: Also vary gap, damping and stiffness (96 more runs).
    """
    result, tables = study(records, kept=kept, workers=workers, solver=solver, with_bands=with_bands)
    if out is not None:
        write_tables(tables, out)
    emit(result, as_json=json, show=lambda: [*show(tables), *said(result["engine_check"])])


def study(
    records: Path | None = None,
    *,
    kept: Path | None = None,
    workers: int | None = None,
    solver: Solver = "exact",
    with_bands: bool = True,
    tests: list[Trial] | None = None,
) -> tuple[dict[str, Any], dict[str, pd.DataFrame]]:
    """Return the stamped result and its tables by name.

    Args:
        records: Folder of records; the usual places when None.
        kept: Folder for finished cases.
        workers: Processes.
        solver: `exact`, of which exudyn runs a sample again, or `exudyn`.
        with_bands: Whether gap, damping and stiffness are varied.
        tests: Tests to run; all 12 when None.
    """
    tests = chapter_6() if tests is None else tests
    folder = None if records is None else str(records)
    own = {test: test.own_gap_mm(folder) for test in tests}
    plan: dict[str, list[dict[str, Any]]] = {
        "laboratory": [case(test, test.gap_mm, law) for test in tests for law in LAWS],
        "own": [case(test, own[test], law) for test in tests for law in LAWS],
        "strong_motion": [
            case(test, test.gap_mm, law, state="strong-motion") for test in tests for law in LAWS
        ],
        "laboratory_flipped": [case(test, test.gap_mm, flip=True) for test in tests],
        "formula": [case(test, own[test], "hertz_damp", contact="formula") for test in tests],
        "tension": [case(test, own[test], tension=True) for test in tests],
        "bands": [one for test in tests for one in band_cases(test, own[test])] if with_bands else [],
    }
    all_cases = [one for cases in plan.values() for one in cases]
    everything = run_all(all_cases, folder=records, kept=kept, workers=workers, solver=solver)
    runs, start = {}, 0
    for name, cases in plan.items():
        runs[name] = everything.iloc[start : start + len(cases)]
        start += len(cases)
    apart = frame_of(
        sweep(
            run_apart,
            [{key: getattr(test, key) for key in KEY} for test in tests],
            settings={"folder": folder or "", "solver": solver},
            folder=kept,
            workers=workers,
        )
    )
    tables = _tables(tests, runs, apart, folder)
    result = stamp(
        {
            "threshold_n": THRESHOLD_N,
            "merging_s": MERGING_S,
            "sample_rate_hz": SAMPLE_RATE_HZ,
            "parameters": "printed",
            "bands": with_bands,
        },
        [shaking(name, folder) for name in dict.fromkeys(test.record for test in tests)],
    )
    result |= {
        "runs": len(everything),
        "model_s": float(everything["model_s"].sum()),
        "wall_s": float(everything["wall_s"].sum()),
        "energy_error": float(everything["energy_error"].max()),
        "engine_check": engine_check(all_cases, everything, solver, records, kept, workers),
        "table_6_3": rank_sums(printed_values(), list(printed_values().columns)),
    }
    return result | {name: keyed(frame) for name, frame in tables.items()}, tables


def _tables(
    tests: list[Trial], runs: dict[str, pd.DataFrame], apart: pd.DataFrame, folder: str | None
) -> dict[str, pd.DataFrame]:
    viscoelastic = runs["own"][runs["own"]["law"] == DEFAULT_LAW]
    hertz = first_impact_dissimilarity(runs["own"], runs["formula"])
    linear = first_impact_dissimilarity(runs["own"], runs["tension"])
    tables = {
        "requirements": requirements(tests, folder),
        "impacts_at_laboratory_gap": _beside(by_law(runs["laboratory"], "count")),
        "impacts_in_strong_motion_fitted_to_table_4_1": _beside(by_law(runs["strong_motion"], "count")),
        "sum_of_differences_at_laboratory_gap": pd.DataFrame(
            {
                "free vibration (blind)": _differences(runs["laboratory"]),
                "strong motion (fitted to Table 4.1)": _differences(runs["strong_motion"]),
            }
        ).rename_axis("law"),
        "impacts_at_same_fraction": _beside(by_law(runs["own"], "count")),
        "impacts_flipped": _beside(by_law(runs["laboratory_flipped"], "count")),
        "impacts_by_merging_time": _merging(runs["laboratory"]),
        "peak_force_at_laboratory_gap": by_law(runs["laboratory"], "peak_force_n"),
        "peak_force_at_same_fraction": by_law(runs["own"], "peak_force_n"),
        "agreement_of_laws": agreement(runs["own"]),
        "ranking": pd.DataFrame(
            {
                "Table 6.3, recomputed": ranking(printed_values()),
                "ours, against hertz_damp with k_h of eq. 2.10": ranking(hertz),
                "ours, against linear_viscoelastic with tension": ranking(linear),
            }
        ).rename_axis("law"),
        "rows_of_table_6_3_that_disagree": _disagreeing(),
        "effect_on_floors": effect(viscoelastic, apart),
    }
    tables["effect_summary"] = effect_summary(tables["effect_on_floors"])
    if len(runs["bands"]):
        tables["band_of_impacts"] = bands(tests, runs["bands"], "count")
        tables["band_of_peak_force"] = bands(tests, runs["bands"], "peak_force_n")
    return tables


def _beside(counts: pd.DataFrame) -> pd.DataFrame:
    """Return our counts with the laboratory's in front, and the sum below."""
    table = counts.astype(int)
    table.insert(0, "counted", counted().reindex(table.index).astype(int))
    return pd.concat([table, table.sum().to_frame("all").T]).rename_axis("case")


def _differences(runs: pd.DataFrame) -> pd.Series:
    """Return the sum over the tests of abs(ours - counted) for each law."""
    counts = by_law(runs, "count").astype(int)
    return counts.sub(counted().reindex(counts.index), axis=0).abs().sum().astype(int)


def _merging(runs: pd.DataFrame) -> pd.DataFrame:
    """Return how the counts of the linear viscoelastic law depend on the time that merges touches."""
    chosen = runs[runs["law"] == DEFAULT_LAW]
    columns = {f"{ms} ms": by_law(chosen, f"merged_{ms}_ms")[DEFAULT_LAW] for ms in OTHER_MERGING_MS}
    columns[f"{1e3 * MERGING_S:g} ms"] = by_law(chosen, "count")[DEFAULT_LAW]
    ordered = {name: columns[name] for name in sorted(columns, key=lambda name: float(name.split()[0]))}
    return _beside(pd.DataFrame(ordered))


def _disagreeing() -> pd.DataFrame:
    found = ranking_table()
    return found.loc[~found["agrees"].astype(bool)].drop(columns="agrees").reset_index()


def show(tables: dict[str, pd.DataFrame]) -> Iterable[Any]:
    """Return the tables for a reader; the floors' table is for files only."""
    for name, frame in tables.items():
        if name != "effect_on_floors":
            flat = frame.reset_index()
            rows = [[cell(value) for value in row] for row in flat.itertuples(index=False)]
            yield table(name.replace("_", " "), [str(column) for column in flat.columns], rows)
    yield (
        f"Impacts: {SAMPLE_RATE_HZ:,.0f} samples a second, {THRESHOLD_N:g} N, merged below "
        f"{1e3 * MERGING_S:g} ms."
    )


if __name__ == "__main__":
    run_script(main)
