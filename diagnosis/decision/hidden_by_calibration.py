"""What is missing may hide in the calibrated frame, and leave no misfit: how far its parameters moved tells."""

from __future__ import annotations

from collections.abc import Sequence

from pounding.diagnosis.decision.false_alarms import thresholds
from pounding.diagnosis.decision.measures import forces_from_motion
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.whole_frame import same_motion
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.model_checks import DAMPING, STRUCTURE, beyond_priors, log_prior_ratio


def straightens(found: Findings, judged: Judged, common: bool) -> bool:
    """Return whether the calibrated frame is within its priors with a likely effect, and much likelier by them.

    What is missing has then moved into stiffness, mass and the model discrepancy, where it shows as no misfit, or what
    dissipates into the damping, far beyond its priors. What the frame is with the effect says that no error of its model
    bends it. Or the effect is what has moved: a storey's stiffness by more than three prior standard deviations is a change
    of it, whatever else takes its part, where none else of its kind has.

    Args:
        found: The findings.
        judged: The effect, alone.
        common: Whether every real frame has a little of it: then it bends the frame as its other errors do, and only what
            has moved by itself tells of it.
    """
    effect = judged.effects[0]
    if effect.rival or found.reference or judged.ln_bayes <= 0.0:
        return False
    if forces_from_motion(found):
        # Such forces bend a frame as well.
        return False

    def far(one: Judged, kinds: Sequence[str]) -> bool:
        return beyond_priors(found.model, one.fit.filtered.values, kinds)

    if far(judged, STRUCTURE):
        return False
    needed = thresholds(found)[0]
    damping = effect.dissipates and far(found.null, DAMPING) and not far(judged, DAMPING)
    # A null model with a smaller discrepancy than the likeliest is bent by that alone.
    without = (found.wide or found.null).fit.filtered
    bent = damping or log_prior_ratio(found.model, without, judged.fit.filtered) >= needed
    likely = judged.ln_bayes >= needed
    return (bent and likely and not common) or moved(found, found.null, judged, effect)


def moved(found: Findings, without: Judged, judged: Judged, effect: Effect) -> bool:
    """Return whether the parameter that an effect changes moves beyond calibration only where the effect is not there.

    Args:
        found: The findings.
        without, judged: The fits without the effect and with it.
        effect: The effect.
    """
    values = without.fit.filtered.values, judged.fit.filtered.values
    alike = [one for one in (effect, same_motion(effect)) if one is not None]
    return any(one.departed(found.model, *values) for one in alike)
