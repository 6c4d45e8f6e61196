"""Chapter 4 of the thesis: required gaps, the codes' rules, and its Tables 4.2 and 4.3.

Five pairs under four records, by the blind model and, beside it, in the state of strong motion, whose damping is fitted to
Table 4.1. The required gap of the closing motion is confirmed by collisions just below and just above it. Run it with
``pounding study chapter-4``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter
from rich.console import RenderableType
from rich.progress import Progress

from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.published.consistency import Pair
from pounding.experiments.records import RECORDS, Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.pounding import built_in
from pounding.experiments.rig.required_gap import RequiredGap, pair_gap
from pounding.experiments.rig.rig import Solver
from pounding.experiments.rig.states import states_of
from pounding.experiments.rig.states import strong_motion as strong_motion_state
from pounding.experiments.separation import pictures
from pounding.experiments.separation.chapter_7.parametric import motions_of_the_study
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.separation.gaps.confirm import confirm
from pounding.experiments.separation.gaps.maps import GapMap, gap_map
from pounding.experiments.studies.table_4_1 import BLIND, Variant, build, variants
from pounding.frames import ReducedFrame
from pounding.frames.files import write_whole
from pounding.scale import THESIS

FRAMES = ("15A", "15B", "10", "5A", "5B")
MAP_DAMPING = 0.005
"""Damping ratio of the oscillators of the gap maps, about that of the frames in free vibration."""
Gaps = dict[tuple[str, str, int, str], RequiredGap]
"""Required gaps by left and right frame, floor and record."""


def main(
    *,
    out: options.Out = None,
    records: options.Records = None,
    collisions: Annotated[
        bool, Parameter(help="Confirm each gap by runs with contacts (a minute by exudyn).")
    ] = True,
    solver: options.Solver = "exudyn",
    json: options.Json = False,
) -> None:
    """Required gaps of the five pairs beside the thesis', the rules beside the gaps, Table 4.3 recomputed.

    Args:
        out: Folder for tables (CSV) and pictures; none are written without it.
    """
    with Progress(console=progress_console(), transient=True) as progress:
        result, tables = study(records, collisions=collisions, progress=progress, solver=solver)
        if out is not None:
            write(tables, out, records, progress)
    emit(result, as_json=json, show=lambda: show(tables))


def study(
    folder: Path | None = None,
    *,
    collisions: bool = True,
    progress: Progress | None = None,
    solver: Solver = "exudyn",
) -> tuple[dict[str, Any], dict[str, pd.DataFrame]]:
    """Return the stamped result and its tables by name.

    Args:
        folder: Records; the usual places when None.
        collisions: Whether each gap is confirmed by runs with contacts.
        progress: Where progress is shown.
        solver: What runs the collisions, see `confirmations`.
    """
    built = {name: build(name, BLIND) for name in FRAMES}
    motions = {name: _motion(name, BLIND, folder) for name in RECORDS}
    gaps = tables_4.computed_gaps(built.__getitem__, motions.__getitem__)
    strong = strong_motion(motions)
    table_4_2 = tables_4.table_4_2(gaps).join(in_mm(strong))
    pga = {name: record.pga_g for name, record in motions.items()}
    measured = tables_4.rules_from_measured(built, pga)
    computed = tables_4.rules_from_computed(lambda _pair: built, pga, gaps)
    in_strong_motion = rules_in_strong_motion(strong, pga)
    tables = {
        "table_4_2": table_4_2,
        "errors": errors(table_4_2),
        "variants": all_variants(folder, progress),
        "table_4_3": tables_4.table_4_3(),
        "rules_measured": measured,
        "rules_computed": computed,
        "rules_strong_motion": in_strong_motion,
        "rules_measured_summary": tables_4.summary(measured),
        "rules_uncontested_summary": tables_4.summary(
            measured[~table_4_2["contested"].reindex(measured.index)]
        ),
        "rules_computed_summary": tables_4.summary(computed),
        "rules_strong_motion_summary": tables_4.summary(in_strong_motion),
    }
    if collisions:
        tables["collisions"] = confirmations(built, motions, progress, solver)
    result = stamp({"variant": str(BLIND), "collisions": collisions}, list(motions.values()))
    result |= {name: _rows(frame) for name, frame in tables.items()}
    return result, tables


def strong_motion(motions: Mapping[str, Record]) -> Gaps:
    """Return the required gaps of Table 4.2 with the frames in the state of strong motion, which is fitted to Table 4.1.

    Args:
        motions: Records at model scale by name.
    """
    found = {}
    for (left, right, floor), record in product(tables_4.pairs(), RECORDS):
        built = _in_strong_motion(Pair(left, right, floor, record))
        found[(left, right, floor, record)] = pair_gap(
            built[left], built[right], motions[record], floor=floor
        )
    return found


def in_mm(gaps: Gaps) -> pd.DataFrame:
    """Return gaps in strong motion as columns for the table of all gaps [mm].

    Args:
        gaps: See `strong_motion`.
    """
    rows = {
        key: {
            "strong_motion_closing_mm": 1e3 * gap.closing_m,
            "strong_motion_equation_4_1_mm": 1e3 * gap.equation_4_1_m,
        }
        for key, gap in gaps.items()
    }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "floor", "record"])


def rules_in_strong_motion(gaps: Gaps, pga_g: Mapping[str, float]) -> pd.DataFrame:
    """Return each rule's gap over equation 4.1, both from frames in the state of strong motion.

    Args:
        gaps: See `strong_motion`.
        pga_g: Peak of each record [g].
    """
    return tables_4.rules_from_computed(_in_strong_motion, pga_g, gaps)


def _in_strong_motion(pair: Pair) -> dict[str, ReducedFrame]:
    names = [pair.left, pair.right]
    return dict(zip(names, map(built_in, states_of(names, "strong-motion", pair.record)), strict=True))


def errors(table_4_2: pd.DataFrame) -> pd.DataFrame:
    """Return the mean errors over all entries, and over those that the thesis' tables do not contradict."""
    both = {
        "all": tables_4.mean_errors(table_4_2),
        "uncontested": tables_4.mean_errors(table_4_2[~table_4_2["contested"]]),
    }
    return pd.concat(both, names=["entries", "gap"])


