"""Regressions of required gaps as section 7.3 has them, and what such a regression is worth beyond its own
cases.

Symbols are those of `separation.chapter_7.equations`. A model is a list of symbols; ``E2`` is the square
of E.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.chapter_7.equations import Linear
from pounding.extras import extra_module

if TYPE_CHECKING:
    from statsmodels.regression.linear_model import RegressionResultsWrapper

ALL = ("HT", "HS", "E", "FT", "FS", "DT", "DS", "ST", "SS", "MT", "MS")
WITHOUT_STIFFNESS_AND_MASS = ("HT", "HS", "E", "FT", "FS", "DT", "DS")
WITHOUT_FREQUENCY_AND_STIFFNESS = ("HT", "HS", "E", "DT", "DS", "MT", "MS")
ENHANCED_LOW = (*WITHOUT_STIFFNESS_AND_MASS, "E2")
HEIGHTS = ("HT", "HS")

MODELS: dict[str, tuple[str, ...]] = {
    "Y1": ALL,
    "Y2": WITHOUT_STIFFNESS_AND_MASS,
    "Y3": WITHOUT_FREQUENCY_AND_STIFFNESS,
}
"""The thesis' three models of each class."""

TABLES: dict[str, tuple[str, tuple[str, ...], bool]] = {
    "7.8": ("low", ALL, True),
    "7.9": ("moderate", ALL, True),
    "7.10": ("high", ALL, True),
    "7.11": ("low", WITHOUT_STIFFNESS_AND_MASS, True),
    "7.12": ("low", WITHOUT_FREQUENCY_AND_STIFFNESS, True),
    "7.13": ("moderate", WITHOUT_STIFFNESS_AND_MASS, True),
    "7.14": ("moderate", WITHOUT_FREQUENCY_AND_STIFFNESS, True),
    "7.15": ("high", WITHOUT_STIFFNESS_AND_MASS, True),
    "7.16": ("high", WITHOUT_FREQUENCY_AND_STIFFNESS, True),
    "7.18": ("low", ENHANCED_LOW, True),
    "7.19": ("low", HEIGHTS, False),
}
"""Table of the thesis: its class, the regressors, and whether it has a constant."""

TARGET = "gap_mm"
"""Equation 4.1's gap, as in the thesis: the larger of closing and opening; no one knows the next sign."""


@dataclass(frozen=True)
class Fit:
    """An ordinary least-squares fit.

    Attributes:
        symbols: The regressors asked for.
        kept: Those of them that are no combination of the constant and the ones before.
        constant: Whether it has a constant.
        results: statsmodels' results.
    """

    symbols: tuple[str, ...]
    kept: tuple[str, ...]
    constant: bool
    results: RegressionResultsWrapper

    @property
    def table(self) -> pd.DataFrame:
        """``coefficient``, ``standard_error``, ``t``, ``p`` by symbol; NaN where it was not kept."""
        order = [*(["constant"] if self.constant else []), *self.symbols]
        return (
            pd.DataFrame(
                {
                    "coefficient": self.results.params,
                    "standard_error": self.results.bse,
                    "t": self.results.tvalues,
                    "p": self.results.pvalues,
                }
            )
            .reindex(order)
            .rename_axis("symbol")
        )

    def predict(self, cases: pd.DataFrame) -> NDArray[np.floating[Any]]:
        """Return the predicted gaps (n,) [mm]."""
        return np.asarray(self.results.predict(regressors(cases, self.kept, self.constant)))

    def interval(self, cases: pd.DataFrame, *, probability: float = 0.95) -> pd.DataFrame:
        """Return ``low_mm`` and ``high_mm`` between which a new case lies with a probability.

        The interval takes the residuals for independent. Those of one earthquake are not, so it is too
        narrow for another earthquake; the column `coverage` of `cross_validate` says by how much.
        """
        frame = self.results.get_prediction(regressors(cases, self.kept, self.constant)).summary_frame(
            alpha=1.0 - probability
        )
        return pd.DataFrame({"low_mm": frame["obs_ci_lower"], "high_mm": frame["obs_ci_upper"]})


