import pytest

from pounding.diagnosis.case.place import in_words


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ({"frame": "5B", "storey": 3}, "storey 3 of 5B"),
        ({"frame": "5B", "floor": 3}, "floor 3 of 5B"),
        ({"frame": "5B", "floor": 0}, "the table"),
        ({"frame": "5B"}, "5B"),
        ({"channel": "5B_a3", "frame": "5B", "floor": 3}, "channel 5B_a3"),
        ({"channel": "a, b"}, "channels a, b"),
        ({"contact": 1}, "contact 1"),
        ({"left": "15B", "right": "5B"}, "between 15B and 5B"),
        ({"left": "15B", "right": "5B", "floor": 2}, "floor 2 between 15B and 5B"),
        ({}, ""),
    ],
)
def test_words(place, words):
    assert in_words(**place) == words
