"""Which contact stands between two floors: the laboratory's at its scale, an estimate from the floors at any other."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from pounding.contact.errors import ContactError
from pounding.contact.floors import (
    Estimate,
    Floor,
    floor_law,
    hertz_spheres,
    is_hertz,
    restitution_of,
    slab_strip,
)
from pounding.contact.laws import Law, law_class
from pounding.contact.parameters import make_law, thesis_law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.pounding import floor_masses
from pounding.frames.definition import Frame, PlateFrame
from pounding.scale import THESIS

if TYPE_CHECKING:
    from pounding.experiments.rig.table_scale import TableScale
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Parameters = Literal["printed", "formula", "floors"]


@dataclass(frozen=True)
class ContactWish:
    """What the user says of the contacts.

    Attributes:
        laws: Names of the laws.
        parameters: ``printed`` or ``formula``: the laboratory's; ``floors``: an estimate; None: what suits the scale.
        stiffness: Stiffness in each law's unit; None: that of the parameters.
        restitution: Restitution [-]; None: that of the parameters.
        radius_m: Radius of a Hertz contact [m]; None: of spheres with the floors' masses.
        tension: May the contact pull?
    """

    laws: Sequence[str]
    parameters: Parameters | None = None
    stiffness: float | None = None
    restitution: float | None = None
    radius_m: float | None = None
    tension: bool = False


def chosen_parameters(frames: Sequence[Frame], table: TableScale, wish: ContactWish) -> Parameters:
    """Return the parameter set that is used, before any frame is built.

    Args:
        frames: Definitions of the two frames.
        table: Their scale.
        wish: What the user says.

    Raises:
        ExperimentError: The laboratory's contact at another scale than its own, or nothing to estimate another from.
        ContactError: An unknown law, one whose stiffness nothing estimates, or a number for which no law has a use.
    """
    at_home = table.scale.is_near(THESIS)
    chosen = wish.parameters or ("printed" if at_home else "floors")
    _check_used(wish, chosen)
    if chosen != "floors":
        if not at_home:
            raise ExperimentError(
                f"the laboratory's contact parameters ({chosen}) hold at {THESIS}, and {_names(frames)} stand at "
                f"{table.scale}; leave --parameters (in a street file 'parameters') out and estimate the contact "
                f"{_needs(frames) or 'from the floors'}, or give --stiffness and --restitution (in a street file the keys)"
            )
        return chosen
    if wish.stiffness is None:
        for name in wish.laws:
            is_hertz(name)
        if _needs(frames):
            raise ExperimentError(
                f"the contact of {_names(frames)} at {table.scale} is not known; estimate it "
                f"{_needs(frames)}, or give --stiffness and --restitution (in a street file the keys)"
            )
    return chosen


def _check_used(wish: ContactWish, chosen: Parameters) -> None:
    """Refuse a number for which none of the laws has a use."""
    laws = [law_class(name) for name in wish.laws]
    names = " and ".join(wish.laws)
    for key, given in (("restitution", wish.restitution is not None), ("tension", wish.tension)):
        if given and not any(law.damped for law in laws):
            raise ContactError(f"{names}: {key} is given, for which this law has no use; leave it out")
    of_spheres = chosen == "floors" and wish.stiffness is None and any(law.unit != "N/m" for law in laws)
    if wish.radius_m is not None and not of_spheres:
        raise ContactError(
            f"{names}: a radius is given, and only a Hertz contact that is estimated from the floors has one; leave it out"
        )


def _names(frames: Sequence[Frame]) -> str:
    return " and ".join(frame.name for frame in frames)


def choose_laws(
    pair: tuple[ReducedFrame, ReducedFrame],
    floor: int | None,
    chosen: Parameters,
    wish: ContactWish,
    masses: tuple[float, float] | None = None,
    places: int = 1,
) -> tuple[list[Law], list[str]]:
    """Return the laws between two floors and, for each, the sentence on what its numbers rest on.

    Args:
        pair: The left and the right frame.
        floor: Floor of the lower frame; its roof when None.
        chosen: The parameter set.
        wish: What the user says.
        masses: The masses that meet [kg]; those of the two floors when None.
        places: How many places along their edge share the slab's strip.
    """
    masses = masses or floor_masses(*pair, floor)
    if chosen != "floors":
        return _laboratory(masses, chosen, wish), [
            _laboratory_basis(name, chosen, wish) for name in wish.laws
        ]
    restitution = restitution_of(wish.restitution)
    found = [
        floor_law(
            name, _stiffness(pair, masses, name, wish, places), restitution, masses, tension=wish.tension
        )
        for name in wish.laws
    ]
    return [law for law, _ in found], [basis for _, basis in found]


def _stiffness(
    pair: tuple[ReducedFrame, ReducedFrame],
    masses: tuple[float, float],
    name: str,
    wish: ContactWish,
    places: int,
) -> Estimate:
    if wish.stiffness is not None:
        return Estimate(wish.stiffness, "as stated")
    left, right = (_floor(frame, mass) for frame, mass in zip(pair, masses, strict=True))
    if is_hertz(name):
        return hertz_spheres((left, right), wish.radius_m)
    strip = slab_strip((left, right))
    if places == 1:
        return strip
    return Estimate(strip.value / places, f"one of {places} places that share {strip.basis}")


def _floor(frame: ReducedFrame, mass_kg: float) -> Floor:
    defined = frame.definition
    length, width = frame.plan_m
    if isinstance(defined, PlateFrame):
        thickness, material = defined.plate.thickness_m, defined.material
        modulus, poisson, density = (
            material.youngs_modulus_gpa,
            material.poissons_ratio,
            material.density_kg_per_m3,
        )
    elif defined.slab is not None:
        slab = defined.slab
        thickness, modulus = slab.thickness_m, slab.youngs_modulus_gpa
        poisson, density = slab.poissons_ratio, slab.density_kg_per_m3
    else:
        raise ExperimentError(f"frame {frame.name}: no [slab]; {_needs([defined])}")
    return Floor(frame.name, mass_kg, thickness, width, length, 1e9 * modulus, poisson, density)


def _needs(frames: Sequence[Frame]) -> str:
    """Return what must be written so that the contact can be estimated, nothing where it can be."""
    without = [frame.name for frame in frames if not isinstance(frame, PlateFrame) and frame.slab is None]
    if not without:
        return ""
    return f"with a table [slab] with thickness_m = 0.2 or so in the file of {' and of '.join(dict.fromkeys(without))}"


def _laboratory(masses: tuple[float, float], chosen: Parameters, wish: ContactWish) -> list[Law]:
    return [
        _changed(thesis_law(name, chosen, masses=masses, tension=wish.tension), masses, wish)
        for name in wish.laws
    ]


def _changed(law: Law, masses: tuple[float, float], wish: ContactWish) -> Law:
    """Return a law with another stiffness and else unchanged, or with the damping of a restitution."""
    stiffer = law if wish.stiffness is None else dataclasses.replace(law, stiffness=wish.stiffness)
    if wish.restitution is None:
        return stiffer
    return make_law(
        law.name,
        stiffness=stiffer.stiffness,
        restitution=wish.restitution,
        masses=masses,
        tension=law.tension,
    )


def _laboratory_basis(name: str, chosen: Parameters, wish: ContactWish) -> str:
    source = "Tables 5.1 and 6.1" if chosen == "printed" else "the formulas"
    said = [f"{name}: the laboratory's contact at {THESIS}, {source} of the thesis"]
    if wish.stiffness is not None:
        said.append(f"stiffness {wish.stiffness:.4g} {law_class(name).unit} as stated")
    if wish.restitution is not None:
        said.append(f"restitution {wish.restitution:g} as stated")
    return ", ".join(said)
