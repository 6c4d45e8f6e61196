"""Forces that oppose the drift of a storey: each a formula of drift, its rate, and of one state where it remembers."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Law:
    """A force between the two floors of a storey; this one is none.

    Attributes:
        remembers: Whether it has a state, which begins at zero.
    """

    remembers = False

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the force [N] at a drift [m] and its rate [m/s]."""
        return 0.0

    def flow(self, rate: float, state: float) -> float:
        """Return the rate of the state [its unit/s]."""
        return 0.0


@dataclass(frozen=True)
class Elastoplastic(Law):
    """A spring [N/m] in series with a slider that slips at a force [N]; its state is its force."""

    limit: float
    stiffness: float
    remembers = True

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the spring's force [N]."""
        return state

    def flow(self, rate: float, state: float) -> float:
        """Return the rate of the spring's force [N/s]; none while it slips."""
        slips = abs(state) >= self.limit and state * rate > 0
        return 0.0 if slips else self.stiffness * rate


@dataclass(frozen=True)
class CreepingFriction(Law):
    """F tanh(v / v0), with F in N and v0 in m/s: friction that never sticks."""

    limit: float
    rate: float

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the friction force [N]."""
        return self.limit * math.tanh(rate / self.rate)


@dataclass(frozen=True)
class Damper(Law):
    """c |v|^power sgn v, with c in N (s/m)^power."""

    coefficient: float
    power: float = 1.0

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the damper's force [N]."""
        size = self.coefficient * float(abs(rate) ** self.power)
        return size if rate > 0 else -size


@dataclass(frozen=True)
class Cubic(Law):
    """k3 d^3, with k3 in N/m^3."""

    stiffness: float

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the spring's force [N]."""
        return self.stiffness * drift**3


@dataclass(frozen=True)
class ProgressiveStop(Law):
    """k1 x + k2 x^2 at a depth x beyond a gap [m] on the positive side, k1 in N/m and k2 in N/m^2."""

    gap: float
    first: float
    second: float

    def force(self, drift: float, rate: float, state: float) -> float:
        """Return the stop's force [N]."""
        depth = max(drift - self.gap, 0.0)
        return self.first * depth + self.second * depth**2
