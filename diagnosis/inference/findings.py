"""What a search finds: fits with their evidence and their misfits, about the null model."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.evidence import Scores
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.misfit import (
    by_frame,
    channel_misfits,
    floors,
    median,
    over_floor,
    simulate,
)
from pounding.diagnosis.inference.refine import Fit, Race
from pounding.diagnosis.inference.tails import FalseAlarms
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS

if TYPE_CHECKING:
    from pounding.diagnosis.model.pair import Pair


@dataclass(frozen=True)
class Judged:
    """A refined candidate as it is judged.

    Attributes:
        fit: The fit. ln_bayes: Its log evidence against the null model.
        misfit: Median misfit over the training and over the held-out runs (NaN without any).
        channel_misfit: Misfit of each channel over the training and the held-out runs, shape (2, channels).
        beside: A fit without which it is not judged, of what only tells how sensors are known; the former is against that.
        sized: The fit that states its sizes, where that is not `fit` (`decision.sizes`).
    """

    fit: Fit
    ln_bayes: float
    misfit: tuple[float, float]
    channel_misfit: np.ndarray
    beside: Judged | None = None
    sized: Fit | None = None

    def __repr__(self) -> str:
        return f"Judged({self.label()!r}, ln Bayes factor {self.ln_bayes:.4g})"

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects in the fit, without those that it is judged beside."""
        aside = () if self.beside is None else self.beside.fit.effects
        return tuple(effect for effect in self.fit.effects if effect not in aside)

    @property
    def places(self) -> frozenset[tuple[object, ...]]:
        """Effects and places, however they are reported."""
        return frozenset(effect.key for effect in self.effects)

    def label(self) -> str:
        """Return the effects and their places in words."""
        return " and ".join(effect.label() for effect in self.effects) or "nothing missing"


@dataclass(frozen=True)
class BesideLatentForce:
    """Two effects beside whatever force acts in the storeys of one of them.

    Attributes:
        gained: What both gain in log evidence over that one.
        both: Their fit; None where that one is no force of storeys.
    """

    gained: float
    both: Fit | None = None


@dataclass
class Findings:
    """What the search found.

    Attributes:
        null: The refined null model. scores: All candidates about it.
        judged: Refined candidates, best first.
        floor: Misfit that a perfect model would leave over the training and the held-out runs, (2, channels).
        sizes: Typical sizes of motion.
        training, held_out: Numbers of the runs in which effects act. reference: Those of the frame as it was before, which
            are fitted too.
    """

    model: Model
    null: Judged
    scores: Scores
    sizes: Scales
    training: tuple[int, ...]
    held_out: tuple[int, ...]
    judged: list[Judged] = field(default_factory=list)
    floor: np.ndarray = field(default_factory=lambda: np.zeros((2, 0)))
    later: Scores | None = None
    """Scores of second effects about the best fit."""
    pair: Pair | None = None
    """Two frames that touch, at the rate of the logger."""
    false_alarms: FalseAlarms | None = None
    """By what it is judged; None: by the nulls that come with the package, at the usual rate."""
    reference: tuple[int, ...] = ()
    plain: Judged | None = None
    """The null model without the errors of the frame that are in it; None where none is."""
    wide: Judged | None = None
    """The null model with the likeliest scale of the discrepancy, where `null` has a smaller one (`decision.imitated`)."""
    beside_latent_force: dict[Hashable, BesideLatentForce] = field(default_factory=dict)
    """Two effects whatever the law of one gets wrong, by the fits of that one and of both."""
    moved: dict[Hashable, Fit] = field(default_factory=dict)
    """Fits calibrated by their own motion (`inference.own_motion`), by the fit."""
    nearest: dict[Hashable, Fit] = field(default_factory=dict)
    """Fits of the nearest frame that moves alike (`decision.nearest_frame`), by the fit."""
    settled: tuple[Judged, Model, Filtered] | None = None
    """Effects that are named in a pair, the model with forces as frames with these put them right, and these frames."""

    def __repr__(self) -> str:
        best = repr(self.judged[0]) if self.judged else "none"
        return f"Findings({len(self.judged)} candidates judged, the best: {best})"

    @property
    def baseline(self) -> Judged:
        """The calibrated baseline model alone, without errors of the frame that the null model may have."""
        return self.plain or self.null

    @property
    def candidates(self) -> list[Effect]:
        """All effects that were tried, those that the null model has as errors of the frame among them."""
        return [*(one.effect for one in self.scores.ranked), *self.null.fit.effects]

    @property
    def fitted(self) -> tuple[int, ...]:
        """Numbers of all runs that are fitted."""
        return (*self.reference, *self.training)

    @property
    def is_light(self) -> bool:
        """Whether there is memory for two pieces of work on these runs at a time."""
        return self.model.is_light(self.training)

    @property
    def shared(self) -> tuple[object, ...]:
        """What results of pieces of work refer to: the model, and kinds of effects, of which a user's cannot be imported."""
        return (self.model, *dict.fromkeys(type(effect) for effect in self.candidates))

    def judge_beside_errors(self) -> None:
        """Judge all beside the errors of the frame as the null model has them now, where it has any."""
        if self.null.beside is None:
            return
        errors = replace(self.null, beside=None)
        self.null = replace(self.null, beside=errors)
        self.judged = [replace(one, beside=errors) for one in self.judged]

    def claimable(self) -> list[Judged]:
        """Return what was judged, best first, without what only tells how badly a pair's forces and sensors are known.

        Those are delays as filters make them, and effects beside a second contact, whose force is what the motion asks for.
        Where such a delay is the likeliest effect, others are judged beside it, since alone they may imitate it.
        """
        pair = self.pair
        if pair is None:
            return self.judged
        floor = None if pair.second is None else pair.second[0]
        told = [one for one in self.judged if not _beside(one, floor)]
        single = [one for one in told if len(one.effects) == 1]
        if not single or not _of_filters(single[0]):
            return [one for one in told if not _of_filters(one)]
        delay = single[0]
        found = [
            replace(one, ln_bayes=one.ln_bayes - delay.ln_bayes, beside=delay)
            for one in told
            if len(one.effects) == 2 and delay.effects[0] in one.effects
        ]
        return [one for one in found if not _of_filters(one)]


