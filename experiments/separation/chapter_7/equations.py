"""Equations 7.2 to 7.20 of the thesis: gaps from heights, peak acceleration, frequencies and damping.

The thesis' symbols are kept as keys: HT, HS heights of the tall and the short building [mm], E peak ground
acceleration [g], FT, FS first frequencies [Hz], DT, DS damping ratios [%], ST, SS roof stiffnesses [kN/mm],
MT, MS total masses [kg]. Equations 7.2 to 7.14 and 7.20's coefficients were fitted at model scale (1:30);
7.16 to 7.18 take full-scale heights [mm] and frequencies [Hz] and give full-scale millimetres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from pounding.experiments.errors import ExperimentError
from pounding.scale import THESIS

LENGTH_SCALE = THESIS.buildings_length
FREQUENCY_SCALE = 5.48
"""Model over full-scale frequency as equation 7.15 rounds it: sqrt(30) = 5.477."""

Level = Literal["low", "moderate", "high"]
CLASSES: dict[Level, tuple[float, float]] = {"low": (0.1, 0.3), "moderate": (0.3, 0.6), "high": (0.6, 0.9)}
"""Peak ground acceleration of each class [g]; a lower edge belongs to its class, the upper to the next."""

LOWEST_PGA_G = 0.2
"""Below this the thesis evaluates at this (section 7.6.2: 'values lower than 0.2g are ignored')."""

MODEL_RANGE: dict[str, tuple[float, float]] = {
    "HT": (1000.0, 1500.0),
    "HS": (500.0, 1000.0),
    "FT": (1.80, 3.87),
    "FS": (2.78, 7.62),
    "DT": (0.366, 5.0),
    "DS": (0.366, 5.0),
    "ST": (0.0081, 0.0179),
    "SS": (0.0144, 0.0331),
    "MT": (72.0, 164.2),
    "MS": (34.85, 112.0),
}
"""Range of the thesis' cases at model scale, in the units of the symbols: Table 3.1, its printed rows
(Tables 7.2 to
7.4), masses added by 2, 3 and 4 kg a floor and stiffness raised by up to 20 %."""


@dataclass(frozen=True)
class Linear:
    """A linear equation of chapter 7.

    Attributes:
        number: The thesis' number, as "7.16".
        level: The class of peak ground acceleration that it was fitted to.
        constant: Its constant [mm].
        terms: Coefficient of each symbol [mm per the symbol's unit].
        full_scale: Whether heights, frequencies and the gap are those of buildings or of the 1:30 models.
        table: Table of the thesis that prints its regression.
    """

    number: str
    level: Level
    constant: float
    terms: Mapping[str, float]
    full_scale: bool = False
    table: str = ""
    needs: frozenset[str] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "needs", frozenset(name.rstrip("2") for name in self.terms))

    def __call__(self, **values: float) -> float:
        """Return the gap [mm]; the arguments are the thesis' symbols in the units of this module.

        Raises:
            ExperimentError: A symbol that the equation needs is missing.
        """
        missing = sorted(self.needs - set(values))
        if missing:
            raise ExperimentError(f"equation {self.number} needs {', '.join(missing)}")
        return self.constant + sum(
            coefficient * (values["E"] ** 2 if name == "E2" else values[name])
            for name, coefficient in self.terms.items()
        )


LOW_1 = Linear(
    "7.2",
    "low",
    460.0,
    {"HT": -0.01, "HS": -0.28, "E": 71.0, "FT": -3.83, "FS": 1.32, "DT": -0.57, "DS": -0.17}
    | {"ST": -902.0, "SS": -11082.0, "MS": 0.17},
    table="7.8",
)
MODERATE_1 = Linear(
    "7.3",
    "moderate",
    434.0,
    {"HT": -0.004, "HS": -0.26, "E": 12.3, "FS": 0.76, "DT": -0.64, "DS": -0.84}
    | {"ST": -578.0, "SS": -10500.0, "MS": 0.07},
    table="7.9",
)
HIGH_1 = Linear(
    "7.4",
    "high",
    58.8,
    {"HT": -0.02, "HS": 0.026, "E": 48.87, "FS": -4.39, "DT": -0.99, "DS": -1.36}
    | {"ST": -1611.0, "MT": 0.006, "MS": -0.244},
    table="7.10",
)
LOW_2 = Linear(
    "7.5",
    "low",
    23.0,
    {"HT": -0.005, "E": 57.77, "FT": -4.08, "FS": -1.7, "DT": -0.57, "DS": -0.138},
    table="7.11",
)
LOW_3 = Linear(
    "7.6", "low", -14.0, {"HS": -0.0023, "E": 57.0, "DT": -0.59, "MT": 0.04, "MS": 0.13}, table="7.12"
)
MODERATE_2 = Linear(
    "7.7",
    "moderate",
    16.0,
    {"HT": -0.002, "HS": 0.008, "E": 3.0, "FT": -2.2, "FS": -0.24, "DT": -0.65, "DS": -0.91},
    table="7.13",
)
MODERATE_3 = Linear(
    "7.8",
    "moderate",
    2.0,
    {"HT": 0.001, "HS": 0.007, "E": 4.0, "DT": -0.66, "DS": -0.87, "MT": 0.02, "MS": 0.03},
    table="7.14",
)
HIGH_2 = Linear(
    "7.9",
    "high",
    -0.83,
    {"HT": -0.009, "HS": 0.024, "E": 49.0, "FT": -3.4, "FS": -0.6, "DT": -1.0, "DS": -1.2},
    table="7.15",
)
HIGH_3 = Linear(
    "7.10",
    "high",
    -24.0,
    {"HT": -0.005, "HS": 0.03, "E": 49.0, "DT": -1.0, "DS": -1.2, "MT": 0.04, "MS": -0.07},
    table="7.16",
)
LOW_ENHANCED = Linear(
    "7.13",
    "low",
    -50.7,
    {
        "HT": -0.0028,
        "HS": 0.0066,
        "E": 600.0,
        "FT": -3.59,
        "FS": -0.46,
        "DT": -0.64,
        "DS": -0.5,
        "E2": -1210.0,
    },
    table="7.18",
)
FULL_LOW = Linear(
    "7.16",
    "low",
    -1521.0,
    {"HT": -0.0028, "HS": 0.0066, "E": 18000.0, "FT": -590.2, "FS": -75.6, "DT": -19.2, "DS": -15.0}
    | {"E2": -36300.0},
    full_scale=True,
)
FULL_MODERATE = Linear(
    "7.17",
    "moderate",
    480.0,
    {"HT": -0.002, "HS": 0.008, "E": 90.0, "FT": -361.7, "FS": -39.5, "DT": -19.5, "DS": -27.3},
    full_scale=True,
)
_FULL_HIGH_TERMS = {"HT": -0.009, "HS": 0.024, "FT": -559.0, "FS": -98.6, "DT": -30.0, "DS": -36.0}
FULL_HIGH_AS_PRINTED = Linear("7.18", "high", -24.9, {"E": 720.0} | _FULL_HIGH_TERMS, full_scale=True)
"""With the printed 720 E."""
FULL_HIGH = Linear("7.18", "high", -24.9, {"E": 1470.0} | _FULL_HIGH_TERMS, full_scale=True)
"""With 30 times the 49 E of equation 7.9, which the line above 7.18 in the thesis writes."""
HEIGHTS_ONLY = Linear("7.20", "low", 0.0, {"HT": 0.0013, "HS": 0.0098}, table="7.19")
"""Homogeneous in the heights: the same at every scale."""

MODEL_SCALE: tuple[Linear, ...] = (
    LOW_1,
    LOW_2,
    LOW_3,
    LOW_ENHANCED,
    MODERATE_1,
    MODERATE_2,
    MODERATE_3,
    HIGH_1,
    HIGH_2,
    HIGH_3,
    HEIGHTS_ONLY,
)


LEAST_CORRECTED_MM = 1.64 / (2.0 * 0.054)
"""Predicted gap at which equation 7.14 has its least value [model mm]."""


def correct_high(predicted_mm: float) -> float:
    """Return equation 7.14, the parabola that corrects equation 7.9, both in model millimetres.

    It has a least value of 16.6 mm at a predicted 15.2 mm and rises below: a smaller prediction then asks
    for a wider gap.

    Args:
        predicted_mm: The gap by equation 7.9 [model mm].
    """
    return 0.054 * predicted_mm**2 - 1.64 * predicted_mm + 29.06


def correct_high_full_scale(predicted_mm: float) -> float:
    """Return equation 7.14 for a full-scale gap by 7.18: S/30 goes in, 30 times the result comes out [mm].

    Section 7.6.1 says that 'the value of S derived from Equation 7.18 will be replaced with the value of Y2
    in Equation 7.14'. Put in as it stands, S = 500 mm gives 12,709 mm; the parabola was fitted to model
    millimetres.
    """
    return LENGTH_SCALE * correct_high(predicted_mm / LENGTH_SCALE)


def period_s(height_m: float, *, kt: float = 0.11) -> float:
    """Return the fundamental period 1.25 k_t h^0.75 [s] (thesis equation 7.19; AS 1170.4-2007).

    Args:
        height_m: Height from the base to the uppermost seismic mass [m].
        kt: 0.11 for moment-resisting steel frames, 0.075 for concrete frames.
    """
    if height_m <= 0.0 or kt <= 0.0:
        raise ExperimentError(f"a height must be above zero to give a period, not {height_m:g} m")
    period: float = 1.25 * kt * height_m**0.75
    return period


def level_of(pga_g: float) -> Level | None:
    """Return the class of a peak ground acceleration [g], or None below 0.1 g and above 0.9 g.

    An edge belongs to the class above it; 0.9 g itself to the high one.
    """
    for level, (lower, upper) in CLASSES.items():
        if lower <= pga_g < upper or (level == "high" and pga_g == upper):
            return level
    return None


def out_of_range(values: Mapping[str, float], *, full_scale: bool) -> list[str]:
    """Return the symbols whose values lie outside the thesis' cases, each as a phrase.

    Args:
        values: Thesis' symbols; E is judged by `level_of` and left out here.
        full_scale: Whether heights and frequencies are those of buildings.
    """
    phrases = []
    for name, value in values.items():
        if name not in MODEL_RANGE:
            continue
        lower, upper = MODEL_RANGE[name]
        factor = 1.0
        if full_scale and name in ("HT", "HS"):
            factor = LENGTH_SCALE
        elif full_scale and name in ("FT", "FS"):
            factor = 1.0 / FREQUENCY_SCALE
        lower, upper = lower * factor, upper * factor
        if not lower * (1 - 1e-3) <= value <= upper * (1 + 1e-3):
            phrases.append(f"{name} {value:.4g} outside {lower:.4g} to {upper:.4g}")
    return phrases
