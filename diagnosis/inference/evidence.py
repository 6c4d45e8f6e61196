"""Evidence of every candidate about a filtered model, as ln Bayes factors, with the nuisance parameters always free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.inference.delays import late_channels, slopes_of_noise
from pounding.diagnosis.inference.discrepancy import SCALES, wider
from pounding.diagnosis.inference.filtering import (
    AT_ONCE,
    LARGEST_SLOPE,
    Filtered,
    feedbacks,
    signature_pieces_of_run,
    whitened_innovations,
)
from pounding.diagnosis.inference.motions import motions
from pounding.diagnosis.inference.numbers import PROBE, Numbers
from pounding.diagnosis.inference.posterior import add_products
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.terms import nuisance_terms


@dataclass(frozen=True)
class Score:
    """What the data say of one candidate at its best shape.

    Attributes:
        effect: The candidate. shape: What is not amplitude, in SI. amplitude: Best amplitude in SI.
        std: Its standard error. ln_bayes: Log evidence against the model without it.
        column: Its row in `Scores.projected`.
        nuisance: How the nuisance parameters move with it, in their own units, shape (parameters,): what of the effect
            they had taken they give back.
    """

    effect: Effect
    shape: tuple[float, ...]
    amplitude: float
    std: float
    ln_bayes: float
    column: int
    nuisance: np.ndarray


@dataclass(frozen=True)
class Scores:
    """Scores of all candidates, best first, and the Gram matrix of their signatures, nuisance parameters projected out."""

    ranked: list[Score]
    projected: np.ndarray

    def cosine(self, one: Score, other: Score) -> float:
        """Return how alike the signatures of two candidates are, after the nuisance parameters took their part."""
        gram = self.projected
        size = np.sqrt(gram[one.column, one.column] * gram[other.column, other.column])
        return abs(float(gram[one.column, other.column] / size)) if size > 0 else 0.0


def scales(model: Model, filtered: Filtered) -> Scales:
    """Return the typical sizes of motion about a baseline."""
    found = motions(model, filtered)
    drift = np.concatenate([motion.drift for motion in found])
    acceleration = np.concatenate([motion.acceleration for motion in found])
    mass = np.concatenate([frame.floor_mass for frame in model.structure.frames])
    shear = np.concatenate(
        [
            root_mean_square(np.cumsum((acceleration * mass)[:, span][:, ::-1], axis=1)[:, ::-1])
            for span in map(model.structure.span, range(len(model.structure.frames)))
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
            root_mean_square(np.concatenate([model.observed.runs[run].measured for run in filtered.runs])),
            nan=1.0,
        ),
        omega=tuple(
            filtered.modes.omega[model.structure.span(frame)] for frame in range(len(model.structure.frames))
        ),
    )


def score(
    model: Model,
    filtered: Filtered,
    effects: Sequence[Effect],
    sizes: Scales,
    present: Sequence[np.ndarray] = (),
) -> Scores:
    """Return the scores of candidates about a baseline.

    Args:
        model: The baseline model.
        filtered: The filtered model about which to linearise.
        effects: The candidates.
        sizes: Typical sizes of the motion.
        present: For each run whitened and prior-scaled columns of effects that the filtered model already has, shape
            (samples * channels, columns); they stay free as the nuisance parameters do.
    """
    columns = [(effect, shape) for effect in effects for shape in effect.grid(sizes)]
    width = np.array([effect.size(model, sizes, shape) for effect, shape in columns])
    free = len(model.std) + (present[0].shape[1] if present else 0)
    total = free + len(columns)
    gram, slope = np.zeros((total, total)), np.zeros(total)
    residuals = whitened_innovations(model, filtered)
    spread = model.spread(filtered.discrepancy)
    wide = np.concatenate([spread, width])
    late = late_channels(model, [effect for effect, _ in columns])
    for number, motion in enumerate(motions(model, filtered)):
        modes, acts = filtered.run_modes[number], model.acts(filtered.runs[number])
        groups: list[list[Term]] = nuisance_terms(model, modes, motion)
        groups += [effect.terms(model, modes, motion, shape) if acts else [] for effect, shape in columns]
        already = present[number] if present else np.zeros((len(residuals[number]), 0), np.float32)
        more = _products(model, filtered, number, groups, wide, already, residuals[number])
        gram += more[0]
        slope += more[1]
        heard = wide * (late @ slopes_of_noise(model, filtered, number, motion, residuals[number]))
        slope[: len(spread)] += heard[: len(spread)]
        slope[free:] += heard[len(spread) :] if acts else 0.0
    numbers = Numbers(model, filtered.runs)
    if len(numbers):
        block = _number_columns(numbers, filtered, columns, width)
        block[:, : len(spread)] *= spread / model.std
        if present:
            block = np.hstack([block[:, : len(spread)], present[-1], block[:, len(spread) :]])
        gram += block.T @ block
        slope += block.T @ numbers.residual(filtered.values, filtered.effects)
    return _rank(model, filtered, columns, width, gram, slope, free)


def _products(
    model: Model,
    filtered: Filtered,
    number: int,
    groups: list[list[Term]],
    width: np.ndarray,
    present: np.ndarray,
    residual: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the products of a run's columns with themselves, (columns, columns), and with its innovations, (columns,).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        groups: Terms of each nuisance parameter, then of each candidate.
        width: What their columns are multiplied by, shape (groups,).
        present: Columns that stand between those of both, shape (samples * channels, present).
        residual: Whitened innovations, shape (samples * channels,).
    """
    nuisance, total = len(model.std), len(width) + present.shape[1]
    gram, slope = np.zeros((total, total)), np.zeros(total)
    for feedback in feedbacks(model, filtered, number):
        gram[:], slope[:] = 0.0, 0.0
        # Nuisance parameters imitate most of many candidates: the rest is a small difference that needs double precision.
        for rows, signature in signature_pieces_of_run(model, filtered, number, groups, AT_ONCE, feedback):
            wide = signature * width
            wide = np.hstack([wide[:, :nuisance], present[rows], wide[:, nuisance:]])
            add_products(gram, slope, wide, residual[rows])
        if np.all(np.diag(gram) < LARGEST_SLOPE**2):
            break
    return gram, slope


