"""The null model of a search: nothing missing, at its best, and with channels put right that were swapped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.findings import (
    Findings,
    Judged,
    best,
    fit_misfits,
    judge,
    leaves_much,
    worth_anew,
)
from pounding.diagnosis.inference.misfit import own_error
from pounding.diagnosis.inference.model_checks import bent
from pounding.diagnosis.inference.posterior import Marquardt
from pounding.diagnosis.inference.refine import Fit, Race, calibrated_at_scale, calibrated_further, refine
from pounding.diagnosis.inference.starting import calibrated, uncalibrated
from pounding.diagnosis.inference.swapped import exchange, exchanged
from pounding.diagnosis.model.forked import meanwhile
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


def best_null(model: Model, start: Filtered) -> Fit:
    """Return the null model refined, if it seems stuck also from the uncalibrated baseline model, the likelier of both.

    The latter needs nothing of the former: a second core works it out meanwhile, whether it will be asked for or not.

    Args:
        model: The baseline model.
        start: Where the former starts.
    """
    runs = start.runs

    def from_uncalibrated() -> Fit:
        return refine(model, uncalibrated(model, runs))

    with meanwhile(from_uncalibrated, model.is_light(runs), (model,)) as again:
        null = refine(model, start)
        left = fit_misfits(model, null.filtered, runs)
        if not (leaves_much(model, left, null.filtered, runs) or bent(model, null.filtered)):
            return null
        return max(null, again(), key=lambda fit: fit.log_posterior)


def null_again(found: Findings) -> Fit | None:
    """Return the null model calibrated again from where the likeliest effect led, None if it is not worth a new search.

    Args:
        found: What was found about the one at hand.
    """
    null, model = found.null.fit, found.model
    led = best(found).fit.filtered
    # With the little noise that an effect leaves, a model without it is led astray.
    start = run_filter(model, led.values, null.filtered.noise, led.runs)
    gain = worth_anew(found)
    again = refine(model, start, race=Race(null.filtered.log_likelihood + gain))
    return again if again.log_posterior >= null.log_posterior + gain else None


def by_its_motion(model: Model, fit: Fit) -> Fit:
    """Return a fit with which the frame moves most like the measured one, if the likeliest one leaves much.

    Latent forces and the filter that estimates them take what a model gets wrong, so that the likeliest parameters need
    not be those with which it moves like the frame. Here it moves by itself, and what it leaves is its own error. Effects
    stay as they are, and so does the likelihood. Where contacts push frames, and with reference runs, it is the fit itself.

    Args:
        model: The baseline model.
        fit: The fit of the null model, or of effects.
    """
    filtered = fit.filtered
    runs = filtered.runs
    before = fit_misfits(model, filtered, runs)
    known = all(model.acts(run) and not model.observed.runs[run].contact.size for run in runs)
    if not known or not (leaves_much(model, before, filtered, runs) or bent(model, filtered)):
        return fit
    start = run_filter(model, filtered.values, tolerant(model, filtered), runs, filtered.effects)
    alone = calibrated_further(model, start, SETTINGS.refinement.by_motion, Marquardt())
    moved = run_filter(model, alone.values, filtered.noise, runs, filtered.effects)
    nearer = np.nanmedian(fit_misfits(model, moved, runs)) < np.nanmedian(before)
    return replace(fit, filtered=moved) if nearer else fit


def tolerant(model: Model, filtered: Filtered) -> list[Noise]:
    """Return noise that has the model's error in it and no latent forces."""
    return [
        replace(
            one,
            latent=np.full_like(one.latent, SETTINGS.refinement.least_latent_n),
            channel=np.hypot(one.channel, own_error(model, filtered, number)),
        )
        for one, number in zip(filtered.noise, filtered.runs, strict=True)
    ]


def no_more_discrepant(found: Findings, judged: Judged, scale: float) -> Judged:
    """Return effects, or the null model, calibrated with a model discrepancy of a smaller scale, or as they are.

    Effects lose the evidence that only a larger scale gave them. The null model keeps its own, with which all are compared.

    Args:
        found: What the search found.
        judged: The effects, or the null model.
        scale: The scale [-].
    """
    model, wide = found.model, judged.fit.filtered
    if scale >= wide.discrepancy:
        return judged
    narrow = calibrated_at_scale(model, wide, scale, SETTINGS.refinement.by_motion)
    fit = by_its_motion(model, replace(judged.fit, filtered=narrow))
    again = judge(model, fit, judged.fit, found.training, found.held_out)
    lost = _log_density(model, wide) - _log_density(model, narrow) if judged.effects else 0.0
    return replace(again, ln_bayes=judged.ln_bayes - max(lost, 0.0), beside=judged.beside)


def _log_density(model: Model, filtered: Filtered) -> float:
    """Return the log likelihood with the log density of the nuisance parameters, up to what is common."""
    strain = filtered.values / model.spread(filtered.discrepancy)
    return filtered.log_likelihood - 0.5 * float(strain @ strain)


def unswapped(model: Model, null: Fit, training: Sequence[int]) -> tuple[Model, Fit]:
    """Return model and fit with two channels exchanged where that is plainly what was measured.

    Which two, the calibrated model tells, or the baseline model: calibrated to what was swapped, a model may be bent so far
    that no exchange is of help to it.

    Args:
        model: The baseline model.
        null: Its fit without effects.
        training: Numbers of the runs.
    """
    pair = exchange(model, null.filtered) or exchange(model, uncalibrated(model, tuple(training)))
    if pair is None:
        return model, null
    observed = exchanged(model.observed, *pair)
    again = model.seeing(observed)
    fit = refine(again, calibrated(again, training))
    runs = tuple(training)
    before, after = (
        fit_misfits(model, one.filtered, runs)[list(pair)].max()
        for model, one in ((model, null), (again, fit))
    )
    least = null.log_posterior + SETTINGS.search.swapped
    if fit.log_posterior < least or after > SETTINGS.search.swapped_misfit * before:
        return model, null
    one, other = (observed.names[channel] for channel in pair)
    observed.warnings.append(
        f"channels {one} and {other} are swapped: the model fits far better with the two exchanged, and so it was done"
    )
    return again, fit
