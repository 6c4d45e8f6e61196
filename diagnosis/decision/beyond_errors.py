"""What is found beyond the errors that the model of every real frame has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from pounding.diagnosis.decision.imitated import unhide
from pounding.diagnosis.decision.verdict import common, error_of_frame, first_detected
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.null_with_error import with_error
from pounding.diagnosis.inference.own_motion import moved_by_themselves
from pounding.diagnosis.inference.search import Progress, search, silent
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


def first_decides(found: Findings, more_errors: bool = True) -> bool:
    """Return whether single effects decide by themselves what is there, so that no second one need be looked for.

    None is there, and a second effect is one beside a first. Or the likeliest is an error of the frame: all others are
    judged anew beside it, and a second one, or what is instead of it, is then one of those.

    Args:
        found: What was found of single effects; it stays as it is.
        more_errors: Whether another error of the frame may become part of the null model.
    """
    moved = replace(found, judged=list(found.judged))
    moved_by_themselves(moved)
    unhide(moved)
    return not first_detected(moved) or (more_errors and _error_leads(moved))


def _error_leads(found: Findings) -> bool:
    """Return whether the likeliest single effect is an error of the frame."""
    likeliest = next((one for one in found.judged if len(one.effects) == 1), None)
    return likeliest is not None and bool(common(found, likeliest)) and error_of_frame(found) is not None


def search_beyond_errors(
    model: Model, effects: Sequence[Effect], training: Sequence[int], held_out: Sequence[int]
) -> Findings:
    """Return what is found in runs of frames that do not touch, with the errors of the frame in the null model.

    Args:
        model: The baseline model.
        effects: The candidates.
        training: Numbers of the runs that are fitted.
        held_out: Numbers of the runs that are only predicted.
    """
    found = search(model, effects, training, held_out, silent, enough=first_decides)
    return beyond_errors(found, effects, silent)


def beyond_errors(found: Findings, effects: Sequence[Effect], progress: Progress) -> Findings:
    """Return what is found with the errors of the frame in the null model, one after the other; as it is without any.

    Args:
        found: What the search found; where a wide model discrepancy hid something, it is judged without that.
        effects: The candidates.
        progress: Called with what is being done and the share that is done.
    """
    unhide(found)
    for further in reversed(range(SETTINGS.search.errors * len(found.model.structure.frames))):
        error = error_of_frame(found)
        if error is None:
            break
        enough = partial(first_decides, more_errors=further > 0)
        found = with_error(found, error, effects, progress, enough)
        unhide(found)
    return found
