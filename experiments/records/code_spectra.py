"""Design spectra of codes as targets, and the factor that brings a record to one.

The numbers of EN 1998-1 and AS 1170.4 are in `code_spectra.toml`; those of ASCE 7 and GB 50011 depend on the site alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding import bounds
from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record
from pounding.experiments.records.spectra import response_spectrum
from pounding.toml_text import tree_of

Real = NDArray[np.floating[Any]]

FORMS = {
    "ec8-1": "ec8-1:AG:GROUND, peak on rock [g] and ground type A to E, type 1 spectrum of EN 1998-1",
    "ec8-2": "ec8-2:AG:GROUND, the type 2 spectrum",
    "asce7": "asce7:SDS:SD1 or asce7:SDS:SD1:TL, design accelerations [g] and the long period [s] of ASCE 7-16",
    "gb50011": "gb50011:ALPHAMAX:TG, largest coefficient [g] and characteristic period [s] of GB 50011-2010",
    "as1170": "as1170:KPZ:CLASS, probability factor times hazard factor [g] and site class Ae to Ee of AS 1170.4-2007",
}
"""How a target is written, for each code."""

BELOW, ABOVE = 0.2, 2.0
"""A record is compared with its target from 0.2 times the shortest to twice the longest first period, as EN 1998-1 section
3.2.3.1.2 has it for one building [-]."""

LOOKS = 30
"""Periods at which record and target are compared."""

STEPS = 4.0
"""Periods from so many steps of a record on can be taken from it."""

LONGEST_SHARE = 0.2
"""Periods up to this share of a record's length can be taken from it [-]: five cycles."""


@dataclass(frozen=True)
class Target:
    """A design spectrum.

    Attributes:
        words: What it is.
        at: Returns its pseudo spectral acceleration (m,) [g] at periods (m,) [s].
    """

    words: str
    at: Callable[[Real], Real]

    def factor(self, record: Record, firsts_s: tuple[float, float], time_factor: float = 1.0) -> float:
        """Return what a record's acceleration is multiplied by to meet the target in the mean of the logarithms [-].

        Args:
            record: The record, at the scale of the frames.
            firsts_s: Shortest and longest first period of the buildings, at their scale [s].
            time_factor: What the time of the record was multiplied by [-]; the target holds at full scale.

        Raises:
            ExperimentError: The record is too short, or too coarse, to say what it does at these periods.
        """
        first, last = BELOW * firsts_s[0], ABOVE * firsts_s[1]
        if last > LONGEST_SHARE * record.duration_s or first < STEPS * record.step_s:
            raise ExperimentError(
                f"record {record.name}, {record.duration_s:.3g} s by steps of {record.step_s:.3g} s, says nothing of "
                f"periods from {first:.3g} to {last:.3g} s, at which it is brought to the target (that takes "
                f"{last / LONGEST_SHARE:.3g} s and steps of at most {first / STEPS:.2g} s); leave it out"
            )
        periods = np.geomspace(first, last, LOOKS)
        own = response_spectrum(record, periods, 0.05).pseudo_acceleration_m_s2 / STANDARD_GRAVITY
        return float(np.exp(np.mean(np.log(self.at(periods / time_factor) / own))))


def target(text: str) -> Target:
    """Return a design spectrum from its text, such as ``ec8-1:0.25:B``.

    Args:
        text: See `FORMS`.

    Raises:
        ExperimentError: No such code, ground or number; the sentence says how it is written.
    """
    code, *given = text.split(":")
    if code not in FORMS:
        raise ExperimentError(f"target {text!r}: no such code; write one of {'; '.join(FORMS.values())}")
    try:
        return _made(code, given)
    except ExperimentError:
        raise
    except (KeyError, ValueError, IndexError):
        raise ExperimentError(f"target {text!r} cannot be read; write {FORMS[code]}") from None


def _made(code: str, given: list[str]) -> Target:
    if code == "asce7":
        short, second = (_level(value) for value in given[:2])
        corner = float(given[2]) if len(given) == 3 else np.inf
        if len(given) > 3 or not corner > second / short:
            raise ValueError
        return Target(
            f"ASCE 7-16, SDS {short:g} g, SD1 {second:g} g", lambda t: _asce7(t, short, second, corner)
        )
    first, second_text = given
    level = _level(first)
    if code == "gb50011":
        characteristic = float(second_text)
        if not 0.1 < characteristic < 2.0:
            raise ValueError
        return Target(
            f"GB 50011-2010, alpha_max {level:g} g, Tg {characteristic:g} s",
            lambda t: _gb50011(t, level, characteristic),
        )
    row = _table()[code][second_text]
    if code == "as1170":
        return Target(
            f"AS 1170.4-2007, kp Z {level:g} g, class {second_text}", lambda t: level * _as1170(t, row)
        )
    kind = code.removeprefix("ec8-")
    return Target(
        f"EN 1998-1, type {kind}, {level:g} g, ground {second_text}", lambda t: level * _ec8(t, row)
    )


def _level(text: str) -> float:
    value = float(text)
    bounds.PGA.check(value, "the acceleration of a target", ExperimentError)
    return value


def _ec8(period_s: Real, row: list[float]) -> Real:
    """Return S_e / a_g of EN 1998-1, equations 3.2 to 3.5, for 5 % damping."""
    soil, first, second, third = row
    t = np.asarray(period_s, float)
    return soil * np.select(
        [t <= first, t <= second, t <= third],
        [1.0 + 1.5 * t / first, np.full_like(t, 2.5), 2.5 * second / t],
        2.5 * second * third / t**2,
    )


def _asce7(period_s: Real, short: float, second: float, corner: float) -> Real:
    """Return S_a of ASCE 7-16, section 11.4.6."""
    t, plateau_ends = np.asarray(period_s, float), second / short
    plateau_begins = 0.2 * plateau_ends
    return np.select(
        [t < plateau_begins, t <= plateau_ends, t <= corner],
        [short * (0.4 + 0.6 * t / plateau_begins), np.full_like(t, short), second / t],
        second * (corner if np.isfinite(corner) else 0.0) / t**2,
    )


def _gb50011(period_s: Real, largest: float, characteristic: float) -> Real:
    """Return alpha of GB 50011-2010, figure 5.1.5, for 5 % damping: gamma 0.9, eta_1 0.02, eta_2 1."""
    t, far = np.asarray(period_s, float), 5.0 * characteristic
    return largest * np.select(
        [t < 0.1, t <= characteristic, t <= far],
        [0.45 + 5.5 * t, np.ones_like(t), (characteristic / t) ** 0.9],
        np.maximum(0.2**0.9 - 0.02 * (t - far), 0.0),
    )


def _as1170(period_s: Real, row: list[float]) -> Real:
    """Return C_h of AS 1170.4-2007, Table 6.4."""
    constant, slope, middle, cap, far = row
    t = np.asarray(period_s, float)
    return np.select([t <= 0.1, t <= 1.5], [constant + slope * t, np.minimum(middle / t, cap)], far / t**2)


@cache
def _table() -> dict[str, dict[str, list[float]]]:
    content = (resources.files(__package__) / "code_spectra.toml").read_bytes()
    return tree_of(content, "code_spectra.toml", ExperimentError)
