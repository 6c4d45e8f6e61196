"""`pounding design`: the worked example, the classes, and bad input."""

from __future__ import annotations

import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.separation.rules.design import Site, design


def rule(result: dict, name: str) -> dict:
    found = [entry for entry in result["rules"] if entry["name"].startswith(name)]
    assert len(found) == 1, name
    return found[0]


def test_worked_example() -> None:
    """Sections 7.6.2 and 7.6.3: 154.32, 390, 210 and 256.50 mm with the printed frequencies."""
    result = design(Site(39.0, 21.0, 0.2, tall_frequency_hz=0.466, short_frequency_hz=0.7414))
    assert rule(result, "equation 7.16")["gap_mm"] == pytest.approx(154.32, abs=0.005)
    assert rule(result, "1 % of the taller")["gap_mm"] == pytest.approx(390.0)
    assert rule(result, "1 % of the lower")["gap_mm"] == pytest.approx(210.0)
    assert rule(result, "equation 7.20")["gap_mm"] == pytest.approx(256.50, abs=0.005)
    for name in ("equation 7.16", "equation 7.20"):
        assert rule(result, name)["in_range"]


def test_frequencies_by_7_19_when_not_given() -> None:
    result = design(Site(39.0, 21.0, 0.2))
    assert result["tall"]["frequency_hz"] == pytest.approx(0.46601, abs=1e-5)
    assert result["short"]["frequency_hz"] == pytest.approx(0.74137, abs=1e-5)
    assert rule(result, "equation 7.16")["gap_mm"] == pytest.approx(154.32, abs=0.05)


def test_below_0_2_g_the_equation_is_asked_at_0_2_g() -> None:
    low, at_edge = design(Site(39.0, 21.0, 0.11)), design(Site(39.0, 21.0, 0.2))
    asked = rule(low, "equation 7.16")
    assert asked["gap_mm"] == rule(at_edge, "equation 7.16")["gap_mm"]
    assert "0.2 g" in asked["reason"]
    assert asked["in_range"]
    assert low["pga_used_g"] == 0.2
    assert low["pga_g"] == 0.11
    assert not rule(design(Site(39.0, 21.0, 0.05)), "equation 7.16")["in_range"]


@pytest.mark.parametrize(
    ("pga", "level", "answering"),
    [
        (0.2, "low", "equation 7.16"),
        (0.3, "moderate", "equation 7.17"),
        (0.75, "high", "equation 7.18 and 7.14 with 1470"),
    ],
)
def test_one_class_answers(pga, level, answering) -> None:
    result = design(Site(39.0, 21.0, pga))
    assert result["pga_class"] == level
    assert rule(result, answering)["gap_mm"] > 0.0
    silent = [
        entry for entry in result["rules"] if entry["name"].startswith(("equation 7.16", "equation 7.17"))
    ]
    assert all(entry["gap_mm"] is None for entry in silent if not entry["name"].startswith(answering))


def test_both_readings_of_7_18_are_given() -> None:
    """With the printed 720 E, 7.18 falls to where 7.14 runs backwards and asks for more."""
    result = design(Site(39.0, 21.0, 0.75, tall_frequency_hz=0.466, short_frequency_hz=0.7414))
    followed = rule(result, "equation 7.18 and 7.14 with 1470")
    printed = rule(result, "equation 7.18 and 7.14 with 720")
    predicted = -24.9 - 0.009 * 39000 + 0.024 * 21000 + 1470 * 0.75 - 559 * 0.466 - 98.6 * 0.7414 - 66 * 5
    assert followed["gap_mm"] == pytest.approx(
        30 * (0.054 * (predicted / 30) ** 2 - 1.64 * predicted / 30 + 29.06)
    )
    assert followed["in_range"]
    assert not printed["in_range"]
    assert "1470" in printed["reason"]
    assert printed["gap_mm"] > followed["gap_mm"]


def test_rules_that_need_peaks() -> None:
    without = design(Site(39.0, 21.0, 0.2))
    with_peaks = design(Site(39.0, 21.0, 0.2, tall_mm=120.0, short_mm=90.0))
    assert rule(without, "SRSS")["gap_mm"] is None
    assert "peak displacement" in rule(without, "SRSS")["reason"]
    assert rule(with_peaks, "SRSS")["gap_mm"] == pytest.approx(150.0)
    assert rule(with_peaks, "ABS")["gap_mm"] == pytest.approx(210.0)
    assert not rule(with_peaks, "NBCC")["in_range"]
    assert not rule(with_peaks, "Naderpour")["in_range"]


def test_five_g_is_beyond_every_class() -> None:
    result = design(Site(39.0, 21.0, 5.0))
    assert result["pga_class"] is None
    assert all(
        entry["gap_mm"] is None for entry in result["rules"] if entry["name"].startswith("equation 7.1")
    )
    assert not rule(result, "equation 7.20")["in_range"]
    assert rule(result, "GB 50011")["gap_mm"] is None


def test_equal_buildings_need_nothing_by_the_rule_that_knows_phase() -> None:
    result = design(Site(30.0, 30.0, 0.2, tall_mm=100.0, short_mm=100.0))
    assert rule(result, "DDC")["gap_mm"] == pytest.approx(0.0, abs=1e-4)
    assert not rule(result, "equation 7.16")["in_range"]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"tall_m": 21.0, "short_m": 39.0, "pga_g": 0.2}, "swap"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": 0.0}, "it must be"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": -0.2}, "it must be"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": float("nan")}, "it must be"),
        ({"tall_m": 39.0, "short_m": 0.0, "pga_g": 0.2}, "height"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": 0.2, "tall_frequency_hz": -1.0}, "frequency"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": 0.2, "damping_percent": 0.0}, "damping"),
        ({"tall_m": 39.0, "short_m": 21.0, "pga_g": 0.2, "tall_mm": 100.0}, "of both"),
    ],
)
def test_bad_input(values, said) -> None:
    with pytest.raises(ExperimentError, match=said):
        design(Site(**values))
