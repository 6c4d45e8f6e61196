"""Tables 7.5 to 7.19 of the thesis beside the same statistics of our cases, and what cannot be in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from pounding.experiments import published
from pounding.experiments.separation.chapter_7 import equations
from pounding.experiments.separation.chapter_7.equations import Linear
from pounding.experiments.separation.chapter_7.regression import (
    MODELS,
    TABLES,
    TARGET,
    WITHOUT_STIFFNESS_AND_MASS,
    correlations,
    cross_validate,
    errors,
    fit,
    impossible,
    mapping_errors,
    p_values_that_do_not_follow,
    pooled,
    variance_inflation,
)

LEVELS = ("low", "moderate", "high")
CORRELATION_TABLES = {"low": "7.5", "moderate": "7.6", "high": "7.7"}
COUNTS = {"low": 3081, "moderate": 3081, "high": 3606}
"""Cases of the thesis in each class."""

CORRECTED: dict[str, tuple[Linear, Callable[[float], float] | None]] = {
    "7.14": (equations.HIGH_2, equations.correct_high)
}


def levels_in(cases: pd.DataFrame) -> list[str]:
    """Return the classes that have cases; with records missing it may not be all three."""
    return [level for level in LEVELS if (cases["level"] == level).any()]


def correlation_rows(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the gap's correlation with each variable, printed and ours, one row a class and variable."""
    rows = {}
    for level in levels_in(cases):
        printed = published.table(CORRELATION_TABLES[level]).loc["gap"]
        ours = correlations(cases[cases["level"] == level]).loc["gap"]
        for symbol in printed.index[1:]:
            rows[(level, symbol)] = {"printed": float(printed[symbol]), "ours": float(ours[symbol])}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["level", "symbol"])


def regression_rows(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the coefficients of every printed regression beside ours, one row a table and symbol.

    Returns:
        ``printed``, ``ours``, ``standard_error`` and ``p`` of ours, and ``same_sign``.
    """
    tables = {}
    for number, (level, symbols, constant) in TABLES.items():
        if level not in levels_in(cases):
            continue
        printed = pd.to_numeric(published.table(number)["coefficient"], errors="coerce")
        ours = fit(cases[cases["level"] == level], symbols, constant=constant).table
        joined = pd.DataFrame(
            {
                "printed": printed,
                "ours": ours["coefficient"],
                "standard_error": ours["standard_error"],
                "p": ours["p"],
            }
        ).reindex(ours.index)
        joined["same_sign"] = np.sign(joined["printed"]) == np.sign(joined["ours"])
        tables[number] = joined
    return pd.concat(tables, names=["table", "symbol"])


def error_rows(cases: pd.DataFrame) -> pd.DataFrame:
    """Return Table 7.17: MSE and MAE of each model, printed, and of ours on our cases, with R^2 of ours."""
    printed = published.table("7.17")
    rows = {}
    for level in levels_in(cases):
        chosen = cases[cases["level"] == level]
        for model, symbols in MODELS.items():
            fitted = fit(chosen, symbols)
            found = errors(chosen[TARGET].to_numpy(float), fitted.predict(chosen))
            rows[(level, model)] = {
                "printed_mse": float(printed[(level, "mse")][model]),
                "ours_mse": found["mse_mm2"],
                "printed_mae": float(printed[(level, "mae")][model]),
                "ours_mae": found["mae_mm"],
                "ours_r2": float(fitted.results.rsquared),
            }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["level", "model"])


def thesis_equations_on(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of equations 7.2 to 7.14 and 7.20 on cases of their own class, by pair.

    Beside each stand the errors that the thesis prints for it, where it prints any for that pair.
    """
    printed = published.table("section 7.4")
    plain: dict[str, tuple[Linear, Callable[[float], float] | None]]
    plain = {equation.number: (equation, None) for equation in equations.MODEL_SCALE}
    rows = {}
    for number, (equation, correct) in (plain | CORRECTED).items():
        for pair, group in cases[cases["level"] == equation.level].groupby("pair"):
            row = mapping_errors(group, equation, correct=correct)
            key = (f"eq {number}", str(pair))
            there = key in printed.index
            row["printed_mse"] = float(printed["mse"][key]) if there else np.nan
            row["printed_mae"] = float(printed["mae"][key]) if there else np.nan
            rows[(number, str(pair))] = row
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["equation", "pair"])


def inflation_rows(cases: pd.DataFrame, models: Sequence[str] = tuple(MODELS)) -> pd.DataFrame:
    """Return the variance inflation of each regressor in each model, over all cases of the lowest class
    there is.

    The design is alike in all classes but for the peaks, so one class stands for all.
    """
    chosen = cases[cases["level"] == levels_in(cases)[0]]
    return pd.DataFrame({model: variance_inflation(chosen, MODELS[model]) for model in models}).rename_axis(
        "symbol"
    )


def validation_rows(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the cross-validated errors of the thesis' three models by row, pair and event, one row each."""
    rows = {}
    for level in levels_in(cases):
        chosen = cases[cases["level"] == level]
        for model, symbols in MODELS.items():
            for by in ("row", "pair", "event"):
                if by != "row" and chosen[by].nunique() < 2:
                    continue  # one earthquake cannot be held out and learnt from
                rows[(level, model, by)] = pooled(cross_validate(chosen, symbols, by))
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["level", "model", "held out"])


def ours_on_new_frames(cases: pd.DataFrame, new: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of the thesis' second model, fitted to our cases, on frames not among them."""
    rows = {}
    for level in levels_in(cases):
        fitted = fit(cases[cases["level"] == level], WITHOUT_STIFFNESS_AND_MASS)
        for pair, group in new[new["level"] == level].groupby("pair"):
            interval = fitted.interval(group)
            actual = group[TARGET].to_numpy(float)
            inside = (actual >= interval["low_mm"].to_numpy()) & (actual <= interval["high_mm"].to_numpy())
            rows[(level, str(pair))] = errors(actual, fitted.predict(group)) | {"coverage": inside.mean()}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["level", "pair"])


def contradictions() -> dict[str, pd.DataFrame]:
    """Return what cannot be: an MSE below the square of its MAE, a p value that is not that of its t."""
    wrong = {}
    for number, (level, _, _) in TABLES.items():
        found = p_values_that_do_not_follow(published.table(number), COUNTS[level])
        if len(found):
            wrong[number] = found
    return {
        "impossible_errors": impossible(published.table("section 7.4")),
        "p_values": pd.concat(wrong, names=["table", "symbol"]),
    }
