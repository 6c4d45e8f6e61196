"""How much of a hidden effect the channels could show at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.scenario import Scenario

REACH = 2.5
"""How far a nuisance parameter may go to imitate an effect or a model error, in prior standard deviations."""

Clean = Callable[[Scenario, bool], np.ndarray]

LEAST = 1e-6
"""Visibility of what changes no channel at all."""

NUDGE = 0.05
"""By how much a nuisance parameter is moved to find slopes, in prior standard deviations."""
NEARBY = 0.02
"""How far from where slopes were made they serve, in prior standard deviations."""

FACTORS = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0, 10.0, 20.0)
"""Multiples of what was refitted last from which a refit may start."""

REFITS = 40
"""Most steps in which nuisance parameters are refitted."""

ENOUGH = 0.01
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
        # What imitated the effect that was looked at last, and the slopes with where they were made.
        self.last = np.zeros(ordinary_parameters(without))
        self.made = (self.last, self._made(self.last))

    def _imitated(self, at: np.ndarray) -> np.ndarray:
        return np.asarray(self.clean(nudged(self.without, at), True) / self.noise + self.coarse)

    def _slopes(self, at: np.ndarray) -> np.ndarray:
        """Return how all samples and the priors change with the nuisance parameters, made there or nearby."""
        if np.abs(at - self.made[0]).max() > NEARBY:
            self.made = (at, self._made(at))
        return self.made[1]

    def _made(self, at: np.ndarray) -> np.ndarray:
        """Return the same, made there, shape (rows, parameters)."""
        here = self._imitated(at)
        moved = [self._imitated(at + NUDGE * unit) for unit in np.eye(len(at))]
        return np.vstack([np.array([(there - here).ravel() / NUDGE for there in moved]).T, np.eye(len(at))])

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
        target = channels / self.noise
        wide = np.full(ordinary_parameters(self.without), REACH + 1e-9)

        def rows(at: np.ndarray) -> np.ndarray:
            return np.concatenate([(self._imitated(at) - target).ravel(), at])

        # A frame of another frequency is soon out of step, and no descent leads back: what imitated the same effect when
        # it was weaker leads on.
        starts = [np.clip(factor * self.last, -REACH, REACH) for factor in FACTORS]
        start = min(starts, key=lambda at: float(np.sum(rows(at) ** 2)))
        fit = least_squares(rows, start, self._slopes, (-wide, wide), ftol=ENOUGH, xtol=1e-4, max_nfev=REFITS)
        if fit.x.any():
            self.last = fit.x
        return np.asarray(target - self._imitated(fit.x))


def _largest(change: np.ndarray) -> float:
    return max(float(np.sqrt(np.mean(change**2, axis=0)).max()), LEAST)


def ordinary_parameters(scenario: Scenario) -> int:
    """Return how many nuisance parameters a scenario has."""
    return 2 + sum(3 + _damped(beams) + 2 * beams.storeys for beams in scenario.frames.values())


def _damped(beams: Beams) -> int:
    return min(len(beams.ratios), beams.storeys)


def nudged(scenario: Scenario, at: np.ndarray) -> Scenario:
    """Return a scenario with its nuisance parameters moved by so many prior standard deviations.

    Args:
        scenario: The scenario.
        at: Shape (ordinary_parameters,): table gain and delay, then for each frame its stiffness as a whole, that of its
            first storey and of its joints, its damping ratios, its storeys' stiffnesses and its floors' masses.
    """
    prior = Prior()
    frames, taken = {}, 2
    for name, beams in scenario.frames.items():
        count = 3 + _damped(beams) + 2 * beams.storeys
        (whole, base, joints), ratios, bending, mass = np.split(
            at[taken : taken + count], [3, 3 + _damped(beams), count - beams.storeys]
        )
        taken += count
        stiffer = np.exp(prior.frame_stiffness * whole)
        columns = prior.storey_stiffness * bending
        columns[0] += prior.base_stiffness * base
        damped = beams.ratios.copy()
        damped[: len(ratios)] *= np.exp(prior.damping_ratio * ratios)
        frames[name] = replace(
            beams,
            # A storey of flexible joints follows its columns about half.
            bending=beams.bending * stiffer * np.exp(2 * columns),
            joint=beams.joint * stiffer * np.exp(prior.joint_stiffness * joints),
            ratios=damped,
            floor_mass=beams.floor_mass * np.exp(prior.floor_mass * mass),
        )
    return replace(
        scenario,
        frames=frames,
        table_gain=scenario.table_gain + prior.table_gain * at[0],
        table_delay_s=scenario.table_delay_s + 1e-3 * prior.table_delay_ms * at[1],
    )
