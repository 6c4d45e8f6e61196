"""Two free bodies that collide along a line: what a law does, with nothing else about."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.contact.damping import reduced_mass
from pounding.contact.errors import ContactError
from pounding.contact.laws import FloatOperations, Law

Real = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Collision:
    """One impact, from first touch to the moment at which the force has gone for good.

    Attributes:
        time_s, deformation_m, rate_m_s, force_n: Histories (m,).
        before_m_s, after_m_s: Velocities (left, right) [m/s].
        masses_kg: (left, right).
    """

    time_s: Real
    deformation_m: Real
    rate_m_s: Real
    force_n: Real
    before_m_s: tuple[float, float]
    after_m_s: tuple[float, float]
    masses_kg: tuple[float, float]

    def __repr__(self) -> str:
        return (
            f"Collision(restitution {self.restitution:.4g}, {1e3 * self.duration_s:.4g} ms in contact, "
            f"at most {self.force_n.max():.4g} N)"
        )

    @property
    def restitution(self) -> float:
        """Separation over approach velocity."""
        return (self.after_m_s[1] - self.after_m_s[0]) / (self.before_m_s[0] - self.before_m_s[1])

    @property
    def duration_s(self) -> float:
        """Time in contact [s]."""
        return float(self.time_s[-1])

    @property
    def momentum_error(self) -> float:
        """Change of momentum over the impulse that was exchanged."""
        left, right = (
            m * (after - before)
            for m, after, before in zip(self.masses_kg, self.after_m_s, self.before_m_s, strict=True)
        )
        return abs(left + right) / abs(left)

    @property
    def energy_ratio(self) -> float:
        """Kinetic energy of the relative motion after the impact over that before it."""
        return self.restitution**2


def collide(
    law: Law,
    mass_left_kg: float,
    mass_right_kg: float,
    velocity_left_m_s: float,
    velocity_right_m_s: float = 0.0,
    *,
    points: int = 400,
    tolerance: float = 1e-11,
) -> Collision:
    """Let two free bodies collide; the left one moves in +x towards the right one.

    Args:
        law: Law of the contact.
        mass_left_kg, mass_right_kg: Masses [kg].
        velocity_left_m_s, velocity_right_m_s: Velocities at first touch [m/s].
        points: Points in time of the histories.
        tolerance: Relative tolerance of the integration.

    Raises:
        ContactError: The bodies do not approach, or a mass is not positive.
    """
    velocities = velocity_left_m_s, velocity_right_m_s
    bodies = _bodies(law, (mass_left_kg, mass_right_kg), velocities)
    found = _until_they_part(bodies, velocities, tolerance)
    times = np.linspace(0.0, found.t[-1], points)
    left, right, v_left, v_right = found.sol(times)
    approach = bodies.approach_m_s
    deformation, rate = (left - right) * bodies.depth_m, (v_left - v_right) * approach
    return Collision(
        times * bodies.span_s,
        deformation,
        rate,
        np.asarray(law.force(deformation, rate, approach)),
        velocities,
        (float(found.y[2, -1]) * approach, float(found.y[3, -1]) * approach),
        bodies.masses_kg,
    )


@dataclass(frozen=True)
class _Bodies:
    """Two bodies that approach, and the scales by which their motion is solved: in these it is of the order of one.

    Attributes:
        law: Law of the contact.
        masses_kg: (left, right).
        reduced_kg: Reduced mass [kg].
        approach_m_s: Velocity at which they approach [m/s].
        span_s: Time in which the spring alone, loaded at that velocity, would stop them [s].
        depth_m: How far they move towards each other in that time at that velocity [m].
    """

    law: Law
    masses_kg: tuple[float, float]
    reduced_kg: float
    approach_m_s: float
    span_s: float
    depth_m: float


def _bodies(law: Law, masses_kg: tuple[float, float], velocities_m_s: tuple[float, float]) -> _Bodies:
    approach = velocities_m_s[0] - velocities_m_s[1]
    if approach <= 0:
        raise ContactError(
            f"the bodies part at {-approach:g} m/s: the left one must be faster than the right one"
        )
    mass = reduced_mass(*masses_kg)
    span = _time_scale(law, mass, approach)
    return _Bodies(law, masses_kg, mass, approach, span, approach * span)


def _time_scale(law: Law, mass: float, approach: float) -> float:
    """Time [s] in which the spring alone, loaded at the approach velocity, would stop the bodies."""
    energy = 0.5 * mass * approach**2
    low, high = 1e-15, 1.0
    for _ in range(200):
        middle = np.sqrt(low * high)
        low, high = (low, middle) if law.stored_energy(middle) > energy else (middle, high)
    return float(high / approach)


def _until_they_part(bodies: _Bodies, velocities_m_s: tuple[float, float], tolerance: float) -> Any:
    """Return scipy's solution from first touch to where the bodies part, in the scales of the bodies."""
    from scipy.integrate import solve_ivp  # only here: importing it takes a third of a second

    approach = bodies.approach_m_s
    start = np.array([0.0, 0.0, *velocities_m_s]) / np.array([1.0, 1.0, approach, approach])
    found = solve_ivp(
        _motion(bodies),
        (0.0, 200.0),
        start,
        method="DOP853",
        rtol=tolerance,
        atol=1e-13,
        events=_partings(bodies),
        dense_output=True,
    )
    if found.status != 1 or found.sol is None:
        raise ContactError(
            f"{bodies.law.name}: the bodies did not part within {200 * bodies.span_s:.3g} s ({found.message})"
        )
    return found