def _number_columns(
    numbers: Numbers,
    filtered: Filtered,
    columns: Sequence[tuple[Effect, tuple[float, ...]]],
    width: np.ndarray,
) -> np.ndarray:
    """Return whitened, prior-scaled slopes of the numbers: of the nuisance parameters, then of the candidates."""
    here = numbers.residual(filtered.values, filtered.effects)
    found = []
    for (effect, shape), size in zip(columns, width, strict=True):
        sign = effect.sign or 1
        values = effect.values(sign * PROBE * size, shape)
        acting = [*filtered.effects, (effect, values)]
        found.append((here - numbers.residual(filtered.values, acting)) / (sign * PROBE))
    return np.hstack([numbers.nuisance_columns(filtered.values, filtered.effects), np.array(found).T])


AT_THE_END = 1.0 - 1e-6
"""Share of its box from which on a nuisance parameter is at its end."""


@dataclass(frozen=True)
class _AtScale:
    """The columns scored with one scale of the model discrepancy.

    `null` is the log evidence without them; the others have shape (columns,), `taken` (free, columns) in units of the priors
    `spread` (nuisance,), `projected` (columns, columns).
    """

    null: float
    amplitude: np.ndarray
    information: np.ndarray
    ln_bayes: np.ndarray
    taken: np.ndarray
    projected: np.ndarray
    spread: np.ndarray


def _at_scale(
    model: Model, filtered: Filtered, gram: np.ndarray, slope: np.ndarray, free: int, scale: float
) -> _AtScale:
    """Return the scores with one scale of the discrepancy; `gram` and `slope` are in units of the filtered model's."""
    by = wider(model.discrepant, len(gram), scale / filtered.discrepancy)
    gram, slope, spread = gram * np.outer(by, by), slope * by, model.spread(scale)
    start = np.zeros(free)
    start[: len(spread)] = filtered.values / spread
    box = box_of(len(spread))
    pushed = start * (slope[:free] - start) > 0.0
    ends = pushed & (np.abs(start) >= AT_THE_END * box)
    loose = _solved(gram, slope, start, np.ones(free, bool))
    held = _solved(gram, slope, start, ~ends) if ends.any() else loose
    # A candidate may let a parameter at the end of its box go; else it stays there, and takes no part of what is missing.
    let_go = np.all(np.abs(loose.ends(start, ends)) <= box, axis=0)
    return _AtScale(
        null=held.null,
        amplitude=np.where(let_go, loose.amplitude, held.amplitude),
        information=np.where(let_go, loose.information, held.information),
        ln_bayes=np.where(let_go, loose.ln_bayes + loose.null - held.null, held.ln_bayes),
        taken=np.where(let_go, loose.taken, held.taken),
        projected=held.projected,
        spread=spread,
    )


