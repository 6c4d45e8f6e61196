"""Rules for the separation of adjacent buildings, each a function with its source and its limits.

The functions take peak displacements without pounding, heights and periods, and return a gap in the unit of
the displacements or heights that they were given. Three of the rules carry numbers with a unit of their own
(NBCC as printed, Naderpour, GB 50011): these name the unit, and make sense at full scale only.
"""

from __future__ import annotations

import math

from pounding.experiments.errors import ExperimentError

AS1170_FRACTION = 0.01
FEMA_273_FRACTION = 0.04
TBC_REDUCTION = 0.6
TBC_OVERSTRENGTH = 1.4
NADERPOUR_PER_SECOND = 10.5

_GB_HEIGHT_STEP_M = {6: 5.0, 7: 4.0, 8: 3.0, 9: 2.0}
_GB_BASE_M = {2001: 0.070, 2010: 0.100}
_GB_STEEL = 1.5
_GB_LOW_HEIGHT_M = 15.0
_GB_WIDENING_M = 0.020


def absolute_sum(peak_a: float, peak_b: float) -> float:
    """Return ABS, the sum of the peaks (thesis equation 2.26; IBC 2009, Eurocode 8 across a property line).

    Safe by construction when the peaks are those of the motions that come: no phase can ask for more.

    Args:
        peak_a: Peak displacement of one building at the height of contact [any length].
        peak_b: The same of the other building.
    """
    _check_peaks(peak_a, peak_b)
    return peak_a + peak_b


def square_root_of_squares(peak_a: float, peak_b: float) -> float:
    """Return SRSS (thesis equation 2.27; IBC 2009, Eurocode 8 on one property).

    Holds for uncorrelated peaks: it is unsafe for two buildings that peak against each other, and asks for
    1.41 times the displacement of two equal buildings, which need nothing.

    Args:
        peak_a: Peak displacement of one building at the height of contact [any length].
        peak_b: The same of the other building.
    """
    _check_peaks(peak_a, peak_b)
    return math.hypot(peak_a, peak_b)


def nbcc_as_printed(peak_a_mm: float, peak_b_mm: float) -> float:
    """Return the square root of the sum of the peaks [mm^0.5] (thesis equation 2.28, NBCC 2010).

    As printed the rule has no consistent unit: 20 mm and 20 mm give 6.3 with millimetres and 0.2 m = 200 mm
    with metres. The Canadian code itself combines by the square root of the sum of *squares*: an exponent
    was lost.

    Args:
        peak_a_mm: Peak displacement of one building [mm].
        peak_b_mm: The same of the other building [mm].
    """
    _check_peaks(peak_a_mm, peak_b_mm)
    return math.sqrt(peak_a_mm + peak_b_mm)


def taiwan(peak_a: float, peak_b: float) -> float:
    """Return 0.6 times the sum of the inelastic peaks (thesis equation 2.29; TBC 1997, Lin and Weng 2002).

    Args:
        peak_a: Peak (inelastic) displacement of one building [any length]; `taiwan_displacement` makes it
            from the elastic displacement under the design forces. Equal to the elastic peak for a frame that
            stays elastic.
        peak_b: The same of the other building.
    """
    return TBC_REDUCTION * absolute_sum(peak_a, peak_b)


def taiwan_displacement(design_displacement: float, amplification: float, ductility: float) -> float:
    """Return the inelastic displacement 1.4 alpha_y R d_e (thesis equations 2.30 and 2.31).

    Args:
        design_displacement: Elastic displacement under the reduced design forces [any length].
        amplification: First-yield amplification factor alpha_y of the seismic force.
        ductility: Ductility (force reduction) factor R.
    """
    if min(design_displacement, amplification, ductility) < 0.0:
        raise ExperimentError(
            "the displacement, amplification and ductility of the Taiwan rule must not be negative"
        )
    return TBC_OVERSTRENGTH * amplification * ductility * design_displacement


def correlation(period_a: float, period_b: float, damping_a: float, damping_b: float) -> float:
    """Return the correlation coefficient of two oscillators (thesis equation 2.34).

    The equation prints xi for one pair of its zetas: both are the damping ratio. It is symmetric in a and b.

    Args:
        period_a: Natural period of one building [any time]; only the ratio counts.
        period_b: The same of the other building.
        damping_a: Its damping ratio, a fraction.
        damping_b: The same of the other building.

    Returns:
        0 (independent) to 1 (in step).
    """
    if min(period_a, period_b) <= 0.0:
        raise ExperimentError("a natural period must be above zero")
    if min(damping_a, damping_b) <= 0.0:
        raise ExperimentError("a damping ratio must be above zero for the double difference rule")
    ratio = period_a / period_b
    numerator = 8.0 * math.sqrt(damping_a * damping_b) * (damping_a + damping_b * ratio) * ratio**1.5
    denominator = (
        (1.0 - ratio**2) ** 2
        + 4.0 * damping_a * damping_b * (1.0 + ratio**2) * ratio
        + 4.0 * (damping_a**2 + damping_b**2) * ratio**2
    )
    return float(numerator / denominator)


