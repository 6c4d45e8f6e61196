"""How large an effect is, and what of it is left when a linear frame is fitted: the yardsticks of the truth.

None of this decides anything: effects are tuned to a size by the first, and strange constructions by the last.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tests.planar_world.baseline import Baseline, Real, baseline_of
from tests.planar_world.frame import Frame
from tests.planar_world.integration import Shaken
from tests.planar_world.linear import TIMES, modal_readings
from tests.planar_world.measuring import Channel

FRAME, STOREY, MASS, DAMPING, GAIN = 0.08, 0.03, 0.01, 0.2, 0.02
"""Standard deviations of what is fitted to readings, as fractions: all storeys, each storey, each floor's mass, the
damping ratio of each mode, the gain of all channels."""
SCANNED = np.arange(-0.2, 0.13, 0.006)
"""Changes of all storeys' stiffness from which a fit may begin [-]."""
FIRST_STEPS = np.r_[np.arange(0.6, 1.25, 0.006)]
FACTORS_OF_DAMPING = (0.5, 0.7, 0.85, 1, 1.2, 1.5, 2.0)
LEAST_NOISE = 0.01


def sizes(one: Real, other: Real) -> Real:
    """Return the difference of two readings over the first, of each channel (channels,) [-].

    Args:
        one: (times of all runs, channels).
        other: The same shape.
    """
    found: Real = np.sqrt(((one - other) ** 2).mean(0) / (one**2).mean(0))
    return found


def over_channels(shares: Real) -> float:
    """Return the root mean square of shares of channels (channels,) [-]."""
    return float(np.sqrt((shares**2).mean()))


@dataclass(frozen=True)
class Scene:
    """In what a frame is fitted: the table's accelerations in the runs, and the channels.

    Attributes:
        name: The frame's in the project.
        tables: At the times of `linear.TIMES` (times,) [m/s^2].
        channels: All but the table's.
    """

    name: str
    tables: tuple[Real, ...]
    channels: tuple[Channel, ...]

    @classmethod
    def of(cls, name: str, shaken: Sequence[Shaken], channels: tuple[Channel, ...]) -> Scene:
        """Return the scene of a frame under motions of the table."""
        return cls(name, tuple(one(TIMES) for one in shaken), channels)


@dataclass(frozen=True)
class OwnFit:
    """What is left of readings with the frame's own matrices [-], and the factors that were fitted [-]."""

    left: float
    stiffness: float
    damping: float


def fit_own(scene: Scene, frame: Frame, read: Real) -> OwnFit:
    """Fit one factor on the stiffness and one on the damping of the true frame without its effect.

    Args:
        scene: What is read, and under which motions.
        frame: The frame without an effect.
        read: Readings with one (times of all runs, channels).
    """
    mass, stiffness = frame.matrices()

    def fit(factor: float, damping: float) -> OwnFit:
        ratios = frame.ratios * damping
        found = modal_readings(mass, stiffness * factor, ratios, scene.tables, scene.channels)
        return OwnFit(over_channels(sizes(read, found)), factor, damping)

    best = min((fit(factor, 1.2) for factor in FIRST_STEPS), key=lambda one: one.left)
    for step in (0.003, 0.0015, 0.0007, 0.0003):
        for more in FACTORS_OF_DAMPING:
            for by in (-step, 0, step):
                if not 0.2 < best.damping * more < 12:
                    continue
                best = min(best, fit(best.stiffness + by, best.damping * more), key=lambda one: one.left)
    return best


@dataclass(frozen=True)
class Left:
    """What a fit leaves of the readings, over the channels: root mean square and median [-]."""

    rms: float
    median: float


