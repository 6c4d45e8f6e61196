"""The frame nearest to the baseline model that moves like the measured one, but for the errors of model and laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import as_new_in_every_sample, simulate
from pounding.diagnosis.inference.null_model import tolerant
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.refining import refined_at_its_noise
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.observations import root_mean_square


def nearest_frame(found: Findings, judged: Judged) -> np.ndarray:
    """Return its nuisance parameters in their own units, shape (nuisance,).

    What a model, or an effect's law, gets wrong bends stiffness and mass where little noise lets them follow it, and says
    nothing of the frame. Beside these errors they go no further than the motion needs.

    Args:
        found: What the search found.
        judged: The effects, or the null model.
    """
    return _nearest(found, judged, laws=True).filtered.values


def nearest_fit(found: Findings, judged: Judged) -> Fit:
    """Return effects refined beside the error that the model may have: they have the sizes that are right then.

    What is wrong with their laws is in the standard errors of sizes.

    Args:
        found: What the search found.
        judged: The effects.
    """
    return _nearest(found, judged, laws=False)


def _nearest(found: Findings, judged: Judged, laws: bool) -> Fit:
    """Return effects, or the null model, refined beside errors of the model, and of laws where these count.

    What was worked out before is kept in the findings.
    """
    model, filtered = found.model, judged.fit.filtered
    # The same effects are asked of with a narrower discrepancy, too, and calibrated by their motion.
    asked = judged.fit.effects, filtered.discrepancy, filtered.values.tobytes(), laws and bool(judged.effects)
    if asked not in found.nearest:
        noise = _tolerant_of_laws(found, judged) if laws else tolerant(model, filtered)
        start = run_filter(model, filtered.values, noise, filtered.runs, filtered.effects)
        fit = refined_at_its_noise(found, judged.fit, start)
        fit.put_away()
        found.nearest[asked] = fit
    return found.nearest[asked]


def evidence_beside_errors(found: Findings, judged: Judged) -> float:
    """Return the ln Bayes factor of effects against the null model, both beside the error that the model may have.

    Args:
        found: What the search found.
        judged: The effects.
    """
    fit, null = nearest_fit(found, judged), found.null.fit
    start = run_filter(
        found.model, null.filtered.values, fit.filtered.noise, null.filtered.runs, null.filtered.effects
    )
    return fit.log_posterior - refined_at_its_noise(found, null, start).log_posterior


def _tolerant_of_laws(found: Findings, judged: Judged) -> list[Noise]:
    """Return noise that has the model's error in it, and what sizes as wrong as the effects' laws change in the motion."""
    model, filtered = found.model, judged.fit.filtered
    noise = tolerant(model, filtered)
    right = list(zip(judged.fit.effects, judged.fit.values, strict=True))
    errors = [effect.law_error(model, values, found.sizes) for effect, values in right]
    if not any(errors):
        return noise
    wrong = [(effect, values * (1.0 + by)) for (effect, values), by in zip(right, errors, strict=True)]
    ours, others = (simulate(model, filtered.values, each, filtered.runs) for each in (right, wrong))
    changed = [root_mean_square(one - other) for one, other in zip(ours, others, strict=True)]
    return [
        replace(
            one,
            channel=np.hypot(one.channel, as_new_in_every_sample(model, filtered, number, np.nan_to_num(by))),
        )
        for one, number, by in zip(noise, filtered.runs, changed, strict=True)
    ]
