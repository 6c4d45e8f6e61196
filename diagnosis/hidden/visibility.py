"""How much of a hidden effect the channels could show at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.scenario import Scenario

REACH = 2.5
"""How far a nuisance parameter may go to imitate an effect or a model error, in prior standard deviations."""

Clean = Callable[[Scenario, bool], np.ndarray]

LEAST = 1e-6
"""Visibility of what changes no channel at all."""

NUDGE = 0.05
REFITS = 10
"""Most steps in which nuisance parameters are refitted."""

ENOUGH = 0.1
"""Share of the misfit that a step has to take away to be followed by another."""


class Eye:
    """What can be told from noise and from nuisance parameters in the channels of one run.

    Two figures say how far an effect stands above the noise, both for the channel that shows most: the root
    mean square change over the noise, and the same after the nuisance parameters have been refitted within
    `REACH` of their priors to imitate it. The second is the visibility of a hidden effect.
    """

    def __init__(self, clean: Clean, without: Scenario, noise: np.ndarray) -> None:
        """Look at a scenario.

        Args:
            clean: Simulates the channels without noise, (samples, channels); coarsely, if told so, which is
                good for the difference between two scenarios.
            without: The scenario without the effect.
            noise: Standard deviation of each channel's noise, shape (channels,).
        """
        self.clean, self.without, self.noise = clean, without, noise
        self.bare = clean(without, False) / noise
        self.coarse = self.bare - clean(without, True) / noise
        self.start = self._sensitivity(np.zeros(ordinary_parameters(without)))

    def _imitated(self, at: np.ndarray) -> np.ndarray:
        return np.asarray(self.clean(nudged(self.without, at), True) / self.noise + self.coarse)

    def _sensitivity(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the channels' change per prior deviation of the nuisance parameters, and its factor."""
        here = self._imitated(at)
        moved = [self._imitated(at + NUDGE * unit) for unit in np.eye(len(at))]
        imitable = np.array([(there - here).ravel() / NUDGE for there in moved]).T
        # Prior-scaled columns make the priors a unit ridge.
        return imitable, np.linalg.cholesky(imitable.T @ imitable + np.eye(len(at))).T

    def sees(self, channels: np.ndarray) -> tuple[float, float]:
        """Return the raw and the calibrated visibility of what changed the channels (samples, channels)."""
        if not np.isfinite(channels / self.noise).all():
            return np.nan, np.nan
        return _largest(channels / self.noise - self.bare), _largest(self.unexplained(channels))

    def unexplained(self, channels: np.ndarray) -> np.ndarray:
        """Return what the refitted nuisance parameters leave of a change over the noise, (samples, channels).

        Args:
            channels: The changed channels without noise, in SI, shape (samples, channels); all finite.
        """
        target, fresh = channels / self.noise, True
        at = np.zeros(ordinary_parameters(self.without))
        left, (imitable, factor) = target - self.bare, self.start
        for _ in range(REFITS):
            wanted = np.linalg.solve(factor.T, imitable.T @ left.ravel() - at)
            step = lsq_linear(factor, wanted, (-REACH - at - 1e-9, REACH - at + 1e-9), tol=1e-6).x
            gained, at, left = self._descend(target, at, step, left)
            if gained < ENOUGH and fresh:
                break
            # The sensitivities serve until they do not help any more; then they are made where we are.
            fresh = gained < ENOUGH
            if fresh:
                imitable, factor = self._sensitivity(at)
        return np.asarray(left)

    def _descend(
        self, target: np.ndarray, at: np.ndarray, step: np.ndarray, left: np.ndarray
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Return by which share a shortened step lowers the misfit, where that is, and what is left."""
        cost = float((left**2).sum())
        for share in (1.0, 0.4, 0.15):
            there = target - self._imitated(at + share * step)
            lower = float((there**2).sum())
            if lower < cost:
                return 1 - lower / cost, at + share * step, there
        return 0.0, at, left


def _largest(change: np.ndarray) -> float:
    return max(float(np.sqrt(np.mean(change**2, axis=0)).max()), LEAST)


def ordinary_parameters(scenario: Scenario) -> int:
    """Return how many nuisance parameters a scenario has."""
    return 2 + sum(1 + _damped(beams) + 2 * beams.storeys for beams in scenario.frames.values())


def _damped(beams: Beams) -> int:
    return min(len(beams.ratios), beams.storeys)


def nudged(scenario: Scenario, at: np.ndarray) -> Scenario:
    """Return a scenario with its nuisance parameters moved by so many prior standard deviations.

    Args:
        scenario: The scenario.
        at: Shape (ordinary_parameters,): table gain and delay, then for each frame its stiffness as a whole,
            its damping ratios, its storeys' stiffnesses and its floors' masses.
    """
    prior = Prior()
    frames, taken = {}, 2
    for name, beams in scenario.frames.items():
        count = 1 + _damped(beams) + 2 * beams.storeys
        whole, ratios, bending, mass = np.split(
            at[taken : taken + count], [1, 1 + _damped(beams), count - beams.storeys]
        )
        taken += count
        stiffer = np.exp(prior.frame_stiffness * whole[0])
        damped = beams.ratios.copy()
        damped[: len(ratios)] *= np.exp(prior.damping_ratio * ratios)
        frames[name] = replace(
            beams,
            # A storey of flexible joints follows its columns about half.
            bending=beams.bending * stiffer * np.exp(2 * prior.storey_stiffness * bending),
            joint=beams.joint * stiffer,
            ratios=damped,
            floor_mass=beams.floor_mass * np.exp(prior.floor_mass * mass),
        )
    return replace(
        scenario,
        frames=frames,
        table_gain=scenario.table_gain + prior.table_gain * at[0],
        table_delay_s=scenario.table_delay_s + 1e-3 * prior.table_delay_ms * at[1],
    )
