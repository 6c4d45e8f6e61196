"""Tables 4.1, 4.2 and 6.2 of the thesis by the exudyn model, blind and with frames in the state of strong motion.

The blind model has the joints and the damping of free vibration. The other one has printed first frequencies that follow
from what stands on the table, and one damping ratio that is fitted to Table 4.1. Frames run alone for the peaks and the
stresses, pairs without contact for the gaps, and collisions for the counts. Run it with ``pounding study strong-motion``.
"""

from __future__ import annotations

import json as jsonlib
from collections.abc import Callable, Iterable
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from pounding.experiments.campaign.cases import chapter_5, chapter_6, frame_of, run_alone, run_apart, run_case
from pounding.experiments.campaign.tables import case, counted, label
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.records import RECORDS
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.rig.rig import Solver
from pounding.experiments.rig.states import FREE_VIBRATION, State, states_of, strong_motion
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.separation.gaps.gap import published_gap
from pounding.experiments.studies.peak_lattice import RATIOS
from pounding.experiments.studies.shared import Kept, Workers, cell, keyed, write_tables
from pounding.experiments.studies.table_4_1 import (
    FRAMES,
    SIDES,
    errors,
    measured,
    predict_in,
    score,
    trusted,
)
from pounding.experiments.sweeps.sweep import sweep
from pounding.frames import load
from pounding.frames.definition import PlateFrame

LABELS: dict[State, str] = {
    FREE_VIBRATION: "free vibration (blind)",
    "strong-motion": "strong motion (fitted to Table 4.1)",
}


def main(
    *,
    records: options.Records = None,
    kept: Kept = None,
    workers: Workers = None,
    solver: options.Solver = "exudyn",
    json: options.Json = False,
    out: options.Out = None,
) -> dict[str, Any]:
    """Tables 4.1, 4.2 and 6.2 by the blind model and in the state of strong motion, and how often steel would yield.

    Args:
        out: Folder for the tables as CSV; none are written without it.
    """
    result, tables = study(records, kept=kept, workers=workers, solver=solver)
    if out is not None:
        write_tables(tables, out)
    emit(result, as_json=json, show=lambda: show(tables))
    return result


def study(
    records: Path | None = None,
    *,
    kept: Path | None = None,
    workers: int | None = None,
    solver: Solver = "exudyn",
) -> tuple[dict[str, Any], dict[str, pd.DataFrame]]:
    """Return the stamped result and its tables by name.

    Args:
        records: Folder of records; the usual places when None.
        kept: Folder for finished cases.
        workers: Processes.
        solver: `exudyn`, or `exact` for the same within the digits shown.
    """
    settings = {"folder": "" if records is None else str(records), "solver": solver}

    def run(function: Callable[..., dict[str, Any]], cases: list[dict[str, Any]]) -> pd.DataFrame:
        return frame_of(sweep(function, cases, settings=settings, folder=kept, workers=workers))

    alone = run(run_alone, _cases([{"frame": f, "record": r} for f in FRAMES for r in RECORDS]))
    pairs = [(left, right, record) for (left, right, _), record in product(tables_4.pairs(), RECORDS)]
    apart = run(
        run_apart, _cases([dict(zip(("left", "right", "record"), pair, strict=True)) for pair in pairs])
    )
    twelve = run(run_case, _cases([case(test, test.gap_mm) for test in chapter_6()]))
    twenty = run(run_case, _cases([case(test, test.gap_mm) for test in chapter_5()]))
    computed = {state: peaks(alone[alone["state"] == state]) for state in LABELS}
    tables = {
        "misfits": pd.DataFrame(),
        "peaks": peaks_table(computed),
        "gaps": gaps(apart),
        "impacts": impacts(twelve),
        "impacts_chapter_5": collided(twenty),
        "stress": stresses(alone),
        "held_out": held_out(records),
    }
    tables["misfits"] = misfits(computed, tables)
    motions = [shaking(name, settings["folder"] or None) for name in RECORDS]
    result = stamp({"solver": solver, "states": _stated()}, motions)
    return result | {name: keyed(frame) for name, frame in tables.items()}, tables


def peaks(alone: pd.DataFrame) -> xr.DataArray:
    """Return the peaks of one state [mm], in the layout of `measured`.

    Args:
        alone: Results of `run_alone`, one row for each frame and record.
    """
    found = xr.full_like(measured(), np.nan)
    for row in alone.itertuples(index=False):
        floors = {peak["floor"]: peak for peak in jsonlib.loads(str(row.peaks))}
        for place in np.flatnonzero(found.frame == row.frame):
            peak = floors[int(found.floor[place])]
            found[place, RECORDS.index(str(row.record))] = [peak[f"{side}_mm"] for side in SIDES]
    return found