@dataclass
class Calibration:
    """The baseline frame with its uncertain parameters, fitted to readings with their priors (Gauss and Newton).

    Parameters are fractions: of all storeys' stiffness, each storey's, each floor's mass, logarithms of the damping
    ratios of the modes, and a gain of all channels.

    Attributes:
        scene: What is read, and under which motions.
        read: Readings (times of all runs, channels).
        noise: Of the readings, over each channel's rms [-].
        bound: Prior standard deviations beyond which no parameter goes, but the first; none where None.
    """

    scene: Scene
    read: Real
    noise: float
    bound: float | None = None
    baseline: Baseline = field(init=False)
    scale: Real = field(init=False)
    measured: Real = field(init=False)
    priors: Real = field(init=False)

    def __post_init__(self) -> None:
        self.baseline = baseline_of(self.scene.name)
        count = self.storeys
        each = (np.full(count, size) for size in (STOREY, MASS, DAMPING))
        self.priors = np.r_[FRAME, *each, GAIN]
        self.scale = np.sqrt((self.read * self.read).mean(0))
        self.measured = self.read / self.scale

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return len(self.baseline.mass)

    @property
    def limits(self) -> Real:
        """Largest sizes of the parameters (parameters,) [-]."""
        free = np.full(len(self.priors), 9.0)
        limits = free if self.bound is None else self.priors * self.bound
        limits[0] = 0.4
        return limits

    def predicted(self, parameters: Real) -> Real:
        """Return the model's readings (times of all runs, channels), over each channel's rms [-]."""
        count = self.storeys
        springs, floors = parameters[1 : count + 1], parameters[count + 1 : 2 * count + 1]
        stiffness = self.baseline.stiffness * (1 + parameters[0])
        stiffness = stiffness + np.tensordot(springs, self.baseline.patterns, 1)
        heavier = np.sqrt(1 + floors)
        mass = self.baseline.mass * np.outer(heavier, heavier)
        ratios = self.baseline.ratios * np.exp(parameters[2 * count + 1 : 3 * count + 1])
        found = modal_readings(mass, stiffness, ratios, self.scene.tables, self.scene.channels)
        predicted: Real = (1 + parameters[-1]) * found / self.scale
        return predicted

    def cost(self, parameters: Real, residual: Real) -> float:
        """Return twice the negative logarithm of the posterior, but for a constant."""
        weight = max(self.noise, LEAST_NOISE)
        return float((residual**2).sum() / weight**2 + ((parameters / self.priors) ** 2).sum())

    def fit(self, most: int) -> Left:
        """Fit in at most so many steps and return what is left."""
        at, residual, cost = self._begun()
        stiffening = 1e-3
        for _ in range(most):
            gradient, curvature = self._derivatives(at, residual)
            for _ in range(5):
                tried = self._step(at, gradient, curvature, stiffening)
                found = self.measured - self.predicted(tried)
                becomes = self.cost(tried, found)
                if becomes < cost:
                    break
                stiffening *= 10
            else:
                break
            done = cost - becomes < 1e-4 * cost
            at, residual, cost = tried, found, becomes
            stiffening = max(stiffening / 10, 1e-6)
            if done:
                break
        shares = np.sqrt((residual**2).mean(0))
        return Left(over_channels(shares), float(np.median(shares)))

    def _begun(self) -> tuple[Real, Real, float]:
        """Return parameters, residual and cost from which the fit begins."""
        found = []
        for change in SCANNED:
            at = np.zeros(len(self.priors))
            at[0] = change
            residual = self.measured - self.predicted(at)
            found.append((at, residual, self.cost(at, residual)))
        return min(found, key=lambda one: one[2])

    def _derivatives(self, at: Real, residual: Real) -> tuple[Real, Real]:
        """Return gradient (parameters,) and curvature (parameters, parameters) of half the cost, priors left out of it."""
        jacobian, here = np.empty((residual.size, len(at))), self.measured - residual
        for number in range(len(at)):
            by = 1e-4 if number <= 2 * self.storeys else 1e-2
            moved = at.copy()
            moved[number] += by
            jacobian[:, number] = ((self.predicted(moved) - here) / by).ravel()
        weight = max(self.noise, LEAST_NOISE) ** 2
        gradient = jacobian.T @ residual.ravel() / weight - at / self.priors**2
        return gradient, jacobian.T @ jacobian / weight

    def _step(self, at: Real, gradient: Real, curvature: Real, stiffening: float) -> Real:
        """Return the parameters after a step (Levenberg and Marquardt); those at a limit that press on it stay."""
        limits = self.limits
        free = ~(((at <= -limits * 0.9999) & (gradient < 0)) | ((at >= limits * 0.9999) & (gradient > 0)))
        whole = curvature + np.diag(1 / self.priors**2) + stiffening * np.diag(np.diag(curvature))
        step = np.zeros(len(at))
        step[free] = np.linalg.solve(whole[np.ix_(free, free)], gradient[free])
        tried = np.clip(at + step, -limits, limits)
        matrices = 2 * self.storeys + 1
        tried[:matrices] = np.clip(tried[:matrices], -0.4, 0.4)
        tried[matrices:] = np.clip(tried[matrices:], -2.5, 2.5)
        return tried
