"""Formulas for a required gap without a simulation, judged on earthquakes and pairs they have not seen.

Two families: those that know of an earthquake its peak acceleration alone, as the thesis', and those that
know its response spectrum at the two first periods.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.separation.chapter_7.regression import (
    TARGET,
    WITHOUT_STIFFNESS_AND_MASS,
    errors,
    fit,
)
from pounding.experiments.separation.rules import rules
from pounding.frames.response.exact import oscillator_peaks

Real = NDArray[np.floating[Any]]
Formula = Callable[[pd.DataFrame, pd.DataFrame], Real]
"""Takes cases to learn from and cases to predict, returns the predicted gaps [mm]."""

POWER_SYMBOLS = ("log_E", "log_FT", "log_FS", "log_DT", "log_DS", "log_HT", "log_HS")
SPECTRAL_SYMBOLS = ("log_spectral_tall", "log_spectral_short")
STOREY_MM = 100.0


def with_spectra(cases: pd.DataFrame, records: Mapping[str, Record]) -> pd.DataFrame:
    """Return the cases with what the formulas need beside the thesis' symbols.

    ``spectral_tall_mm`` and ``spectral_short_mm`` are the peaks at the lower roof that the response spectrum
    gives for a frame of equal floors moving along a straight line: participation 3n/(2n+1) and the share of
    the height. ``correlation`` is that of `rules.correlation`. Logarithms have the prefix ``log_``.

    Args:
        cases: The study's cases, with ``record``.
        records: Motions at model scale by name, at the peaks that the cases had.

    Raises:
        ExperimentError: A motion of the cases is not given.
    """
    made = cases.copy()
    for side in ("T", "S"):
        made[f"sd_{side}"] = np.nan
    for name, group in cases.groupby("record"):
        if name not in records:
            raise ExperimentError(f"the record '{name}' of the cases is not given")
        for side in ("T", "S"):
            made.loc[group.index, f"sd_{side}"] = _spectral_mm(group, side, records[str(name)])
    storeys_tall, storeys_short = made["HT"] / STOREY_MM, made["HS"] / STOREY_MM
    made["spectral_tall_mm"] = _participation(storeys_tall) * made["HS"] / made["HT"] * made["sd_T"]
    made["spectral_short_mm"] = _participation(storeys_short) * made["sd_S"]
    made["correlation"] = [
        rules.correlation(1.0 / tall, 1.0 / short, damping_tall / 100.0, damping_short / 100.0)
        for tall, short, damping_tall, damping_short in made[["FT", "FS", "DT", "DS"]].to_numpy(float)
    ]
    for symbol in ("E", "FT", "FS", "DT", "DS", "HT", "HS"):
        made[f"log_{symbol}"] = np.log(made[symbol])
    made["log_spectral_tall"] = np.log(made["spectral_tall_mm"])
    made["log_spectral_short"] = np.log(made["spectral_short_mm"])
    made["log_gap"] = np.log(np.maximum(made[TARGET], 1e-6))
    return made


def by_class(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return gaps [mm] by the thesis' form: a linear equation for each class (equations 7.5, 7.7, 7.9 refitted)."""
    found = pd.Series(np.nan, index=predict.index)
    for level, group in predict.groupby("level"):
        known = learn[learn["level"] == level]
        if len(known):
            found[group.index] = fit(known, WITHOUT_STIFFNESS_AND_MASS).predict(group)
    return np.asarray(found, float)


