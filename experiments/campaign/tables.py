"""Tables of the pounding campaign: counts beside the laboratory's, forces, bands, ranking, floors' peaks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from pounding.experiments.campaign.cases import LAWS, Trial, own_required_mm, peaks_table
from pounding.experiments.campaign.dissimilarity import counted_impacts, dissimilarity, ranks

KEY = ["left", "right", "record"]
DEFAULT_LAW = "linear_viscoelastic"

BANDS: dict[str, tuple[dict[str, float], dict[str, float]]] = {
    "gap 0.5 mm": ({"gap_mm": -0.5}, {"gap_mm": 0.5}),
    "frame damping 20 %": ({"frame_damping": 0.8}, {"frame_damping": 1.2}),
    "frame stiffness 8 %": ({"frame_stiffness": 0.92}, {"frame_stiffness": 1.08}),
    "contact stiffness x 2": ({"contact_stiffness": 0.5}, {"contact_stiffness": 2.0}),
}
"""What each band changes, down and up: the gap is added to, all else multiplied."""


def label(left: str, right: str, record: str) -> str:
    """Return how a case is called in tables, as 15B-5B kobe.

    Args:
        left: Name of the frame on the left.
        right: Name of the frame on the right.
        record: Name of the ground motion.
    """
    return f"{left}-{right} {record}"


def case(test: Trial, gap_mm: float, law: str = DEFAULT_LAW, **own: Any) -> dict[str, Any]:
    """Return a test as arguments of `pounding.experiments.campaign.cases.run_case`.

    Args:
        test: The test.
        gap_mm: Gap at rest [mm].
        law: Name of the impact law.
        own: Further arguments of `run_case`.
    """
    return {"left": test.left, "right": test.right, "record": test.record, "law": law, "gap_mm": gap_mm} | own


def band_cases(test: Trial, gap_mm: float) -> list[dict[str, Any]]:
    """Return a test with each of `BANDS` down and up, each marked in `contact` by nothing but its numbers."""
    cases = []
    for changes in BANDS.values():
        for change in changes:
            own: dict[str, Any] = dict(change)
            gap = max(0.0, gap_mm + own.pop("gap_mm", 0.0))
            cases.append(case(test, gap, **own))
    return cases


def requirements(tests: Sequence[Trial], folder: str | None = None) -> pd.DataFrame:
    """Return each test's gap, the laboratory's and our required gap, and the same fraction of ours."""
    rows = {}
    for test in tests:
        rows[label(test.left, test.right, test.record)] = {
            "gap_mm": test.gap_mm,
            "required_laboratory_mm": test.required_mm,
            "fraction": test.fraction,
            "required_own_mm": own_required_mm(test.left, test.right, test.record, folder),
            "required_own_flipped_mm": own_required_mm(test.left, test.right, test.record, folder, True),
            "own_gap_mm": test.own_gap_mm(folder),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("case")


def by_law(runs: pd.DataFrame, value: str) -> pd.DataFrame:
    """Return a result with one row a case and one column a law."""
    table = runs.assign(case=[label(*row) for row in runs[KEY].itertuples(index=False)])
    wide = table.pivot(index="case", columns="law", values=value)
    return wide.reindex(
        index=list(dict.fromkeys(table["case"])), columns=[law for law in LAWS if law in wide]
    )


def counted() -> pd.Series:
    """Return the impacts of Table 6.2 by case; 40 in all."""
    found = {label(*key): number for key, number in counted_impacts().items()}
    return pd.Series(found, name="counted").rename_axis("case")


def bands(tests: Sequence[Trial], runs: pd.DataFrame, value: str) -> pd.DataFrame:
    """Return the lowest and highest value over each band, from the runs of `band_cases` in their order.

    Args:
        tests: The tests.
        runs: Results, a row a run.
        value: Column of the results.
    """
    rows: dict[str, dict[str, Any]] = {}
    values = iter(runs[value])
    for test in tests:
        row = rows.setdefault(label(test.left, test.right, test.record), {})
        for name in BANDS:
            low, high = sorted([next(values), next(values)])
            row[f"{name}, from"], row[f"{name}, to"] = low, high
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("case")


def first_impact_dissimilarity(runs: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """Return each law's dissimilarity [N] from a reference over the first impact, in cases where all touched.

    Args:
        runs: One row a case and law, with `first_force`.
        reference: One row a case, with `first_force`.
    """
    references = {tuple(row[KEY]): row["first_force"] for _, row in reference.iterrows()}
    rows: dict[str, dict[str, float]] = {}
    for _, row in runs.iterrows():
        against = references[tuple(row[KEY])]
        if np.any(row["first_force"]) and np.any(against):
            rows.setdefault(label(*row[KEY]), {})[row["law"]] = dissimilarity(row["first_force"], against)
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("case").dropna()


def ranking(values: pd.DataFrame) -> pd.Series:
    """Return the sum of ranks of each law; the lowest is nearest to the reference."""
    return pd.Series(ranks(values).sum(axis=0), index=values.columns, name="sum of ranks")


def effect(runs: pd.DataFrame, apart: pd.DataFrame) -> pd.DataFrame:
    """Return by how much pounding changes each floor's peaks, as ratios to the run without contact.

    Args:
        runs: One row a case, with `peaks`.
        apart: One row a case without contact, with `peaks`.

    Returns:
        One row a case and floor: `displacement` and `acceleration` ratios, and their values apart.
    """
    without = {tuple(row[KEY]): peaks_table(row["peaks"]) for _, row in apart.iterrows()}
    parts = {}
    for _, row in runs.iterrows():
        base, found = without[tuple(row[KEY])], peaks_table(row["peaks"])
        parts[label(*row[KEY])] = pd.DataFrame(
            {
                "displacement": found["displacement_mm"] / base["displacement_mm"],
                "acceleration": found["max_acceleration_g"] / base["max_acceleration_g"],
                "apart_mm": base["displacement_mm"],
                "apart_g": base["max_acceleration_g"],
            }
        )
    return pd.concat(parts, names=["case"])


def effect_summary(ratios: pd.DataFrame) -> pd.DataFrame:
    """Return, for each case and side, the smallest and largest ratio over the floors and the roof's."""
    rows = {}
    for (name, side), floors in ratios.groupby(level=["case", "side"], sort=False):
        rows[f"{name} {side}"] = {
            "displacement_lowest": floors["displacement"].min(),
            "displacement_highest": floors["displacement"].max(),
            "displacement_roof": floors["displacement"].iloc[-1],
            "acceleration_lowest": floors["acceleration"].min(),
            "acceleration_highest": floors["acceleration"].max(),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("frame")


def agreement(runs: pd.DataFrame) -> pd.DataFrame:
    """Return how far the laws agree in each case: counts, time and peak of the first impact, largest peak."""
    rows = {}
    for key, group in runs.groupby(KEY, sort=False):
        touched = group[group["count"] > 0]
        rows[label(*key)] = {
            "impacts_fewest": int(group["count"].min()),
            "impacts_most": int(group["count"].max()),
            "first_time_spread_ms": 1e3 * float(np.ptp(touched["first_time_s"])) if len(touched) else np.nan,
            "first_peak_ratio": _ratio(touched["first_peak_n"]),
            "peak_ratio": _ratio(touched["peak_force_n"]),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("case")


def _ratio(values: pd.Series) -> float:
    return float(values.max() / values.min()) if len(values) else float("nan")
