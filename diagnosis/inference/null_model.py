"""The null model of a search: nothing missing, at its best, and with channels put right that were swapped."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, best, fit_misfits, leaves_much
from pounding.diagnosis.inference.model_checks import bent
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import calibrated, starting_noise
from pounding.diagnosis.inference.swapped import exchange, exchanged
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


def best_null(model: Model, null: Fit) -> Fit:
    """Return the null model, calibrated also with small latent forces from the baseline model if it seems stuck."""
    filtered, runs = null.filtered, null.filtered.runs
    left = fit_misfits(model, filtered, runs)
    if not (leaves_much(model, left, filtered, runs) or bent(model, filtered)):
        return null
    noise = starting_noise(model, runs, SETTINGS.start.rescue_level)
    start = run_filter(model, np.zeros(len(model.std)), noise, runs)
    return max(null, refine(model, start), key=lambda fit: fit.log_posterior)


def null_again(found: Findings) -> Fit:
    """Return the null model calibrated again from where the likeliest effect led, or the one at hand."""
    null, model = found.null.fit, found.model
    if best(found) is found.null:
        return null
    led = best(found).fit.filtered
    starts = [run_filter(model, led.values, noise, led.runs) for noise in (led.noise, null.filtered.noise)]
    tried = [refine(model, start) for start in starts]
    return max([null, *tried], key=lambda fit: fit.log_posterior)


def unswapped(model: Model, null: Fit, training: Sequence[int]) -> tuple[Model, Fit]:
    """Return model and fit with two channels exchanged where that is plainly what was measured.

    Args:
        model: The baseline model.
        null: Its fit without effects.
        training: Numbers of the runs.
    """
    pair = exchange(model, null.filtered)
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
