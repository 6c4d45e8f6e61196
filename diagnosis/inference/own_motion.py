"""The null model and the candidates that lead, calibrated by their own motion."""

from __future__ import annotations

from dataclasses import replace

from pounding.diagnosis.inference.findings import Findings, Judged, judge_in
from pounding.diagnosis.inference.null_model import by_its_motion
from pounding.diagnosis.inference.refining import each


def moved_by_themselves(found: Findings) -> None:
    """Let frames move by themselves with the null model and with the candidates that lead, and judge them by that.

    Args:
        found: The findings, whose fits are exchanged.
    """
    model, null = found.model, found.null
    leading = _leading(found)
    fits = each(found, lambda one: by_its_motion(model, one.fit), [*leading, null])
    # Evidence is about the null model as it was.
    again = {id(one): judge_in(found, fit) for one, fit in zip([*leading, null], fits, strict=True)}
    found.null = again[id(null)]
    found.judged = [again.get(id(one), one) for one in found.judged]
    if null.beside is not None:
        errors = replace(found.null, beside=None)
        found.null = replace(found.null, beside=errors)
        found.judged = [replace(one, beside=errors) for one in found.judged]


def _leading(found: Findings) -> list[Judged]:
    """Return the candidates on which a verdict may rest: the best of each kind, and each effect of the best two."""
    single = [one for one in found.judged if len(one.effects) == 1]
    doubles = [one for one in found.judged if len(one.effects) > 1][:1]
    leading = single[:1] + [one for one in single if not one.effects[0].rival][:1] + doubles
    leading += [one for one in single if doubles and one.effects[0] in doubles[0].effects]
    return list({id(one): one for one in leading}.values())