@dataclass(frozen=True)
class _Solved:
    """The best sizes of single columns, those of the free parameters that move being the best with each.

    `null` is the log evidence without them, `step` (free,) how the parameters move then; the others as in `_AtScale`.
    """

    null: float
    step: np.ndarray
    amplitude: np.ndarray
    information: np.ndarray
    ln_bayes: np.ndarray
    taken: np.ndarray
    projected: np.ndarray

    def ends(self, start: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Return where some parameters end with each column, shape (which, columns)."""
        return np.asarray((start + self.step)[which, None] - self.taken[which] * self.amplitude)


def _solved(gram: np.ndarray, slope: np.ndarray, start: np.ndarray, moves: np.ndarray) -> _Solved:
    """Return the best size of each column beside the free parameters, of which only some move.

    Args:
        gram: Products of all columns, shape (free + columns, free + columns).
        slope: Their products with the innovations, shape (free + columns,).
        start: The free parameters in units of the priors, shape (free,).
        moves: Which of these move, shape (free,).
    """
    free = len(start)
    information = gram[:free, :free] + np.eye(free)
    pull = slope[:free] - start
    moved = np.zeros((free, len(gram) - free + 1))
    moved[moves] = np.linalg.solve(
        information[np.ix_(moves, moves)], np.column_stack([gram[:free, free:], pull])[moves]
    )
    taken, step = moved[:, :-1], moved[:, -1]
    # The volume of the posterior is that of all, as in a fit that ends at the end of a box.
    null = (
        0.5 * float(pull @ step) - 0.5 * float(start @ start) - 0.5 * float(np.linalg.slogdet(information)[1])
    )
    projected = gram[free:, free:] - gram[free:, :free] @ taken
    known = np.maximum(np.diag(projected), 0.0)
    pulled = slope[free:] - taken.T @ pull
    return _Solved(
        null=null,
        step=step,
        amplitude=pulled / (1 + known),
        information=known,
        ln_bayes=0.5 * pulled**2 / (1 + known) - 0.5 * np.log1p(known),
        taken=taken,
        projected=projected,
    )


def _rank(
    model: Model,
    filtered: Filtered,
    columns: Sequence[tuple[Effect, tuple[float, ...]]],
    width: np.ndarray,
    gram: np.ndarray,
    slope: np.ndarray,
    free: int,
) -> Scores:
    """Return the best column of each effect, its evidence averaged over the scales of the discrepancy, the best first."""
    scales = SCALES if model.discrepant.any() else np.array([filtered.discrepancy])
    each = [_at_scale(model, filtered, gram, slope, free, float(scale)) for scale in scales]
    null = np.array([one.null for one in each])
    signs = np.array([effect.sign for effect, _ in columns])
    weighed = np.array([one.null + _allowed(one, signs) for one in each])
    ln_bayes = logsumexp(weighed, axis=0) - logsumexp(null)
    best: dict[int, Score] = {}
    for column, (effect, shape) in enumerate(columns):
        likeliest = each[int(np.argmax(weighed[:, column]))]
        amplitude = likeliest.amplitude[column]
        nuisance = len(likeliest.spread)
        found = Score(
            effect=effect,
            shape=shape,
            amplitude=float(amplitude * width[column]),
            std=float(width[column] / np.sqrt(1 + likeliest.information[column])),
            ln_bayes=float(ln_bayes[column]),
            column=column,
            nuisance=-likeliest.taken[:nuisance, column] * amplitude * likeliest.spread,
        )
        key = id(effect)
        if key not in best or found.ln_bayes > best[key].ln_bayes:
            best[key] = found
    projected = each[int(np.argmax(null))].projected
    return Scores(sorted(best.values(), key=lambda s: -s.ln_bayes), projected)


def _allowed(scored: _AtScale, signs: np.ndarray) -> np.ndarray:
    """Return ln Bayes factors, what has the wrong sign being worth no more than its freedom costs, shape (columns,)."""
    cost = -0.5 * np.log1p(scored.information)
    wrong = (signs != 0) & (signs * scored.amplitude <= 0)
    return np.where(wrong, np.minimum(scored.ln_bayes, cost), scored.ln_bayes)