def linear(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return gaps [mm] by one linear equation for all classes."""
    return fit(learn, WITHOUT_STIFFNESS_AND_MASS).predict(predict)


def power(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return gaps [mm] by one product of powers of peak acceleration, frequencies, damping and heights."""
    return np.asarray(np.exp(fit(learn, POWER_SYMBOLS, target="log_gap").predict(predict)))


def spectral_power(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return gaps [mm] by a product of powers of both spectral displacements."""
    return np.asarray(np.exp(fit(learn, SPECTRAL_SYMBOLS, target="log_gap").predict(predict)))


def spectral_ddc(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return the double difference of the spectral displacements [mm]; nothing is fitted."""
    return np.array(
        [
            rules.double_difference(tall, short, rho)
            for tall, short, rho in predict[
                ["spectral_tall_mm", "spectral_short_mm", "correlation"]
            ].to_numpy(float)
        ]
    )


def spectral_abs(learn: pd.DataFrame, predict: pd.DataFrame) -> Real:
    """Return the sum of the spectral displacements [mm]; nothing is fitted."""
    return np.asarray(predict["spectral_tall_mm"] + predict["spectral_short_mm"], float)


FORMULAS: dict[str, Formula] = {
    "thesis' form, a class each": by_class,
    "one linear equation": linear,
    "product of powers": power,
    "powers of spectral displacements": spectral_power,
    "DDC of spectral displacements": spectral_ddc,
    "ABS of spectral displacements": spectral_abs,
}
"""The first three know the peak acceleration, the others the spectrum; the last two are not fitted."""


def held_out(cases: pd.DataFrame, formula: Formula, by: str) -> Real:
    """Return the predicted gap [mm] of each case by a formula that has learnt from the other values of a column.

    NaN where nothing is left to learn from.

    Args:
        cases: The cases, a row each.
        formula: Predicts the gaps of cases from others that it may learn from.
        by: Column of the cases.
    """
    found = pd.Series(np.nan, index=cases.index)
    for value in cases[by].unique():
        inside = cases[by] == value
        if inside.all():
            continue
        found[inside] = formula(cases[~inside], cases[inside])
    return np.asarray(found, float)


def compare(cases: pd.DataFrame, formulas: Mapping[str, Formula] = FORMULAS) -> pd.DataFrame:
    """Return the mean relative errors of formulas, and how often they are unsafe.

    Args:
        cases: See `with_spectra`.
        formulas: By name.

    Returns:
        One row a formula: ``seen``, ``pair`` and ``event`` (mean of the error's size over the gap, nothing
        held out, a pair, an earthquake), ``unsafe`` (share of cases predicted too small with the earthquake
        held out), ``factor`` (the factor that the prediction has to be multiplied with to cover 95 % of
        cases then) and ``worst_event``.
    """
    rows = {}
    for name, formula in formulas.items():
        seen = formula(cases, cases)
        pair, event = held_out(cases, formula, "pair"), held_out(cases, formula, "event")
        actual = cases[TARGET].to_numpy(float)
        rows[name] = {
            "seen": _relative(actual, seen),
            "pair": _relative(actual, pair),
            "event": _relative(actual, event),
            **_unseen(actual, event, cases["event"]),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("formula")


def _relative(actual: Real, predicted: Real) -> float:
    """Return the mean of the error's size over the gap, of the cases that could be predicted; NaN if none."""
    known = np.isfinite(predicted)
    return errors(actual[known], predicted[known])["relative"] if known.any() else np.nan


def _unseen(actual: Real, predicted: Real, event: pd.Series) -> dict[str, Any]:
    """Return how the prediction of earthquakes held out fails; empty where none could be held out."""
    known = np.isfinite(predicted)
    if not known.any():
        return {"unsafe": np.nan, "factor": np.nan, "worst_event": "", "worst_event_error": np.nan}
    share = pd.Series(np.abs(predicted[known] / actual[known] - 1.0))
    by_event = share.groupby(event.to_numpy()[known]).mean()
    return {
        "unsafe": float(np.mean(predicted[known] < actual[known])),
        "factor": _covering_factor(actual[known], predicted[known]),
        "worst_event": str(by_event.idxmax()),
        "worst_event_error": float(by_event.max()),
    }


def _covering_factor(actual: Real, predicted: Real) -> float:
    """Return the 95 % quantile of gap over prediction; infinite if too many predictions are not positive."""
    ratio = np.where(predicted > 0.0, actual / np.where(predicted > 0.0, predicted, 1.0), np.inf)
    return float(np.quantile(ratio, 0.95, method="higher"))


def _participation(storeys: pd.Series) -> pd.Series:
    return 3.0 * storeys / (2.0 * storeys + 1.0)


def _spectral_mm(group: pd.DataFrame, side: str, record: Record) -> Real:
    """Return the spectral displacement of each case [mm]; every distinct oscillator is run once."""
    columns = group[[f"F{side}", f"D{side}"]].to_numpy(float)
    distinct, where = np.unique(columns, axis=0, return_inverse=True)
    peaks = oscillator_peaks(
        distinct[:, 0], distinct[:, 1] / 100.0, record.acceleration_m_s2, record.step_s
    ).absolute
    return 1e3 * peaks[where.ravel()]
