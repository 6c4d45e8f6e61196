"""Stiffness of the contact: formulas of thesis section 2.3 that its tables use, and equation 5.2, in SI units."""

from __future__ import annotations

import math

from pounding.contact.damping import check_restitution
from pounding.contact.errors import ContactError

EXPERIMENT_FULL_SCALE = 620e3 * 1e3  # thesis eq. 5.2: 620 kN/mm at full scale [N/m]
JANKOWSKI_STEEL = 482e3 * 1e3  # steel on steel, linear viscoelastic, thesis section 2.3 [N/m]
JANKOWSKI_STEEL_HERTZ = 6.6e10  # steel on steel, nonlinear viscoelastic, thesis section 6.5 [N/m^1.5]


def axial(modulus: float, area: float, length: float) -> float:
    """E A / L [N/m] of the colliding slab (thesis eq. 2.21, Maison and Kasai; 2.22, Cole et al.).

    Args:
        modulus: Young's modulus [Pa].
        area: Cross-section [m^2].
        length: Length along the impact [m].
    """
    return _positive(modulus * area / length)


def naserkhaki(building_stiffness: float, factor: float = 100.0) -> float:
    """50 to 100 times the building's lateral stiffness [N/m] (thesis eq. 2.24; the thesis takes 100)."""
    if not 50.0 <= factor <= 100.0:
        raise ContactError(f"a factor of {factor:g} lies outside the 50 to 100 of thesis eq. 2.24")
    return _positive(factor * building_stiffness)


def xu(axial_stiffness: float, mass_left: float, mass_right: float, restitution: float) -> float:
    """Xu et al. (thesis eq. 2.25, denominator read as m_i + m_j) [N/m]; the right mass [kg] is m_j.

    Args:
        axial_stiffness: See `axial` [N/m].
        mass_left: Mass m_i [kg].
        mass_right: Mass m_j [kg].
        restitution: Coefficient of restitution [-].
    """
    logarithm = math.log(check_restitution(restitution))
    angle = math.asin(math.pi / math.hypot(math.pi, logarithm))
    share = mass_right / (mass_left + mass_right)
    return _positive(share * axial_stiffness * math.exp(2.0 * logarithm / math.pi * angle))


def experiment(scale: float) -> float:
    """The thesis' own k = 620 kN/mm times the length scale (thesis eq. 5.2) [N/m]."""
    return _positive(EXPERIMENT_FULL_SCALE * scale)


def scaled_hertz(full_scale: float, scale: float) -> float:
    """Stiffness of a Hertz law at a length scale [N/m^1.5], the root of the scale times that at full scale.

    Equation 5.2 scales a force over a deformation with the length, so the force goes with its square; a force over a
    deformation to the power of 1.5 then goes with its root. So does eq. 2.10, by the root of the radius.

    Args:
        full_scale: Stiffness at full scale [N/m^1.5].
        scale: Length at model scale over that at full scale [-].
    """
    return _positive(full_scale * math.sqrt(scale))


def material_parameter(modulus: float, poisson: float) -> float:
    """delta = (1 - rho^2) / (pi E) [1/Pa] of a contact partner (thesis eq. 2.11)."""
    return (1.0 - poisson**2) / (math.pi * modulus)


def hertz_sphere_on_plane(radius: float, first: tuple[float, float], second: tuple[float, float]) -> float:
    """k_h [N/m^1.5] of a sphere of `radius` [m] on a plane (thesis eq. 2.10).

    Args:
        radius: Radius of the sphere [m].
        first: Young's modulus [Pa] and Poisson's ratio [-] of the one material.
        second: The same of the other.
    """
    compliance = material_parameter(*first) + material_parameter(*second)
    return _positive(4.0 * math.sqrt(radius) / (3.0 * math.pi) / compliance)


def _positive(stiffness: float) -> float:
    if not (stiffness > 0.0 and math.isfinite(stiffness)):
        raise ContactError(
            f"these numbers give a contact stiffness of {stiffness:g}; it must be positive and finite"
        )
    return stiffness
