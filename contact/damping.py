"""Damping of the impact laws from the restitution asked for (thesis eq. 2.6, 2.7, 2.14, 2.17, 2.18)."""

from __future__ import annotations

import math

from pounding.contact.errors import ContactError

HERTZ_DAMP_FORMULAS = ("ye", "muthukumar")


def check_restitution(restitution: float) -> float:
    """The restitution itself if it lies in (0, 1]; `ContactError` otherwise.

    At 0 the bodies would stay together, for which every formula here divides by zero or takes the
    logarithm of it; above 1 the contact would create energy.
    """
    if not 0.0 < restitution <= 1.0:
        raise ContactError(
            f"a coefficient of restitution of {restitution:g} cannot be: give one above 0 (at 0 the damping "
            "is infinite) and at most 1 (above it, the contact creates energy)"
        )
    return restitution


def reduced_mass(mass_left: float, mass_right: float) -> float:
    """m_i m_j / (m_i + m_j) [kg] of two colliding bodies [kg]."""
    if not (mass_left > 0 and mass_right > 0):
        raise ContactError(
            f"colliding masses of {mass_left:g} and {mass_right:g} kg cannot be; both must be positive"
        )
    return mass_left * mass_right / (mass_left + mass_right)


def linear_damping_ratio(restitution: float) -> float:
    """Damping ratio xi of the linear viscoelastic law (thesis eq. 2.7), exact if tension is let through."""
    logarithm = math.log(check_restitution(restitution))
    return -logarithm / math.hypot(math.pi, logarithm)


def linear_damping(stiffness: float, damping_ratio: float, mass: float) -> float:
    """Dashpot C [N s/m] for a stiffness [N/m], a damping ratio and the reduced mass [kg] (thesis eq. 2.6).

    Args:
        stiffness: Stiffness of the contact [N/m].
        damping_ratio: Damping ratio of the contact [-].
        mass: Reduced mass [kg].
    """
    return 2.0 * damping_ratio * math.sqrt(stiffness * mass)


def linear_restitution(damping_ratio: float, *, tension: bool) -> float:
    """Restitution that the linear viscoelastic law reaches at a damping ratio below 1, in closed form.

    With tension the contact lasts a damped half period (the inverse of eq. 2.7). Without, the bodies part
    when the force first vanishes, before the deformation has.
    """
    decay = damping_ratio / math.sqrt(1.0 - damping_ratio**2)
    if tension:
        return math.exp(-math.pi * decay)
    angle = math.pi - math.atan2(
        2.0 * damping_ratio * math.sqrt(1.0 - damping_ratio**2), 2.0 * damping_ratio**2 - 1.0
    )
    return math.exp(-decay * (math.pi - angle))


def nonlinear_damping_ratio(restitution: float) -> float:
    """Damping ratio of the nonlinear viscoelastic law (thesis eq. 2.14, Jankowski's approximation)."""
    e = check_restitution(restitution)
    return 4.5 * math.sqrt(5.0) * (1.0 - e**2) / (e * (e * (9.0 * math.pi - 16.0) + 16.0))


def hertz_damp_ratio(restitution: float, formula: str = "ye") -> float:
    """xi_h v_0 / k_h of the Hertz-damp law [-]: thesis eq. 2.18 (``"ye"``) or eq. 2.17 (``"muthukumar"``)."""
    e = check_restitution(restitution)
    if formula == "ye":
        return 8.0 * (1.0 - e) / (5.0 * e)
    if formula == "muthukumar":
        return 0.75 * (1.0 - e**2)
    raise ContactError(
        f"no damping formula of hertz_damp is called {formula!r}; known are {', '.join(HERTZ_DAMP_FORMULAS)}"
    )
