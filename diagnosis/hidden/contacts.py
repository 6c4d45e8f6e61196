"""Impact laws of the hidden pairs, written anew: what touches, how stiffly, and what it loses.

Sources: Kelvin-Voigt and its damping (Anagnostopoulos 1988, Earthq. Eng. Struct. Dyn. 16), Hertz, nonlinear
viscoelastic (Jankowski 2005, 34(6), with the restitution formula of his 2006 paper, 35(4)), Hertz-damp
(Muthukumar and DesRoches 2006, 35(7), with the factor of Ye, Li and Zhu 2009, 38(9)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pounding.diagnosis.hidden.stepping import Law


@dataclass(frozen=True)
class Touch:
    """A contact between the edges of two floors at one height; parameters as in the case format, in SI."""

    left: str
    right: str
    floor: int
    gap_m: float
    law: str
    stiffness: float
    damping: float | None = None
    restitution: float | None = None


STIFFNESS = {
    "linear_spring": 20.66e6,
    "linear_viscoelastic": 20.66e6,
    "hertz": 9.772e8,
    "nonlinear_viscoelastic": 2.0e9,
    "hertz_damp": 9.772e8,
}
"""Usual stiffness of each law between steel frames of this size [N/m], [N/m^1.5]."""

DAMPED = ("linear_viscoelastic", "nonlinear_viscoelastic", "hertz_damp")


class Contact(Law):
    """The force between two floors of given reduced mass; positive is compression."""

    def __init__(self, touch: Touch, reduced_mass: float) -> None:
        self.touch, self.reduced_mass = touch, reduced_mass
        self.closes_at = touch.gap_m
        self.approach = 0.0
        self.ratio = damping_ratio(touch)

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the force [N] where the left floor has come nearer by `deformation` [m]."""
        depth, touch = deformation - self.touch.gap_m, self.touch
        if depth <= 0.0:
            return 0.0
        if touch.law in ("linear_spring", "linear_viscoelastic"):
            damper = touch.damping
            if damper is None:
                damper = 2 * self.ratio * math.sqrt(touch.stiffness * self.reduced_mass)
            return max(touch.stiffness * depth + damper * rate, 0.0)
        elastic: float = touch.stiffness * depth**1.5
        if touch.law == "hertz":
            return elastic
        if touch.law == "hertz_damp":
            first = self.approach if self.approach > 0 else max(rate, 1e-3)
            return max(elastic * (1 + self.ratio * rate / first), 0.0)
        if rate <= 0:
            return elastic
        damper = touch.damping
        if damper is None:
            damper = 2 * self.ratio * math.sqrt(touch.stiffness * math.sqrt(depth) * self.reduced_mass)
        return elastic + damper * rate

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Remember how fast the floors met."""
        if deformation <= self.touch.gap_m:
            self.approach = 0.0
        elif self.approach == 0.0:
            self.approach = max(rate, 1e-3)


def damping_ratio(touch: Touch) -> float:
    """Return the damping ratio of a law for its restitution; 0 where it has none."""
    e = touch.restitution
    if e is None:
        return 0.0
    if touch.law == "linear_viscoelastic":
        return -math.log(e) / math.hypot(math.pi, math.log(e))
    if touch.law == "nonlinear_viscoelastic":
        return 4.5 * math.sqrt(5) * (1 - e**2) / (e * (e * (9 * math.pi - 16) + 16))
    return 8 * (1 - e) / (5 * e)
