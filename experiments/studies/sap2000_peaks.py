"""SAP2000's columns of Tables 4.1 and 4.2 computed again: from which frequencies, damping and gain they follow."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pounding.experiments.records import RECORDS, Record
from pounding.experiments.rig.states import first_frequency
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.separation.gaps.gap import published_gap
from pounding.experiments.studies.sap2000_model import (
    Real,
    fitted_gain,
    mean_error,
    moved,
    printed_frequencies,
    table_damping,
)
from pounding.experiments.studies.single_changes import extremes
from pounding.experiments.studies.table_4_1 import FRAMES, measured, trusted

DAMPINGS = (0.005, 0.0075, 0.01, 0.0125, 0.015, 0.0175, 0.02, 0.025, 0.03, 0.04)
"""Damping ratios of all modes of all frames that are tried [-]."""
TWINS = (("15A", "15B"), ("5A", "5B"))
"""Pairs of frames of the same height."""
SOFT_TO_STIFF = np.arange(0.92, 1.1201, 0.01)
"""First frequencies over those of Table 3.1 that are tried for a pair."""


def frequencies() -> dict[str, dict[str, float]]:
    """Return the first frequencies [Hz] that SAP2000's frames may have had, by what they are called."""
    own = {name: printed_frequencies(name)[0] for name in FRAMES}
    chapter_7 = {name: first_frequency(name, "unequal pair") for name in ("5B", "10", "15B")}
    return {
        "Table 3.1, SAP2000": own,
        "the same, 5B as in Tables 7.2 to 7.4": own | {"5B": chapter_7["5B"]},
        "5B, 10 and 15B as in Tables 7.2 to 7.4": own | chapter_7,
    }


def peaks(first_hz: Mapping[str, float], damping: float | None, shaking: Mapping[str, Record]) -> Real:
    """Return the peaks of Table 4.1 (places, records, sides) [mm].

    Args:
        first_hz: First frequency of each frame [Hz].
        damping: Damping ratio of all modes [-]; None for each frame's own of Table 3.1.
        shaking: Motion of the table by record.
    """
    truth = measured()
    found = np.empty(truth.shape)
    for name in FRAMES:
        here = np.flatnonzero(truth.frame.values == name)
        floors = [int(one) for one in truth.floor.values[here]]
        for column, record in enumerate(RECORDS):
            history = moved(name, floors, shaking[record], first_hz[name], damping or table_damping(name))
            found[here, column] = extremes(history)
    return found


def compare_peaks(shaking: Mapping[str, Record], foretold_gain: float) -> pd.DataFrame:
    """Return how near models come to SAP2000's columns of Table 4.1, and to the measured ones, one row a model.

    Args:
        shaking: Motion of the table by record.
        foretold_gain: Gain that was fitted to the gaps of chapter 7 [-].

    Returns:
        By name of the frequencies: ``damping`` (nan for Table 3.1's), ``gain`` and where it is from, ``fitted`` (how many
        numbers were fitted to SAP2000's columns), and mean errors [-] against SAP2000's peaks, all 64 and 58, and against
        the measured ones.
    """
    theirs, truth, sure = measured("numerical").values, measured().values, trusted().values
    found = []
    for name, first_hz in frequencies().items():
        tried = {ratio: peaks(first_hz, ratio, shaking) for ratio in (None, *DAMPINGS)}
        for gain_by in ("none", "chapter 7", "fitted"):
            for damping_by in ("Table 3.1", "fitted"):
                allowed = [None] if damping_by == "Table 3.1" else [None, *DAMPINGS]
                gains = {one: _gain(gain_by, foretold_gain, tried[one], theirs) for one in allowed}
                best = min(allowed, key=lambda one: mean_error(tried[one], theirs, gains[one]))
                ours = gains[best] * tried[best]
                found.append(
                    {
                        "frequencies": name,
                        "damping": np.nan if best is None else best,
                        "gain": gains[best],
                        "gain_by": gain_by,
                        "fitted": (damping_by == "fitted") + (gain_by == "fitted"),
                        "error_64": mean_error(ours, theirs),
                        "error_58": mean_error(ours[sure], theirs[sure]),
                        "measured_64": mean_error(ours, truth),
                        "measured_58": mean_error(ours[sure], truth[sure]),
                    }
                )
    return pd.DataFrame(found).set_index("frequencies")


def _gain(by: str, foretold: float, ours: Real, theirs: Real) -> float:
    return {"none": 1.0, "chapter 7": foretold}.get(by) or fitted_gain(ours, theirs)


