"""Chapter 7 of the thesis: 9,768 required gaps, their regressions, and what a formula of this kind is worth.

Run it with ``pounding study chapter-7``. The motions SAP 1 to 5 of the thesis are not public; the nearest
that can be had stand in for them under their own names, and those that are not at hand are named as missing.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter
from rich.console import RenderableType

from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import REFERENCES, Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.separation import pictures
from pounding.experiments.separation.chapter_7 import equations, formulas, printed_rows, tables_7
from pounding.experiments.separation.chapter_7.parametric import (
    PAIR_NAMES,
    VALIDATION_LABEL,
    motions_of_the_study,
    study,
)
from pounding.experiments.separation.chapter_7.regression import WITHOUT_STIFFNESS_AND_MASS, fit
from pounding.experiments.separation.rules.design import Site, design
from pounding.experiments.studies.chapter_4 import from_frame
from pounding.extras import extra_module
from pounding.frames import build, load
from pounding.frames.files import write_whole
from pounding.scale import THESIS

NEW_PAIRS = ("12-8", "10-8")
NEW_LABELS = ("sap2", "sap3", VALIDATION_LABEL)
"""Section 7.4: frames not in the study, under SAP 2, SAP 3 and SAP 5."""

Cases = Annotated[
    Path | None,
    Parameter(
        help="Folder that keeps finished cases, to go on with later.", validator=options.writable_folder
    ),
]


def main(
    *,
    out: options.Out = None,
    records: options.Records = None,
    cases: Cases = None,
    workers: options.Workers = None,
    scheduler: Annotated[str | None, Parameter(help="Address of a dask.distributed scheduler.")] = None,
    json: options.Json = False,
) -> None:
    """The 9,768 cases, their regressions beside Tables 7.2 to 7.19, and what holds for unseen earthquakes.

    Args:
        out: Folder for tables (CSV) and pictures; none are written without it.
    """
    extra_module("statsmodels.api")  # said before the cases are computed, which takes a minute
    found, missing = gather(records, folder=cases, workers=workers, scheduler=scheduler)
    for sentence in missing:
        warn(sentence)
    tables = evaluate(found, records)
    if out is not None:
        write(found, tables, out)
    motions = list(_records(found, records).values())
    asked = {"records": None if records is None else str(records), "cases": len(found["study"])}
    result = stamp(asked, motions) | {"missing": missing}
    result |= {name: table.reset_index().to_dict("records") for name, table in tables.items()}
    emit(result, as_json=json, show=lambda: show(tables, missing))


def gather(
    records: Path | None = None,
    *,
    folder: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> tuple[dict[str, pd.DataFrame], list[str]]:
    """Return the cases of the study and of its validation, and a sentence for each motion that is missing.

    Args:
        records: Folder of records; the usual places when None.
        folder: Where finished cases are kept.
        workers: Processes; 0 for none.
        scheduler: Address of a dask.distributed scheduler.

    Returns:
        ``study`` (9,768 rows when all motions are there), ``held_out`` (the study's pairs under SAP 5's
        stand-in) and ``validation`` (12-8 and 10-8 storeys).
    """
    settings = {"records": "" if records is None else str(records)}
    options_: dict[str, Any] = {
        "settings": settings,
        "folder": folder,
        "workers": workers,
        "scheduler": scheduler,
    }
    found, failures = {}, {}
    found["study"], failures["study"] = study(**options_)
    for name, labels, pairs in (
        ("held_out", [VALIDATION_LABEL], PAIR_NAMES),
        ("validation", list(NEW_LABELS), NEW_PAIRS),
    ):
        try:
            found[name], failures[name] = study(labels, pairs, **options_)
        except ExperimentError as error:
            failures[name] = {f"all of {', '.join(labels)}": str(error)}
    missing = dict.fromkeys(
        f"{case.split()[-1] if name == 'study' else name}: {reason}"
        for name, told in failures.items()
        for case, reason in told.items()
    )
    return found, list(missing)


def evaluate(found: dict[str, pd.DataFrame], records: Path | None = None) -> dict[str, pd.DataFrame]:
    """Return every table of the study by name.

    Args:
        found: See `gather`.
        records: Folder of records.
    """
    cases = found["study"]
    tables = {
        "worked_example": worked_example(),
        "full_scale_readings": readings(),
        "printed_rows": printed_rows_compared(records),
        "correlations": tables_7.correlation_rows(cases),
        "regressions": tables_7.regression_rows(cases),
        "errors": tables_7.error_rows(cases),
        "inflation": tables_7.inflation_rows(cases),
        "cross_validation": tables_7.validation_rows(cases),
        "equations_on_our_cases": tables_7.thesis_equations_on(cases),
        **tables_7.contradictions(),
    }
    own = cases[cases["record"].isin(list(REFERENCES))]
    if len(own):
        tables["equations_on_their_own_motions"] = tables_7.thesis_equations_on(own)
    if "validation" in found:
        tables["equations_on_new_frames"] = tables_7.thesis_equations_on(found["validation"])
        tables["ours_on_new_frames"] = tables_7.ours_on_new_frames(cases, found["validation"])
    everything = pd.concat([cases, *([found["held_out"]] if "held_out" in found else [])], ignore_index=True)
    prepared = formulas.with_spectra(everything, _records(found, records))
    tables["formulas"] = formulas.compare(prepared)
    return tables


def worked_example() -> pd.DataFrame:
    """Return sections 7.6.2 and 7.6.3: the printed gaps of the worked example beside ours [mm]."""
    printed = published.table("section 7.6")["value"]
    site = Site(
        printed["tall_height_m"],
        printed["short_height_m"],
        printed["pga_g"],
        tall_frequency_hz=printed["tall_frequency_hz"],
        short_frequency_hz=printed["short_frequency_hz"],
        damping_percent=printed["damping_percent"],
    )
    ours = {rule["name"]: rule["gap_mm"] for rule in design(site)["rules"]}
    named = {
        "equation 7.16": "equation_7_16_mm",
        "1 % of the taller height": "as1170_tall_mm",
        "1 % of the lower height": "as1170_short_mm",
        "equation 7.20": "equation_7_20_mm",
    }
    rows = {rule: {"printed_mm": printed[key], "ours_mm": ours[rule]} for rule, key in named.items()}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("rule")


def readings() -> pd.DataFrame:
    """Return the worked example over the peak acceleration, by each reading of 7.16 to 7.18 [mm]."""
    values = {"HT": 39000.0, "HS": 21000.0, "FT": 0.466, "FS": 0.7414, "DT": 5.0, "DS": 5.0}
    rows = {}
    for pga in (0.167, 0.2, 0.248, 0.299, 0.3, 0.45, 0.599, 0.6, 0.75, 0.9):
        level = equations.level_of(pga)
        row = dict.fromkeys(("7.16", "7.17", "7.18 with 1470 E", "7.18 with 720 E"), np.nan)
        if level == "low":
            row["7.16"] = equations.FULL_LOW(**values, E=pga)
        elif level == "moderate":
            row["7.17"] = equations.FULL_MODERATE(**values, E=pga)
        else:
            for name, equation in (
                ("7.18 with 1470 E", equations.FULL_HIGH),
                ("7.18 with 720 E", equations.FULL_HIGH_AS_PRINTED),
            ):
                row[name] = equation(**values, E=pga)
                row[f"{name}, then 7.14 on S/30"] = equations.correct_high_full_scale(row[name])
                row[f"{name}, then 7.14 on S"] = equations.correct_high(row[name])
        rows[pga] = row
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("pga_g")


def printed_rows_compared(records: Path | None) -> pd.DataFrame:
    """Return the printed rows of Tables 7.2 to 7.4 beside ours: mean gaps and errors by table and motion.

    Each motion at Table 7.1's peak and at its own. Both by equation 4.1: the printed gaps are nearer to closing gaps, and
    which peak the thesis used then follows differently (`pounding.experiments.studies.sap2000_input`).
    """
    rows = printed_rows.printed_rows()
    built = {name: build(load(name)) for name in ("15B", "10", "5B")}
    tables = {}
    for peak, scaled in (("Table 7.1", True), ("its own", False)):
        motions = _by_label(records, scaled=scaled)
        compared = printed_rows.compare(rows, built, motions)
        for column in ("tuned", "ours"):
            compared[f"{column}_error"] = (compared[f"{column}_mm"] / compared["gap_mm"] - 1.0).abs()
        means = compared.groupby(["level", "label"], sort=False)[
            ["gap_mm", "tuned_mm", "ours_mm", "tuned_error", "ours_error"]
        ].mean()
        tables[peak] = means.assign(rows=compared.groupby(["level", "label"], sort=False).size())
    return pd.concat(tables, names=["peak"])


def _by_label(records: Path | None, *, scaled: bool) -> dict[str, Record]:
    found = {}
    for label, motion in motions_of_the_study().iterrows():
        try:
            record = find(str(motion["record"]), records)
        except ExperimentError:
            continue  # the sweep has said so already
        found[str(label)] = record.scaled(
            THESIS.time_factor, pga_g=float(motion["pga_g"]) if scaled else None
        )
    return found


def _records(found: dict[str, pd.DataFrame], records: Path | None) -> dict[str, Record]:
    """Return the motions that the cases were made with, at model scale and Table 7.1's peaks, by name."""
    used = {name for cases in found.values() for name in cases["record"].unique()}
    motions = motions_of_the_study(with_validation=True)
    return {
        str(motion["record"]): find(str(motion["record"]), records).scaled(
            THESIS.time_factor, pga_g=float(motion["pga_g"])
        )
        for _, motion in motions.iterrows()
        if motion["record"] in used
    }