def regressors(cases: pd.DataFrame, symbols: Sequence[str], constant: bool = True) -> pd.DataFrame:
    """Return the columns of a model, the square of E made and a column of ones put first.

    Args:
        cases: The cases, a row each.
        symbols: Columns wanted; E2 is the square of E.
        constant: Put a column of ones first.

    Raises:
        ExperimentError: A symbol that is no column.
    """
    columns = {}
    for symbol in symbols:
        source = "E" if symbol == "E2" else symbol
        if source not in cases:
            raise ExperimentError(f"the cases have no column '{source}'")
        columns[symbol] = cases[source] ** 2 if symbol == "E2" else cases[source]
    made = pd.DataFrame(columns, index=cases.index)
    if constant:
        made.insert(0, "constant", 1.0)
    return made


def fit(cases: pd.DataFrame, symbols: Sequence[str], *, constant: bool = True, target: str = TARGET) -> Fit:
    """Fit a linear model by ordinary least squares.

    A regressor that is an exact combination of others (SS of HS, when the stiffness of the lower frame was
    never changed alone) is met by the least coefficients of all that fit alike (pseudo-inverse).

    Args:
        cases: One row a case.
        symbols: Regressors.
        constant: Whether the model has a constant.
        target: Column to be explained [mm].

    Raises:
        ExperimentError: Too few cases.
        MissingExtraError: statsmodels is not installed.
    """
    if len(cases) <= len(symbols) + 1:
        raise ExperimentError(f"{len(cases)} cases cannot carry {len(symbols)} regressors")
    design = regressors(cases, symbols, constant)
    kept = independent(design)
    model = extra_module("statsmodels.api").OLS(cases[target], design[kept])
    return Fit(tuple(symbols), tuple(name for name in kept if name != "constant"), constant, model.fit())


def independent(design: pd.DataFrame) -> list[str]:
    """Return the columns that are no linear combination of those before them, to one part in a million."""
    basis: list[NDArray[np.floating[Any]]] = []
    kept = []
    for name in design.columns:
        column = design[name].to_numpy(float)
        rest = column.copy()
        # Twice, since once leaves the round-off of nearly parallel columns.
        for _ in range(2):
            for direction in basis:
                rest = rest - (direction @ rest) * direction
        if np.linalg.norm(rest) > 1e-6 * np.linalg.norm(column):
            basis.append(rest / np.linalg.norm(rest))
            kept.append(str(name))
    return kept


def correlations(cases: pd.DataFrame) -> pd.DataFrame:
    """Return Pearson's correlations of the gap and the eleven variables (12, 12), as Tables 7.5 to 7.7."""
    columns = cases[[TARGET, *ALL]].rename(columns={TARGET: "gap"})
    return columns.corr().rename_axis("variable")


def variance_inflation(cases: pd.DataFrame, symbols: Sequence[str]) -> pd.Series:
    """Return the variance inflation factor of each regressor; above 10 its coefficient cannot be read on its
    own.

    Infinite where a regressor is an exact combination of the others.
    """
    factor = extra_module("statsmodels.stats.outliers_influence").variance_inflation_factor
    design = regressors(cases, symbols)
    factors = {}
    for symbol in symbols:
        # With the regressor last, it is left out exactly when the others already say all that it says.
        kept = independent(design[[name for name in design.columns if name != symbol] + [symbol]])
        inside = symbol in kept
        factors[symbol] = factor(design[kept].to_numpy(float), len(kept) - 1) if inside else np.inf
    return pd.Series(factors, name="vif")


def errors(actual: NDArray[np.floating[Any]], predicted: NDArray[np.floating[Any]]) -> dict[str, float]:
    """Return ``mse_mm2`` and ``mae_mm`` (thesis equations 7.11 and 7.12), ``bias_mm``, ``unsafe`` and
    ``relative``.

    ``unsafe`` is the share of cases whose gap is predicted too small, ``relative`` the mean size of the
    error over gap.

    Args:
        actual: Gap of each case (cases,) [mm].
        predicted: Its prediction (cases,) [mm].
    """
    error = np.asarray(predicted, float) - np.asarray(actual, float)
    return {
        "mse_mm2": float(np.mean(error**2)),
        "mae_mm": float(np.mean(np.abs(error))),
        "bias_mm": float(np.mean(error)),
        "unsafe": float(np.mean(error < 0.0)),
        "relative": float(np.mean(np.abs(error) / np.maximum(np.abs(actual), 1e-9))),
    }


