"""A second effect beside the first."""

from __future__ import annotations

from collections.abc import Sequence

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.evidence import score
from pounding.diagnosis.inference.findings import Findings, best
from pounding.diagnosis.inference.refining import each, keep, refined
from pounding.diagnosis.settings import SETTINGS


def second(found: Findings, effects: Sequence[Effect]) -> None:
    """Refine a second effect beside the leading one, where another one has evidence about it.

    Args:
        found: The findings, to which the fits are added.
        effects: The candidates.
    """
    fit = best(found).fit
    if not fit.effects:
        return
    model = found.model
    told = {*fit.effects, *map(same_motion, fit.effects)}
    others = [effect for effect in effects if effect not in told]
    found.later = score(model, fit.filtered, others, found.sizes, fit.columns)
    if found.later.ranked[0].ln_bayes < SETTINGS.search.second:
        return
    worth = [
        one
        for number, one in enumerate(found.later.ranked[: SETTINGS.search.seconds])
        if one.ln_bayes > SETTINGS.search.second and not (number and one.effect.rival)
    ]
    for both in each(found, lambda one: refined(found, fit.filtered, one, fit), worth):
        keep(found, both)