def write(found: dict[str, pd.DataFrame], tables: dict[str, pd.DataFrame], out: Path) -> None:
    """Write the cases and every table as CSV, and the pictures as PNG, into a folder.

    Args:
        found: The cases of each level by its name.
        tables: The study's tables by name.
        out: Folder for tables and pictures.
    """
    for name, cases in found.items():
        write_whole(out / f"cases_{name}.csv", cases.to_csv(index=False, float_format="%.8g").encode())
    for name, table in tables.items():
        write_whole(out / f"{name}.csv", table.to_csv().encode())
    cases = found["study"]
    fits = {
        level: fit(cases[cases["level"] == level], WITHOUT_STIFFNESS_AND_MASS)
        for level in tables_7.levels_in(cases)
    }
    pictures.save(pictures.regression_diagnostics(cases, fits), out / "regression_diagnostics.png")
    pictures.save(pictures.held_out(tables["formulas"]), out / "held_out.png")


def show(tables: dict[str, pd.DataFrame], missing: list[str]) -> Iterable[RenderableType | str]:
    """Return the tables for a reader, the plain conclusion last."""
    for name, table in tables.items():
        yield from_frame(name.replace("_", " "), table)
    for sentence in missing:
        yield f"missing: {sentence}"
    yield conclusion(tables["formulas"])


def conclusion(compared: pd.DataFrame) -> str:
    """Return in words what the comparison of formulas says."""
    names = list(formulas.FORMULAS)
    by_class, spectral = compared.loc[names[0]], compared.loc["DDC of spectral displacements"]
    seen = (
        f"A formula in the peak acceleration misses the gaps of its own earthquakes by {by_class['seen']:.0%}"
    )
    best = compared.loc[names[:3], "event"].min()
    if not np.isfinite(best):
        return f"{seen} in the mean; with one earthquake at hand nothing can be said of another."
    form = f"{by_class['event']:.0%} in the thesis' form, by " if np.isfinite(by_class["event"]) else ""
    return (
        f"{seen} in the mean, and those of an earthquake it has not seen by {form}{best:.0%} in the best: it "
        "cannot be trusted outside its records. The double difference of the spectral displacements, with "
        f"nothing fitted, misses them by {spectral['event']:.0%}."
    )


if __name__ == "__main__":
    run_script(main)