def peaks_table(computed: dict[State, xr.DataArray]) -> pd.DataFrame:
    """Return the 64 peaks [mm] of each state beside the measured and SAP2000's.

    Args:
        computed: Peaks by state.
    """
    columns = {"measured": measured(), "sap2000": measured("numerical")}
    columns |= {LABELS[state]: values for state, values in computed.items()}
    frame = xr.Dataset(columns).assign(trusted=trusted()).to_dataframe()
    return frame[[*columns, "trusted"]].round(2)


def gaps(apart: pd.DataFrame) -> pd.DataFrame:
    """Return the gaps of Table 4.2 [mm] and of each state, as closing motion and by equation 4.1.

    Args:
        apart: Results of `run_apart`.
    """
    rows: dict[tuple[str, str, str], dict[str, float]] = {}
    floors = {(left, right): floor for left, right, floor in tables_4.pairs()}
    for row in apart.itertuples(index=False):
        left, right, record = str(row.left), str(row.right), str(row.record)
        printed = published_gap(left, right, floors[left, right], record)
        assert printed is not None
        cells = rows.setdefault(
            (left, right, record), {"measured": printed["experiment_mm"], "sap2000": printed["numerical_mm"]}
        )
        name = LABELS[row.state]
        cells[f"{name}, closing"] = float(row.closing_mm)
        cells[f"{name}, eq. 4.1"] = max(float(row.closing_mm), float(row.opening_mm))
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "record"])


def impacts(collided: pd.DataFrame) -> pd.DataFrame:
    """Return the impacts of the 12 tests of section 6.3.2 in each state beside the laboratory's.

    Args:
        collided: Results of `run_case`.
    """
    names = [label(*row) for row in collided[["left", "right", "record"]].itertuples(index=False)]
    wide = collided.assign(test=names).pivot(index="test", columns="state", values="count")
    wide = wide.loc[list(dict.fromkeys(names)), list(LABELS)].astype(int).rename(columns=dict(LABELS))
    wide.insert(0, "counted", counted().reindex(wide.index).astype(int))
    return wide.rename_axis(columns=None)


def stresses(alone: pd.DataFrame) -> pd.DataFrame:
    """Return the largest von Mises stress of each frame under each record in each state, and the yield stress [MPa].

    `at_measured` is the stress in strong motion times the measured over the computed peak of the roof: what the linear model
    says of the motion that was measured, as far as that has its shape.

    Args:
        alone: Results of `run_alone`.
    """
    wide = alone.pivot(index=["frame", "record"], columns="state", values="max_stress_mpa")
    wide = wide.reindex(pd.MultiIndex.from_product([FRAMES, RECORDS], names=["frame", "record"]))
    wide = wide[list(LABELS)].rename(columns=dict(LABELS)).rename_axis(columns=None)
    roofs = [_roof(alone, str(frame), str(record)) for frame, record in wide.index]
    wide["at_measured"] = wide[LABELS["strong-motion"]] * roofs
    return wide.assign(yields=[_yield_mpa(str(frame)) for frame, _ in wide.index])


def collided(chapter_5: pd.DataFrame) -> pd.DataFrame:
    """Return the impacts of the 20 tests of section 5.2.2, in all of which the frames collided, in each state.

    Args:
        chapter_5: Results of `run_case`.
    """
    wide = chapter_5.pivot(index=["record", "gap_mm"], columns="state", values="count")
    return wide[list(LABELS)].astype(int).rename(columns=dict(LABELS)).rename_axis(columns=None)


def held_out(records: Path | None = None) -> pd.DataFrame:
    """Return the mean error [-] on peaks that took no part in the fit of the damping ratio, by how many records were fitted.

    The states were chosen beforehand, with all peaks seen. The peaks are those of the exact response.

    Args:
        records: Folder with ground motions; None for the default.
    """
    ratios = [ratio for ratio in RATIOS if ratio is not None]
    off = np.array([np.abs(errors(predict_in("strong-motion", records, ratio)).values) for ratio in ratios])
    blind = np.abs(errors(predict_in(FREE_VIBRATION, records)).values)
    sure = np.broadcast_to(trusted().values[..., None], blind.shape)
    rows = {}
    for count in (2, 3, 4):
        for fitted in combinations(range(len(RECORDS)), count):
            rest = [one for one in range(len(RECORDS)) if one not in fitted] or list(fitted)
            used = [float(one[:, fitted][sure[:, fitted]].mean()) for one in off]
            best = int(np.argmin(used))
            rows[(count, " ".join(RECORDS[one] for one in fitted))] = {
                "damping_ratio": ratios[best],
                "fitted": used[best],
                "held_out": np.nan
                if count == len(RECORDS)
                else float(off[best][:, rest][sure[:, rest]].mean()),
                "blind": float(blind[:, rest][sure[:, rest]].mean()),
            }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["records", "fitted to"])


