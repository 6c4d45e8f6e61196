"""The parameters theta of an inference: nuisance parameters and effects in units of their priors' standard deviations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.posterior import Likelihood, Posterior
from pounding.diagnosis.model.kalman import DISCREPANCY
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.settings import SETTINGS

REACH = 1.0
"""Prior standard deviations that an effect's parameter may move in one step."""
LOG_WIDTH = 1.5
"""Prior standard deviation of a parameter that is refined as a logarithm."""
LARGEST_LOGARITHM = 6.0
"""How far the logarithm of such a parameter may be from its start's."""
WIDEST = 4.0
"""Prior standard deviations that a size may reach."""
NUDGE = 1e-4
"""Change of a size, in prior standard deviations, by which the slope of what is reported of it is taken."""


def box_of(parameters: int) -> float:
    """Return how far a nuisance parameter may be from the baseline [prior standard deviations].

    Further than any of them is likely to be: were it a fixed number, some parameter of a large model would be outside by
    chance, and what it lacks would be called an effect with an evidence that grows with the data.

    Args:
        parameters: How many nuisance parameters there are.
    """
    return float(norm.isf(0.5 * SETTINGS.refinement.outside / parameters))


@dataclass(frozen=True)
class Coordinates:
    """How nuisance parameters and effects follow from theta, shape (nuisance + effects' parameters,).

    Attributes:
        scale: Prior standard deviations of the nuisance parameters in their own units.
        effects: The effects, whose parameters follow the nuisance parameters in theta.
        start: SI parameters about which those that are refined as logarithms are centred, all effects' in turn.
        width: Prior standard deviations of the effects' parameters; of a logarithm where `logarithmic`.
        logarithmic: Which of them are refined as logarithms; the others are centred on zero.
        fixed: Other effects that act, with SI parameters that stay.
    """

    scale: np.ndarray
    effects: tuple[Effect, ...]
    start: np.ndarray
    width: np.ndarray
    logarithmic: np.ndarray
    fixed: tuple[tuple[Acting, np.ndarray], ...] = ()

    @classmethod
    def of(
        cls,
        model: Model,
        effects: Sequence[Effect],
        values: Sequence[np.ndarray],
        widths: Sequence[np.ndarray],
        fixed: Sequence[tuple[Acting, np.ndarray]] = (),
        discrepancy: float = DISCREPANCY,
    ) -> Coordinates:
        """Return the coordinates of nuisance parameters and effects.

        Args:
            model: The baseline model.
            effects: The effects that are fitted.
            values: SI parameters of each effect about which logarithms are centred, each of shape (parameters,).
            widths: Prior standard deviations of these [SI], each of shape (parameters,); those of logarithms are not used.
            fixed: Other effects that act, each with its SI parameters, shape (parameters,), which stay.
            discrepancy: Scale of the model discrepancy [-].
        """
        logarithmic = np.concatenate(
            [np.array(effect.logarithmic()) for effect in effects] or [np.zeros(0, bool)]
        )
        start = np.concatenate([np.asarray(v, float) for v in values] or [np.zeros(0)])
        width = np.concatenate([np.asarray(w, float) for w in widths] or [np.zeros(0)])
        wide = np.where(logarithmic, LOG_WIDTH, width)
        spread = np.array([one.spread for effect in effects for one in effect.quantities])
        wide = np.where(spread > 0.0, spread, wide)
        return cls(model.spread(discrepancy), tuple(effects), start, wide, logarithmic, tuple(fixed))

    def theta(self, nuisance: np.ndarray) -> np.ndarray:
        """Return theta at nuisance parameters in their own units, shape (nuisance,), and the effects' start."""
        return np.concatenate(
            [nuisance / self.scale, np.where(self.logarithmic, 0.0, self.start / self.width)]
        )

    def nuisance(self, theta: np.ndarray) -> np.ndarray:
        """Return the nuisance parameters at theta in their own units, shape (nuisance,)."""
        return np.asarray(theta[: len(self.scale)] * self.scale)

    def values(self, theta: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the SI parameters of each effect at theta, shape (nuisance + effects' parameters,)."""
        own = theta[len(self.scale) :]
        grown = np.exp(np.where(self.logarithmic, own * self.width, 0.0))
        moved = np.where(self.logarithmic, self.start * grown, own * self.width)
        return self.split(moved)

    def split(self, flat: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return what belongs to each effect, (parameters,), of all effects' parameters in turn, shape (all parameters,)."""
        ends = np.cumsum([len(effect.quantities) for effect in self.effects])
        return tuple(np.split(flat, ends[:-1])) if self.effects else ()

    def acting(self, theta: np.ndarray) -> tuple[tuple[Acting, np.ndarray], ...]:
        """Return all effects that act, with their SI parameters at theta, shape (nuisance + effects' parameters,)."""
        return (*self.fixed, *zip(self.effects, self.values(theta), strict=True))

    def slopes(self, theta: np.ndarray) -> np.ndarray:
        """Return the derivative of each of the effects' SI parameters by its coordinate at theta, shape (parameters,)."""
        flat = np.concatenate(self.values(theta)) if self.effects else np.zeros(0)
        return np.where(self.logarithmic, flat * self.width, self.width)

    def nudge(self, theta: np.ndarray, number: int) -> float:
        """Return the change of an effect's coordinate by which slopes are taken, small enough to go beyond an end.

        Args:
            theta: Nuisance parameters and effects in units of their priors, shape (nuisance + effects' parameters,).
            number: Number of the coordinate among those of the effects.
        """
        size = abs(float(theta[len(self.scale) + number]))
        return 1e-3 if self.logarithmic[number] else 1e-3 * max(1.0, size)

    def posterior(self, terms: Sequence[Likelihood]) -> Posterior:
        """Return the posterior of terms: nuisance parameters stay in their `box`, effects between their ends.

        Effects move by `REACH` at most in a step.

        Args:
            terms: The terms.
        """
        own = len(self.start)
        least, most = self._ends()
        box = np.full(len(self.scale), box_of(len(self.scale)))
        return Posterior(
            tuple(terms),
            np.concatenate([-box, least]),
            np.concatenate([box, most]),
            np.concatenate([np.full(len(box), np.inf), np.full(own, REACH)]),
        )

    def _ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the least and the largest coordinate of each of the effects' parameters, shape (parameters,)."""
        ends = np.array([one.ends for effect in self.effects for one in effect.quantities]).reshape(-1, 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            logarithms = np.log(np.maximum(ends, 0.0)) - np.log(np.abs(self.start))[:, None]
        logarithms = np.clip(logarithms, -LARGEST_LOGARITHM, LARGEST_LOGARITHM)
        found = np.where(self.logarithmic[:, None], logarithms, ends) / self.width[:, None]
        return found[:, 0], found[:, 1]


@dataclass(frozen=True)
class Amplitudes(Coordinates):
    """Coordinates of effects of one size each, `width` being the sizes' prior standard deviations in SI."""

    @classmethod
    def of_sizes(cls, model: Model, effects: Sequence[Effect]) -> Amplitudes:
        """Return the coordinates of nuisance parameters and sizes of effects, which need no motion to have one."""
        sizes = np.array([one.size(model, None, ()) for one in effects])  # type: ignore[arg-type]
        return cls(model.std, tuple(effects), np.zeros(len(sizes)), sizes, np.zeros(len(sizes), bool))

    def values(self, theta: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the SI parameters of each effect at theta, shape (nuisance + effects,)."""
        amplitudes = theta[len(self.scale) :] * self.width
        return tuple(one.values(float(a), ()) for one, a in zip(self.effects, amplitudes, strict=True))

    def slopes(self, theta: np.ndarray) -> np.ndarray:
        """Return the derivative of each effect's first SI parameter by its coordinate at theta, shape (effects,)."""
        moved = theta + NUDGE * (np.arange(len(theta)) >= len(self.scale))
        both = zip(self.values(moved), self.values(theta), strict=True)
        return np.array([float(there[0] - here[0]) / NUDGE for there, here in both])

    def posterior(self, terms: Sequence[Likelihood]) -> Posterior:
        """Return the posterior of terms; a size whose sign is known has a prior cut in half."""
        signs = np.array([one.sign for one in self.effects], int)
        free = np.full(len(self.scale), np.inf)
        return Posterior(
            tuple(terms),
            np.concatenate([-free, np.where(signs > 0, 0.0, -WIDEST)]),
            np.concatenate([free, np.where(signs < 0, 0.0, WIDEST)]),
            np.concatenate([free, np.ones(len(signs))]),
            truncated=tuple(len(free) + int(j) for j in np.flatnonzero(signs)),
        )
