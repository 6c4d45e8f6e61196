"""What a channel may measure, the units it may be written in, and what a sensor can read."""

from __future__ import annotations

from pounding import bounds
from pounding.units import ACCELERATION, FORCE, LENGTH, VELOCITY

_ACCELERATION = ({unit: ACCELERATION[unit] for unit in ("m/s^2", "g", "cm/s^2")}, bounds.ACCELERATION)
_DISPLACEMENT = (LENGTH, bounds.DISPLACEMENT)

_QUANTITIES: dict[str, tuple[dict[str, float], bounds.Bound]] = {
    "table_acceleration": _ACCELERATION,
    "table_displacement": _DISPLACEMENT,
    "absolute_acceleration": _ACCELERATION,
    "relative_displacement": _DISPLACEMENT,
    "absolute_displacement": _DISPLACEMENT,
    "relative_velocity": (VELOCITY, bounds.VELOCITY),
    "contact_force": (FORCE, bounds.FORCE),
}

UNITS: dict[str, dict[str, float]] = {name: units for name, (units, _) in _QUANTITIES.items()}
"""For each quantity the units it may be given in, each with its factor to SI."""

BOUNDS: dict[str, bounds.Bound] = {name: bound for name, (_, bound) in _QUANTITIES.items()}
"""For each quantity what a sensor of it can read, in SI."""
