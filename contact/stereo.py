"""Stereo-mechanical relations: velocities after an impact that takes no time.

The thesis' equations 2.1 and 2.2 violate the momentum they are meant to keep: they give both bodies a
change of velocity of the same sign (and 2.1 starts from the other body's velocity). Both versions are
kept: `after_impact` to compute with, `after_impact_as_printed` to show the misprint by.
"""

from __future__ import annotations

from pounding.contact.damping import check_restitution


def after_impact(
    mass_left: float, mass_right: float, velocity_left: float, velocity_right: float, restitution: float
) -> tuple[float, float]:
    """Velocities [m/s] after the impact of two masses [kg] (thesis eq. 2.1 and 2.2, corrected).

    Args:
        mass_left: Mass of the left body [kg].
        mass_right: Mass of the right body [kg].
        velocity_left: Velocity of the left body before the impact [m/s].
        velocity_right: Velocity of the right body before the impact [m/s].
        restitution: Coefficient of restitution [-].
    """
    if restitution:  # 0, the entirely plastic impact, is well defined here
        check_restitution(restitution)
    change = (1.0 + restitution) * (velocity_left - velocity_right) / (mass_left + mass_right)
    return velocity_left - change * mass_right, velocity_right + change * mass_left


def after_impact_as_printed(
    mass_left: float, mass_right: float, velocity_left: float, velocity_right: float, restitution: float
) -> tuple[float, float]:
    """Thesis eq. 2.1 and 2.2 letter by letter (the denominator read as m_i + m_j): momentum is *not* kept.

    Args:
        mass_left: Mass of the left body [kg].
        mass_right: Mass of the right body [kg].
        velocity_left: Velocity of the left body before the impact [m/s].
        velocity_right: Velocity of the right body before the impact [m/s].
        restitution: Coefficient of restitution [-].
    """
    change = (1.0 + restitution) * (velocity_left - velocity_right) / (mass_left + mass_right)
    return velocity_right - change * mass_right, velocity_right - change * mass_left


def restitution_of(before_left: float, before_right: float, after_left: float, after_right: float) -> float:
    """Separation velocity over approach velocity (thesis eq. 2.3, 2.8).

    Args:
        before_left: Velocity of the left body before the impact [m/s].
        before_right: Velocity of the right body before the impact [m/s].
        after_left: Velocity of the left body after the impact [m/s].
        after_right: Velocity of the right body after the impact [m/s].
    """
    return (after_right - after_left) / (before_left - before_right)
