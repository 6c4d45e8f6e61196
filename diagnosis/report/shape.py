"""What is said of a law's shape: where it is not the catalogue's, and where the measured loop is not the law's."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.decision.claims import place_of
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.effects.catalogue import Effect, Quantity
from pounding.diagnosis.inference.coordinates import LOG_WIDTH
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.report.loops import Difference, Loops, bend, fullness
from pounding.diagnosis.report.making import shown_after
from pounding.diagnosis.report.report import LoopMeasure, Shape
from pounding.diagnosis.settings import SETTINGS

FULLER = ("the measured loop is thinner than the law's", "the measured loop is fuller than the law's")
BENT = (
    "the measured force grows less with large drifts than the law's",
    "the measured force grows more with large drifts than the law's",
)
"""Where a measure of the measured loop is below the law's, and where it is above."""


def shape(diagnosis: Diagnosis, loop: Loops | None) -> Shape | None:
    """Return what is said of the shape of the shown candidate's law; None where none is shown, or nothing is missing.

    Args:
        diagnosis: What was found and decided.
        loop: The loops of the named storey, if there is one.
    """
    judged = shown_after(diagnosis)
    if judged is None or not judged.effects or diagnosis.conclusion.verdict == "nothing_missing":
        return None
    said = [
        words
        for effect, values, std in zip(judged.fit.effects, judged.fit.values, judged.fit.std, strict=True)
        if effect in judged.effects
        for words in departures(diagnosis.found, effect, values, std)
    ]
    name = " and ".join(place_of(effect).words() for effect in judged.effects)
    if not diagnosis.decision.named:
        name = f"nearest is {name}"
    if loop is None:
        return Shape(statement=f"{name}; {', and '.join(said)}") if said else None
    full, bent = fullness(loop), bend(loop)
    from_law = [
        f"{words[one.measured > one.law]} ({one.measured:.2f} instead of {one.law:.2f} ± {one.std:.1g})"
        for one, words in ((full, FULLER), (bent, BENT))
        if one.apart
    ]
    told = ", and ".join(
        [*said, *(from_law or ["area and bend of the measured loop are the law's within their uncertainty"])]
    )
    frame, number = diagnosis.found.model.structure.place(loop.storey)
    return Shape(
        statement=f"{name}; {told}", frame=frame, storey=number, fullness=_measure(full), bend=_measure(bent)
    )


def _measure(one: Difference) -> LoopMeasure:
    return LoopMeasure(measured=one.measured, law=one.law, std=one.std)


def departures(found: Findings, effect: Effect, values: np.ndarray, std: np.ndarray) -> list[str]:
    """Return in words where the refined shape of a law is not the catalogue's by more than its uncertainty.

    Args:
        found: What the search found.
        effect: The effect.
        values, std: Its SI parameters and their standard errors, shape (parameters,).
    """
    words = effect.described.shapes if effect.described is not None else {}
    if not words:
        return []
    listed = effect.values(1.0, next(iter(effect.grid(found.sizes)), ()))
    said = []
    for quantity, value, error, ours in zip(effect.quantities, values, std, listed, strict=True):
        if quantity.name in words and departs(quantity, float(value), float(error), float(ours)):
            below, above = words[quantity.name]
            name = quantity.name.replace("_", " ")
            said.append(
                f"{above if value > ours else below} ({name} {value:.2g} ± {error:.1g}, the catalogue's {ours:.2g})"
            )
    return said


def departs(quantity: Quantity, value: float, std: float, listed: float) -> bool:
    """Return whether a parameter is away from the catalogue's value, by its standard error and by its prior's width.

    Args:
        quantity: The parameter.
        value, std: Its value and standard error [SI].
        listed: The catalogue's value [SI].
    """
    width = quantity.spread
    if quantity.logarithmic:
        value, std, listed, width = np.log(value), std / value, np.log(listed), LOG_WIDTH
    away = abs(value - listed)
    return bool(away > SETTINGS.report.shape_apart * std and away > SETTINGS.report.shape_size * width)