def all_variants(folder: Path | None, progress: Progress | None = None) -> pd.DataFrame:
    """Return the mean error of closing motion and equation 4.1 for every variant of the model.

    A reversed record closes what the record as it stands opens, so one run serves both polarities.
    """
    chosen = [variant for variant in variants() if variant.polarity > 0]
    bar = None if progress is None else progress.add_task("variants of the model", total=len(chosen))
    rows = {}
    for variant in chosen:
        built = {name: build(name, variant) for name in FRAMES}
        motions = {name: _motion(name, variant, folder) for name in RECORDS}
        table_4_2 = tables_4.table_4_2(tables_4.computed_gaps(built.__getitem__, motions.__getitem__))
        mean = tables_4.mean_errors(table_4_2)["mean"]
        for polarity, closing in ((1, "closing_mm"), (-1, "opening_mm")):
            rows[str(replace(variant, polarity=polarity))] = {
                "closing": mean[closing],
                "equation_4_1": mean["equation_4_1_mm"],
            }
        if progress is not None and bar is not None:
            progress.advance(bar)
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("variant")


def _motion(name: str, variant: Variant, folder: Path | None) -> Record:
    """Return a record at a variant's peak and its own step: `required_gap` looks between the samples."""
    pga = None if variant.peaks == "3.7" else float(published.table("7.1")["pga_g"][name])
    return find(name, folder).scaled(THESIS.time_factor, pga_g=pga)


def confirmations(
    built: dict[str, ReducedFrame],
    motions: dict[str, Record],
    progress: Progress | None = None,
    solver: Solver = "exudyn",
) -> pd.DataFrame:
    """Return what collisions 1 % below and 1 % above each required gap say.

    Args:
        built: Frames by name.
        motions: Records at model scale by name.
        progress: Where progress is shown.
        solver: `exudyn`, which knows nothing of the exact response that it confirms, or `exact`.
    """
    cases = [(*pair, name) for pair in tables_4.pairs() for name in motions]
    bar = None if progress is None else progress.add_task("collisions below and above", total=len(cases))
    rows = {}
    for left, right, floor, name in cases:
        found = confirm(built[left], built[right], motions[name], floor=floor, solver=solver)
        rows[(left, right, floor, name)] = {
            "closing_mm": found.closing_mm,
            "engine_closing_mm": found.engine_closing_mm,
            "impacts_below": found.impacts_below,
            "impacts_above": found.impacts_above,
            "holds": found.holds,
        }
        if progress is not None and bar is not None:
            progress.advance(bar)
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "floor", "record"])


