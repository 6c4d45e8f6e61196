"""From evidence to a verdict: nothing missing, an effect, a class of effects, or something that is none of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.confidence import Features, basis, confidence, features_of
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.impulses import impulses
from pounding.diagnosis.effects.catalogue import CHANNEL_UNIT, Effect
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import by_frame, misfit, over_floor
from pounding.diagnosis.inference.misfit_map import where
from pounding.diagnosis.inference.model_checks import model_checks
from pounding.diagnosis.model.twin import simulate_engine

CLASS_NATS = 12.0
FOIL_NATS = 5.0
"""Refined candidates within this of the best cannot be told from it: two that are one and the same to a single channel, a
late table and a late sensor, end ten apart. A foil has to be better than the catalogue by the second."""
EXPLAINED = 0.8
MOSTLY_EXPLAINED = 0.85
"""Share of the explainable gap that effects must close on the held-out run, or else something else is missing; the
larger one where more than `PLAINLY_LEFT` is left."""
UNEXPLAINED, BLIND_UNEXPLAINED = 1.15, 1.3
PLAINLY_LEFT = 2.5
"""Gap over noise floor below which nothing is left to explain, the second where contact forces are those that the motion
asks for; from which on something is missing whatever the candidates say, and plainly so."""
SECOND_NATS, SECOND_SIZE = 2.0, 0.1
SECOND_SHARE = 0.1
"""What a second effect must add: evidence as a multiple of what a first one needs, size in units of a channel's noise; and a
share of the first one's evidence too, because laws that are not quite the catalogue's leave that much of a strong effect."""
SAME_STOREY = 0.8
"""Share of what a single effect leaves unexplained that a second one in the same storey must explain."""
LEFT = 1.6
"""Gap over noise floor below which a confidence sees nothing left to explain."""


def decide(found: Findings) -> Decision:
    """Return the verdict on a case."""
    judged = found.claimable()
    single = [one for one in judged if len(one.effects) == 1]
    if not single or not found.plain(single[0], signal_to_noise(found, single[0])):
        objections = _model_checks(found, found.null)
        if objections or remaining(found, found.null) > _unexplained(found):
            return Decision("unknown_effect", single[0] if single else found.null, (), objections)
        return Decision("nothing_missing", found.null, ())
    chosen = _listed(single)
    doubles = [one for one in judged if len(one.effects) > 1]
    if doubles and _worth(found, chosen, doubles[0]):
        chosen = doubles[0]
    objections = _model_checks(found, chosen)
    if (
        any(effect.rival for effect in chosen.effects)
        or objections
        or not _explained(found, chosen)
        or _spread(chosen)
    ):
        return Decision("unknown_effect", chosen, (), objections)
    alike = tuple(
        other
        for other in single
        if len(chosen.effects) == 1
        and other is not chosen
        and not other.effects[0].rival
        and other.ln_bayes > chosen.ln_bayes - CLASS_NATS
    )
    verdict = "effect_class" if alike else "effect_named"
    return Decision(verdict, chosen, alike)


def _listed(single: list[Judged]) -> Judged:
    """Return the best single effect; one of the catalogue where a foil is not told from it."""
    catalogue = [one for one in single if not one.effects[0].rival]
    near = catalogue and catalogue[0].ln_bayes > single[0].ln_bayes - FOIL_NATS
    return catalogue[0] if near else single[0]


def _model_checks(found: Findings, judged: Judged) -> tuple[str, ...]:
    filtered = judged.fit.filtered
    said = model_checks(found.model, filtered)
    # A contact's push that was missed is no knock.
    pushed = None if _blind(found) else impulses(found.model, filtered)
    return tuple(said) if pushed is None else (*said, pushed.sentence())


def _unexplained(found: Findings) -> float:
    return BLIND_UNEXPLAINED if _blind(found) else UNEXPLAINED


def _blind(found: Findings) -> bool:
    return found.pair is not None and found.pair.blind


def _explained(found: Findings, judged: Judged) -> bool:
    """Return whether effects close enough of the gap on runs that they were not fitted to."""
    left = remaining(found, judged)
    if left < _unexplained(found):
        return True
    return closed(found, judged, 1.0) >= (MOSTLY_EXPLAINED if left > PLAINLY_LEFT else EXPLAINED)


def _spread(judged: Judged) -> bool:
    """Return whether one law seems to act in two storeys that meet: one thing across both, which is no such law."""
    if len(judged.effects) != 2:
        return False
    one, other = judged.effects
    if one.storey is None or other.storey is None:
        return False
    return one.name == other.name and one.frame == other.frame and abs(one.storey - other.storey) == 1


def remaining(found: Findings, judged: Judged) -> float:
    """Return the gap over the noise floor of the frame that has most: median over its channels, mean over the runs.

    Training and held-out runs count alike. Where a pair's forces are those that the motion asks for, only the held-out
    floor knows how uncertain they are.
    """
    over_floors = _over(found, judged)
    if _blind(found) and np.isfinite(over_floors[1]).any():
        over_floors = over_floors[1:]
    each = by_frame(found.model, over_floors)
    known = np.isfinite(each).any(axis=0)
    return float(np.nanmean(each[:, known], axis=0).max()) if known.any() else 1.0


def _over(found: Findings, judged: Judged) -> np.ndarray:
    """Return gaps over the noise floor of each channel, training and held-out runs, (2, channels)."""
    return over_floor(found.model, judged.channel_misfit, found.floor)


def signal_to_noise(found: Findings, judged: Judged, without: Judged | None = None) -> float:
    """Return how much effects take out of the channel where they show most, in units of that channel's noise.

    Contact forces being known, what acts on one frame moves that one alone: what else takes out of the channels of the
    other, such as another optimum of its parameters, does not count.

    Args:
        found: The findings.
        judged: The effects.
        without: What they are compared with; when None what they are judged beside, or the null model.
    """
    before, after = _over(found, without or judged.beside or found.null), _over(found, judged)
    taken = np.sqrt(np.maximum(before**2 - after**2, 0.0))[:, _moved(found, judged)]
    return float(np.nanmax(np.nanmean(taken, axis=0))) if np.isfinite(taken).any() else 0.0


def _moved(found: Findings, judged: Judged) -> np.ndarray:
    """Return which channels effects can change, shape (channels,): those of their frames, all if one acts on no frame."""
    model, frames = found.model, {effect.frame for effect in judged.effects}
    if None in frames:
        return np.ones(len(model.observed.names), bool)
    return np.any([model.at_frame(model.structure.index(str(frame))) for frame in frames], axis=0)


def closed(found: Findings, judged: Judged, nothing: float = LEFT) -> float:
    """Return the share of the explainable gap that is closed, on the held-out runs if there are any.

    Args:
        found: The findings.
        judged: The effects.
        nothing: Gap over noise floor of a channel that counts as wholly explained.
    """
    which = 1 if found.held_out else 0
    before, after = _over(found, found.null)[which], _over(found, judged)[which]
    # Over all channels together, by power: a channel that never saw the effect should not decide.
    explainable = np.nansum(np.maximum(before**2 - 1, 0.0))
    left = np.nansum(np.maximum(after**2 - nothing**2, 0.0))
    return float(1 - np.sqrt(left / explainable)) if explainable > 0 else 1.0


def _worth(found: Findings, single: Judged, double: Judged) -> bool:
    """Return whether a second effect explains a good part of what the first one leaves."""
    ln_bayes, _ = found.thresholds(
        any(effect.absorbing for effect in double.effects if effect not in single.effects)
    )
    likely = double.ln_bayes > single.ln_bayes + SECOND_NATS * ln_bayes + SECOND_SHARE * single.ln_bayes
    if not likely or signal_to_noise(found, double, single) < SECOND_SIZE:
        return False
    if len({(effect.frame, effect.storey) for effect in double.effects}) > 1:
        return True
    # In the same storey it is more likely that the first one's law is not quite the catalogue's.
    which = 1 if found.held_out else 0
    left = [np.nansum(np.maximum(_over(found, one)[which] ** 2 - 1, 0.0)) for one in (single, double)]
    return bool(left[1] < (1 - SAME_STOREY) * left[0])


def features(found: Findings, decision: Decision) -> Features:
    """Return what the confidence in a verdict rests on."""
    shown = decision.judged
    if decision.verdict == "nothing_missing" and found.judged:
        shown = found.judged[0]
    return features_of(found, decision, signal_to_noise(found, shown), closed(found, shown))


def report_of(case: Case, found: Findings) -> dict[str, Any]:
    """Return the report as it goes into `report.json`."""
    decision = decide(found)
    stated = features(found, decision)
    return {
        "schema": 1,
        "verdict": decision.verdict,
        "confidence": confidence(stated),
        "confidence_basis": basis(stated),
        "effects": _effects(case, found, decision),
        "gap": _gaps(found, found.null if decision.verdict == "unknown_effect" else decision.judged),
        "where": where(
            found.model,
            found.null.fit.filtered,
            np.nan_to_num(found.floor[0], nan=1.0),
            [*found.training, *found.held_out],
        ),
        "candidates": _candidates(found),
        "warnings": [*case.warnings, *found.model.observed.warnings, *decision.model_checks],
    }


def _gaps(found: Findings, judged: Judged) -> dict[str, Any]:
    corrected, filtered = found.model, judged.fit.filtered
    if found.settled is not None and found.settled[0] is judged:
        _, corrected, filtered = found.settled

    def numbers(which: int) -> dict[str, float]:
        after = found.null.misfit[which]
        if judged is not found.null:
            runs = (found.training, found.held_out)[which]
            outputs = simulate_engine(corrected, filtered.values, filtered.effects, runs)
            found.engine.update(zip(runs, outputs, strict=True))
            after = misfit(found.model, outputs, runs)
        return {
            "before": found.null.misfit[which],
            "after": after,
            "noise_floor": float(np.nanmedian(found.floor[which])),
        }

    held_out = None
    if found.held_out:
        names = ", ".join(found.model.observed.runs[run].name for run in found.held_out)
        held_out = {"run": names} | numbers(1)
    return {"training": numbers(0), "held_out": held_out}


def _effects(case: Case, found: Findings, decision: Decision) -> list[dict[str, Any]]:
    if decision.verdict == "nothing_missing":
        return []
    fit = decision.judged.fit
    shown = []
    for number, effect in enumerate(fit.effects):
        if effect.rival or effect not in decision.judged.effects:
            continue
        for entry in effect.entries():
            shown.append(
                entry
                | {
                    "parameters": parameters(case, found, effect, fit.values[number], fit.std[number]),
                    "log_evidence": decision.judged.ln_bayes,
                    "class": [entry, *(other.effects[0].place() for other in decision.alike)],
                }
            )
    return shown


def parameters(
    case: Case, found: Findings, effect: Effect, values: np.ndarray, std: np.ndarray
) -> list[dict[str, Any]]:
    """Return an effect's parameters as reported: names, values, standard errors, units."""
    shown = []
    for quantity, value, spread in zip(effect.quantities, values, std, strict=True):
        if not quantity.reported:
            continue
        unit, factor = quantity.unit, quantity.per_si
        if unit == CHANNEL_UNIT:
            channel = case.channels[case.channel_index(str(effect.channel))]
            unit, factor = channel.unit, 1 / channel.to_si
        if effect.name == "joint_flexibility":
            factor = found.model.structure.frames[effect.index].joint_stiffness
        shown.append(
            {
                "name": quantity.name,
                "value": float(value) * factor,
                "std": float(spread) * factor,
                "unit": unit,
            }
        )
    return shown


def _candidates(found: Findings) -> list[dict[str, Any]]:
    ln_bayes: dict[Effect, float] = {one.effect: one.ln_bayes for one in found.scores.ranked}
    for judged in (*found.judged, *found.claimable()):
        if len(judged.effects) == 1:
            ln_bayes[judged.effects[0]] = judged.ln_bayes
    ranked = sorted(ln_bayes.items(), key=lambda item: -item[1])
    return [effect.place() | {"log_evidence": value} for effect, value in ranked if not effect.rival]
