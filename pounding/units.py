"""Units that files and users may write, each with its factor to SI; inside the program everything is SI.

Which of them a format takes is said where the format is read; what one of them is, is said here alone.
"""

from __future__ import annotations

from pounding.constants import STANDARD_GRAVITY

LENGTH = {"m": 1.0, "cm": 0.01, "mm": 0.001}
VELOCITY = {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001}
ACCELERATION = {
    "m/s^2": 1.0,
    "g": STANDARD_GRAVITY,
    "cm/s^2": 0.01,
    "mm/s^2": 0.001,
    "mg": STANDARD_GRAVITY / 1000,
    "ft/s^2": 0.3048,
    "in/s^2": 0.0254,
}
FORCE = {"N": 1.0, "kN": 1e3}
MASS = {"kg": 1.0, "t": 1e3}
STIFFNESS = {"N/m": 1.0, "N/mm": 1e3, "kN/mm": 1e6, "kN/m": 1e3}
FREQUENCY = {"Hz": 1.0}
TIME = {"s": 1.0, "ms": 0.001}

_OTHER_SPELLINGS = {
    "m": ("metre", "meter", "metres", "meters"),
    "cm": ("centimetre", "centimeter"),
    "mm": ("millimetre", "millimeter"),
    "m/s": ("m_s", "m/sec"),
    "cm/s": ("cm_s", "cm/sec"),
    "mm/s": ("mm_s", "mm/sec"),
    "m/s^2": ("m/s/s", "m/ss", "m/sec2", "m/sec/sec", "m_s2", "ms-2", "mps2", "meters/sec2"),
    "cm/s^2": ("cm/s/s", "cm/sec2", "cm/sec/sec", "cm_s2", "gal", "gals"),
    "mm/s^2": ("mm/s/s", "mm/sec2", "mm_s2"),
    "ft/s^2": ("ft/sec2", "ft_s2"),
    "in/s^2": ("in/sec2", "in_s2"),
    "N": ("newton",),
    "s": ("sec", "seconds"),
}


def _plain(written: str) -> str:
    """Return a unit without what spellings differ in: case, blanks, and the mark of an exponent."""
    return written.strip().lower().replace("^", "").replace("**", "").replace(" ", "").replace("²", "2")


_KINDS = (LENGTH, VELOCITY, ACCELERATION, FORCE, MASS, STIFFNESS, FREQUENCY, TIME)
_UNIT_OF = {_plain(unit): unit for kind in _KINDS for unit in kind} | {
    _plain(spelling): unit for unit, spellings in _OTHER_SPELLINGS.items() for spelling in spellings
}


def named(written: str) -> str | None:
    """Return the unit that is meant, as it is called here, or None.

    Args:
        written: As a file or a user writes it: `m/s**2`, `m_s2`, `gal`, `cm/sec/sec`, `G`, ...
    """
    return _UNIT_OF.get(_plain(written))


def spellings(kind: dict[str, float]) -> list[str]:
    """Return all ways in which the units of one kind may be written, in lower case and without `^`."""
    return [spelling for spelling, unit in _UNIT_OF.items() if unit in kind]


def si(kind: dict[str, float]) -> str:
    """Return the SI unit of a kind, which is the one whose factor is 1."""
    return next(unit for unit, factor in kind.items() if factor == 1.0)


LARGE_FORCE_N = 1e5
"""Where a larger force occurs, forces are shown in kN."""


def force_unit(largest_n: float) -> tuple[str, float]:
    """Return the unit in which forces are shown, and what it is in N: N for models, kN for buildings.

    Args:
        largest_n: The largest of them [N].
    """
    return ("kN", 1e3) if largest_n > LARGE_FORCE_N else ("N", 1.0)
