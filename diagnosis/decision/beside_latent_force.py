"""A second effect whatever force acts where the first one's law does: how much likelier both are, and their sizes."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered, run_filter, tangents_of
from pounding.diagnosis.inference.findings import BesideLatentForce, Findings, Judged, judge_in
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.refining import each, refined_at_its_noise
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.settings import SETTINGS


def beside_latent_force(found: Findings, single: Judged, double: Judged) -> BesideLatentForce:
    """Return two effects beside whatever force acts in the storeys of one of them, beside its law's.

    The square of that force is a share of the law's own. What the law gets wrong is such a force, and passes for no second
    effect. An effect that is no force of storeys may get as large a share of its evidence wrong.

    Args:
        found: What the search found; what was worked out before is kept in it.
        single: The one effect.
        double: The two.
    """
    asked = _asked(single, double)
    if asked not in found.beside_latent_force:
        found.beside_latent_force[asked] = _worked_out(found, single, double)
    return found.beside_latent_force[asked]


def with_sizes(found: Findings, single: Judged, double: Judged) -> Judged:
    """Return two effects with the sizes that they have whatever force acts, where that had to be asked.

    What the law of the one gets wrong would draw the size of the other one away. Where frames touch, the sizes are those
    with which the contact forces were put right.

    Args:
        found: What the search found.
        single: The one effect.
        double: The two.
    """
    known = found.beside_latent_force.get(_asked(single, double))
    if known is None or known.both is None or found.pair is not None:
        return double
    return replace(judge_in(found, known.both), ln_bayes=double.ln_bayes, beside=double.beside)


def _asked(single: Judged, double: Judged) -> Hashable:
    return tuple((one.fit.effects, one.fit.log_posterior) for one in (single, double))


def _worked_out(found: Findings, single: Judged, double: Judged) -> BesideLatentForce:
    share = SETTINGS.decision.second_share
    wrong = _wrong_forces(found, single, share)
    if wrong is None:
        return BesideLatentForce(double.ln_bayes - (1.0 + share) * single.ln_bayes)

    def freed(fit: Fit) -> Fit:
        return refined_at_its_noise(found, fit, _with_forces(found, fit, wrong))

    both, alone = each(found, freed, (double.fit, single.fit))
    # The two may end at different maxima of one likelihood: the simpler one is led to the other's.
    known = dict(zip(both.effects, both.values, strict=True))
    there = tuple(known.get(effect, value) for effect, value in zip(alone.effects, alone.values, strict=True))
    again = refined_at_its_noise(found, replace(alone, values=there), both.filtered)
    return BesideLatentForce(both.log_posterior - max(alone.log_posterior, again.log_posterior), both)


def _wrong_forces(found: Findings, single: Judged, share: float) -> list[np.ndarray] | None:
    """Return rms forces [N] of each run, (storeys,) each, whose square is a share of an effect's, None without such."""
    model, filtered = found.model, single.fit.filtered
    laws = model.assemble(filtered.values, filtered.effects).laws
    first = len(model.assemble(filtered.values).laws)
    each = [len(model.assemble(filtered.values, [one]).laws) - first for one in filtered.effects]
    asked = np.repeat([effect in single.effects for effect, _ in filtered.effects], each)
    own = first + np.flatnonzero(asked)
    rows = [laws[j].row for j in own]
    if not rows:
        return None
    # A force on a floor is one in each storey below it.
    storeys = np.linalg.solve(model.structure.drift.T, np.transpose(rows)).T
    every_run = []
    for number, run in enumerate(filtered.runs):
        square = np.zeros(len(model.structure.drift))
        if model.acts(run):
            acting = tangents_of(model, filtered, number)
            assert acting is not None
            square = np.mean((acting.forces[:, 0, own] @ storeys) ** 2, axis=0)
        every_run.append(np.sqrt(share * square))
    return every_run


def _with_forces(found: Findings, fit: Fit, wrong: list[np.ndarray]) -> Filtered:
    """Return a fit filtered with latent forces that are at least so large."""
    filtered = fit.filtered
    noise: list[Noise] = [
        replace(one, latent=np.maximum(one.latent, least))
        for one, least in zip(filtered.noise, wrong, strict=True)
    ]
    return run_filter(found.model, filtered.values, noise, filtered.runs, filtered.effects)
