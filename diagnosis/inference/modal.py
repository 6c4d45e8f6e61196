"""Diagnosis of a case that holds modal data only: which effect explains frequencies, roof stiffness and mass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.inference.modal_evidence import (
    Acting,
    Softening,
    Weighed,
    foretold_from_others,
    modal_candidates,
    weigh,
)
from pounding.diagnosis.inference.modal_model import Joints, alone, joints
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model

DETECTED_NATS = 3.0
"""Evidence [nats] from which on an effect is claimed: odds of 20 to 1."""
CLASS_NATS = 3.0
"""Effects within this of the best cannot be told from it."""
SECOND_NATS = 3.0
UNLIKELY = 0.001
"""Probability of the misfit below which nothing in the catalogue fits."""
CALIBRATION = "posterior probability among the candidates at equal prior odds; not calibrated on cases"

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class ModalFindings:
    """What was found of one frame: data, the baseline model, single effects and pairs, best first."""

    model: Model
    data: tuple[ModalDatum, ...]
    null: Weighed
    singles: tuple[Weighed, ...]
    pairs: tuple[Weighed, ...]

    @property
    def frame(self) -> str:
        """The frame's name."""
        return self.model.structure.frames[0].name

    @cached_property
    def foretold(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Each datum as foretold from the others, SI, and its surprise, by the baseline model and the best explanation."""
        chosen = {"null": self.null, "best": self.best}
        return {key: foretold_from_others(self.model, self.data, one.acting) for key, one in chosen.items()}

    @property
    def best(self) -> Weighed:
        """What is claimed: nothing, a single effect, or a pair that is worth its second effect."""
        single = self.singles[0]
        if single.log_evidence < self.null.log_evidence + DETECTED_NATS:
            return self.null
        if self.pairs and self.pairs[0].log_evidence > single.log_evidence + SECOND_NATS:
            return self.pairs[0]
        return single

    @property
    def alike(self) -> tuple[Weighed, ...]:
        """Other explanations of the same number of effects that these data cannot tell from the best."""
        rivals = {0: (), 1: self.singles, 2: self.pairs}[len(self.best.acting)]
        return tuple(
            one
            for one in rivals
            if one is not self.best and one.log_evidence > self.best.log_evidence - CLASS_NATS
        )

    @property
    def fits(self) -> bool:
        """Whether the best explanation leaves no more than the stated uncertainties."""
        freedom = max(len(self.data) - len(self.best.acting), 1)
        return bool(chi2.sf(self.best.misfit, freedom) > UNLIKELY)


def examine(
    model: Model,
    flexible: Joints | None,
    data: Sequence[ModalDatum],
    told: Callable[[str], None] = lambda what: None,
) -> ModalFindings:
    """Return what modal data of one frame say of single effects and of pairs with the best one."""
    candidates = modal_candidates(model, flexible, data)
    null = weigh(model, data)
    singles = []
    for one in candidates:
        told(one.label())
        singles.append(weigh(model, data, [one]))
    singles.sort(key=lambda one: -one.log_evidence)
    pairs: list[Weighed] = []
    if singles[0].log_evidence > null.log_evidence + DETECTED_NATS:
        for first in leaders(singles):
            for one in candidates:
                if (
                    (one.effect.where == "frame" or one.test)
                    and one != first
                    and {one, first} not in [set(pair.acting) for pair in pairs]
                ):
                    told(f"{first.label()} with {one.label()}")
                    pairs.append(weigh(model, data, [first, one]))
    pairs.sort(key=lambda one: -one.log_evidence)
    return ModalFindings(model, tuple(data), null, tuple(singles), tuple(pairs))


def leaders(singles: Sequence[Weighed]) -> list[Acting]:
    """Return what the pairs are built on: the best single effect, and the best that acts in every test."""
    everywhere = next(one.acting[0] for one in singles if one.acting[0].test is None)
    return list(dict.fromkeys([singles[0].acting[0], everywhere]))


def diagnose_modal(case: Case, progress: Progress) -> dict[str, Any]:
    """Return the report on a case with modal data only, in the form of docs/diagnosis/case-format.md."""
    found = []
    for number, (frame, storeys) in enumerate(zip(case.frames, baseline_frames(case), strict=True)):
        data = [datum for datum in case.modal if datum.frame == frame.name]
        if data:
            told = partial(_told, progress, 0.1 + 0.8 * number / len(case.frames))
            found.append(examine(alone(storeys, case.prior), joints(frame), data, told))
    return modal_report(case, found)


def _told(progress: Progress, share: float, what: str) -> None:
    progress(what, share)


def modal_report(case: Case, found: Sequence[ModalFindings]) -> dict[str, Any]:
    """Return the report on what was found of each frame."""
    missing = [one for one in found if one.best.acting]
    if not missing:
        verdict = "nothing_missing"
    elif not all(one.fits for one in found):
        verdict = "unknown_effect"
    elif any(one.alike or _several(one.best) for one in missing):
        verdict = "effect_class"
    else:
        verdict = "effect_named"
    return {
        "schema": 1,
        "verdict": verdict,
        "confidence": float(np.prod([_probability(one, verdict) for one in found])),
        "confidence_basis": {"calibration": CALIBRATION},
        "effects": [entry for one in missing for entry in _effects(one)],
        "gap": _gaps(found),
        "where": [],
        "candidates": sorted(
            (entry for one in found for entry in _candidates(one)), key=lambda entry: -entry["log_evidence"]
        ),
        "modal": [row for one in found for row in _rows(one)],
        "warnings": list(case.warnings),
    }


def _probability(found: ModalFindings, verdict: str) -> float:
    """Return the posterior probability of what is claimed among everything that was tried."""
    claimed = [found.best, *found.alike]
    if verdict == "unknown_effect":
        freedom = max(len(found.data) - len(found.best.acting), 1)
        return float(1 - chi2.sf(found.best.misfit, freedom))

    # Two effects at once are believed less beforehand, by as much as a second one must bring.
    def odds(one: Weighed) -> float:
        return one.log_evidence - SECOND_NATS * max(len(one.acting) - 1, 0)

    total = logsumexp([odds(one) for one in (found.null, *found.singles, *found.pairs)])
    return float(np.exp(logsumexp([odds(one) for one in claimed]) - total))


def _several(one: Weighed) -> bool:
    return any(isinstance(acting.effect, Softening) for acting in one.acting)


def _place(acting: Acting) -> list[dict[str, object]]:
    place = acting.effect.place() | ({"test": acting.test} if acting.test else {})
    if isinstance(acting.effect, Softening):
        return [place | {"effect": name} for name in acting.effect.alike]
    return [place]


def _effects(found: ModalFindings) -> list[dict[str, Any]]:
    best = found.best
    shown = []
    for number, acting in enumerate(best.acting):
        others = [place for one in found.alike for place in _place(one.acting[number])]
        members = _place(acting)
        members += [place for place in others if place not in members]
        quantity = acting.effect.quantities[0]
        value, std = (float(v[number]) * quantity.per_si for v in (best.value, best.std))
        shown.append(
            members[0]
            | {
                "parameters": [{"name": quantity.name, "value": value, "std": std, "unit": quantity.unit}],
                "log_evidence": best.log_evidence - found.null.log_evidence,
                "class": members,
            }
        )
    return shown


def _gaps(found: Sequence[ModalFindings]) -> dict[str, Any]:
    """Return relative errors: of the fit, and of each datum foretold from the others."""

    def median(rows: list[np.ndarray]) -> float:
        return float(np.median(np.concatenate(rows)))

    value = [np.array([datum.value for datum in one.data]) for one in found]
    noise = median([np.array([datum.std / datum.value for datum in one.data]) for one in found])

    def errors(of: Callable[[ModalFindings], np.ndarray]) -> float:
        return median([np.abs(of(one) / v - 1) for one, v in zip(found, value, strict=True)])

    return {
        "training": {
            "before": errors(lambda one: one.null.fitted),
            "after": errors(lambda one: one.best.fitted),
            "noise_floor": noise,
        },
        "held_out": {
            "run": "each number foretold from the others",
            "before": errors(lambda one: one.foretold["null"][0]),
            "after": errors(lambda one: one.foretold["best"][0]),
            "noise_floor": noise,
        },
    }


def _candidates(found: ModalFindings) -> list[dict[str, Any]]:
    entries: dict[str, dict[str, Any]] = {}
    for one in found.singles:
        for place in _place(one.acting[0]):
            entry = place | {"log_evidence": one.log_evidence - found.null.log_evidence}
            entries.setdefault(str(place), entry)
    return list(entries.values())


def _rows(found: ModalFindings) -> list[dict[str, Any]]:
    return [
        {
            "frame": found.frame,
            "quantity": datum.quantity,
            "mode": datum.mode,
            "test": datum.test,
            "measured": datum.value,
            "std": datum.std,
            "believed": float(found.null.fitted[i]),
            "fitted": float(found.best.fitted[i]),
            "foretold": float(found.foretold["best"][0][i]),
            "surprise": float(found.foretold["best"][1][i]),
        }
        for i, datum in enumerate(found.data)
    ]
