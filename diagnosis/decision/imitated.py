"""Effects that a wide model discrepancy imitates: it bends each mode, and a frame of few storeys has few modes."""

from __future__ import annotations

from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.decision.measures import signal_to_noise, stands_out
from pounding.diagnosis.inference.findings import Findings, best
from pounding.diagnosis.inference.null_model import no_more_discrepant


def unhide(found: Findings) -> None:
    """Judge all by a model discrepancy that is no larger than the likeliest candidate leaves it.

    The scale of the discrepancy belongs to the frame. Where the evidence, which is averaged over all scales, says that an
    effect and a small scale are far likelier than a large scale alone, the large one is no reason to say nothing, nor to
    name another effect that needs it, too. What takes enough out of the motion anyway is not hidden. Frames that touch and
    reference runs have discrepancies of their own.

    Args:
        found: What the search found; its null model and its candidates are exchanged where that is so.
    """
    likeliest = best(found)
    needed, least = thresholds(found, any(effect.absorbing for effect in likeliest.effects))
    if found.pair is not None or found.reference or likeliest.ln_bayes < needed:
        return
    if signal_to_noise(found, likeliest) >= least and stands_out(found, likeliest):
        return
    scale = likeliest.fit.filtered.discrepancy
    found.judged = sorted(
        (one if one.ln_bayes < needed else no_more_discrepant(found, one, scale) for one in found.judged),
        key=lambda one: -one.ln_bayes,
    )
    found.wide = found.null
    found.null = no_more_discrepant(found, found.null, scale)
    found.judge_beside_errors()
