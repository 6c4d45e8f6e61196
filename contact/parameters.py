"""Parameter sets of the five laws: as the thesis prints them, and as its formulas give them.

`printed` holds Tables 5.1 and 6.1. `formula` holds what the thesis' own equations give for the same sensor,
plate and mean restitution; docs/theory/contact.md sets the two beside each other, value by value.
"""

from __future__ import annotations

from typing import Any

from pounding.contact import stiffness as k
from pounding.contact.damping import (
    check_restitution,
    linear_damping,
    linear_damping_ratio,
    nonlinear_damping_ratio,
    reduced_mass,
)
from pounding.contact.errors import ContactError
from pounding.contact.laws import HertzDamp, Law, LinearViscoelastic, NonlinearViscoelastic, law_class
from pounding.scale import THESIS

RESTITUTION = 0.810154  # mean over the measured impacts, thesis section 5.3.1
FLOOR_MASS = 6.2  # kg; with it, eq. 2.6 gives the C of Table 5.1 from its k and xi = 0.078407
SENSOR_RADIUS = 4.49e-3  # m, impact cap of the force sensor
SENSOR_AREA = 63.5e-6  # m2
SENSOR_MATERIAL = (1.965e11, 0.272)  # Pa, -; stainless steel
PLATE_LENGTH = 0.4  # m
PLATE_MATERIAL = (2e11, 0.3)  # Pa, -; structural steel

# Table 5.1: stiffness [N/m], damping [N s/m].
STIFFNESS_SETS: dict[str, tuple[float, float]] = {
    "experiment": (20.660e6, 1255.0),
    "maison_kasai": (31.750e6, 1556.0),
    "naserkhaki": (2.750e6, 458.0),
    "jankowski": (16.000e6, 1104.0),
    "xu": (12.848e6, 990.0),
}

# Table 6.1, and C of Table 5.1.
PRINTED: dict[str, dict[str, float]] = {
    "linear_spring": {"stiffness": 20.66e6},
    "linear_viscoelastic": {"stiffness": 20.66e6, "damping": 1255.0},
    "hertz": {"stiffness": 9.772e8},
    "nonlinear_viscoelastic": {"stiffness": 2.2e9, "damping_ratio": 0.193872},
    "hertz_damp": {"stiffness": 9.772e8, "restitution": RESTITUTION},
}

PARAMETER_SETS = ("printed", "formula")


def _formula() -> dict[str, dict[str, float]]:
    linear = k.experiment(THESIS.length)
    hertz = k.hertz_sphere_on_plane(SENSOR_RADIUS, SENSOR_MATERIAL, PLATE_MATERIAL)
    return {
        "linear_spring": {"stiffness": linear},
        "linear_viscoelastic": {"stiffness": linear, "damping_ratio": linear_damping_ratio(RESTITUTION)},
        "hertz": {"stiffness": hertz},
        "nonlinear_viscoelastic": {
            "stiffness": k.scaled_hertz(k.JANKOWSKI_STEEL_HERTZ, THESIS.length),
            "damping_ratio": nonlinear_damping_ratio(RESTITUTION),
        },
        "hertz_damp": {"stiffness": hertz, "restitution": RESTITUTION},
    }


def thesis_law(
    name: str,
    parameters: str = "printed",
    *,
    masses: tuple[float, float] = (FLOOR_MASS, FLOOR_MASS),
    tension: bool = False,
) -> Law:
    """One of the five laws with the thesis' parameters.

    Args:
        name: Name of the law.
        parameters: ``"printed"`` (Tables 5.1 and 6.1) or ``"formula"``.
        masses: Colliding floors' masses [kg], which eq. 2.6 and 2.13 need.
        tension: See `Law`.

    Raises:
        ContactError: There is no such law or set, or the set has no values for a law of one's own.
    """
    if parameters not in PARAMETER_SETS:
        raise ContactError(
            f"no parameter set is called {parameters!r}; known are {', '.join(PARAMETER_SETS)}"
        )
    law_class(name)
    values = (PRINTED if parameters == "printed" else _formula()).get(name)
    if values is None:
        raise ContactError(f"the thesis has no parameters for {name!r}; build that law with `make_law`")
    return make_law(name, masses=masses, tension=tension, **values)


def viscoelastic_of(source: str, *, tension: bool = False) -> LinearViscoelastic:
    """Linear viscoelastic law with a row of Table 5.1; source is a key of `STIFFNESS_SETS`."""
    if source not in STIFFNESS_SETS:
        raise ContactError(f"Table 5.1 has no row {source!r}; its rows are {', '.join(STIFFNESS_SETS)}")
    stiffness, damping = STIFFNESS_SETS[source]
    return LinearViscoelastic(stiffness, tension=tension, damping=damping)


def make_law(
    name: str,
    *,
    stiffness: float,
    damping: float | None = None,
    damping_ratio: float | None = None,
    restitution: float | None = None,
    masses: tuple[float, float] = (FLOOR_MASS, FLOOR_MASS),
    tension: bool = False,
    **own: Any,
) -> Law:
    """A law by its name, its damping given in whichever way is at hand.

    Args:
        name: Name of the law.
        stiffness: [N/m], or [N/m^1.5] for the Hertz family.
        damping: Dashpot of the linear viscoelastic law [N s/m].
        damping_ratio: Damping ratio of a viscoelastic law.
        restitution: Coefficient of restitution, turned into damping by the law's own formula.
        masses: The colliding masses [kg].
        tension: See `Law`.
        own: Further fields of the law, such as ``formula`` of hertz_damp.

    Raises:
        ContactError: Unknown law, a value that cannot be, or a damping that the law has no use for.
    """
    law = law_class(name)
    given = [
        key
        for key, value in (
            ("damping", damping),
            ("damping_ratio", damping_ratio),
            ("restitution", restitution),
        )
        if value is not None
    ]
    if len(given) > 1:
        raise ContactError(f"{name}: {' and '.join(given)} are both given; give one of them")
    if law is LinearViscoelastic:
        if restitution is not None:
            damping_ratio = linear_damping_ratio(restitution)
        if damping_ratio is not None and stiffness > 0:
            damping = linear_damping(stiffness, damping_ratio, reduced_mass(*masses))
        return LinearViscoelastic(stiffness, tension, damping or 0.0, **own)
    if law is NonlinearViscoelastic and damping is None:
        if restitution is not None:
            damping_ratio = nonlinear_damping_ratio(restitution)
        return NonlinearViscoelastic(stiffness, tension, damping_ratio or 0.0, reduced_mass(*masses), **own)
    if law is HertzDamp and damping is None and damping_ratio is None:
        return HertzDamp(
            stiffness, tension, check_restitution(1.0 if restitution is None else restitution), **own
        )
    if given:
        raise ContactError(f"{name}: {given[0]} is given, for which this law has no use")
    return law(stiffness, tension, **own)
