"""What a channel may measure, the units it may be written in, and the contact laws a case may name."""

from __future__ import annotations

from pounding import bounds, units
from pounding.constants import STANDARD_GRAVITY
from pounding.contact.laws import BUILT_IN, DAMPED
from pounding.experiments.measurements.quantities import UNITS

__all__ = [
    "ABSOLUTE",
    "DISPLACEMENTS",
    "LAWS",
    "MODAL_BOUNDS",
    "MODAL_UNITS",
    "OF_A_CONTACT",
    "OF_THE_TABLE",
    "STANDARD_GRAVITY",
    "UNDAMPED_LAWS",
    "UNITS",
]

OF_THE_TABLE = frozenset({"table_acceleration", "table_displacement"})
OF_A_CONTACT = frozenset({"contact_force"})
ABSOLUTE = frozenset({"absolute_acceleration", "absolute_displacement"})
"""Quantities that mean something at floor 0, the table, too."""
DISPLACEMENTS = frozenset({"absolute_displacement", "relative_displacement"})
"""What says how far a floor goes."""

MODAL_UNITS: dict[str, dict[str, float]] = {
    "frequency": units.FREQUENCY,
    "roof_stiffness": units.STIFFNESS,
    "mass": units.MASS,
}
"""What a modal test may have found, and its units with factors to SI."""

MODAL_BOUNDS = {
    "frequency": bounds.FREQUENCY,
    "roof_stiffness": bounds.STIFFNESS,
    "mass": bounds.BUILDING_MASS,
}
"""What it can have found, in SI."""

LAWS = BUILT_IN
UNDAMPED_LAWS = frozenset(LAWS) - frozenset(DAMPED)
