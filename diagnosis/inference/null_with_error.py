"""The search about a null model that has an error of the frame in it: what every real frame has a little of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.own_motion import moved_by_themselves
from pounding.diagnosis.inference.refining import keep
from pounding.diagnosis.inference.search import Enough, Progress, never
from pounding.diagnosis.inference.second import beside, second
from pounding.diagnosis.settings import SETTINGS


def with_error(
    found: Findings, error: Judged, effects: Sequence[Effect], progress: Progress, enough: Enough = never
) -> Findings:
    """Return what is found with an error of the frame in the null model; its parameters stay free beside all effects.

    Args:
        found: What was found without it.
        error: Its fit, alone or beside the errors that the null model has already.
        effects: The candidates.
        progress: Called with what is being done and the share that is done.
        enough: Whether single effects beside it are enough, once they are refined.
    """
    progress(f"looking beyond a little {error.label()}", 0.8)
    null = replace(error, ln_bayes=0.0, beside=error)
    known = [one.fit for one in found.judged if _has_more(one, error)]
    about = replace(found, null=null, plain=found.baseline, judged=[], later=None, wide=None)
    for fit in known:
        keep(about, fit)
    about.scores = beside(about, effects, null, SETTINGS.search.refined_beside)
    if about.judged and not enough(about):
        second(about, effects)
    moved_by_themselves(about)
    return about


def _has_more(judged: Judged, error: Judged) -> bool:
    inside = set(error.fit.effects)
    return inside < set(judged.fit.effects)
