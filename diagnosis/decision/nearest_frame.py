"""The frame nearest to the baseline model that moves like the measured one, but for the error that a model may have."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.null_model import tolerant
from pounding.diagnosis.inference.refining import refined_at_its_noise


def nearest_frame(found: Findings, judged: Judged) -> np.ndarray:
    """Return its nuisance parameters in their own units, shape (nuisance,).

    What a model, or an effect's law, gets wrong bends stiffness and mass where little noise lets them follow it, and says
    nothing of the frame. Beside that error they go no further than the motion needs, and effects have the sizes that are
    right then.

    Args:
        found: What the search found; what was worked out before is kept in it.
        judged: The effects, or the null model.
    """
    model, filtered = found.model, judged.fit.filtered
    # The same effects are asked of with a narrower discrepancy, too, and calibrated by their motion.
    asked = judged.fit.effects, filtered.discrepancy, filtered.values.tobytes()
    if asked not in found.nearest:
        noise = tolerant(model, filtered)
        start = run_filter(model, filtered.values, noise, filtered.runs, filtered.effects)
        found.nearest[asked] = refined_at_its_noise(found, judged.fit, start).filtered.values
    return found.nearest[asked]
