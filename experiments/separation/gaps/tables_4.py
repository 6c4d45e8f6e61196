"""Tables 4.2 and 4.3 of the thesis beside computed gaps, and every rule beside the gap it should cover."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from pounding.experiments import published
from pounding.experiments.published import consistency
from pounding.experiments.published.consistency import Pair
from pounding.experiments.records import RECORDS
from pounding.experiments.rig.required_gap import RequiredGap, fine_step, motions, required_gap
from pounding.experiments.separation.gaps.gap import published_gap
from pounding.experiments.separation.rules.answers import Building, code_rules
from pounding.frames import ReducedFrame
from pounding.scale import THESIS

TABLE_4_3_TOLERANCE_MM = 0.1
"""Peaks and sums are printed to a tenth."""


def pairs() -> list[tuple[str, str, int]]:
    """Return left frame, right frame and floor of contact of the thesis' five pairs."""
    return [(str(left), str(right), int(floor)) for left, right, floor in published.table("4.2").index]


def computed_gaps(
    frame: Callable[[str], ReducedFrame], motion: Callable[[str], Any]
) -> dict[tuple[str, str, int, str], RequiredGap]:
    """Return the required gap of each pair under each record.

    Args:
        frame: Gives a frame by its name.
        motion: Gives a record at model scale by its name.
    """
    floors: dict[str, list[int]] = {}
    for left, right, floor in pairs():
        for name in (left, right):
            floors.setdefault(name, []).append(floor)
    found = {}
    for record in RECORDS:
        shaking = motion(record)
        step = shaking.step_s / fine_step(shaking.step_s)
        moved = {
            (name, floor): history
            for name, wanted in floors.items()
            for floor, history in zip(wanted, motions(frame(name), shaking, wanted).T, strict=True)
        }
        for left, right, floor in pairs():
            found[(left, right, floor, record)] = required_gap(
                moved[(left, floor)], moved[(right, floor)], step
            )
    return {(*pair, record): found[(*pair, record)] for pair, record in product(pairs(), RECORDS)}


def table_4_2(gaps: Mapping[tuple[str, str, int, str], RequiredGap]) -> pd.DataFrame:
    """Return Table 4.2 beside computed gaps: one row a pair and record.

    Returns:
        ``experiment_mm``, ``sap2000_mm``, ``closing_mm``, ``opening_mm``, ``equation_4_1_mm``, ``contested``
        (a frame's peaks under this record are contradicted by the thesis' own tables).
    """
    blamed = consistency.contested(consistency.check_published())
    rows = {}
    for (left, right, floor, record), gap in gaps.items():
        printed = published_gap(left, right, floor, record)
        assert printed is not None
        rows[(left, right, floor, record)] = {
            "experiment_mm": printed["experiment_mm"],
            "sap2000_mm": printed["numerical_mm"],
            "closing_mm": 1e3 * gap.closing_m,
            "opening_mm": 1e3 * gap.opening_m,
            "equation_4_1_mm": 1e3 * gap.equation_4_1_m,
            "contested": bool({(left, record), (right, record)} & blamed),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "floor", "record"])


def mean_errors(table: pd.DataFrame) -> pd.DataFrame:
    """Return mean, worst and bias of ``abs(computed - measured) / measured`` for every column [mm] but the measured."""
    rows = {}
    for name in [column for column in table if str(column).endswith("_mm") and column != "experiment_mm"]:
        error = table[name] / table["experiment_mm"] - 1.0
        rows[name] = {
            "mean": error.abs().mean(),
            "median": error.abs().median(),
            "worst": error.abs().max(),
            "bias": error.mean(),
        }
    return pd.DataFrame(rows).T


