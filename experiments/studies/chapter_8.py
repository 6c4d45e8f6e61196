"""Chapter 8 of the thesis: its conclusions one by one, each with the test of it, the figures and a verdict.

Some follow from the printed tables alone, the others are held against our model: by the
modules and studies of chapters 4, 6 and 7 and by a few collisions more. Run it with ``pounding study chapter-8``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from cyclopts import Parameter

from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.records import RECORDS, REFERENCES, Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.separation.chapter_7 import parametric, tables_7
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.studies import chapter_6, chapter_7, chapter_8_printed, chapter_8_runs
from pounding.experiments.studies.chapter_8_conclusions import conclusions
from pounding.experiments.studies.chapter_8_tables import Conclusion, Printed, Runs
from pounding.experiments.studies.shared import Workers, write_tables
from pounding.experiments.studies.table_4_1 import BLIND, FRAMES, build, table_motion


def printed() -> Printed:
    """Return what the printed tables say alone."""
    gaps = chapter_8_printed.gaps()
    share = (gaps["required"] / gaps["abs"]).groupby(gaps["equal"]).mean()
    return Printed(
        height_rule=chapter_8_printed.height_rule(gaps),
        rules=chapter_8_printed.combination_rules(gaps),
        by_field=chapter_8_printed.by_field(gaps["required"], published.table("section 3.7")["pga_g"]),
        share_of_abs=pd.Series({"equal": share[True], "unequal": share[False]}),
        ranking=chapter_8_printed.ranking(),
        by_pair=chapter_8_printed.dissimilarity_by_pair(),
        taller_and_lower=chapter_8_printed.taller_and_lower(),
    )


def runs(folder: Path | None = None, workers: int | None = None) -> Runs:
    """Return what our model says: gaps as in chapter 4, the studies of chapters 6 and 7, and runs of this study.

    Args:
        folder: Records; the usual places when None.
        workers: Processes; 0 for none.
    """
    _, of_6 = chapter_6.study(folder, workers=workers)
    settings = {"records": "" if folder is None else str(folder)}
    cases, _ = parametric.study(settings=settings, workers=workers)
    own = cases[cases["record"].isin(list(REFERENCES))]
    collided, ratios = chapter_8_runs.collisions(folder, workers)
    pga = pd.Series({name: find(name, folder).pga_g for name in RECORDS})
    motions = {name: table_motion(name, BLIND, folder) for name in RECORDS}
    gaps, rules = _gaps_and_rules(motions, pga.to_dict())
    return Runs(
        by_field=chapter_8_printed.by_field(gaps, pga),
        srss=chapter_8_runs.srss_by_ratio(motions),
        floors=chapter_8_runs.effect_on_frames(collided, ratios),
        force=chapter_8_runs.force_over_velocity(collided),
        rules=rules,
        chapter_6=of_6,
        correlations=tables_7.correlation_rows(cases),
        equations=tables_7.thesis_equations_on(own),
        readings=chapter_7.readings(),
    )


def _gaps_and_rules(motions: Mapping[str, Record], pga_g: dict[str, float]) -> tuple[pd.Series, pd.DataFrame]:
    """Return our closing gaps [mm] by left, right and record, and how the codes' rules compare with equation 4.1."""
    built = {name: build(name, BLIND) for name in FRAMES}
    gaps = tables_4.computed_gaps(built.__getitem__, motions.__getitem__)
    rules = tables_4.summary(tables_4.rules_from_computed(lambda _pair: built, pga_g, gaps))
    return tables_4.table_4_2(gaps)["closing_mm"].droplevel("floor"), rules


def main(
    *,
    records: options.Records = None,
    out: options.Out = None,
    workers: Workers = None,
    model: Annotated[
        bool, Parameter(help="Also run our model (minutes); printed tables alone without.")
    ] = True,
    json: options.Json = False,
) -> list[Conclusion]:
    """The 20 conclusions of chapter 8, one by one: test, figures, confirmed, contradicted or open.

    Args:
        out: Folder for the tables as CSV; none are written without it.
    """
    motions = (
        [find(name, records) for name in RECORDS] if model else []
    )  # missing ones are named before long work
    tables, found = printed(), runs(records, workers) if model else None
    chosen = conclusions(tables, found)
    result = stamp({"model": model}, motions) | {"conclusions": [asdict(one) for one in chosen]}
    if out is not None:
        write_tables(_tables(chosen, tables, found), out)
    emit(result, as_json=json, show=lambda: show(chosen))
    return chosen


def _tables(chosen: list[Conclusion], tables: Printed, found: Runs | None) -> dict[str, pd.DataFrame]:
    """Return the conclusions and what they rest on, as tables by file name."""
    kept = {"conclusions": pd.DataFrame([asdict(one) for one in chosen]).set_index("place")}
    kept |= {
        "height_rule": tables.height_rule,
        "combination_rules": tables.rules,
        "ranking_resampled": tables.ranking,
        "taller_and_lower": tables.taller_and_lower,
    }
    if found is not None:
        kept |= {
            "srss_by_frequency_ratio": found.srss,
            "effect_on_frames": found.floors,
            "force_over_velocity": found.force,
            "equations_on_their_own_motions": found.equations,
        }
    return kept


def show(chosen: list[Conclusion]) -> Iterable[Any]:
    """Return the conclusions for a reader, how many of each verdict last."""
    rows = [
        [
            one.place,
            one.statement,
            one.test,
            "; ".join(filter(None, (one.printed, one.runs))) or "-",
            one.verdict,
        ]
        for one in chosen
    ]
    yield table(
        "Conclusions of the thesis", ["place", "the thesis says", "held against", "figures", "verdict"], rows
    )
    counts = pd.Series([one.verdict for one in chosen]).value_counts()
    yield ", ".join(f"{verdict}: {count}" for verdict, count in counts.items()) + "."


if __name__ == "__main__":
    run_script(main)
