"""What is found beyond the errors that the model of every real frame has."""

from __future__ import annotations

from collections.abc import Sequence

from pounding.diagnosis.decision.verdict import error_of_frame
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.null_with_error import with_error
from pounding.diagnosis.inference.search import Progress
from pounding.diagnosis.settings import SETTINGS


def beyond_errors(found: Findings, effects: Sequence[Effect], progress: Progress) -> Findings:
    """Return what is found with the errors of the frame in the null model, one after the other; as it is without any.

    Args:
        found: What the search found.
        effects: The candidates.
        progress: Called with what is being done and the share that is done.
    """
    for _ in range(SETTINGS.search.errors):
        error = error_of_frame(found)
        if error is None:
            break
        found = with_error(found, error, effects, progress)
    return found
