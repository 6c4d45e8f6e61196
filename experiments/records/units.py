"""Units of acceleration as files name them, converted at the edge."""

from __future__ import annotations

import difflib

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import STANDARD_GRAVITY

_SPELLINGS = {
    1.0: ("m/s2", "m/s/s", "m/sec2", "m/sec/sec", "m_s2", "mps2", "meters/sec2"),
    0.01: ("cm/s2", "cm/s/s", "cm/sec2", "cm/sec/sec", "cm_s2", "gal", "gals"),
    0.001: ("mm/s2", "mm/s/s", "mm/sec2", "mm_s2"),
    STANDARD_GRAVITY: ("g",),
    STANDARD_GRAVITY / 1000: ("mg",),
    0.3048: ("ft/s2", "ft/sec2", "ft_s2"),
    0.0254: ("in/s2", "in/sec2", "in_s2"),
}
_FACTORS = {spelling: factor for factor, spellings in _SPELLINGS.items() for spelling in spellings}
KNOWN = "m/s^2, cm/s^2 (gal), mm/s^2, g, mg, ft/s^2, in/s^2"


def to_metric(unit: str, where: str) -> float:
    """Return how many m/s^2 one unit of acceleration is.

    Args:
        unit: As the file or the user writes it: `m/s^2`, `m_s2`, `gal`, `cm/sec/sec`, `g`, ...
        where: File and line for the message.

    Raises:
        ExperimentError: A unit that is not an acceleration known here.
    """
    plain = unit.strip().lower().replace("^", "").replace("**", "").replace(" ", "").replace("²", "2")
    if plain in _FACTORS:
        return _FACTORS[plain]
    near = difflib.get_close_matches(plain, _FACTORS, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise ExperimentError(f"{where}: unit '{unit.strip()}' is not an acceleration known here ({KNOWN}){hint}")
