"""What a linear frame leaves of a motion when it is calibrated to it: the yardstick of a model error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import least_squares
from scipy.signal import lfilter

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.hidden.visibility import REACH

FREE_MODES = 5
"""Lowest modes whose damping ratios are calibrated one by one; those above have theirs changed as the last of them."""

STEPS = 20
SHIFTS = np.array([0.0, 0.5, -0.25, -0.5, -1.0, -1.5, -2.0, -3.0])
"""Where the calibration may start: the whole frame's stiffness shifted, in standard deviations of its prior."""

TRIED = 3
"""From how many of them, those that fit best, it descends."""

ENOUGH_HZ = 400.0
"""Rate at which a motion is compared [Hz]: a table moves up to 60 Hz."""

SEEN = 0.01
"""Over the motion: what of a sample counts as one standard deviation beside the priors."""

NUDGE = 1e-5
"""Change of a mode's frequency and damping ratio by which its slopes are found (relative)."""


@dataclass(frozen=True)
class Seen:
    """A run as its sensors on one frame see it, without noise.

    Attributes:
        step_s: Time between samples [s].
        table: Acceleration of the table [m/s^2], shape (samples,).
        channels: What the sensors read, in SI, shape (samples, channels).
        fixed: What they would read if the frame were rigid, shape (samples, channels).
        floors: Floor of each sensor, from 0, shape (channels,).
        derivatives: What each sees of the floor's motion relative to the table: 0 for displacement, 1 for velocity, 2 for
            acceleration, shape (channels,).
    """

    step_s: float
    table: np.ndarray
    channels: np.ndarray
    fixed: np.ndarray
    floors: np.ndarray
    derivatives: np.ndarray


@dataclass(frozen=True)
class Believed:
    """A linear frame as it is before its calibration.

    Attributes:
        mass: Of each floor [kg], shape (storeys,).
        stiffness: Of the floors along x [N/m], shape (storeys, storeys).
        storeys: The part of it that each storey's columns give [N/m], shape (storeys, storeys, storeys).
        ratios: Damping ratio of each mode, shape (storeys,).
    """

    mass: np.ndarray
    stiffness: np.ndarray
    storeys: np.ndarray
    ratios: np.ndarray


def beyond_calibration(runs: Sequence[Seen], believed: Believed, prior: Prior) -> np.ndarray:
    """Return the misfit over the motion that the calibrated frame leaves, root mean square, shape (2, channels).

    The first is that of the runs to which it is calibrated, the second that of the last run, which is held out.

    Free are each storey's stiffness and that of the whole frame, each floor's mass, the damping of the lowest modes and the
    table's gain, the same in all runs.

    Args:
        runs: The runs, two or more, each of which counts alike.
        believed: The frame.
        prior: How well its parameters are known.
    """
    calibration, held_out = (Calibration(some, believed, prior) for some in (runs[:-1], runs[-1:]))
    # With light damping a frequency that is off by more than that is out of step, and no descent leads back.
    starts = np.zeros((len(SHIFTS), len(calibration.sizes)))
    starts[:, len(believed.mass)] = SHIFTS
    likeliest = sorted(starts, key=lambda start: float(np.sum(calibration.rows(start) ** 2)))
    fits = [
        least_squares(calibration.rows, start, calibration.slopes, method="lm", max_nfev=STEPS)
        for start in likeliest[:TRIED]
    ]
    best = min(fits, key=lambda fit: float(fit.cost))
    return np.array([np.sqrt(np.mean(some.left(best.x) ** 2, axis=0)) for some in (calibration, held_out)])


class Calibration:
    """What a calibration leaves, and how that changes with its parameters.

    These are logarithms of factors over their priors: of the storeys, the frame, the masses, the damping and the gain. They
    go no further than `REACH`, which they near as a hyperbolic tangent does: beyond it is another frame.

    Args:
        runs: The runs.
        believed: The frame.
        prior: How well its parameters are known.

    Attributes:
        sizes: Standard deviations of the priors (logarithms), shape (parameters,).
    """

    def __init__(self, runs: Sequence[Seen], believed: Believed, prior: Prior) -> None:
        self.runs, self.believed = runs, believed
        count = len(believed.mass)
        free = min(FREE_MODES, count)
        self.sizes = np.concatenate(
            [
                np.full(count, prior.storey_stiffness),
                [prior.frame_stiffness],
                np.full(count, prior.floor_mass),
                np.full(free, prior.damping_ratio),
                [prior.table_gain],
            ]
        )
        self.thin = max(int(1 / (runs[0].step_s * ENOUGH_HZ)), 1)
        self.loud = [float(np.sqrt(np.mean(run.table**2))) for run in runs]
        moving = self._joined([run.channels - run.fixed for run in runs])
        self.motion = np.sqrt(
            np.mean(self._centred(self._joined([run.channels for run in runs])) ** 2, axis=0)
        )
        self.wanted = self._centred(moving) / self.motion

    def _joined(self, each: Sequence[np.ndarray]) -> np.ndarray:
        return np.vstack([one[:: self.thin] / size for one, size in zip(each, self.loud, strict=True)])

    @staticmethod
    def _centred(values: np.ndarray) -> np.ndarray:
        return np.asarray(values - values.mean(axis=0))

    def _frame(self, steps: np.ndarray) -> _Frame:
        return _Frame(self.believed, np.exp(REACH * np.tanh(steps / REACH) * self.sizes))

    def left(self, steps: np.ndarray) -> np.ndarray:
        """Return what is left over the motion, shape (samples, channels), of parameters (parameters,)."""
        frame = self._frame(steps)
        seen = [frame.seen(run, frame.modes(run)) for run in self.runs]
        return np.asarray(self.wanted - self._centred(self._joined(seen)) / self.motion)

    def rows(self, steps: np.ndarray) -> np.ndarray:
        """Return what is squared and summed, shape (rows,), of parameters (parameters,)."""
        return np.concatenate([self.left(steps).ravel() / SEEN, steps])

    def slopes(self, steps: np.ndarray) -> np.ndarray:
        """Return the rows' derivatives, shape (rows, parameters), by parameters (parameters,)."""
        frame, nearing = self._frame(steps), 1.0 - np.tanh(steps / REACH) ** 2
        each = [frame.slopes(run) for run in self.runs]
        columns = [
            self._centred(self._joined(seen)) / self.motion * -size / SEEN
            for size, *seen in zip(self.sizes * nearing, *each, strict=True)
        ]
        return np.vstack([np.array([one.ravel() for one in columns]).T, np.eye(len(steps))])


