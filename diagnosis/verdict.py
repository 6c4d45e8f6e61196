"""From evidence to a verdict: nothing missing, an effect, a class of effects, or something that is none of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.case import Case
from diagnosis.catalogue import CHANNEL_UNIT, Effect
from diagnosis.gap import channel_gaps, floors, gap, simulate
from diagnosis.refine import Fit
from diagnosis.search import Findings, best

DETECTED = 12.0
"""Evidence [nats] from which something is missing."""
CLASS_NATS = 4.0
"""Refined candidates within this of the best cannot be told from it."""
EXPLAINED = 0.6
"""Share of the explainable gap that an effect must close on the held-out run, or else it is not what is missing."""


def report_of(case: Case, found: Findings) -> dict[str, Any]:
    """Return the report as it goes into `report.json`."""
    fit = best(found)
    nats = found.evidence(fit)
    gaps = _gaps(found, fit)
    if not fit.effects or nats < DETECTED:
        verdict, shown = "nothing_missing", []
        gaps = _gaps(found, found.null)
    else:
        shown = _effects(case, found, fit)
        if any(effect.foil for effect in fit.effects) or _closed(gaps) < EXPLAINED:
            verdict = "unknown_effect"
        elif any(len(effect["class"]) > 1 for effect in shown):
            verdict = "effect_class"
        else:
            verdict = "effect_named"
        shown = [effect for effect in shown if not effect.pop("foil")]
    return {
        "schema": 1,
        "verdict": verdict,
        "confidence": _confidence(verdict, nats),
        "effects": shown,
        "gap": gaps,
        "where": [],
        "candidates": _candidates(found),
        "warnings": [*case.warnings, *found.believed.observed.warnings],
    }


def _closed(gaps: dict[str, Any]) -> float:
    """Return the share of the explainable gap that is closed, on the held-out run if there is one."""
    where = gaps["held_out"] or gaps["training"]
    explainable = where["before"] - where["noise_floor"]
    return (where["before"] - where["after"]) / explainable if explainable > 0 else 0.0


def _gaps(found: Findings, fit: Fit) -> dict[str, Any]:
    believed = found.believed

    def numbers(runs: tuple[int, ...]) -> dict[str, float]:
        before = simulate(believed, found.null.baseline.values, (), runs)
        after = simulate(believed, fit.baseline.values, fit.baseline.effects, runs)
        return {
            "before": gap(believed, before, runs),
            "after": gap(believed, after, runs),
            "noise_floor": float(np.nanmedian(floors(believed, fit.baseline, runs))),
        }

    held_out = None
    if found.held_out:
        names = ", ".join(believed.observed.runs[run].name for run in found.held_out)
        held_out = {"run": names} | numbers(found.held_out)
    return {"training": numbers(found.training), "held_out": held_out}


def _effects(case: Case, found: Findings, fit: Fit) -> list[dict[str, Any]]:
    shown = []
    nats = found.evidence(fit)
    for number, effect in enumerate(fit.effects):
        alike = [effect.place()]
        if len(fit.effects) == 1:
            alike += [
                other.effects[0].place()
                for other in found.fits
                if len(other.effects) == 1
                and other.effects[0] != effect
                and not other.effects[0].foil
                and found.evidence(other) > nats - CLASS_NATS
            ]
        shown.append(
            effect.place()
            | {
                "parameters": _parameters(case, found, effect, fit.values[number], fit.std[number]),
                "log_evidence": nats,
                "class": alike,
                "foil": effect.foil,
            }
        )
    return shown


def _parameters(
    case: Case, found: Findings, effect: Effect, values: np.ndarray, std: np.ndarray
) -> list[dict[str, Any]]:
    shown = []
    for quantity, value, spread in zip(effect.quantities, values, std, strict=True):
        if not quantity.reported:
            continue
        unit, factor = quantity.unit, quantity.per_si
        if unit == CHANNEL_UNIT:
            channel = case.channels[case.channel_index(str(effect.channel))]
            unit, factor = channel.unit, 1 / channel.to_si
        if effect.name == "joint_flexibility":
            frame = found.believed.structure.frames[effect.index]
            factor = frame.joint_stiffness
        shown.append(
            {"name": quantity.name, "value": float(value) * factor, "std": float(spread) * factor, "unit": unit}
        )
    return shown


def _candidates(found: Findings) -> list[dict[str, Any]]:
    nats: dict[Effect, float] = {one.effect: one.nats for one in found.scores.ranked}
    for fit in found.fits:
        if len(fit.effects) == 1:
            nats[fit.effects[0]] = found.evidence(fit)
    ranked = sorted(nats.items(), key=lambda item: -item[1])
    return [effect.place() | {"log_evidence": value} for effect, value in ranked if not effect.foil]


def _confidence(verdict: str, nats: float) -> float:
    if verdict == "nothing_missing":
        return float(1 / (1 + np.exp((nats - DETECTED) / 4)))
    return float(1 / (1 + np.exp(-(nats - DETECTED) / 4)))


__all__ = ["channel_gaps", "report_of"]