def double_difference(peak_a: float, peak_b: float, coefficient: float) -> float:
    """Return DDC, the spectral difference or CQC rule (thesis equations 2.33; Jeng, Kasai and Maison 1992).

    Holds for two single-mode oscillators in steady random vibration, both moving in phase with the same
    ground; near-field pulses and higher modes lie outside it.

    Args:
        peak_a: Peak displacement of one building at the height of contact [any length].
        peak_b: The same of the other building.
        coefficient: Correlation coefficient, see `correlation`; -1 gives ABS, 0 SRSS.
    """
    _check_peaks(peak_a, peak_b)
    return math.sqrt(max(peak_a**2 + peak_b**2 - 2.0 * coefficient * peak_a * peak_b, 0.0))


def separation_factor(period_a_s: float, period_b_s: float) -> float:
    """Return the separation factor T_long/T_short - 10.5 (T_long - T_short) (thesis equation 2.36, T_a <
    T_b).

    Meant as a correlation coefficient, but it leaves [-1, 1] as soon as the periods differ by some tenths of
    a second, and `double_difference` then asks for more than the absolute sum, which no motion can need. The
    10.5 is a number per second, so the periods are those of the full scale.

    Args:
        period_a_s: First period of one building at full scale [s].
        period_b_s: The same of the other building [s].
    """
    if min(period_a_s, period_b_s) <= 0.0:
        raise ExperimentError("a natural period must be above zero")
    short, long = sorted((period_a_s, period_b_s))
    return long / short - NADERPOUR_PER_SECOND * (long - short)


def height_fraction(height: float) -> float:
    """Return 1 % of the height (thesis equation 2.32; AS 1170.4-2007 clauses 5.4.5 and 5.5.5, ISC 2005).

    The Australian clause is a setback from the boundary, for structures over 15 m; neither code says which
    of two heights counts between two buildings, so both are reported. It knows no shaking.

    Args:
        height: Height of the taller or the shorter building [any length].
    """
    if height <= 0.0:
        raise ExperimentError("a height must be above zero")
    return AS1170_FRACTION * height


def fema_273(peak_a: float, peak_b: float, contact_height: float) -> float:
    """Return FEMA 273's gap: SRSS, but not more than 4 % of the height above grade at the contact (section
    2.11.10).

    Args:
        peak_a: Peak displacement of one building at the height of contact [any length].
        peak_b: The same of the other building.
        contact_height: Height of the possible contact above grade [the same length].
    """
    if contact_height <= 0.0:
        raise ExperimentError("the height of contact must be above zero")
    return min(square_root_of_squares(peak_a, peak_b), FEMA_273_FRACTION * contact_height)


def gb_50011(height_m: float, intensity: int, *, edition: int = 2010, steel: bool = True) -> float:
    """Return the Chinese code's joint width [m] (GB 50011 clause 6.1.4, and 8.1.4 for steel).

    100 mm (70 mm in 2001) for a concrete frame up to 15 m; above, 20 mm more for each further 5, 4, 3 or 2 m
    at intensity 6, 7, 8 or 9; 1.5 times that for steel. The lower building's height counts. A step begun
    counts whole, the safe reading. The thesis shortens this to '0.02 m for seismic intensity levels of 6 to
    9'.

    Args:
        height_m: Height of the lower building at full scale [m].
        intensity: Design intensity, 6 to 9.
        edition: 2001 or 2010.
        steel: Steel structures (1.5 times) or concrete frames.

    Raises:
        ExperimentError: An intensity or edition the code does not have, or no height.
    """
    if intensity not in _GB_HEIGHT_STEP_M:
        raise ExperimentError(f"GB 50011 knows the intensities 6 to 9, not {intensity}")
    if edition not in _GB_BASE_M:
        raise ExperimentError(f"GB 50011 is known here in its editions 2001 and 2010, not {edition}")
    if height_m <= 0.0:
        raise ExperimentError("a height must be above zero")
    above = max(height_m - _GB_LOW_HEIGHT_M, 0.0)
    # A tolerance, so that 21 m at 3 m a step is two steps whatever the last bit of the height.
    steps = math.ceil(above / _GB_HEIGHT_STEP_M[intensity] - 1e-9)
    width = _GB_BASE_M[edition] + _GB_WIDENING_M * steps
    return width * (_GB_STEEL if steel else 1.0)


def gb_intensity(pga_g: float) -> int | None:
    """Return the lowest design intensity of GB 50011 (table 3.2.2) whose basic acceleration reaches
    ``pga_g`` [g].

    Returns:
        6 (0.05 g), 7 (0.10 g), 8 (0.20 g), 9 (0.40 g); None above 0.40 g, where the code asks for special
        study. The half steps 0.15 g and 0.30 g belong to 7 and 8 there, so 0.11 to 0.15 g is 7 and 0.21 to
        0.30 g is 8.
    """
    for intensity, reach in ((6, 0.05), (7, 0.15), (8, 0.30), (9, 0.40)):
        if pga_g <= reach + 1e-12:
            return intensity
    return None


def _check_peaks(peak_a: float, peak_b: float) -> None:
    if not (math.isfinite(peak_a) and math.isfinite(peak_b)) or min(peak_a, peak_b) < 0.0:
        raise ExperimentError(
            f"peak displacements must be finite and not negative, not {peak_a} and {peak_b}: give magnitudes"
        )
