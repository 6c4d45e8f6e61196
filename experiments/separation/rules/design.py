"""The gap between two buildings at full scale, asked of every rule: what `pounding design` answers."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from pounding import bounds
from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.chapter_7 import equations
from pounding.experiments.separation.chapter_7.equations import (
    CLASSES,
    LENGTH_SCALE,
    LOWEST_PGA_G,
    Level,
    Linear,
)
from pounding.experiments.separation.chapter_7.experience import HELD_OUT_SENTENCE
from pounding.experiments.separation.rules.answers import Answer, Building, code_rules
from pounding.units import LENGTH

MM = 1000.0
DEFAULT_DAMPING_PERCENT = 5.0
TURNING_PGA_G = 18000.0 / (2.0 * 36300.0)
"""Equation 7.16 falls with the acceleration above this [g]."""


LIMITS = (
    "The rules by height know no shaking; the rules by peaks are as good as the peaks given; the "
    "thesis' equations "
    "were fitted to 1:30 models of 5, 10 and 15 storeys under eight records and know of an "
    "earthquake only its peak "
    "acceleration.",
    "Linear steel frames of unequal height on rigid ground; no twist, no yielding, no soil.",
    HELD_OUT_SENTENCE,
)


@dataclass(frozen=True)
class Site:
    """Two buildings and the shaking, at full scale.

    Attributes:
        tall_m: Height of the taller building [m].
        short_m: Height of the lower building [m].
        pga_g: Peak ground acceleration [g].
        tall_frequency_hz: First frequency [Hz]; by equation 7.19 when None.
        short_frequency_hz: First frequency [Hz]; by equation 7.19 when None.
        damping_percent: Damping of both [% of critical].
        tall_mm: Peak displacement of the taller building at the lower one's roof [mm], or None.
        short_mm: Peak displacement of the lower building's roof [mm], or None.
        kt: Factor of equation 7.19: 0.11 steel, 0.075 concrete moment-resisting frames.
    """

    tall_m: float
    short_m: float
    pga_g: float
    tall_frequency_hz: float | None = None
    short_frequency_hz: float | None = None
    damping_percent: float = DEFAULT_DAMPING_PERCENT
    tall_mm: float | None = None
    short_mm: float | None = None
    kt: float = 0.11

    def __post_init__(self) -> None:
        mm = LENGTH["mm"]
        for what, value, bound, per, unit in (
            ("height of the taller building", self.tall_m, bounds.HEIGHT, 1.0, "m"),
            ("height of the lower building", self.short_m, bounds.HEIGHT, 1.0, "m"),
            ("peak ground acceleration", self.pga_g, bounds.PGA, 1.0, "g"),
            ("frequency of the taller building", self.tall_frequency_hz, bounds.FREQUENCY, 1.0, "Hz"),
            ("frequency of the lower building", self.short_frequency_hz, bounds.FREQUENCY, 1.0, "Hz"),
            ("damping", self.damping_percent, bounds.DAMPING_PERCENT, 1.0, "%"),
            ("peak of the taller building", self.tall_mm, bounds.SWAY, mm, "mm"),
            ("peak of the lower building", self.short_mm, bounds.SWAY, mm, "mm"),
        ):
            if value is not None:
                bound.check(value, f"the {what}", ExperimentError, per=per, unit=unit)
        if (self.tall_mm is None) != (self.short_mm is None):
            raise ExperimentError(
                "give the peak displacement of both buildings (--tall-mm and --short-mm) or of none"
            )

    def buildings(self) -> tuple[Building, Building]:
        """Return the taller and the lower building, frequencies filled in."""
        return (
            self._building(self.tall_m, self.tall_frequency_hz, self.tall_mm),
            self._building(self.short_m, self.short_frequency_hz, self.short_mm),
        )

    def _building(self, height_m: float, frequency_hz: float | None, peak_mm: float | None) -> Building:
        if frequency_hz is None:
            frequency_hz = 1.0 / equations.period_s(height_m, kt=self.kt)
        peak_m = None if peak_mm is None else peak_mm / MM
        return Building(height_m, frequency_hz, self.damping_percent / 100.0, peak_m)


def design(site: Site) -> dict[str, Any]:
    """Ask every rule for the gap of two buildings.

    Args:
        site: The buildings and the shaking.

    Returns:
        ``tall`` and ``short`` (``height_m``, ``frequency_hz``, ``period_s``, ``damping_ratio``, ``peak_mm``),
        ``pga_g``, ``pga_class`` ("low", "moderate", "high" or None), ``pga_used_g``, ``pga_classes`` (their
        edges) and ``rules``: a list of ``name``, ``gap_mm`` (or None), ``basis``, ``in_range``, ``reason``.

    Raises:
        ExperimentError: Heights swapped, a peak acceleration that is not above zero, or no building.
    """
    tall, short = site.buildings()
    rules = [*code_rules(tall, short, site.pga_g), *thesis_equations(site, tall, short)]
    asked = [answer.gap_mm for answer in rules if answer.in_range and answer.gap_mm is not None]
    return {
        "tall": _described(tall),
        "short": _described(short),
        "pga_g": site.pga_g,
        "pga_class": equations.level_of(site.pga_g),
        "pga_used_g": max(site.pga_g, LOWEST_PGA_G),
        "pga_classes": {
            level: {"lower_g": lower, "upper_g": upper} for level, (lower, upper) in CLASSES.items()
        },
        "in_range": {
            "count": len(asked),
            "low_mm": min(asked, default=None),
            "high_mm": max(asked, default=None),
        },
        "rules": [asdict(answer) for answer in rules],
        "limits": list(LIMITS),
    }


def thesis_equations(site: Site, tall: Building, short: Building) -> list[Answer]:
    """Return the answers of equations 7.16, 7.17, 7.18 (both readings) with 7.14, and 7.20, at full scale.

    Args:
        site: The site: peak acceleration and damping.
        tall: The taller building.
        short: The lower one.
    """
    values = {
        "HT": MM * tall.height_m,
        "HS": MM * short.height_m,
        "FT": tall.frequency_hz,
        "FS": short.frequency_hz,
        "DT": site.damping_percent,
        "DS": site.damping_percent,
        "E": max(site.pga_g, LOWEST_PGA_G),
    }
    outside = equations.out_of_range(values, full_scale=True)
    if tall.height_m == short.height_m:
        outside.append("the study had unequal heights only")
    heights = {name: values[name] for name in ("HT", "HS")}
    low_only = [] if site.pga_g < CLASSES["low"][1] else [f"fitted to the low class, not to {site.pga_g:g} g"]
    return [
        _fitted(equations.FULL_LOW, site.pga_g, values, outside),
        _fitted(equations.FULL_MODERATE, site.pga_g, values, outside),
        _fitted(equations.FULL_HIGH, site.pga_g, values, outside, reading=" with 1470 E"),
        _fitted(
            equations.FULL_HIGH_AS_PRINTED, site.pga_g, values, outside, reading=" with 720 E as printed"
        ),
        Answer(
            "equation 7.20",
            equations.HEIGHTS_ONLY(**heights),
            "regression on the heights alone, low class; the thesis' suggestion for Australia",
            not (low_only or equations.out_of_range(heights, full_scale=True)),
            "; ".join([*low_only, *equations.out_of_range(heights, full_scale=True)]),
        ),
    ]


def _fitted(
    equation: Linear, pga_g: float, values: dict[str, float], outside: list[str], *, reading: str = ""
) -> Answer:
    high = equation.level == "high"
    name = f"equation {equation.number}{' and 7.14' if high else ''}{reading}"
    basis = f"regression of the thesis' {equation.level} class, {_edges(equation.level)}"
    if not _asked_of(equation.level, pga_g):
        return Answer(name, None, basis, False, f"{pga_g:g} g is not in this class")
    notes = []
    if pga_g < LOWEST_PGA_G:
        notes.append(f"evaluated at {LOWEST_PGA_G} g, as the thesis does below it")
    gap = equation(**values)
    if high:
        model_mm = gap / LENGTH_SCALE
        notes.append(f"7.14 is in model millimetres: {gap:.4g} mm of 7.18 went in as {model_mm:.4g} mm")
        if model_mm < 0.0:
            return Answer(name, None, basis, False, "; ".join([f"7.18 is negative ({gap:.4g} mm)", *outside]))
        if model_mm < equations.LEAST_CORRECTED_MM:
            outside = [
                *outside,
                "left of the least value of 7.14, where a smaller gap by 7.18 makes a larger one",
            ]
        if equation is equations.FULL_HIGH_AS_PRINTED:
            outside = [*outside, "720 E is a misprint: 30 x 49 is 1470"]
        gap = equations.correct_high_full_scale(gap)
    if equation is equations.FULL_LOW and pga_g > TURNING_PGA_G:
        notes.append(f"7.16 falls with the acceleration above {TURNING_PGA_G:.3f} g")
    if gap < 0.0:
        return Answer(name, None, basis, False, "; ".join([f"negative ({gap:.4g} mm)", *outside, *notes]))
    in_class = equations.level_of(pga_g) == equation.level
    if not in_class:
        notes.append(f"{pga_g:g} g lies below every class")
    return Answer(name, gap, basis, in_class and not outside, "; ".join([*outside, *notes]))


def _asked_of(level: Level, pga_g: float) -> bool:
    """Below its lowest class the thesis goes on with the low one; above the highest it has none."""
    if level == "low":
        return pga_g < CLASSES["low"][1]
    return equations.level_of(pga_g) == level


def _edges(level: Level) -> str:
    lower, upper = CLASSES[level]
    closing = "up to and with" if level == "high" else "to below"
    return f"{lower} g {closing} {upper} g"


def _described(building: Building) -> dict[str, Any]:
    return {
        "height_m": building.height_m,
        "frequency_hz": building.frequency_hz,
        "period_s": 1.0 / building.frequency_hz,
        "damping_ratio": building.damping_ratio,
        "peak_mm": None if building.peak_m is None else MM * building.peak_m,
    }
