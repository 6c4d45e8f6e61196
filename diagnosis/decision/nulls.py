"""What a simulated null shows: a rig on which nothing is missing, with noise and with errors of its model.

Nuisance parameters are drawn from their priors and the model discrepancy at a scale drawn from its own; the null is then
searched as a measured case is. How large the evidence for anything becomes in many of them says how much is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.decision.false_alarms import least_size
from pounding.diagnosis.decision.measures import remaining, signal_to_noise
from pounding.diagnosis.inference.findings import Findings, Judged, best
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.observations import Observations, RunData, root_mean_square
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class Shown:
    """The most that the search found in a null.

    Attributes:
        ordinary: Largest ln Bayes factor of a single effect that may be named, and that absorbs no errors of models.
        ordinary_effect: That effect and its place, in words.
        ordinary_size: Its signal-to-noise ratio in the channel where it shows most.
        absorbing, absorbing_effect, absorbing_size: The same of effects that absorb such errors.
        second: Largest ln Bayes factor of a second effect, given the first; nothing where none was looked at.
        second_size: Its signal-to-noise ratio.
        left: Misfit over the noise floor with nothing missing, of the frame that has most.
        left_by_best: The same with the likeliest single effect.
    """

    ordinary: float
    ordinary_effect: str
    ordinary_size: float
    absorbing: float
    absorbing_effect: str
    absorbing_size: float
    second: float
    second_size: float
    left: float
    left_by_best: float


def shown(found: Findings) -> Shown:
    """Return the most that a search found in a null."""
    ordinary, absorbing = _most(found, absorbing=False), _most(found, absorbing=True)
    singles = [one for one in found.judged if len(one.effects) == 1]
    doubles = [one for one in found.judged if len(one.effects) > 1]
    second, second_size = 0.0, 0.0
    if singles and doubles:
        second = max(doubles[0].ln_bayes - singles[0].ln_bayes, 0.0)
        second_size = signal_to_noise(found, doubles[0], singles[0])
    leading = singles[0] if singles else best(found)
    left = remaining(found, found.null), remaining(found, leading)
    return Shown(*ordinary, *absorbing, second, second_size, *left)


def _most(found: Findings, absorbing: bool) -> tuple[float, str, float]:
    """Return the largest ln Bayes factor of a kind of single effects that may be named, the effect in words, and its size.

    However likely, an effect that is smaller than a name needs raises no alarm. Where none was refined that is as large it
    is the largest score of the others, which is too small to be refined, and nothing is known of its size.
    """
    refined = [one for one in found.judged if _is(one, absorbing)]
    for one in refined:
        if (size := signal_to_noise(found, one)) >= least_size(absorbing):
            return one.ln_bayes, one.label(), size
    known = {one.effects[0] for one in refined}
    scored = [
        one for one in found.scores.ranked if one.effect.absorbing == absorbing and one.effect not in known
    ]
    if not scored:
        return 0.0, "", 0.0
    return min(scored[0].ln_bayes, SETTINGS.search.worth), scored[0].effect.label(), 0.0


def _is(judged: Judged, absorbing: bool) -> bool:
    return len(judged.effects) == 1 and judged.effects[0].absorbing == absorbing


def drawn(model: Model, rng: np.random.Generator, discrepancy: float) -> np.ndarray:
    """Return nuisance parameters drawn from their priors, in their own units, shape (nuisance,).

    Args:
        model: The baseline model.
        rng: Random numbers.
        discrepancy: Scale of the model discrepancy [-], which frames of this kind have.
    """
    within = SETTINGS.calibration.within
    spread = model.spread(discrepancy)
    return np.asarray(spread * np.clip(rng.standard_normal(len(spread)), -within, within))


def with_data_of(
    model: Model,
    nuisance: np.ndarray,
    acting: Sequence[tuple[Acting, np.ndarray]],
    noise: tuple[np.ndarray, float],
    rng: np.random.Generator,
) -> Model:
    """Return a rig with simulated data, with dropouts where there are some in its own.

    Args:
        model: The rig, whose table motions are taken for the true ones.
        nuisance: Its nuisance parameters, shape (nuisance,).
        acting: Effects in the data, each with its SI parameters, shape (parameters,).
        noise: Standard deviation of the noise over the root mean square of each channel, (channels,), and of the table.
        rng: Random numbers for the noise.
    """
    share, table_share = noise
    runs: list[RunData] = []
    outputs = model.predict(nuisance, None, acting).outputs
    for run, clean in zip(model.observed.runs, outputs, strict=True):
        size = share * root_mean_square(clean)
        noisy = clean + size * rng.standard_normal(clean.shape)
        noisy[~np.isfinite(run.measured)] = np.nan
        table_size = table_share * float(root_mean_square(run.table))
        table = run.table + table_size * rng.standard_normal(len(run.table))
        runs.append(replace(run, measured=noisy, table=table))
    observed: Observations = replace(model.observed, runs=tuple(runs), warnings=[])
    return model.seeing(observed)
