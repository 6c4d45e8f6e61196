"""What a channel may measure, the units it may be written in, and the contact laws a case may name."""

from __future__ import annotations

STANDARD_GRAVITY = 9.80665
"""[m/s^2], exact by convention (CGPM 1901)."""

_ACCELERATION = {"m/s^2": 1.0, "g": STANDARD_GRAVITY, "cm/s^2": 0.01}
_LENGTH = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_VELOCITY = {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001}
_FORCE = {"N": 1.0, "kN": 1000.0}

UNITS: dict[str, dict[str, float]] = {
    "table_acceleration": _ACCELERATION,
    "table_displacement": _LENGTH,
    "absolute_acceleration": _ACCELERATION,
    "relative_displacement": _LENGTH,
    "absolute_displacement": _LENGTH,
    "relative_velocity": _VELOCITY,
    "contact_force": _FORCE,
}
"""For each quantity the units it may be given in, each with its factor to SI."""

OF_THE_TABLE = frozenset({"table_acceleration", "table_displacement"})
OF_A_CONTACT = frozenset({"contact_force"})
ABSOLUTE = frozenset({"absolute_acceleration", "absolute_displacement"})
"""Quantities that mean something at floor 0, the table, too."""

LAWS = ("linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp")
UNDAMPED_LAWS = frozenset({"linear_spring", "hertz"})
