"""Evidence of every candidate about a calibrated predictor, in nats, with the ordinary parameters always free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.filtering import Baseline, grouped_signatures, motions, whitened_innovations
from pounding.diagnosis.model.model import Believed
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.terms import ordinary_terms


@dataclass(frozen=True)
class Score:
    """What the data say of one candidate at its best shape.

    Attributes:
        effect: The candidate. shape: What is not amplitude, in SI. amplitude: Best amplitude in SI.
        std: Its standard error. nats: Log evidence against the model without it.
        column: Its row in `Scores.projected`.
        ordinary: How the ordinary parameters move with it, in their own units, shape (parameters,): what of the effect
            they had taken they give back.
    """

    effect: Effect
    shape: tuple[float, ...]
    amplitude: float
    std: float
    nats: float
    column: int
    ordinary: np.ndarray


@dataclass(frozen=True)
class Scores:
    """Scores of all candidates, best first, and the Gram matrix of their signatures without the ordinary ones."""

    ranked: list[Score]
    projected: np.ndarray

    def cosine(self, one: Score, other: Score) -> float:
        """Return how alike the signatures of two candidates are, after the ordinary parameters took their part."""
        gram = self.projected
        size = np.sqrt(gram[one.column, one.column] * gram[other.column, other.column])
        return abs(float(gram[one.column, other.column] / size)) if size > 0 else 0.0


def scales(believed: Believed, baseline: Baseline) -> Scales:
    """Return the typical sizes of motion about a baseline."""
    found = motions(believed, baseline)
    drift = np.concatenate([motion.drift for motion in found])
    acceleration = np.concatenate([motion.acceleration for motion in found])
    mass = np.concatenate([frame.floor_mass for frame in believed.structure.frames])
    shear = np.concatenate(
        [
            root_mean_square(np.cumsum((acceleration * mass)[:, span][:, ::-1], axis=1)[:, ::-1])
            for span in map(believed.structure.span, range(len(believed.structure.frames)))
        ]
    )
    # A storey that hardly moves still needs a scale: a hundredth of the largest.
    rms = root_mean_square(drift)
    rms = np.maximum(rms, 0.01 * rms.max())
    return Scales(
        drift=rms,
        drift_rate=root_mean_square(np.concatenate([motion.drift_rate for motion in found])),
        highest=np.maximum(drift.max(axis=0), 0.5 * rms),
        lowest=np.minimum(drift.min(axis=0), -0.5 * rms),
        shear=shear,
        acceleration=root_mean_square(acceleration),
        rate=root_mean_square(np.concatenate([m.floor_rate + m.table_rate[:, None] for m in found])),
        output=np.nan_to_num(
            root_mean_square(np.concatenate([believed.observed.runs[run].measured for run in baseline.runs])),
            nan=1.0,
        ),
        omega=tuple(
            baseline.modes.omega[believed.structure.span(frame)]
            for frame in range(len(believed.structure.frames))
        ),
    )


def score(
    believed: Believed,
    baseline: Baseline,
    effects: Sequence[Effect],
    sizes: Scales,
    present: Sequence[np.ndarray] = (),
) -> Scores:
    """Return the scores of candidates about a baseline.

    Args:
        believed: The believed model.
        baseline: The predictor about which to linearise.
        effects: The candidates.
        sizes: Typical sizes of motion.
        present: For each run whitened and prior-scaled columns of effects that the baseline already has; they stay
            free as the ordinary parameters do.
    """
    columns = [(effect, shape) for effect in effects for shape in effect.grid(sizes)]
    width = np.array([effect.size(believed, sizes, shape) for effect, shape in columns])
    free = len(believed.std) + (present[0].shape[1] if present else 0)
    total = free + len(columns)
    gram, slope = np.zeros((total, total)), np.zeros(total)
    residuals = whitened_innovations(believed, baseline)
    for number, motion in enumerate(motions(believed, baseline)):
        one = Baseline(
            baseline.values,
            baseline.effects,
            baseline.modes,
            (baseline.noise[number],),
            (baseline.filters[number],),
            baseline.prediction,
            0.0,
            (baseline.runs[number],),
        )
        groups: list[list[Term]] = ordinary_terms(believed, baseline.modes, motion)
        groups += [effect.terms(believed, baseline.modes, motion, shape) for effect, shape in columns]
        signature = grouped_signatures(believed, one, [groups])[0]
        # Candidates are often nearly ordinary: what is left of them is a small difference, and needs double precision.
        signature = signature.astype(float) * np.concatenate([believed.std, width])
        if present:
            ordinary = len(believed.std)
            signature = np.hstack([signature[:, :ordinary], present[number], signature[:, ordinary:]])
        gram += signature.T @ signature
        slope += signature.T @ residuals[number]
    slope[: len(believed.std)] -= baseline.values / believed.std
    return _rank(columns, width, gram, slope, free, believed.std)


def _rank(
    columns: Sequence[tuple[Effect, tuple[float, ...]]],
    width: np.ndarray,
    gram: np.ndarray,
    slope: np.ndarray,
    free: int,
    std: np.ndarray,
) -> Scores:
    ordinary = gram[:free, :free] + np.eye(free)
    taken = np.linalg.solve(ordinary, gram[:free, free:])
    projected = gram[free:, free:] - gram[free:, :free] @ taken
    pull = slope[free:] - taken.T @ slope[:free]
    information = np.maximum(np.diag(projected), 0.0)
    amplitude = pull / (1 + information)
    nats = 0.5 * pull**2 / (1 + information) - 0.5 * np.log1p(information)
    best: dict[int, Score] = {}
    for column, (effect, shape) in enumerate(columns):
        allowed = effect.sign == 0 or effect.sign * amplitude[column] > 0
        found = Score(
            effect=effect,
            shape=shape,
            amplitude=float(amplitude[column] * width[column]),
            std=float(width[column] / np.sqrt(1 + information[column])),
            nats=float(nats[column])
            if allowed
            else float(min(nats[column], -0.5 * np.log1p(information[column]))),
            column=column,
            ordinary=-taken[: len(std), column] * amplitude[column] * std,
        )
        key = id(effect)
        if key not in best or found.nats > best[key].nats:
            best[key] = found
    return Scores(sorted(best.values(), key=lambda s: -s.nats), projected)