def impossible(printed: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose ``mse`` is below the square of their ``mae``, which no set of errors can have.

    A half of the last printed digit of either is allowed for.
    """
    least = (printed["mae"] - 0.005).clip(lower=0.0) ** 2
    return printed[printed["mse"] + 0.005 < least]


def p_values_that_do_not_follow(printed: pd.DataFrame, count: int) -> pd.DataFrame:
    """Return the rows of a printed regression whose p value is not that of their t, by more than a factor
    10^6.

    Args:
        printed: Table of the thesis with ``t`` and ``p``, see `pounding.experiments.published.table`.
        count: Number of cases.

    Returns:
        ``t``, ``p`` as printed and ``p_of_t``; a t rounded to a digit moves a small p by powers of ten,
        hence the factor, which grows with t.
    """
    t = pd.to_numeric(printed["t"], errors="coerce")
    p = pd.to_numeric(printed["p"], errors="coerce")
    degrees = count - len(printed)
    exponent = stats.t.logsf(t.abs(), degrees) / np.log(10.0) + np.log10(2.0)
    digits = np.where(t.abs() >= 10.0, 0.5, 0.05)
    room = 1.0 + digits * t.abs() / np.log(10.0)
    wrong = (p > 0.0) & ((np.log10(p.where(p > 0.0)) - exponent).abs() > room)
    found = pd.DataFrame({"t": t, "p": p, "log10_p_of_t": exponent})
    return found[wrong]


def cross_validate(
    cases: pd.DataFrame, symbols: Sequence[str], by: str, *, constant: bool = True, seed: int = 7
) -> pd.DataFrame:
    """Return the errors on cases that the fit had not seen.

    Args:
        cases: One row a case.
        symbols: Regressors.
        by: Column whose values are held out one after the other (``event``, ``pair``), or ``row``: ten
            random tenths.
        constant: Whether the model has a constant.
        seed: Of the random tenths.

    Returns:
        One row a group: ``cases``, `errors` on it, and ``coverage``, the share inside the 95 % prediction
        interval.
    """
    shuffled = np.random.default_rng(seed).permutation(len(cases))
    labels = shuffled % 10 if by == "row" else cases[by].to_numpy()
    rows = {}
    for label in pd.unique(labels):
        held, rest = cases[labels == label], cases[labels != label]
        if rest.empty:
            raise ExperimentError(f"only one {by} among the cases: nothing is left to fit on")
        fitted = fit(rest, symbols, constant=constant)
        actual = held[TARGET].to_numpy(float)
        interval = fitted.interval(held)
        inside = (actual >= interval["low_mm"].to_numpy()) & (actual <= interval["high_mm"].to_numpy())
        rows[label] = (
            {"cases": len(held)} | errors(actual, fitted.predict(held)) | {"coverage": float(inside.mean())}
        )
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(by)


def pooled(groups: pd.DataFrame) -> dict[str, float]:
    """Return the errors over all groups of a cross-validation, each case counted once."""
    weights = groups["cases"] / groups["cases"].sum()
    return {name: float((groups[name] * weights).sum()) for name in groups.columns if name != "cases"}


def mapping_errors(
    cases: pd.DataFrame, equation: Linear, *, correct: Callable[[float], float] | None = None
) -> dict[str, float]:
    """Return the `errors` of one of the thesis' equations over cases.

    Args:
        cases: One row a case.
        equation: The equation, at model scale.
        correct: What is done to its result, as `equations.correct_high`.
    """
    rows = cases[list(ALL)].to_numpy(float)
    predicted = [equation(**dict(zip(ALL, row, strict=True))) for row in rows]
    if correct is not None:
        predicted = [correct(value) for value in predicted]
    return errors(cases[TARGET].to_numpy(float), np.array(predicted))
