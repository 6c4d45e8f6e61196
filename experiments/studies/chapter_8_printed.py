"""What the printed tables of the thesis say, alone, of the conclusions of its chapter 8."""

from __future__ import annotations

import numpy as np
import pandas as pd

from pounding.experiments import published
from pounding.experiments.campaign.dissimilarity import printed_values, ranks
from pounding.experiments.published.consistency import published_gaps
from pounding.experiments.studies.sap2000_peaks import TWINS

NEAR_FIELD = ("northridge", "kobe")
"""Section 3.7 calls these two near-field, El Centro and Hachinohe far-field."""
DRAWS, SEED = 10_000, 8
CORRELATIONS = {"low": "7.5", "moderate": "7.6", "high": "7.7"}
REGRESSIONS = ("7.11", "7.12", "7.13", "7.14", "7.15", "7.16", "7.18")


def gaps() -> pd.DataFrame:
    """Return the measured gaps of Table 4.2 with the sums of Table 4.3 and 1 % of heights, one row a pair and record [mm].

    Returns:
        ``required``, ``abs``, ``srss``, ``taller``, ``lower`` and ``summed`` (1 % of both heights: AS 1170.4 is a setback
        from the boundary), and whether the pair is of ``equal`` height and the record ``near``.
    """
    required = published_gaps("4.2", "experiment")
    sums, roots = published_gaps("4.3", "abs"), published_gaps("4.3", "srss")
    left, right = published_gaps("4.2", "as1170_a"), published_gaps("4.2", "as1170_b")
    rows = {
        (pair.left, pair.right, pair.record): {
            "required": gap,
            "abs": sums[pair],
            "srss": roots[pair],
            "taller": max(left[pair], right[pair]),
            "lower": min(left[pair], right[pair]),
            "summed": left[pair] + right[pair],
            "equal": (pair.left, pair.right) in TWINS,
            "near": pair.record in NEAR_FIELD,
        }
        for pair, gap in required.items()
    }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "record"])


def height_rule(table: pd.DataFrame) -> pd.DataFrame:
    """Return how often 1 % of a height suffices, one row a rule.

    Args:
        table: See `gaps`.

    Returns:
        ``far`` and ``near``: how many of the ten entries each are covered, ``least``: the smallest share of the gap [-].
    """
    rows = {}
    for rule in ("lower", "taller", "summed"):
        enough = table[rule] >= table["required"]
        rows[rule] = {
            "far": int(enough[~table["near"]].sum()),
            "near": int(enough[table["near"]].sum()),
            "least": float((table[rule] / table["required"]).min()),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("rule")


def combination_rules(table: pd.DataFrame) -> pd.DataFrame:
    """Return how ABS and SRSS compare with the measured gap, for frames of equal height and for the others.

    Frames of equal height are those whose frequencies are close (5A and 5B by 6 %, 15A and 15B by 1 %).

    Args:
        table: See `gaps`.

    Returns:
        By rule and group: ``entries``, ``safe`` (how many are covered), ``error`` (mean of abs(rule / required - 1)),
        ``least`` and ``largest`` (rule / required).
    """
    rows = {}
    groups = {"all": table, "equal heights": table[table["equal"]], "unequal": table[~table["equal"]]}
    for rule in ("abs", "srss"):
        for name, group in groups.items():
            ratio = group[rule] / group["required"]
            rows[(rule, name)] = {
                "entries": len(group),
                "safe": int((ratio >= 1.0).sum()),
                "error": float((ratio - 1.0).abs().mean()),
                "least": float(ratio.min()),
                "largest": float(ratio.max()),
            }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["rule", "pairs"])


def by_field(required: pd.Series, pga_g: pd.Series) -> pd.DataFrame:
    """Return the mean required gap of far-field and near-field records, and over the record's peak, one row each.

    Args:
        required: Required gap [mm], indexed by left, right and record.
        pga_g: Peak of each record [g].
    """
    record = required.index.get_level_values("record")
    per_g = required / pga_g.reindex(record).to_numpy(float)
    near = pd.Series(record.isin(NEAR_FIELD), required.index)
    rows = {
        name: {"gap_mm": float(required[chosen].mean()), "gap_mm_per_g": float(per_g[chosen].mean())}
        for name, chosen in (("far", ~near), ("near", near))
    }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("field")


def ranking() -> pd.DataFrame:
    """Return the sum of ranks of each law, recomputed from Table 6.2, and how often it is first in resampled tables.

    The 40 impacts are drawn with replacement, as if they were independent; impacts of one test are not, so that the true
    uncertainty is larger.
    """
    values = printed_values()
    found = ranks(values)
    draws = np.random.default_rng(SEED).integers(0, len(found), (DRAWS, len(found)))
    first = found[draws].sum(axis=1).argmin(axis=1)
    share = [float((first == law).mean()) for law in range(found.shape[1])]
    return pd.DataFrame(
        {"rank_sum": found.sum(axis=0), "first": share}, index=pd.Index(values.columns, name="law")
    )


def dissimilarity_by_pair() -> pd.DataFrame:
    """Return mean and median of Table 6.2's dissimilarities by pair, over impacts and laws [N], and the impacts."""
    rows = {}
    for (left, right), group in printed_values().groupby(level=["left", "right"], sort=False):
        values = group.to_numpy(float)
        rows[f"{left}-{right}"] = {
            "impacts": len(group),
            "mean_n": float(values.mean()),
            "median_n": float(np.median(values)),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("pair")


def taller_and_lower() -> pd.DataFrame:
    """Return whether the lower frame counts for more than the taller, for height and damping, one row a printed table.

    Correlations with the gap (Tables 7.5 to 7.7) and coefficients of the regressions are compared by size.
    """
    rows = {}
    for level, number in CORRELATIONS.items():
        rows[f"{number}, correlation, {level}"] = published.table(number).loc["gap"].astype(float).abs()
    for number in REGRESSIONS:
        rows[f"{number}, coefficient"] = pd.to_numeric(published.table(number)["coefficient"]).abs()
    return pd.DataFrame(
        {
            name: {
                "HT": row["HT"],
                "HS": row["HS"],
                "HS larger": bool(row["HS"] > row["HT"]),
                "DT": row["DT"],
                "DS": row["DS"],
                "DS larger": bool(row["DS"] > row["DT"]),
            }
            for name, row in rows.items()
        }
    ).T.rename_axis("table")
