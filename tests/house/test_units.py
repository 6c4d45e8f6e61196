"""Units: what spellings mean, and that the documents list what is read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from scipy.stats import norm

from pounding import units
from pounding.constants import STANDARD_GRAVITY, STD_PER_MAD
from pounding.experiments.measurements.quantities import UNITS

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize(
    ("written", "unit"),
    [
        ("m/s**2", "m/s^2"),
        ("M/S²", "m/s^2"),
        ("ms-2", "m/s^2"),
        ("m_s2", "m/s^2"),
        ("cm / sec / sec", "cm/s^2"),
        ("Gal", "cm/s^2"),
        ("G", "g"),
        ("kn", "kN"),
        ("n/mm", "N/mm"),
        ("mm_s", "mm/s"),
        ("metre", "m"),
        ("parsec", None),
        ("", None),
    ],
)
def test_spellings(written: str, unit: str | None) -> None:
    assert units.named(written) == unit


def test_no_spelling_means_two_units() -> None:
    """`m/s` read as `m_s` must not hide a unit of another kind."""
    kinds = (
        units.LENGTH,
        units.VELOCITY,
        units.ACCELERATION,
        units.FORCE,
        units.MASS,
        units.STIFFNESS,
        units.FREQUENCY,
        units.TIME,
    )
    for kind in kinds:
        assert {units.named(unit) for unit in kind} == set(kind)
    assert sum(len(units.spellings(kind)) for kind in kinds) == len(
        {spelling for kind in kinds for spelling in units.spellings(kind)}
    )


def test_si_is_the_unit_whose_factor_is_one() -> None:
    assert [units.si(kind) for kind in (units.LENGTH, units.ACCELERATION, units.MASS)] == ["m", "m/s^2", "kg"]


def test_the_case_format_lists_the_units_that_are_read() -> None:
    text = (DOCS / "diagnosis" / "case-format.md").read_text(encoding="utf-8")
    told = {}
    for row in re.findall(r"^\| (`.*`) \| (`.*) \|$", text, re.MULTILINE):
        named = re.findall(r"`([^`]+)`", row[0])
        if set(named) <= set(UNITS):
            told |= {key: set(re.findall(r"`([^`]+)`", row[1])) for key in named}
    assert told == {quantity: set(factors) for quantity, factors in UNITS.items()}


def test_the_records_page_lists_the_accelerations_that_are_read() -> None:
    text = (DOCS / "records.md").read_text(encoding="utf-8")
    listed = re.search(r"Units known: (.*?)\.", text)
    assert listed is not None
    assert {units.named(unit) for unit in listed[1].replace(" (gal)", "").split(",")} == set(
        units.ACCELERATION
    )


def test_constants() -> None:
    assert pytest.approx(32.17405, abs=1e-5) == STANDARD_GRAVITY / 0.3048
    assert pytest.approx(1.0 / norm.ppf(0.75), rel=2e-5) == STD_PER_MAD
