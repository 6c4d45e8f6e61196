"""The null model and the candidates that lead, calibrated by their own motion."""

from __future__ import annotations

from functools import partial

from pounding.diagnosis.inference.findings import Findings, Judged, judge_in
from pounding.diagnosis.inference.null_model import by_its_motion
from pounding.diagnosis.inference.refining import each


def moved_by_themselves(found: Findings) -> None:
    """Let frames move by themselves with the null model and with the candidates that lead, and judge them by that.

    What was worked out before is kept in the findings.

    Args:
        found: The findings, whose fits are exchanged.
    """
    model, null = found.model, found.null
    asked = [*_leading(found), null]
    new = [one.fit for one in asked if one.fit.key not in found.moved]
    for fit, alone in zip(new, each(found, partial(by_its_motion, model), new), strict=True):
        found.moved[fit.key] = alone
    # Evidence is about the null model as it was.
    again = {id(one): judge_in(found, found.moved[one.fit.key]) for one in asked}
    found.null = again[id(null)]
    found.judged = [again.get(id(one), one) for one in found.judged]
    found.judge_beside_errors()


def _leading(found: Findings) -> list[Judged]:
    """Return the candidates on which a verdict may rest: the best of each kind, and each effect of the best two."""
    single = [one for one in found.judged if len(one.effects) == 1]
    doubles = [one for one in found.judged if len(one.effects) > 1][:1]
    leading = single[:1] + [one for one in single if not one.effects[0].rival][:1] + doubles
    leading += [one for one in single if doubles and one.effects[0] in doubles[0].effects]
    return list({id(one): one for one in leading}.values())
