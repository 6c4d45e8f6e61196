"""Effects that a wide model discrepancy imitates: it bends each mode, and a frame of few storeys has few modes."""

from __future__ import annotations

from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.decision.measures import signal_to_noise
from pounding.diagnosis.inference.findings import Findings, best
from pounding.diagnosis.inference.null_model import no_more_discrepant


def unhide(found: Findings) -> None:
    """Judge the likeliest effect against a baseline model with no more discrepancy than the effect leaves.

    The scale of the discrepancy belongs to the frame. Where the evidence, which is averaged over all scales, says that an
    effect and a small scale are far likelier than a large scale alone, the large one is no reason to say nothing. Frames
    that touch and reference runs have discrepancies of their own.

    Args:
        found: What the search found; its null model is exchanged where that is so.
    """
    likeliest = best(found)
    needed, least = thresholds(found)
    if found.pair is not None or found.reference or likeliest.ln_bayes < needed:
        return
    if signal_to_noise(found, likeliest) < least:
        found.null = no_more_discrepant(found, likeliest)