def write(
    tables: dict[str, pd.DataFrame], out: Path, folder: Path | None, progress: Progress | None = None
) -> None:
    """Write every table as CSV and the pictures as PNG into a folder.

    Args:
        tables: See `study`.
        out: The folder; made if it is not there.
        folder: Records; those of the map that are not at hand are left out.
        progress: Where progress is shown.
    """
    for name, frame in tables.items():
        write_whole(out / f"{name}.csv", frame.to_csv().encode())
    pictures.save(pictures.rules_against_simulation(tables["rules_measured"]), out / "rules_measured.png")
    pictures.save(pictures.rules_against_simulation(tables["rules_computed"]), out / "rules_computed.png")
    pictures.save(
        pictures.rules_against_simulation(tables["rules_strong_motion"]), out / "rules_strong_motion.png"
    )
    motions, summaries = _at_hand(folder), {}
    pictured = {"gap_maps": MAP_DAMPING, "gap_maps_strong_motion": strong_motion_state().damping_ratio}
    bar = None if progress is None else progress.add_task("gap maps", total=len(pictured) * len(motions))
    for name, ratio in pictured.items():
        maps = {}
        for motion in motions:
            maps[motion.name] = gap_map(motion, damping_ratio=ratio)
            if progress is not None and bar is not None:
                progress.advance(bar)
        pictures.save(pictures.gap_maps(maps), out / f"{name}.png")
        summaries[ratio] = map_summary(list(maps.values()))
    summary = pd.DataFrame.from_dict(summaries, orient="index").rename_axis("damping_ratio")
    write_whole(out / "gap_maps.csv", summary.to_csv().encode())


def _at_hand(folder: Path | None) -> list[Record]:
    """Return the motions of the study of chapter 7 at model scale, those that are at hand."""
    found = []
    for name in motions_of_the_study()["record"]:
        try:
            found.append(find(str(name), folder).scaled(THESIS.time_factor))
        except ExperimentError as error:
            warn(f"no gap map of a motion that is not at hand: {error}")
    return found


def map_summary(maps: Sequence[GapMap]) -> dict[str, float]:
    """Return how often SRSS falls short of the required gap over all pairs of some maps, and by how much.

    Args:
        maps: The maps.
    """
    over = np.concatenate([one.over_srss[:, one.ratio < 1.0].ravel() for one in maps])
    return {
        "pairs": float(over.size),
        "unsafe": float((over > 1.0).mean()),
        "median_over_srss": float(np.median(over)),
        "largest_over_srss": float(over.max()),
    }


def show(tables: dict[str, pd.DataFrame]) -> Iterable[RenderableType | str]:
    """Return the tables for a reader."""
    titles = {
        "table_4_2": "Table 4.2 [mm]; columns of strong motion: damping fitted to Table 4.1, all others blind",
        "errors": "Error of the gaps against the measured ones",
        "variants": "Mean error of every variant of the model",
        "rules_measured_summary": "Rules from the measured peaks over the measured gaps",
        "rules_uncontested_summary": "The same without the entries that the thesis' own tables contradict",
        "rules_computed_summary": "Rules from the computed peaks over the computed equation 4.1",
        "rules_strong_motion_summary": "The same in strong motion, whose damping is fitted to Table 4.1",
        "collisions": "Runs with contacts 1 % below and 1 % above the required gap",
    }
    for name, title in titles.items():
        if name in tables:
            yield from_frame(title, tables[name])
    wrong = tables["table_4_3"]
    yield from_frame("Entries of Table 4.3 that do not follow from Table 4.1", wrong[~wrong["follows"]])


def from_frame(title: str, frame: pd.DataFrame) -> RenderableType:
    """Return a table of numbers as one for the terminal, four digits a number."""
    flat = frame.reset_index()
    cells = [[_cell(value) for value in row] for row in flat.itertuples(index=False)]
    return table(title, [str(column) for column in flat.columns], cells)


def _cell(value: Any) -> Any:
    if isinstance(value, bool | str):
        return str(value)
    return f"{value:.4g}" if isinstance(value, float) else value


def _rows(frame: pd.DataFrame) -> list[dict[Any, Any]]:
    rows: list[dict[Any, Any]] = frame.reset_index().to_dict("records")
    return rows


if __name__ == "__main__":
    run_script(main)
