"""What is asked where a name is mistyped: all that are equally near."""

from __future__ import annotations

import pytest

from pounding.frames import names
from pounding.spelling import did_you_mean, nearest
from pounding.toml_text import meant


@pytest.mark.parametrize(
    ("word", "near"),
    [
        ("5X", ["5A", "5B"]),
        ("15c", ["15A", "15B"]),
        (" 15b ", ["15B"]),
        ("5", ["5A", "5B"]),
        ("tower", []),
    ],
)
def test_all_names_that_are_equally_near_are_meant(word: str, near: list[str]) -> None:
    assert nearest(word, names(), 0.5) == near


def test_the_nearest_is_meant_alone_where_others_are_near_too() -> None:
    assert nearest("hachinohi", ["hachinohe", "hachinohe-1968", "kobe"]) == ["hachinohe"]


def test_the_question_names_each() -> None:
    assert did_you_mean([]) == ""
    assert did_you_mean(["5A"]) == "did you mean 5A?"
    assert did_you_mean(["5A", "5B"], repr) == "did you mean '5A' or '5B'?"
    assert did_you_mean(["5A", "5B", "10"]) == "did you mean 5A, 5B or 10?"


def test_an_unknown_key_is_answered_with_the_near_ones_or_with_all() -> None:
    assert meant("stifness_1", ["stiffness_2", "stiffness_3", "mass"]).endswith("stiffness_2 or stiffness_3?")
    assert meant("mass_kg", ["mass_t", "mass_g", "name"]) == "; expected mass_t or mass_g (mind the unit)"
    assert meant("colour", ["mass", "name"]) == "; known are mass, name"
