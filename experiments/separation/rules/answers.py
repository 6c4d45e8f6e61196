"""Every code rule asked of one pair of buildings: the gap, its basis, and whether it applies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.rules import rules

MM = 1000.0
MID_RISE_M = 15.0
NO_PEAKS = "needs the peak displacement of both buildings at the height of contact"


@dataclass(frozen=True)
class Building:
    """What the rules ask of a building, all at one scale.

    Attributes:
        height_m: Height [m].
        frequency_hz: First natural frequency [Hz].
        damping_ratio: Damping ratio, a fraction.
        peak_m: Peak displacement without pounding at the height of contact [m], or None when not known.
    """

    height_m: float
    frequency_hz: float
    damping_ratio: float
    peak_m: float | None = None

    def __post_init__(self) -> None:
        for value, name in ((self.height_m, "height"), (self.frequency_hz, "frequency")):
            if not 0.0 < value < float("inf"):
                raise ExperimentError(f"the {name} of a building must be above zero and finite, not {value}")
        if not 0.0 < self.damping_ratio < 1.0:
            raise ExperimentError(
                "a damping ratio must lie between 0 and 1 as a fraction (5 % is 0.05), not "
                f"{self.damping_ratio}"
            )
        if self.peak_m is not None and not 0.0 <= self.peak_m < float("inf"):
            raise ExperimentError(f"a peak displacement must not be negative, not {self.peak_m} m")


@dataclass(frozen=True)
class Answer:
    """What one rule says.

    Attributes:
        name: The rule.
        gap_mm: Its gap [mm], or None where it cannot be evaluated.
        basis: What it rests on.
        in_range: Whether it applies to the case asked.
        reason: Why it does not apply, or what to mind.
    """

    name: str
    gap_mm: float | None
    basis: str
    in_range: bool
    reason: str = ""


def code_rules(tall: Building, short: Building, pga_g: float, *, length_scale: float = 1.0) -> list[Answer]:
    """Ask every code rule of sections 2.4 and 2.5.

    Args:
        tall: The taller building (or either of two equally high ones).
        short: The lower one; its height is the height of contact.
        pga_g: Peak ground acceleration [g].
        length_scale: Full-scale length over the length given: 30 for the thesis' models, 1 for buildings.
            Times scale with its square root. Rules with a unit of their own are evaluated at full scale and
            brought back.

    Returns:
        One answer a rule, in the order of the thesis.

    Raises:
        ExperimentError: The tall building is the lower one, or a property that no building has.
    """
    if tall.height_m < short.height_m:
        raise ExperimentError(
            f"the tall building ({tall.height_m:g} m) is lower than the short one ({short.height_m:g} "
            "m): swap them"
        )
    return [
        *_peak_rules(tall, short, length_scale),
        *_height_rules(tall, short, length_scale),
        _fema(tall, short),
        _chinese(short, pga_g, length_scale),
    ]


def _peak_rules(tall: Building, short: Building, length_scale: float) -> list[Answer]:
    peaks = _Peaks(tall.peak_m, short.peak_m)
    return [*_sums(peaks, length_scale), *_double_differences(peaks, tall, short, length_scale)]


class _Peaks(NamedTuple):
    """Peak displacements of both buildings at the height of contact [m], or None where not known."""

    a_m: float | None
    b_m: float | None

    def answer(
        self,
        name: str,
        basis: str,
        gap_mm: Callable[[float, float], float],
        *,
        applies: bool = True,
        reason: str = "",
    ) -> Answer:
        if self.a_m is None or self.b_m is None:
            return Answer(name, None, basis, False, NO_PEAKS)
        return Answer(name, gap_mm(self.a_m, self.b_m), basis, applies, reason)


def _sums(peaks: _Peaks, length_scale: float) -> list[Answer]:
    """Return the rules that add up the peaks or their squares, whatever the periods."""
    return [
        peaks.answer(
            "ABS",
            "absolute sum of the peak displacements (eq 2.26; IBC 2009, Eurocode 8)",
            lambda a, b: MM * rules.absolute_sum(a, b),
        ),
        peaks.answer(
            "SRSS",
            "square root of the sum of squares of the peak displacements (eq 2.27; IBC 2009, Eurocode 8)",
            lambda a, b: MM * rules.square_root_of_squares(a, b),
        ),
        peaks.answer(
            "NBCC as printed",
            "square root of the sum of the peak displacements in mm (eq 2.28; NBCC 2010)",
            lambda a, b: rules.nbcc_as_printed(MM * length_scale * a, MM * length_scale * b) / length_scale,
            applies=False,
            reason=(
                "no consistent unit: the code combines by the root of the sum of squares, an exponent "
                "was lost"
            ),
        ),
        peaks.answer(
            "TBC 1997",
            "0.6 of the sum of the peak inelastic displacements (eq 2.29 to 2.31)",
            lambda a, b: MM * rules.taiwan(a, b),
            reason="the peaks given are taken as the inelastic ones",
        ),
    ]


def _double_differences(peaks: _Peaks, tall: Building, short: Building, length_scale: float) -> list[Answer]:
    """Return the rules that ask how far both buildings move together, by their periods."""
    period_a, period_b = 1.0 / tall.frequency_hz, 1.0 / short.frequency_hz
    rho = rules.correlation(period_a, period_b, tall.damping_ratio, short.damping_ratio)
    time_scale = length_scale**0.5
    factor = rules.separation_factor(period_a * time_scale, period_b * time_scale)
    factor_holds = -1.0 <= factor <= 1.0
    return [
        peaks.answer(
            "DDC",
            f"double difference, complete quadratic combination, correlation {rho:.3f} (eq 2.33 and 2.34)",
            lambda a, b: MM * rules.double_difference(a, b, rho),
        ),
        peaks.answer(
            "Naderpour",
            f"double difference with the separation factor {factor:.3g} (eq 2.35 and 2.36)",
            lambda a, b: MM * rules.double_difference(a, b, factor),
            applies=factor_holds,
            reason="" if factor_holds else f"the factor {factor:.3g} is no correlation: it leaves -1 to 1",
        ),
    ]


def _height_rules(tall: Building, short: Building, length_scale: float) -> list[Answer]:
    low = short.height_m * length_scale < MID_RISE_M
    reason = "the Australian clause speaks of structures over 15 m" if low else ""
    basis = (
        "1 % of the height of the {} building, a setback from the boundary (eq 2.32; AS 1170.4-2007, ISC "
        "2005)"
    )
    return [
        Answer(
            "1 % of the taller height",
            MM * rules.height_fraction(tall.height_m),
            basis.format("taller"),
            tall.height_m * length_scale >= MID_RISE_M,
            reason if tall.height_m * length_scale < MID_RISE_M else "",
        ),
        Answer(
            "1 % of the lower height",
            MM * rules.height_fraction(short.height_m),
            basis.format("lower"),
            not low,
            reason,
        ),
    ]


def _fema(tall: Building, short: Building) -> Answer:
    basis = "SRSS, at most 4 % of the height of contact (FEMA 273, section 2.11.10)"
    if tall.peak_m is None or short.peak_m is None:
        ceiling = MM * rules.FEMA_273_FRACTION * short.height_m
        return Answer("FEMA 273", None, basis, False, f"{NO_PEAKS}; never more than {ceiling:.4g} mm")
    return Answer("FEMA 273", MM * rules.fema_273(tall.peak_m, short.peak_m, short.height_m), basis, True)


def _chinese(short: Building, pga_g: float, length_scale: float) -> Answer:
    intensity = rules.gb_intensity(pga_g)
    basis = (
        "joint width by the lower height and the design intensity, steel (GB 50011-2010 clauses 6.1.4 "
        "and 8.1.4)"
    )
    if intensity is None:
        return Answer("GB 50011", None, basis, False, f"{pga_g:.3g} g is above intensity 9 (0.40 g)")
    width = rules.gb_50011(short.height_m * length_scale, intensity) / length_scale
    return Answer("GB 50011", MM * width, basis, True, f"intensity {intensity} for {pga_g:g} g")
