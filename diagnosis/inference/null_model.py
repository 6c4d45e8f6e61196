"""The null model of a search: nothing missing, at its best, and with channels put right that were swapped."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.inference.filtering import run_baseline
from pounding.diagnosis.inference.findings import Findings, best, fit_gaps, leaves_much
from pounding.diagnosis.inference.model_checks import bent
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import calibrated, starting_noise
from pounding.diagnosis.inference.swapped import SWAPPED_NATS, exchange, exchanged
from pounding.diagnosis.model.model import Believed

RESCUE_LEVEL = 0.01
"""Latent force as a share of a storey's shear where nothing fits yet."""
SWAPPED_GAP = 0.6
"""Largest gap of two exchanged channels, as a share of that before, at which the exchange is believed."""


def best_null(believed: Believed, null: Fit) -> Fit:
    """Return the null model, calibrated also with small latent forces from the believed parameters if it seems stuck."""
    baseline, runs = null.baseline, null.baseline.runs
    left = fit_gaps(believed, baseline, runs)
    if not (leaves_much(believed, left, baseline, runs) or bent(believed, baseline)):
        return null
    noise = starting_noise(believed, runs, RESCUE_LEVEL)
    start = run_baseline(believed, np.zeros(len(believed.std)), noise, runs)
    return max(null, refine(believed, start, (), (), ()), key=lambda fit: fit.log_posterior)


def null_again(found: Findings) -> Fit:
    """Return the null model calibrated again from where the likeliest effect led, or the one at hand."""
    null, believed = found.null.fit, found.believed
    if best(found) is found.null:
        return null
    led = best(found).fit.baseline
    starts = [
        run_baseline(believed, led.values, noise, led.runs) for noise in (led.noise, null.baseline.noise)
    ]
    tried = [refine(believed, start, (), (), ()) for start in starts]
    return max([null, *tried], key=lambda fit: fit.log_posterior)


def unswapped(believed: Believed, null: Fit, training: Sequence[int]) -> tuple[Believed, Fit]:
    """Return model and fit with two channels exchanged where that is plainly what was measured."""
    pair = exchange(believed, null.baseline)
    if pair is None:
        return believed, null
    observed = exchanged(believed.observed, *pair)
    again = Believed(believed.structure, observed, believed.prior)
    fit = refine(again, calibrated(again, training), (), (), ())
    runs = tuple(training)
    before, after = (
        fit_gaps(model, one.baseline, runs)[list(pair)].max()
        for model, one in ((believed, null), (again, fit))
    )
    if fit.log_posterior < null.log_posterior + SWAPPED_NATS or after > SWAPPED_GAP * before:
        return believed, null
    one, other = (observed.names[channel] for channel in pair)
    observed.warnings.append(
        f"channels {one} and {other} are swapped: the model fits far better with the two exchanged, and so it was done"
    )
    return again, fit
