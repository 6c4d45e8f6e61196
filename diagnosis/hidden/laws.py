"""Force laws of the hidden effects: smooth, regularised or with internal states, unlike idealised ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pounding.diagnosis.hidden.stepping import Law


class Memoryless(Law):
    """A force of time, deformation and rate alone."""

    def __init__(self, function: Callable[[float, float, float], float]) -> None:
        self.function = function

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the force [N]."""
        return self.function(time, deformation, rate)

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Nothing is remembered."""


@dataclass
class LuGre(Law):
    """Friction of elastic bristles (Canudas de Wit et al. 1995, IEEE Trans. Autom. Control 40(3)).

    Attributes:
        level: Force at steady sliding [N].
        bristles: Stiffness of the bristles before they slide [N/m].
        breakaway: Static over sliding force.
        stribeck: Rate at which the static force has faded [m/s].
    """

    level: float
    bristles: float
    breakaway: float = 1.0
    stribeck: float = 0.005
    stretch: float = 0.0

    def _stretched(self, rate: float, step: float) -> float:
        limit = (
            self.level * (1 + (self.breakaway - 1) * math.exp(-((rate / self.stribeck) ** 2))) / self.bristles
        )
        if abs(rate) < 1e-12:
            return self.stretch
        # Exact over the step at constant rate: the stretch runs into +-limit.
        end = math.copysign(limit, rate)
        return end + (self.stretch - end) * math.exp(-abs(rate) * step / limit)

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the friction force [N]."""
        return self.bristles * self._stretched(rate, step)

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Keep the bristles' stretch."""
        self.stretch = self._stretched(rate, step)


@dataclass
class BoucWen(Law):
    """The departure of a yielding spring from an elastic one (Wen 1976, J. Eng. Mech. Div. 102(2)).

    Attributes:
        yield_force: Force at which it flows [N].
        stiffness: Its stiffness at small amplitude [N/m].
        sharpness: Exponent of the transition; large is nearly bilinear.
    """

    yield_force: float
    stiffness: float
    sharpness: float = 4.0
    pull: float = 0.0
    reached: float = 0.0

    def _pulled(self, deformation: float) -> float:
        # In pull over yield force z: dz = k/F (1 - |z|^n (1 + sgn(v z)) / 2) dx; midpoint rule in x.
        travel = (deformation - self.reached) * self.stiffness / self.yield_force
        z = self.pull / self.yield_force
        half = z + 0.5 * travel * self._slope(z, travel)
        z += travel * self._slope(half, travel)
        return self.yield_force * max(-1.0, min(1.0, z))

    def _slope(self, z: float, travel: float) -> float:
        return 1.0 - abs(z) ** self.sharpness if z * travel > 0 else 1.0

    def force(self, time: float, deformation: float, rate: float, step: float) -> float:
        """Return the force [N] beyond the elastic one, which the storey itself keeps."""
        return self._pulled(deformation) - self.stiffness * deformation

    def accept(self, time: float, deformation: float, rate: float, step: float) -> None:
        """Keep the pull."""
        self.pull, self.reached = self._pulled(deformation), deformation


def cubic(coefficient: float) -> Memoryless:
    """Return a hardening or softening spring k3 d^3 [N/m^3]."""
    return Memoryless(lambda time, d, v: coefficient * d * d * d)


def drag(coefficient: float, creep: float = 1e-3) -> Memoryless:
    """Return quadratic drag c v abs(v) [N s^2/m^2] that is linear below `creep` [m/s]."""
    return Memoryless(lambda time, d, v: coefficient * v * math.sqrt(v * v + creep * creep))


def stop(gap: float, stiffness: float, softness: float, loss_s: float) -> Memoryless:
    """Return a bumper with a rounded onset.

    Args:
        gap: Free travel [m]; negative for a bumper on the other side.
        stiffness: [N/m] once closed.
        softness: Width of the onset [m].
        loss_s: Time that makes the stiffness a damper while closed [s].
    """
    side = math.copysign(1.0, gap)

    def push(time: float, d: float, v: float) -> float:
        past = side * d - abs(gap)
        if past < -8 * softness:
            return 0.0
        if past > 8 * softness:
            pressed, closed = past, 1.0
        else:
            closed = 1 / (1 + math.exp(-past / softness))
            pressed = softness * math.log1p(math.exp(past / softness))
        return side * max(stiffness * (pressed + closed * loss_s * side * v), 0.0)

    return Memoryless(push)


def fading(stiffness: float, change: float, duration_s: float) -> Memoryless:
    """Return a spring that is not there at first and is `change` times `stiffness` [N/m] at the end.

    Args:
        stiffness: Stiffness of the storey [N/m].
        change: Spring at the end over that stiffness [-].
        duration_s: Time in which the spring grows [s].
    """
    return Memoryless(lambda time, d, v: change * stiffness * min(time / duration_s, 1.0) * d)


def breathing(stiffness: float, depth: float, frequency_hz: float, phase: float) -> Memoryless:
    """Return a spring of `depth` times `stiffness` [N/m] that comes and goes with time.

    Args:
        stiffness: Stiffness of the storey [N/m].
        depth: Amplitude of the spring over that stiffness [-].
        frequency_hz: How often it comes and goes [Hz].
        phase: Phase at time zero [rad].
    """
    circular = 2 * math.pi * frequency_hz
    return Memoryless(lambda time, d, v: depth * stiffness * math.sin(circular * time + phase) * d)


def snapping(stiffness: float, reach: float) -> Memoryless:
    """Return a negative spring [N/m] that lets go beyond `reach` [m], as between two magnets."""
    return Memoryless(lambda time, d, v: -stiffness * d / (1 + (d / reach) ** 2) ** 2)


def weakening(level: float, rate: float) -> Memoryless:
    """Return dry friction [N] that fades as sliding grows beyond `rate` [m/s]."""
    return Memoryless(lambda time, d, v: level * math.tanh(20 * v / rate) / (1 + (v / rate) ** 2))
