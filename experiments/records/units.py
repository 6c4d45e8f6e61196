"""Units of acceleration as files name them, converted where a file is read."""

from __future__ import annotations

from pounding.experiments.errors import ExperimentError
from pounding.spelling import did_you_mean, nearest
from pounding.units import ACCELERATION, named, spellings


def to_metric(unit: str, where: str, advice: str = "") -> float:
    """Return how many m/s^2 one unit of acceleration is.

    Args:
        unit: As the file or the user writes it: `m/s^2`, `m_s2`, `gal`, `cm/sec/sec`, `g`, ...
        where: File and line for the message.
        advice: What else the message says, with the mark before it.

    Raises:
        ExperimentError: A unit that is not an acceleration known here.
    """
    known = named(unit)
    if known in ACCELERATION:
        return ACCELERATION[known]
    question = did_you_mean(nearest(unit, spellings(ACCELERATION)))
    hint = f"; {question}" if question else ""
    raise ExperimentError(
        f"{where}: unit '{unit.strip()}' is not an acceleration known here ({', '.join(ACCELERATION)}){hint}{advice}"
    )