def _of_filters(judged: Judged) -> bool:
    each = zip(judged.fit.effects, judged.fit.values, strict=True)
    return any(
        effect.name == "sensor_delay" and abs(values[0]) < SETTINGS.pair_decision.filtered_s
        for effect, values in each
        if effect in judged.effects
    )


def _beside(judged: Judged, floor: int | None) -> bool:
    """Return whether an effect is at a floor (from 1) or in one of the two storeys that meet there."""
    if floor is None:
        return False
    return any(effect.storey in (floor, floor + 1) or effect.floor == floor for effect in judged.effects)


def judge(model: Model, fit: Fit, null: Fit, training: tuple[int, ...], held_out: tuple[int, ...]) -> Judged:
    """Return a fit with its evidence and its misfits.

    Args:
        model: The baseline model.
        fit: The fit.
        null: The fit of the null model, against which its ln Bayes factor is.
        training, held_out: Numbers of the runs.
    """
    each = [fit_misfits(model, fit.filtered, runs) for runs in (training, held_out)]
    fit.put_away()
    return Judged(fit, fit.log_posterior - null.log_posterior, _medians(each), np.array(each))


def judge_in(found: Findings, fit: Fit) -> Judged:
    """Return a fit as it is judged about the null model of findings, beside the errors that this one has.

    Args:
        found: The findings.
        fit: The fit.
    """
    judged = judge(found.model, fit, found.null.fit, found.training, found.held_out)
    return replace(judged, beside=found.null.beside)


def judged_on(judged: Judged, model: Model, filtered: Filtered, *runs: tuple[int, ...]) -> Judged:
    """Return a candidate with the misfits that a baseline with its effects leaves in a model with other contact forces.

    Args:
        judged: The candidate.
        model: The model.
        filtered: Its frames with the effects.
        runs: Numbers of the training and of the held-out runs.
    """
    each = [fit_misfits(model, filtered, some) for some in runs]
    return replace(judged, misfit=_medians(each), channel_misfit=np.array(each))


def _medians(each: Sequence[np.ndarray]) -> tuple[float, float]:
    training, held_out = (float(median(misfits)) for misfits in each)
    return training, held_out


def fit_misfits(model: Model, filtered: Filtered, runs: tuple[int, ...]) -> np.ndarray:
    """Return the misfit of each channel that a fit leaves over some runs, shape (channels,), NaN without any.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        runs: Numbers of the runs.
    """
    if not runs:
        return np.full(len(model.observed.names), np.nan)
    return channel_misfits(model, simulate(model, filtered.values, filtered.effects, runs), runs)


def noise_floor(found: Findings, fit: Fit) -> np.ndarray:
    """Return the misfit that a perfect model would leave over the training and the held-out runs, (2, channels)."""
    nothing = np.full(len(found.model.observed.names), np.nan)
    return np.array(
        [
            floors(found.model, fit.filtered, runs) if runs else nothing
            for runs in (found.training, found.held_out)
        ]
    )


def worth_anew(found: Findings) -> float:
    """Return what another start must gain in log evidence to be worth what follows from it being done again.

    Args:
        found: The findings.
    """
    return max(SETTINGS.search.restart_gain, SETTINGS.search.restart_share * best(found).ln_bayes)


def best(found: Findings) -> Judged:
    """Return the candidate with most evidence, or the null model."""
    return found.judged[0] if found.judged and found.judged[0].ln_bayes > 0 else found.null


def leaders(found: Findings) -> list[Judged]:
    """Return the likeliest candidate and, where it is outside the catalogue, the likeliest in it; none without any.

    Args:
        found: The findings.
    """
    likely = [one for one in found.judged if one.ln_bayes > 0]
    named = [one for one in likely if not any(effect.rival for effect in one.effects)]
    return list({id(one): one for one in (*likely[:1], *named[:1])}.values())


def race(found: Findings, about: Fit | None = None) -> Race:
    """Return what a refinement is up against: the likeliest fit of effects of the catalogue.

    Args:
        found: The findings.
        about: The fit beside which an effect is refined; the null model by default.
    """
    named = [one for one in found.judged if not any(effect.rival for effect in one.effects)]
    ahead = max((one.fit.filtered.log_likelihood for one in named), default=-np.inf)
    return Race(ahead, (about or found.null.fit).filtered.log_likelihood)


def unexplained(found: Findings, judged: Judged) -> bool:
    """Return whether a fit leaves much more than noise of a frame in the training runs."""
    return leaves_much(found.model, judged.channel_misfit[0], judged.fit.filtered, found.training)


def leaves_much(model: Model, misfits: np.ndarray, filtered: Filtered, runs: tuple[int, ...]) -> bool:
    """Return whether misfits are much more than noise in a frame.

    Args:
        model: The baseline model.
        misfits: Misfit of each channel over the runs, shape (channels,).
        filtered: The filtered model, with the noise.
        runs: Numbers of the runs.
    """
    over = over_floor(model, misfits, floors(model, filtered, runs))
    return bool(np.nanmax(by_frame(model, over)) > SETTINGS.search.unexplained)
