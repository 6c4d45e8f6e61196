"""What speaks against a model however well it fits: that it is another frame, blows, tones that are nobody's."""

from __future__ import annotations

from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.decision.impulses import impulses
from pounding.diagnosis.decision.measures import forces_from_motion, something_left, within_model_error
from pounding.diagnosis.decision.nearest_frame import nearest_frame
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.model_checks import strained, stray_tones


def against_the_model(found: Findings, judged: Judged) -> tuple[bool, tuple[str, ...]]:
    """Return whether something speaks against effects however well they fit, and a sentence for each thing seen.

    A part of a real frame that sways by itself makes a tone too: one that is within the model's error is only said. So is
    one of frames whose forces are what the motion asks for: these are wrong at the rate at which the frames touch.

    Args:
        found: What the search found.
        judged: The effects, or the null model.
    """
    # What speaks against the model in a reference run was there before, and is no answer to what changed since.
    filtered = judged.fit.filtered.since(found.model)
    against = [] if bends(found, judged) else another_frame(found, judged)
    # A contact's push that was missed is no blow.
    asked = not forces_from_motion(found)
    pushed = impulses(found.model, filtered) if asked else None
    if pushed is not None:
        against.append(pushed.sentence())
    stray = stray_tones(found.model, filtered)
    objections = bool(against) or (bool(stray) and asked and not within_model_error(found, judged))
    return objections, (*against, *stray)


def bends(found: Findings, judged: Judged) -> bool:
    """Return whether effects alone make another frame of one that is itself, within its model's error, without them.

    Args:
        found: What the search found.
        judged: The effects.
    """
    if not judged.effects or not within_model_error(found):
        return False
    another, itself = (bool(another_frame(found, one)) for one in (judged, found.null))
    return another and not itself


def another_frame(found: Findings, judged: Judged) -> list[str]:
    """Return a sentence if effects, or the baseline model alone, make another frame of the one that case.toml names.

    What a model gets wrong bends its stiffness and mass: the nearest frame is asked that moves alike. With reference runs
    the frame at hand is known, and where no more than noise remains there is no error that could bend it, but that of the
    effects' laws where the frame is itself without them.

    Args:
        found: What the search found.
        judged: The effects, or the null model.
    """
    said = strained(found.model, judged.fit.filtered.values)
    by_law = bool(judged.effects) and not strained(found.model, found.null.fit.filtered.values)
    if not said or found.reference or not (by_law or something_left(found, judged)):
        return said
    return strained(found.model, nearest_frame(found, judged))


def itself_only_with(found: Findings, judged: Judged) -> bool:
    """Return whether the frame is the one that case.toml names with a likely effect, and another one without it.

    What is missing has then moved into stiffness and mass, and leaves no misfit by which it could be large enough.

    Args:
        found: What the search found.
        judged: A single effect.
    """
    if forces_from_motion(found) or judged.effects[0].rival or judged.ln_bayes < thresholds(found)[0]:
        return False
    return not strained(found.model, judged.fit.filtered.values) and bool(another_frame(found, found.null))
