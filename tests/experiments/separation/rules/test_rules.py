"""Separation rules against their sources, their limits, and the motions that they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.rules import rules
from pounding.experiments.separation.rules.answers import Building, code_rules

lengths = st.floats(0.0, 5.0)
ratios = st.floats(0.003, 0.2)
periods = st.floats(0.05, 5.0)


def test_table_4_3_of_the_thesis() -> None:
    """15B beside 10 under El Centro: peaks 12.1 and 6.8 mm (Table 4.1), 19 and 13.9 mm (Table 4.3)."""
    printed = published.table("4.3").loc[("15B", "10", 10)]
    assert rules.absolute_sum(12.1, 6.8) == pytest.approx(printed[("elcentro", "abs")], abs=0.11)
    assert rules.square_root_of_squares(12.1, 6.8) == pytest.approx(printed[("elcentro", "srss")], abs=0.05)


@given(lengths, lengths, periods, periods, ratios, ratios)
def test_double_difference_lies_between_its_limits(a, b, period_a, period_b, ratio_a, ratio_b) -> None:
    rho = rules.correlation(period_a, period_b, ratio_a, ratio_b)
    assert -1e-9 <= rho <= 1.0 + 1e-9
    gap = rules.double_difference(a, b, rho)
    assert abs(a - b) - 1e-6 <= gap <= rules.square_root_of_squares(a, b) + 1e-9
    assert rho == pytest.approx(rules.correlation(period_b, period_a, ratio_b, ratio_a), rel=1e-9)


def test_correlation_is_that_of_two_oscillators_under_white_noise() -> None:
    """Equation 2.34 is the covariance of two oscillators under white noise, over their deviations."""
    period_a, period_b, ratio_a, ratio_b = 0.47, 0.53, 0.02, 0.05
    omega = np.linspace(0.0, 400.0, 400_001)

    def transfer(period, ratio):
        circular = 2.0 * np.pi / period
        return 1.0 / (circular**2 - omega**2 + 2j * ratio * circular * omega)

    a, b = transfer(period_a, ratio_a), transfer(period_b, ratio_b)
    covariance = np.trapezoid((a * b.conj()).real, omega)
    deviations = math.sqrt(np.trapezoid(abs(a) ** 2, omega) * np.trapezoid(abs(b) ** 2, omega))
    assert rules.correlation(period_a, period_b, ratio_a, ratio_b) == pytest.approx(
        covariance / deviations, rel=2e-4
    )


def test_equal_buildings_move_together() -> None:
    assert rules.correlation(0.5, 0.5, 0.02, 0.02) == pytest.approx(1.0)
    assert rules.double_difference(0.1, 0.1, 1.0) == 0.0
    assert rules.separation_factor(0.5, 0.5) == 1.0


def test_separation_factor_leaves_what_a_correlation_can_be() -> None:
    """Half a second beside a whole one: 2 - 5.25, and the rule asks for more than the absolute sum."""
    factor = rules.separation_factor(0.5, 1.0)
    assert factor == pytest.approx(-3.25)
    assert rules.separation_factor(1.0, 0.5) == factor
    assert rules.double_difference(0.1, 0.1, factor) > rules.absolute_sum(0.1, 0.1)


def test_nbcc_as_printed_depends_on_the_unit() -> None:
    assert rules.nbcc_as_printed(20.0, 20.0) == pytest.approx(6.32, abs=0.01)
    in_metres = rules.nbcc_as_printed(0.020, 0.020)
    assert 1000.0 * in_metres == pytest.approx(200.0)


def test_taiwan() -> None:
    displacement = rules.taiwan_displacement(10.0, 1.65, 4.0)
    assert displacement == pytest.approx(1.4 * 1.65 * 4.0 * 10.0)
    assert rules.taiwan(displacement, 0.0) == pytest.approx(0.6 * displacement)
    with pytest.raises(ExperimentError, match="negative"):
        rules.taiwan_displacement(-1.0, 1.0, 1.0)


def test_fema_273_is_capped_by_the_height() -> None:
    assert rules.fema_273(0.3, 0.4, 100.0) == pytest.approx(0.5)
    assert rules.fema_273(0.3, 0.4, 10.0) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("height_m", "intensity", "edition", "steel", "width_mm"),
    [
        (12.0, 8, 2010, False, 100.0),
        (12.0, 8, 2001, False, 70.0),
        (15.0, 9, 2010, False, 100.0),
        (21.0, 8, 2010, False, 140.0),
        (21.0, 8, 2010, True, 210.0),
        (25.0, 6, 2010, False, 140.0),
        (16.0, 9, 2010, False, 120.0),
        (23.0, 7, 2001, True, 165.0),
    ],
)
def test_gb_50011(height_m, intensity, edition, steel, width_mm) -> None:
    width = rules.gb_50011(height_m, intensity, edition=edition, steel=steel)
    assert 1000.0 * width == pytest.approx(width_mm)


def test_gb_50011_refuses_what_it_does_not_know() -> None:
    with pytest.raises(ExperimentError, match="6 to 9"):
        rules.gb_50011(20.0, 5)
    with pytest.raises(ExperimentError, match="editions"):
        rules.gb_50011(20.0, 7, edition=1989)
    assert [rules.gb_intensity(pga) for pga in (0.05, 0.1, 0.2, 0.3, 0.4, 0.41)] == [6, 7, 8, 8, 9, None]


@pytest.mark.parametrize("rule", [rules.absolute_sum, rules.square_root_of_squares, rules.taiwan])
def test_peaks_are_magnitudes(rule) -> None:
    with pytest.raises(ExperimentError, match="magnitudes"):
        rule(-1.0, 2.0)
    with pytest.raises(ExperimentError, match="finite"):
        rule(float("nan"), 2.0)


def test_every_rule_answers_and_says_why_not() -> None:
    answers = code_rules(Building(39.0, 0.466, 0.05), Building(21.0, 0.7414, 0.05), 0.2)
    by_name = {answer.name: answer for answer in answers}
    assert len(by_name) == len(answers) == 10
    for answer in answers:
        assert answer.basis
        assert answer.gap_mm is not None or answer.reason
        assert answer.in_range or answer.reason
    assert by_name["ABS"].gap_mm is None
    assert by_name["1 % of the taller height"].gap_mm == pytest.approx(390.0)
    assert by_name["1 % of the lower height"].gap_mm == pytest.approx(210.0)


def test_rules_do_not_depend_on_the_scale_they_are_asked_at() -> None:
    """A 1:30 model and its building: lengths by 30, times by its square root, and the same gap after that."""
    tall, short = Building(45.0, 0.4, 0.01, 0.6), Building(30.0, 0.63, 0.01, 0.4)
    full = code_rules(tall, short, 0.25)
    time = 30.0**0.5
    model = code_rules(
        Building(1.5, 0.4 * time, 0.01, 0.02),
        Building(1.0, 0.63 * time, 0.01, 0.4 / 30.0),
        0.25,
        length_scale=30.0,
    )
    for at_full, at_model in zip(full, model, strict=True):
        assert at_full.name == at_model.name
        assert at_full.gap_mm == pytest.approx(30.0 * at_model.gap_mm), at_full.name


def test_bad_buildings_are_refused() -> None:
    with pytest.raises(ExperimentError, match="swap"):
        code_rules(Building(10.0, 1.0, 0.05), Building(20.0, 1.0, 0.05), 0.2)
    with pytest.raises(ExperimentError, match="height"):
        Building(0.0, 1.0, 0.05)
    with pytest.raises(ExperimentError, match="fraction"):
        Building(10.0, 1.0, 5.0)
    with pytest.raises(ExperimentError, match="negative"):
        Building(10.0, 1.0, 0.05, -0.1)
