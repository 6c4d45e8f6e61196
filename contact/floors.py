"""Stiffness and damping of a contact between two floors, from what is known of the floors themselves.

Nobody has measured the contact of two real floors, so these are estimates with a stated range:

- the linear laws take the axial stiffness E A / L of the slab strip that is hit, the softer of the two (thesis eq. 2.21,
  Maison and Kasai 1992; eq. 2.22, Cole et al. 2012);
- the laws of the Hertz family take two spheres of concrete (thesis eq. 2.10 for two radii, Goldsmith 1960), with radii
  that are stated, or of the floors' masses, R = (3 m / (4 pi rho))^(1/3) (Muthukumar and DesRoches 2006);
- damping follows from the restitution and the floors' masses by each law's own formula (thesis eq. 2.6, 2.7, 2.14, 2.18;
  Anagnostopoulos 1988, Jankowski 2005, Ye et al. 2009).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pounding.contact import stiffness as k
from pounding.contact.errors import ContactError
from pounding.contact.laws import Law, law_class
from pounding.contact.parameters import make_law

RESTITUTION = 0.65
"""Restitution where none is stated: concrete against concrete (Jankowski 2005; thesis section 2.1.2)."""

RESTITUTION_RANGE = (0.5, 0.85)
"""0.5 to 0.75 (Anagnostopoulos and Spiliopoulos 1992) and 0.53 to 0.85 (Maison and Kasai 1992), thesis section 5.3.1."""

STIFFNESS_RANGE = (93.5e6, 1e10)
"""From concrete elements of a laboratory, 93.5 kN/mm (Jankowski 2005), to where a stiffer contact changes nothing any
more, as Ghandil and Aldaikh (2017) found; thesis sections 2.3 and 5.1 [N/m]."""

HERTZ_RANGE = (2.75e9, 1e11)
"""From concrete elements of a laboratory (van Mier 1991, Jankowski 2005) to steel on steel, thesis section 2.3 [N/m^1.5]."""


@dataclass(frozen=True)
class Floor:
    """What is known of a floor that may be hit.

    Attributes:
        name: What messages call it.
        mass_kg: Its mass [kg].
        thickness_m: Thickness of its slab [m].
        width_m: Side along the edge that is hit [m].
        length_m: Side along the impact [m].
        modulus_pa: Young's modulus of the slab [Pa].
        poisson: Poisson's ratio [-].
        density_kg_per_m3: Density of the slab [kg/m^3].
    """

    name: str
    mass_kg: float
    thickness_m: float
    width_m: float
    length_m: float
    modulus_pa: float
    poisson: float
    density_kg_per_m3: float

    @property
    def radius_m(self) -> float:
        """Radius of a sphere of the slab's density that has the floor's mass [m]."""
        return float((3.0 * self.mass_kg / (4.0 * math.pi * self.density_kg_per_m3)) ** (1.0 / 3.0))


@dataclass(frozen=True)
class Estimate:
    """A value and what it rests on.

    Attributes:
        value: The value, in the unit of the quantity.
        basis: What it rests on, in words.
    """

    value: float
    basis: str


def slab_strip(floors: tuple[Floor, Floor]) -> Estimate:
    """Return the stiffness of a linear contact: E t W / L of the softer slab [N/m], W the width of the narrower floor.

    Args:
        floors: The floors that meet.
    """
    width = min(floor.width_m for floor in floors)
    found = [k.axial(floor.modulus_pa, floor.thickness_m * width, floor.length_m) for floor in floors]
    softer = found.index(min(found))
    one = floors[softer]
    basis = (
        f"E A / L of the slab strip of {one.name}, {one.modulus_pa / 1e9:g} GPa x {one.thickness_m:g} m x {width:g} m / "
        f"{one.length_m:g} m (thesis eq. 2.21 and 2.22)"
    )
    return Estimate(found[softer], basis + _outside(found[softer], STIFFNESS_RANGE, "N/m"))


def hertz_spheres(floors: tuple[Floor, Floor], radius_m: float | None = None) -> Estimate:
    """Return the stiffness of a Hertz contact [N/m^1.5].

    Args:
        floors: The floors that meet.
        radius_m: Radius of the contact, R1 R2 / (R1 + R2) of the two surfaces [m]; that of spheres with the floors'
            masses when None.
    """
    first, second = (floor.radius_m for floor in floors)
    radius = first * second / (first + second) if radius_m is None else radius_m
    materials = [(floor.modulus_pa, floor.poisson) for floor in floors]
    found = k.hertz_sphere_on_plane(radius, materials[0], materials[1])
    source = (
        f"spheres of the floors' masses, {first:.3g} and {second:.3g} m (Muthukumar and DesRoches 2006)"
        if radius_m is None
        else f"a contact radius of {radius_m:g} m, as stated"
    )
    return Estimate(found, f"Hertz, {source}, thesis eq. 2.10" + _outside(found, HERTZ_RANGE, "N/m^1.5"))


def restitution_of(stated: float | None) -> Estimate:
    """Return the restitution and its basis.

    Args:
        stated: As the user states it; `RESTITUTION` when None.
    """
    if stated is None:
        return Estimate(
            RESTITUTION, "concrete on concrete (Jankowski 2005); state another with --restitution"
        )
    return Estimate(stated, "as stated" + _outside(stated, RESTITUTION_RANGE, ""))


def floor_law(
    name: str,
    stiffness: Estimate,
    restitution: Estimate,
    masses: tuple[float, float],
    *,
    tension: bool = False,
) -> tuple[Law, str]:
    """Return a law between two floors and the sentence that says what its numbers rest on.

    Args:
        name: Name of the law.
        stiffness: Its stiffness, in its own unit.
        restitution: Its restitution; a law without loss takes none.
        masses: The floors' masses [kg].
        tension: See `Law`.
    """
    kind = law_class(name)
    said = f"{name}: stiffness {stiffness.value:.4g} {kind.unit}, {stiffness.basis}"
    if not kind.damped:
        return make_law(name, stiffness=stiffness.value, masses=masses, tension=tension), said
    law = make_law(
        name, stiffness=stiffness.value, restitution=restitution.value, masses=masses, tension=tension
    )
    between = " and ".join(f"{mass / 1e3:.4g} t" for mass in masses)
    return law, f"{said}; restitution {restitution.value:g}, {restitution.basis}; floors of {between}"


def is_hertz(name: str) -> bool:
    """Return whether a law's stiffness is that of Hertz' contact; `ContactError` for a law of which nothing is known."""
    unit = law_class(name).unit
    if unit not in ("N/m", "N/m^1.5"):
        raise ContactError(f"{name}: nothing estimates a stiffness in {unit}; give it with --stiffness")
    return unit == "N/m^1.5"


def _outside(value: float, usual: tuple[float, float], unit: str) -> str:
    low, high = usual
    if low <= value <= high:
        return ""
    return f", outside the {low:g} to {high:g} {unit}".rstrip() + " of the literature"