def table_4_3() -> pd.DataFrame:
    """Return Table 4.3 recomputed from the experimental peaks of Table 4.1, one row a printed sum or root.

    Returns:
        ``printed_mm``, ``recomputed_mm``, ``difference_mm`` and ``follows``: whether they agree within 0.1 mm
        after rounding to the printed digits.
    """
    peaks = consistency.published_peaks()
    combine: dict[str, Callable[[float, float], float]] = {"abs": operator.add, "srss": math.hypot}
    rows = {}
    for rule, function in combine.items():
        for pair, printed in consistency.published_gaps("4.3", rule).items():
            a, b = (max(peaks[(name, pair.floor, pair.record)]) for name in (pair.left, pair.right))
            again = function(a, b)
            digits = 0 if float(printed).is_integer() else 1 if round(printed, 1) == printed else 2
            rows[(pair.left, pair.right, pair.floor, pair.record, rule)] = {
                "printed_mm": printed,
                "recomputed_mm": again,
                "difference_mm": printed - again,
                "follows": abs(printed - round(again, digits)) <= TABLE_4_3_TOLERANCE_MM + 1e-9,
            }
    index = ["left", "right", "floor", "record", "rule"]
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(index)


def rules_from_measured(frames: Mapping[str, ReducedFrame], pga_g: Mapping[str, float]) -> pd.DataFrame:
    """Return each rule's gap from the *measured* peaks over the *measured* gap, one row a pair and record.

    Args:
        frames: Frames by name, for heights, periods and damping.
        pga_g: Peak of each record [g].
    """
    peaks = consistency.published_peaks()
    rows = {}
    for pair, gap in consistency.published_gaps("4.2", "experiment").items():
        peak = {name: 1e-3 * max(peaks[(name, pair.floor, pair.record)]) for name in (pair.left, pair.right)}
        rows[_key(pair)] = _ratios(frames, pair, peak, pga_g[pair.record], gap)
    return _ratio_table(rows)


def rules_from_computed(
    frames: Callable[[Pair], Mapping[str, ReducedFrame]],
    pga_g: Mapping[str, float],
    gaps: Mapping[tuple[str, str, int, str], RequiredGap],
) -> pd.DataFrame:
    """Return each rule's gap from the computed peaks over the computed equation 4.1, as above.

    Args:
        frames: Gives the frames of a pair under a record by their names.
        pga_g: Peak of each record [g].
        gaps: Required gap by left and right frame, floor and record.
    """
    rows = {}
    for (left, right, floor, record), gap in gaps.items():
        pair = Pair(left, right, floor, record)
        peak = {left: gap.left_peak_m, right: gap.right_peak_m}
        rows[_key(pair)] = _ratios(frames(pair), pair, peak, pga_g[record], 1e3 * gap.equation_4_1_m)
    return _ratio_table(rows)


def summary(ratios: pd.DataFrame) -> pd.DataFrame:
    """Return for each rule how often it is safe, how far it is off, and its least and largest share of the
    gap.

    ``error`` is the mean of ``abs(rule / required - 1)``, ``safe`` the share of pairs and records that it
    covers, and ``covers_for`` the factor by which it would have to be multiplied to cover all of them.
    """
    table = pd.DataFrame(
        {
            "cases": ratios.notna().sum(),
            "safe": (ratios >= 1.0 - 1e-9).sum() / ratios.notna().sum(),
            "error": (ratios - 1.0).abs().mean(),
            "least": ratios.min(),
            "median": ratios.median(),
            "largest": ratios.max(),
        }
    )
    table["covers_for"] = 1.0 / table["least"]
    return table.sort_values("error").rename_axis("rule")


def _key(pair: Pair) -> tuple[str, str, int, str]:
    return pair.left, pair.right, pair.floor, pair.record


def _ratios(
    frames: Mapping[str, ReducedFrame], pair: Pair, peak: Mapping[str, float], pga_g: float, gap_mm: float
) -> dict[str, float]:
    buildings = [
        Building(
            float(frames[name].heights_m[-1]),
            float(frames[name].frequencies_hz[0]),
            frames[name].damping_ratio,
            peak[name],
        )
        for name in (pair.left, pair.right)
    ]
    short, tall = sorted(buildings, key=lambda building: building.height_m)
    answers = code_rules(tall, short, pga_g, length_scale=THESIS.buildings_length)
    return {a.name: np.nan if a.gap_mm is None else a.gap_mm / gap_mm for a in answers}


def _ratio_table(rows: dict[tuple[str, str, int, str], dict[str, float]]) -> pd.DataFrame:
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "floor", "record"])
