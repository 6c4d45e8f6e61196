"""The sizes that are stated of effects: the likeliest, or the nearest frame's where errors of the model bias these."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.decision.measures import less_certain, something_left
from pounding.diagnosis.decision.nearest_frame import evidence_beside_errors, nearest_fit
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, Judged, judged_on
from pounding.diagnosis.inference.refine import Fit, calibrated_further
from pounding.diagnosis.settings import SETTINGS


def with_unbiased_sizes(found: Findings, judged: Judged) -> Judged:
    """Return effects of a frame with sizes that hold beside the errors of its model, where the likeliest do not.

    While the model is right the likeliest sizes are the more precise ones; those of the nearest frame are right with its
    errors, too. What both differ by beyond chance is the bias of the former (Hausman 1978). Those with the smaller mean
    square error count, if the effects are likelier than none beside these errors as well. Where the discrepancy is none
    there is no error that could bend anything, and with reference runs the frame is known.

    Args:
        found: What the search found.
        judged: The effects that are named.
    """
    fit, model = judged.fit, found.model
    known = found.pair is not None or bool(found.reference) or fit.filtered.discrepancy <= float(SCALES[0])
    if known or all(effect.frame is None for effect in judged.effects):
        return judged
    nearest = nearest_fit(found, judged)
    if (
        not _biased(judged, less_certain(found, judged), nearest)
        or evidence_beside_errors(found, judged) <= 0.0
    ):
        return judged
    # What is claimed is what the model has; its frame must move as measured with these sizes, too.
    noise, runs = fit.filtered.noise, fit.filtered.runs
    claimed = run_filter(model, nearest.filtered.values, noise, runs, nearest.filtered.effects)
    moved = calibrated_further(model, claimed, SETTINGS.refinement.steps)
    with_these = replace(fit, values=nearest.values, filtered=moved)
    again = judged_on(
        replace(judged, fit=with_these, sized=nearest), model, moved, found.training, found.held_out
    )
    with_these.put_away()
    return judged if something_left(found, again) and not something_left(found, judged) else again


def stated_sizes(found: Findings, judged: Judged) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return SI parameters and standard errors of each effect, (parameters,) each, as they are stated.

    Args:
        found: What the search found.
        judged: The effects.
    """
    if judged.sized is not None:
        # Beside the errors of the model it has what these leave in it already.
        return judged.sized.stated(found.model, found.sizes)
    return judged.fit.stated(found.model, found.sizes, less_certain(found, judged))


def likeliest_sizes(found: Findings, judged: Judged) -> Judged | None:
    """Return effects that are named with their likeliest sizes, where others are stated, or None.

    Args:
        found: What the search found.
        judged: The effects.
    """
    if judged.sized is None:
        return None
    known = (*found.judged, *found.claimable())
    return next((one for one in known if one.fit.effects == judged.fit.effects), None)


def _biased(judged: Judged, wider: float, nearest: Fit) -> bool:
    """Return whether the mean square errors of the likeliest sizes are larger than those of the nearest frame's.

    An effect's size is its first parameter. The square of a difference is larger than that of the bias by the difference's
    variance, which is what the two variances differ by as the likeliest sizes are efficient. Standard errors of these that
    are the larger ones have what the model leaves in them, or what varies between windows, and say nothing against them.

    Args:
        judged: The effects with their likeliest sizes.
        wider: What the standard errors of these are multiplied by because the model leaves more than noise.
        nearest: The effects in the nearest frame.
    """
    fit = judged.fit
    ours = [effect.frame is not None and effect in judged.effects for effect in fit.effects]
    size, std, other, others_std = (
        np.array([each[0] for each, one in zip(series, ours, strict=True) if one])
        for series in (fit.values, fit.widened(wider), nearest.values, nearest.std)
    )
    bias = np.maximum((other - size) ** 2 - np.abs(others_std**2 - std**2), 0.0)
    return bool(np.mean((bias + std**2) / np.maximum(others_std, std) ** 2) > 1.0)