class _Frame:
    """A frame with its parameters changed by factors, in its modes."""

    def __init__(self, believed: Believed, factors: np.ndarray) -> None:
        count = len(believed.mass)
        storeys, self.masses = factors[:count], believed.mass * factors[count + 1 : 2 * count + 1]
        self.storeys = factors[count] * storeys[:, None, None] * believed.storeys
        rest = believed.stiffness - believed.storeys.sum(axis=0)
        self.stiffness = factors[count] * rest + self.storeys.sum(axis=0)
        self.squared, self.shapes = eigh(self.stiffness, np.diag(self.masses))
        self.omega = np.sqrt(np.maximum(self.squared, np.finfo(float).eps * self.squared[-1]))
        self.free = len(factors) - 2 * count - 2
        self.owner = np.minimum(np.arange(count), self.free - 1)
        self.ratios = believed.ratios * factors[2 * count + 1 : -1][self.owner]
        self.gamma = self.shapes.T @ self.masses
        self.gain = float(factors[-1])

    def modes(self, run: Seen, circular: float = 1.0, damping: float = 1.0) -> np.ndarray:
        """Return how each mode answers to the table, its frequency and damping changed by factors, (modes, 3, samples)."""
        return np.array(
            [
                _mode(run.step_s, self.gain * run.table, circular * omega, damping * ratio)
                for omega, ratio in zip(self.omega, self.ratios, strict=True)
            ]
        )

    def seen(self, run: Seen, modes: np.ndarray, shares: np.ndarray | None = None) -> np.ndarray:
        """Return what sensors see of modes with such shares in the floors (storeys, modes), shape (samples, channels)."""
        shares = self.shapes * self.gamma if shares is None else shares
        return np.column_stack(
            [
                shares[floor] @ modes[:, derivative]
                for floor, derivative in zip(run.floors, run.derivatives, strict=True)
            ]
        )

    def slopes(self, run: Seen) -> list[np.ndarray]:
        """Return how what is seen changes with the logarithm of each factor, each of shape (samples, channels)."""
        here = self.modes(run)
        faster = (self.modes(run, circular=1 + NUDGE) - here) / NUDGE
        damped = (self.modes(run, damping=1 + NUDGE) - here) / NUDGE
        shares = self.shapes * self.gamma
        still = np.zeros_like(self.stiffness)
        changes = [(one, still) for one in (*self.storeys, self.stiffness)]
        changes += [(still, np.diag(self.masses * one)) for one in np.eye(len(self.masses))]
        found = []
        for stiffness, mass in changes:
            omega, shapes = self._perturbed(stiffness, mass)
            gamma = shapes.T @ self.masses + self.shapes.T @ mass.diagonal()
            moved = shapes * self.gamma + self.shapes * gamma
            found.append(self.seen(run, here, moved) + self.seen(run, faster, shares * omega))
        found += [self.seen(run, damped, shares * (self.owner == mode)) for mode in range(self.free)]
        return [*found, self.seen(run, here)]

    def _perturbed(self, stiffness: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return changes of the frequencies (relative, (modes,)) and of the shapes with stiffness and mass."""
        coupled = self.shapes.T @ stiffness @ self.shapes
        carried = self.shapes.T @ mass @ self.shapes
        pulled = coupled - carried * self.squared
        apart = self.squared - self.squared[:, None]
        np.fill_diagonal(apart, np.inf)
        mixed = pulled / apart
        np.fill_diagonal(mixed, -0.5 * carried.diagonal())
        return pulled.diagonal() / (2 * self.omega**2), self.shapes @ mixed


def _mode(step_s: float, drive: np.ndarray, circular: float, ratio: float) -> np.ndarray:
    """Return how a mode moves: coordinate, its rate and its acceleration, shape (3, samples)."""
    # Newmark's average acceleration is the bilinear transform s = (z - 1) / (z + 1) * 2 / step.
    per_s = 2 / step_s
    plus, across, minus = np.array([1.0, 2.0, 1.0]), np.array([1.0, 0.0, -1.0]), np.array([1.0, -2.0, 1.0])
    below = per_s**2 * minus + 2 * ratio * circular * per_s * across + circular**2 * plus
    moved, rate = (lfilter(-above, below, drive) for above in (plus, per_s * across))
    return np.array([moved, rate, -drive - 2 * ratio * circular * rate - circular**2 * moved])
