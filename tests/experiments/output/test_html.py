"""What a report says of the parameters that it was asked with."""

from __future__ import annotations

import pytest

from pounding.experiments.output.html import three_digits, worded


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "not given"),
        (True, "yes"),
        (False, "no"),
        (0.0046700001, "0.00467"),
        (5, "5"),
        ([], "none"),
        ([0.005, 0.01], "0.005, 0.01"),
        (["a", "b"], "a; b"),
        ([{"frame": "15B", "state": None}, {"frame": "5B", "state": "sweep"}], "frame 15B; frame 5B, state sweep"),
        ([{"gap_mm": 60.0, "tension": False, "floors": []}] * 2, "gap_mm 60 (all 2)"),
        ([0.01, 0.01], "0.01, 0.01"),
    ],
)  # fmt: skip
def test_parameters_stand_in_words(value: object, words: str) -> None:
    assert worded(value) == words


def test_small_and_large_forces_stand_in_one_table() -> None:
    assert [three_digits(value) for value in (0.2381, 55.12, 990.4, 19009.5)] == [
        "0.238",
        "55.1",
        "990",
        "19,010",
    ]