def misfits(computed: dict[State, xr.DataArray], tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Return how far each state and SAP2000 are from the tests: mean errors [-], numbers of impacts, of tests and of shakes.

    Args:
        computed: Peaks by state.
        tables: `gaps`, `impacts`, `impacts_chapter_5` and `stress`.
    """
    found, count, twenty, stress = (
        tables[name] for name in ("gaps", "impacts", "impacts_chapter_5", "stress")
    )

    def off(column: str) -> float:
        return float((found[column] / found["measured"] - 1.0).abs().mean())

    rows: dict[str, dict[str, float]] = {
        "SAP2000 (printed)": {
            "peaks_58": score(measured("numerical"), trusted()).mean,
            "peaks_64": score(measured("numerical")).mean,
            "gap_equation_4_1": off("sap2000"),
        }
    }
    for state, name in LABELS.items():
        rows[name] = {
            "peaks_58": score(computed[state], trusted()).mean,
            "peaks_64": score(computed[state]).mean,
            "gap_equation_4_1": off(f"{name}, eq. 4.1"),
            "gap_closing": off(f"{name}, closing"),
            "impacts": float(count[name].sum()),
            "sum_of_differences": float((count[name] - count["counted"]).abs().sum()),
            "chapter_5_collisions": float((twenty[name] > 0).sum()),
            "shakes_beyond_yield": float((stress[name] >= stress["yields"]).sum()),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("model")


def show(tables: dict[str, pd.DataFrame]) -> Iterable[Any]:
    """Return the tables for a reader, the one with all 64 peaks for files only."""
    words = {
        "peaks_58": "58 uncontested peaks of Table 4.1, mean error",
        "peaks_64": "all 64 peaks",
        "gap_equation_4_1": "20 gaps of Table 4.2 by equation 4.1, mean error",
        "gap_closing": "the same as closing motion",
        "impacts": "impacts at the gaps of section 6.3.2 (40 counted)",
        "sum_of_differences": "sum of |ours - counted| over its 12 tests",
        "chapter_5_collisions": "tests of section 5.2.2 that collide (20 did)",
        "shakes_beyond_yield": "20 shakes of single frames: beyond yield",
    }
    across = tables["misfits"].T.rename(index=words)
    yield _shown("Misfits", across.rename_axis("quantity"))
    titles = {
        "gaps": "Table 4.2 [mm]",
        "impacts": "Impacts at the gaps of section 6.3.2",
        "impacts_chapter_5": "Impacts at the gaps of section 5.2.2",
        "stress": "Largest stress of the frames alone [MPa]",
        "held_out": "One damping ratio fitted to some records, judged on the others; the frequencies were chosen beforehand",
    }
    for name, title in titles.items():
        yield _shown(title, tables[name])
    strong = strong_motion()
    yield f"Strong motion: damping {100 * strong.damping_ratio:g} %, fitted to {strong.fitted_to} by `{strong.fitted_by}`."


def _shown(title: str, frame: pd.DataFrame) -> Any:
    flat = frame.reset_index()
    rows = [["" if _missing(value) else cell(value) for value in row] for row in flat.itertuples(index=False)]
    return table(title, [str(column) for column in flat.columns], rows)


def _missing(value: Any) -> bool:
    return isinstance(value, float) and bool(np.isnan(value))


def _cases(cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return cases in each state."""
    return [one | {"state": state} for state in LABELS for one in cases]


def _stated() -> list[dict[str, Any]]:
    """Return the states of every frame alone, for the result's parameters."""
    return [states_of([name], state)[0].as_dict() for state in LABELS for name in FRAMES]


def _roof(alone: pd.DataFrame, frame: str, record: str) -> float:
    """Return the measured over the computed peak of a roof in strong motion, each the larger of both sides [-]."""
    rows = alone[
        (alone["frame"] == frame) & (alone["record"] == record) & (alone["state"] == "strong-motion")
    ]
    peaks: list[dict[str, float]] = jsonlib.loads(rows["peaks"].iloc[0])
    roof = max(peaks, key=lambda one: one["floor"])
    known = measured().sel(place=f"{frame} floor {roof['floor']}", record=record)
    return float(known.max()) / max(roof["max_mm"], roof["min_mm"])


def _yield_mpa(name: str) -> float:
    frame = load(name)
    assert isinstance(frame, PlateFrame)
    return frame.material.yield_stress_mpa


if __name__ == "__main__":
    run_script(main)