def by_frame(shaking: Mapping[str, Record]) -> pd.DataFrame:
    """Return how near each frame alone comes to SAP2000's column, one damping ratio fitted to it, one row a frequency.

    Args:
        shaking: Motion of the table by record.

    Returns:
        By frame and first frequency [Hz], that of Table 3.1 and for 5B that of Tables 7.2 to 7.4: the ``damping`` ratio that
        comes nearest and its mean ``error`` [-].
    """
    theirs, frame = measured("numerical"), measured().frame.values
    own, changed, *_ = frequencies().values()
    rows = {}
    for first_hz, names in ((own, FRAMES), (changed, ("5B",))):
        tried = {damping: peaks(first_hz, damping, shaking) for damping in DAMPINGS}
        for name in names:
            here = frame == name
            errors = {damping: mean_error(ours[here], theirs.values[here]) for damping, ours in tried.items()}
            best = min(errors, key=lambda one: errors[one])
            rows[(name, first_hz[name])] = {"damping": best, "error": errors[best]}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["frame", "first_hz"])


def gaps_4_2(
    first_hz: Mapping[str, float], damping: float | None, shaking: Mapping[str, Record]
) -> pd.DataFrame:
    """Return the gaps of Table 4.2 beside SAP2000's, one row a pair and record [mm].

    Args:
        first_hz: First frequency of each frame [Hz].
        damping: Damping ratio of all modes [-]; None for each frame's own of Table 3.1.
        shaking: Motion of the table by record.
    """
    rows = {}
    for (left, right, floor), record in product(tables_4.pairs(), RECORDS):
        one, other = (
            moved(name, [floor], shaking[record], first_hz[name], damping or table_damping(name))[:, 0]
            for name in (left, right)
        )
        printed = published_gap(left, right, floor, record)
        assert printed is not None
        rows[(left, right, record)] = {
            "sap2000": printed["numerical_mm"],
            "closing": float((one - other).max()),
            "opening": float((other - one).max()),
            "equation_4_1": float(np.abs(one - other).max()),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "record"])


def compare_gaps_4_2(shaking: Mapping[str, Record], gain: float) -> pd.DataFrame:
    """Return mean errors against SAP2000's gaps of Table 4.2, nothing fitted to them, one row a group of pairs.

    Pairs of unequal height have the frequencies of Tables 7.2 to 7.4, pairs of equal height those of Table 3.1; the
    damping is Table 3.1's.

    Args:
        shaking: Motion of the table by record.
        gain: Gain that was fitted to the gaps of chapter 7 [-].
    """
    named = frequencies()
    unequal = gaps_4_2(named["5B, 10 and 15B as in Tables 7.2 to 7.4"], None, shaking)
    equal = gaps_4_2(named["Table 3.1, SAP2000"], None, shaking)
    groups = {"pairs of unequal height": unequal[~_twins(unequal)]}
    groups |= {f"{a} beside {b}": equal.xs((a, b), level=["left", "right"]) for a, b in TWINS}
    rows = {}
    for name, table in groups.items():
        printed = table["sap2000"].to_numpy(float)
        errors: dict[str, Any] = {"entries": len(table)}
        for direction in ("closing", "opening", "equation_4_1"):
            errors[direction] = mean_error(table[direction].to_numpy(float), printed, gain)
        rows[name] = errors
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("pairs")


def _twins(table: pd.DataFrame) -> NDArray[np.bool_]:
    return np.array([(left, right) in TWINS for left, right, _ in table.index], dtype=bool)


def twin_frequencies(shaking: Mapping[str, Record]) -> pd.DataFrame:
    """Return what first frequencies SAP2000's gaps between frames of the same height ask for, one row a pair.

    Returns:
        ``printed_left_hz``, ``printed_right_hz``, ``best_error_at_printed`` (the least mean error by equation 4.1 at these,
        over all damping ratios), and the frequencies and damping ratio that come nearest, with their error: three fitted
        values for four gaps.
    """
    rows = {}
    for left, right in TWINS:
        own = [printed_frequencies(name)[0] for name in (left, right)]
        floor = next(one for a, b, one in tables_4.pairs() if (a, b) == (left, right))
        printed = [published_gap(left, right, floor, record) for record in RECORDS]
        wanted = np.array([one["numerical_mm"] for one in printed if one is not None])
        tried: dict[tuple[float, float, float], float] = {}
        for damping in DAMPINGS:
            motion = [
                {
                    float(factor): [
                        moved(name, [floor], shaking[record], factor * first, damping)[:, 0]
                        for record in RECORDS
                    ]
                    for factor in SOFT_TO_STIFF
                }
                for name, first in zip((left, right), own, strict=True)
            ]
            for (a, one), (b, other) in product(motion[0].items(), motion[1].items()):
                gaps = np.array([np.abs(x - y).max() for x, y in zip(one, other, strict=True)])
                tried[(a, b, damping)] = mean_error(gaps, wanted)
        at_printed = min(
            error for (a, b, _), error in tried.items() if abs(a - 1) < 1e-9 and abs(b - 1) < 1e-9
        )
        best = min(tried, key=lambda one: tried[one])
        rows[(left, right)] = {
            "printed_left_hz": own[0],
            "printed_right_hz": own[1],
            "best_error_at_printed": at_printed,
            "left_hz": best[0] * own[0],
            "right_hz": best[1] * own[1],
            "damping": best[2],
            "error": tried[best],
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right"])
