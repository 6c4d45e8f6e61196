"""What a channel may measure, and the units it may be written in."""

from __future__ import annotations

from pounding.units import ACCELERATION, FORCE, LENGTH, VELOCITY

_ACCELERATION = {unit: ACCELERATION[unit] for unit in ("m/s^2", "g", "cm/s^2")}

UNITS: dict[str, dict[str, float]] = {
    "table_acceleration": _ACCELERATION,
    "table_displacement": LENGTH,
    "absolute_acceleration": _ACCELERATION,
    "relative_displacement": LENGTH,
    "absolute_displacement": LENGTH,
    "relative_velocity": VELOCITY,
    "contact_force": FORCE,
}
"""For each quantity the units it may be given in, each with its factor to SI."""
