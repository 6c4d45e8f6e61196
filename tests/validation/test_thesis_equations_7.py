"""Equations 7.2 to 7.20 against their tables and the worked example, and what is wrong in them."""

from __future__ import annotations

import pytest

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.chapter_7 import equations as eq

EXAMPLE = {"HT": 39000.0, "HS": 21000.0, "FT": 0.466, "FS": 0.7414, "DT": 5.0, "DS": 5.0, "E": 0.2}
AT_MODEL_SCALE = {"HT": 1500.0, "HS": 1000.0, "FT": 2.29, "FS": 3.53, "DT": 1.0, "DS": 1.0}


@pytest.mark.parametrize("equation", [e for e in eq.MODEL_SCALE if e.table], ids=lambda e: e.number)
def test_coefficients_are_those_of_the_table(equation) -> None:
    """Sections 7.3.6, 7.5, 7.6.3: each equation takes the significant coefficients of its table, rounded."""
    printed = published.table(equation.table)["coefficient"]
    for symbol, coefficient in {"constant": equation.constant, **equation.terms}.items():
        if equation.number == "7.2" and symbol == "SS":
            assert printed.isna()[symbol], "Table 7.8 prints no coefficient of SS"
            continue
        assert float(printed[symbol]) == pytest.approx(coefficient, rel=0.02), symbol


@pytest.mark.parametrize(
    ("model", "full"),
    [(eq.LOW_ENHANCED, eq.FULL_LOW), (eq.MODERATE_2, eq.FULL_MODERATE), (eq.HIGH_2, eq.FULL_HIGH)],
)
def test_full_scale_equations_are_thirty_times_the_model_ones(model, full) -> None:
    """Section 7.6.1: 30 x constant and E, heights unchanged, frequencies 30 x 5.48, damping 30."""
    factor = {"HT": 1.0, "HS": 1.0, "FT": 30 * 5.48, "FS": 30 * 5.48}
    assert full.constant == pytest.approx(30.0 * model.constant, rel=1e-3)
    for symbol, coefficient in model.terms.items():
        # 39.5 is printed for 39.456, 98.6 for 98.64: three digits.
        assert full.terms[symbol] == pytest.approx(factor.get(symbol, 30.0) * coefficient, rel=2e-3), symbol


def test_only_720_does_not_follow() -> None:
    printed, followed = eq.FULL_HIGH_AS_PRINTED.terms, eq.FULL_HIGH.terms
    assert {symbol for symbol in printed if printed[symbol] != followed[symbol]} == {"E"}
    assert followed["E"] == 30 * eq.HIGH_2.terms["E"]


def test_worked_example_of_7_6_2_and_7_6_3() -> None:
    printed = published.table("section 7.6")["value"]
    assert eq.FULL_LOW(**EXAMPLE) == pytest.approx(printed["equation_7_16_mm"], abs=0.005)
    assert eq.HEIGHTS_ONLY(HT=39000.0, HS=21000.0) == pytest.approx(printed["equation_7_20_mm"], abs=0.005)
    # 2.14586 and 1.34886 s are printed as 2.1458 and 1.3488: cut, not rounded.
    assert eq.period_s(39.0) == pytest.approx(printed["tall_period_s"], abs=1e-4)
    assert eq.period_s(21.0) == pytest.approx(printed["short_period_s"], abs=1e-4)
    assert 1.0 / eq.period_s(39.0) == pytest.approx(printed["tall_frequency_hz"], abs=5e-4)
    assert 1.0 / eq.period_s(21.0) == pytest.approx(printed["short_frequency_hz"], abs=5e-5)


def test_7_16_is_negative_at_0_167_g_and_falls_above_0_248_g() -> None:
    at = {pga: eq.FULL_LOW(**EXAMPLE | {"E": pga}) for pga in (0.167, 0.2, 0.247, 0.249, 0.28)}
    assert at[0.167] < 0.0 < at[0.2] < at[0.247]
    assert at[0.249] > at[0.28]
    turning = eq.FULL_LOW.terms["E"] / (-2.0 * eq.FULL_LOW.terms["E2"])
    assert turning == pytest.approx(0.248, abs=5e-4)


def test_7_14_is_in_model_millimetres() -> None:
    """At the gaps of the study the parabola stays near its argument, at thirty times that it does not."""

    assert eq.correct_high(40.0) == pytest.approx(49.86, abs=0.01)
    assert eq.correct_high_full_scale(1200.0) == pytest.approx(30.0 * eq.correct_high(40.0))
    assert eq.correct_high(1200.0) > 60 * 1200.0
    assert eq.correct_high(eq.LEAST_CORRECTED_MM) == pytest.approx(16.61, abs=0.01)
    assert eq.correct_high(5.0) > eq.correct_high(eq.LEAST_CORRECTED_MM)


def test_classes_and_their_edges() -> None:
    cases = {0.05: None, 0.1: "low", 0.2999: "low", 0.3: "moderate", 0.6: "high", 0.9: "high", 0.901: None}
    assert {pga: eq.level_of(pga) for pga in cases} == cases


def test_missing_symbol_is_named() -> None:
    with pytest.raises(ExperimentError, match=r"7\.5 needs DT, FS"):
        eq.LOW_2(HT=1500.0, E=0.2, FT=2.0, DS=1.0)


def test_range() -> None:
    inside = {"HT": 39000.0, "HS": 21000.0, "FT": 0.466, "FS": 0.7414, "DT": 5.0, "DS": 5.0}
    assert eq.out_of_range(inside, full_scale=True) == []
    assert eq.out_of_range(inside | {"HT": 60000.0}, full_scale=True) == ["HT 6e+04 outside 3e+04 to 4.5e+04"]
    assert len(eq.out_of_range(inside, full_scale=False)) == 4
    assert eq.out_of_range(AT_MODEL_SCALE, full_scale=False) == []


def test_height_must_be_positive() -> None:
    with pytest.raises(ExperimentError, match="height"):
        eq.period_s(0.0)
