"""SAP2000's gaps of Tables 7.2 to 7.4 computed again: which difference of two motions they are, and of which input."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from pounding.experiments import published
from pounding.experiments.records import RECORDS, Record
from pounding.experiments.separation.chapter_7.printed_rows import printed_rows
from pounding.experiments.studies.frame_states import baseline
from pounding.experiments.studies.sap2000_model import Real, fitted_gain, mean_error, moved

DIRECTIONS = {"closing": "closing", "opening": "opening", "equation_4_1": "larger of both (equation 4.1)"}
FACTORS = np.arange(0.980, 1.0101, 0.0025)
"""Factors on all frequencies that are tried."""


def rows() -> pd.DataFrame:
    """Return the printed rows of Tables 7.2 to 7.4 under the four records of the tests, see `printed_rows`."""
    every = printed_rows()
    return every[every["label"].isin(RECORDS)].reset_index(drop=True)


def computed(chosen: pd.DataFrame, shaking: Mapping[str, Record], factor: float = 1.0) -> dict[str, Real]:
    """Return the gaps of rows by direction (rows,) [mm], at the printed frequencies and damping ratios.

    Closing is the largest of u_tall - u_short, the motion of the taller frame on the left towards the lower one.

    Args:
        chosen: See `rows`.
        shaking: Motion of the table by record.
        factor: By which the printed frequencies are multiplied [-].
    """
    known: dict[tuple[Any, ...], Real] = {}
    closing, opening = np.empty(len(chosen)), np.empty(len(chosen))
    for number, row in enumerate(chosen.to_dict("records")):
        floor, record = len(baseline(row["short"]).height_m), row["label"]
        pair = []
        for side in ("tall", "short"):
            key = (row[side], floor, record, row[f"{side}_frequency_hz"], row[f"{side}_damping_percent"])
            if key not in known:
                known[key] = moved(row[side], [floor], shaking[record], factor * key[3], 0.01 * key[4])[:, 0]
            pair.append(known[key])
        difference = pair[0] - pair[1]
        closing[number], opening[number] = difference.max(), -difference.min()
    return {"closing": closing, "opening": opening, "equation_4_1": np.maximum(closing, opening)}


def by_record(chosen: pd.DataFrame, gaps: Real) -> pd.DataFrame:
    """Return a gain for each record and what is left: one row a record with ``rows``, ``gain`` and ``error`` [-].

    Args:
        chosen: See `rows`.
        gaps: Computed gaps of the rows [mm].
    """
    printed, label = chosen["gap_mm"].to_numpy(float), chosen["label"].to_numpy()
    found = {}
    for name in RECORDS:
        here = label == name
        gain = fitted_gain(gaps[here], printed[here])
        found[name] = {
            "rows": int(here.sum()),
            "gain": gain,
            "error": mean_error(gaps[here], printed[here], gain),
        }
    return pd.DataFrame.from_dict(found, orient="index").rename_axis("record")


def fits(chosen: pd.DataFrame, by_factor: Mapping[float, Mapping[str, Real]]) -> pd.DataFrame:
    """Return how near the gaps come in each direction with more and more fitted numbers, one row a model.

    Args:
        chosen: See `rows`.
        by_factor: Gaps by direction (rows,) [mm] for each factor on the frequencies, 1 among them, see `computed`.

    Returns:
        ``direction``, ``fitted`` (how many numbers), ``factor``, ``gain`` (nan for four gains), ``error`` and
        ``held_out``: the mean error on each record when the numbers are fitted to the other three (nan where a record has
        a gain of its own).
    """
    found = []
    for direction in DIRECTIONS:
        plain = by_factor[1.0][direction]
        free = {factor: gaps[direction] for factor, gaps in by_factor.items()}
        four = by_record(chosen, plain)
        found += [
            _row(chosen, direction, {1.0: plain}, 0),
            _row(chosen, direction, {1.0: plain}, 1),
            _row(chosen, direction, free, 2),
            {
                "direction": direction,
                "fitted": 4,
                "factor": 1.0,
                "gain": np.nan,
                "error": float((four["error"] * four["rows"]).sum() / four["rows"].sum()),
                "held_out": np.nan,
            },
        ]
    return pd.DataFrame(found)


def _row(chosen: pd.DataFrame, direction: str, gaps: Mapping[float, Real], fitted: int) -> dict[str, Any]:
    printed, label = chosen["gap_mm"].to_numpy(float), chosen["label"].to_numpy()
    factor, gain, error = _best(gaps, printed, fitted)
    left_out = []
    for name in RECORDS:
        out = label == name
        inside = {key: values[~out] for key, values in gaps.items()}
        found = _best(inside, printed[~out], fitted)
        left_out.append(mean_error(gaps[found[0]][out], printed[out], found[1]) * out.sum())
    return {
        "direction": direction,
        "fitted": fitted,
        "factor": factor,
        "gain": gain,
        "error": error,
        "held_out": sum(left_out) / len(chosen),
    }


def _best(gaps: Mapping[float, Real], printed: Real, fitted: int) -> tuple[float, float, float]:
    """Return factor, gain and error of the nearest gaps; the gain is 1 when nothing is fitted."""
    tried = []
    for factor, values in gaps.items():
        gain = fitted_gain(values, printed) if fitted else 1.0
        tried.append((factor, gain, mean_error(values, printed, gain)))
    return min(tried, key=lambda one: one[2])


def peaks_of_records(
    chosen: pd.DataFrame, gaps: Mapping[str, Real], pga_g: Mapping[str, float]
) -> pd.DataFrame:
    """Return which peak each record had in the thesis' runs if the other three ran at their own, one row each.

    Args:
        chosen: See `rows`.
        gaps: Computed gaps by direction [mm].
        pga_g: The records' own peaks [g].

    Returns:
        By direction and record: ``own_g``, ``table_7_1_g``, ``implied_g`` (own peak times the record's gain over the one
        gain of the others), ``error_own`` and ``error_table_7_1``: mean errors at both peaks with that gain [-].
    """
    printed, label = chosen["gap_mm"].to_numpy(float), chosen["label"].to_numpy()
    listed = published.table("7.1")["pga_g"]
    found = {}
    for direction in DIRECTIONS:
        values = gaps[direction]
        for name in RECORDS:
            here = label == name
            others = fitted_gain(values[~here], printed[~here])
            ratio = float(listed[name]) / pga_g[name]
            found[(direction, name)] = {
                "own_g": pga_g[name],
                "table_7_1_g": float(listed[name]),
                "implied_g": pga_g[name] * fitted_gain(values[here], printed[here]) / others,
                "error_own": mean_error(values[here], printed[here], others),
                "error_table_7_1": mean_error(values[here], printed[here], others * ratio),
            }
    return pd.DataFrame.from_dict(found, orient="index").rename_axis(["direction", "record"])


def factors(
    chosen: pd.DataFrame, shaking: Mapping[str, Record], tried: Iterable[float]
) -> dict[float, dict[str, Real]]:
    """Return the gaps by direction (rows,) [mm] for each factor on the frequencies, and for 1, see `computed`.

    Args:
        chosen: See `rows`.
        shaking: Motion of the table by record.
        tried: The factors [-].
    """
    wanted = sorted({1.0, *(round(float(one), 6) for one in tried)})
    return {factor: computed(chosen, shaking, factor) for factor in wanted}
