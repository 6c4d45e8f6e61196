"""From modal data to what is concluded: nothing missing, an effect, a class of effects, or none of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import (
    Candidate,
    Claim,
    Parameter,
    Place,
    candidate,
    claim,
    parameter,
    places_of,
)
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.confidence import Basis
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.inference.modal import ModalFindings
from pounding.diagnosis.inference.modal_evidence import Weighed
from pounding.diagnosis.settings import SETTINGS

CALIBRATION = "posterior probability among the candidates at equal prior odds; not calibrated on cases"


def of_modal_data(case: Case, found: Sequence[ModalFindings]) -> Conclusion:
    """Return what is concluded of what was found of each frame."""
    missing = [one for one in found if one.best.acting]
    verdict = _verdict(found, missing)
    tried = (one for frame in found for one in _candidates(frame))
    return Conclusion(
        verdict=verdict,
        confidence=float(np.prod([probability(one, verdict) for one in found])),
        basis=Basis(calibration=CALIBRATION),
        effects=tuple(claimed for one in missing for claimed in _claims(one)),
        candidates=tuple(sorted(tried, key=lambda one: -one.log_evidence)),
        warnings=tuple(case.warnings),
    )


def _verdict(found: Sequence[ModalFindings], missing: Sequence[ModalFindings]) -> Verdict:
    if not all(one.fits for one in found):
        return "unknown_effect"
    if not missing:
        return "nothing_missing"
    if any(one.alike or _several(one.best) for one in missing):
        return "effect_class"
    return "effect_named"


def probability(found: ModalFindings, verdict: Verdict) -> float:
    """Return the posterior probability of what is claimed among everything that was tried.

    Args:
        found: What was found of a frame.
        verdict: The verdict; of an unknown effect it is that of a misfit below the one that is left.
    """
    claimed = [found.best, *found.alike]
    if verdict == "unknown_effect":
        freedom = max(len(found.data) - len(found.best.acting), 1)
        return float(1 - chi2.sf(found.best.misfit, freedom))

    # Two effects at once are less likely beforehand, by as much as a second one must bring.
    def odds(one: Weighed) -> float:
        return one.log_evidence - SETTINGS.modal.evidence * max(len(one.acting) - 1, 0)

    total = logsumexp([odds(one) for one in (found.null, *found.singles, *found.pairs)])
    return float(np.exp(logsumexp([odds(one) for one in claimed]) - total))


def _several(one: Weighed) -> bool:
    return any(len(places_of(effect)) > 1 for effect in one.acting)


def _claims(found: ModalFindings) -> list[Claim]:
    best = found.best
    shown = []
    for number, acting in enumerate(best.acting):
        others = [place for one in found.alike for place in places_of(one.acting[number])]
        members = places_of(acting)
        members += [place for place in others if place not in members]
        shown.append(
            claim(members[0], [_size(best, number)], best.log_evidence - found.null.log_evidence, members)
        )
    return shown


def _candidates(found: ModalFindings) -> list[Candidate]:
    entries: dict[Place, Candidate] = {}
    for one in found.singles:
        for place in places_of(one.acting[0]):
            evidence = one.log_evidence - found.null.log_evidence
            entries.setdefault(place, candidate(place, evidence, (_size(one, 0),)))
    return list(entries.values())


def _size(weighed: Weighed, number: int) -> Parameter:
    """Return the size of one of the effects that were weighed together, by its number among them."""
    quantity = weighed.acting[number].quantities[0]
    value, std = (float(each[number]) * quantity.per_si for each in (weighed.value, weighed.std))
    return parameter(quantity.name, value, std, quantity.unit)