def _motion(bodies: _Bodies) -> Callable[[float, Real], list[float]]:
    """Return the equation of motion: the rates of both places and both velocities."""
    law, approach, span, depth = bodies.law, bodies.approach_m_s, bodies.span_s, bodies.depth_m
    mass_left, mass_right = bodies.masses_kg

    def motion(_t: float, y: Real) -> list[float]:
        left, right, v_left, v_right = y.tolist()
        force = law.force((left - right) * depth, (v_left - v_right) * approach, approach, FloatOperations)
        unit = force * span / approach
        return [v_left, v_right, -unit / mass_left, unit / mass_right]

    return motion


def _partings(bodies: _Bodies) -> tuple[Callable[[float, Real], float], ...]:
    """Return where the bodies part: where the deformation ends or, without tension, where the law would begin to pull."""
    law, approach, span, depth = bodies.law, bodies.approach_m_s, bodies.span_s, bodies.depth_m

    def closed(_t: float, y: Real) -> float:
        return float(y[0] - y[1])

    def pushing(_t: float, y: Real) -> float:
        # Per deformation, so that the root is a simple one whatever the law's power.
        deformation, rate = float(y[0] - y[1]) * depth, float(y[2] - y[3]) * approach
        if law.tension or deformation <= 0.0:
            return 1.0
        pressed = float(law.compression(deformation, rate, approach, FloatOperations))
        return pressed / deformation * depth * span / (bodies.reduced_kg * approach)

    for event in (closed, pushing):
        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
    return closed, pushing


def contact_time_linear(stiffness: float, mass: float, damping_ratio: float = 0.0) -> float:
    """Contact time [s] of the linear laws with tension let through: half a damped period.

    Args:
        stiffness: Stiffness of the contact [N/m].
        mass: Reduced mass [kg].
        damping_ratio: Damping ratio of the contact [-].
    """
    return float(np.pi / (np.sqrt(stiffness / mass) * np.sqrt(1.0 - damping_ratio**2)))


def contact_time_hertz(stiffness: float, mass: float, approach: float) -> float:
    """Contact time [s] of Hertz' law without damping, 2.9433 x_max / v (Goldsmith 2001, section 4.2).

    Args:
        stiffness: Stiffness of the contact [N/m^1.5].
        mass: Reduced mass [kg].
        approach: Velocity at first touch [m/s].
    """
    deepest = (1.25 * mass * approach**2 / stiffness) ** 0.4
    return float(2.943275 * deepest / approach)
