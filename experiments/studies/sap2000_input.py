"""With which frequencies, damping and motion did the thesis run SAP2000? Its printed results, computed again.

78 gaps of Tables 7.2 to 7.4 print frequencies and damping beside them, so that only their direction and the motion are open;
what is fitted to them foretells the SAP2000 columns of Tables 4.1 and 4.2. Beside every error stands how many numbers were
fitted to the same values. Run it with ``pounding study sap2000-input``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit
from pounding.experiments.records import RECORDS, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.studies import sap2000_gaps, sap2000_peaks
from pounding.experiments.studies.chapter_4 import from_frame
from pounding.experiments.studies.sap2000_model import TIME_FACTOR, motions
from pounding.experiments.studies.sap2000_picture import picture
from pounding.experiments.studies.table_4_1 import measured, score, trusted
from pounding.frames.files import write_whole
from pounding.scale import THESIS

TITLES = {
    "gaps_7": "78 gaps of Tables 7.2 to 7.4: mean error by direction and number of fitted values",
    "gaps_7_by_record": "The same as closing gaps, a gain for each record (four fitted values), at two factors",
    "peaks_of_records": "The peak of each record, when the other three ran at their own",
    "table_4_1": "SAP2000's columns of Table 4.1: mean error by its input, and what the same model is off the tests",
    "table_4_1_by_frame": "Each frame alone at its frequency, one damping ratio fitted to its SAP2000 column",
    "table_4_2": "SAP2000's gaps of Table 4.2, nothing fitted to them: mean error by direction",
    "equal_heights": "Frequencies that SAP2000's gaps between frames of equal height ask for",
}


def study(folder: Path | None = None) -> dict[str, pd.DataFrame]:
    """Return every table of the study by name.

    Args:
        folder: Records; the usual places when None.
    """
    shaking, rows = motions(folder), sap2000_gaps.rows()
    by_factor = sap2000_gaps.factors(rows, shaking, sap2000_gaps.FACTORS)
    exact = sap2000_gaps.computed(rows, motions(folder, THESIS.time_factor))
    fits = sap2000_gaps.fits(rows, by_factor)
    pga = {name: find(name, folder).pga_g for name in RECORDS}
    gain = one_gain(fits)
    return {
        "gaps_7": pd.concat(
            {
                f"time factor {TIME_FACTOR}": fits,
                "root of 1/30": sap2000_gaps.fits(rows, {1.0: exact}),
            },
            names=["motion", "number"],
        ).reset_index("number", drop=True),
        "gaps_7_by_record": pd.concat(
            {
                factor: sap2000_gaps.by_record(rows, by_factor[factor]["closing"])
                for factor in (1.0, fitted_factor(fits))
            },
            names=["factor"],
        ),
        "peaks_of_records": sap2000_gaps.peaks_of_records(rows, by_factor[1.0], pga),
        "table_4_1": sap2000_peaks.compare_peaks(shaking, gain),
        "table_4_1_by_frame": sap2000_peaks.by_frame(shaking),
        "table_4_2": sap2000_peaks.compare_gaps_4_2(shaking, gain),
        "equal_heights": sap2000_peaks.twin_frequencies(shaking),
    }


def one_gain(fits: pd.DataFrame) -> float:
    """Return the one gain that was fitted to the closing gaps [-], see `sap2000_gaps.fits`."""
    return float(fits.set_index(["direction", "fitted"]).loc[("closing", 1), "gain"])


def fitted_factor(fits: pd.DataFrame) -> float:
    """Return the factor on the frequencies that was fitted to the closing gaps with one gain [-]."""
    return float(fits.set_index(["direction", "fitted"]).loc[("closing", 2), "factor"])


def main(
    *, records: options.Records = None, json: options.Json = False, out: options.Out = None
) -> dict[str, Any]:
    """Find which frequencies, damping, motion and direction of the gap the thesis' SAP2000 results follow from."""
    tables = study(records)
    result = stamp({"time_factor": TIME_FACTOR}, [find(name, records) for name in RECORDS])
    result |= {name: _rows(table) for name, table in tables.items()}
    result["sap2000_against_tests"] = {
        "64": score(measured("numerical")).mean,
        "58": score(measured("numerical"), trusted()).mean,
    }
    if out is not None:
        for name, table in tables.items():
            write_whole(out / f"{name}.csv", table.to_csv(float_format="%.6g").encode())
        rows = sap2000_gaps.rows()
        gaps = sap2000_gaps.computed(rows, motions(records))
        picture(rows, gaps, tables["gaps_7_by_record"].loc[1.0], out / "sap2000-input.png")
    emit(result, as_json=json, show=lambda: show(tables))
    return result


def show(tables: dict[str, pd.DataFrame]) -> Iterable[Any]:
    """Return the tables for a reader, what they say last."""
    for name, title in TITLES.items():
        yield from_frame(title, tables[name])
    yield conclusion(tables)


def conclusion(tables: dict[str, pd.DataFrame]) -> str:
    """Return in words what the gaps and the peaks say of the input."""
    fits = tables["gaps_7"].loc[f"time factor {TIME_FACTOR}"]
    closing = fits[fits["direction"] == "closing"].set_index("fitted")["error"]
    other = fits[fits["direction"] == "equation_4_1"].set_index("fitted")["error"]
    kobe = tables["peaks_of_records"].loc[("closing", "kobe")]
    table = tables["table_4_1"]
    plain = table[table["gain_by"] == "none"].set_index("fitted", append=True)
    own, one_changed, *_ = sap2000_peaks.frequencies()
    best = plain.loc[(own, 1)]
    gained = table[(table["gain_by"] == "fitted") & (table["fitted"] == 1)].loc[one_changed]
    three = "{:.1%} with nothing fitted, {:.1%} with one gain, {:.1%} with four".format
    return (
        f"The 78 gaps are closing gaps: {three(closing[0], closing[1], closing[4])} "
        f"(by equation 4.1 {three(other[0], other[1], other[4])}). Kobe ran at {kobe['implied_g']:.2f} g if the others "
        "ran at their own peaks. SAP2000's peaks of Table 4.1 follow from its printed frequencies within "
        f"{plain.loc[(own, 0), 'error_64']:.0%} at Table 3.1's damping and within {best['error_64']:.0%} at "
        f"{best['damping']:.2%} (fitted to them); with 5B's frequency as in Tables 7.2 to 7.4 and a gain of "
        f"{gained['gain']:.2f} (fitted), Table 3.1's damping brings them within {gained['error_64']:.0%}: peaks do not "
        "tell damping from gain."
    )


def _rows(table: pd.DataFrame) -> list[dict[Any, Any]]:
    """Return a table as plain rows; what is not a number there is None."""
    flat = table.reset_index().to_dict("records")
    return [
        {key: None if isinstance(value, float) and math.isnan(value) else value for key, value in row.items()}
        for row in flat
    ]


if __name__ == "__main__":
    run_script(main)
