"""Rules that find contradictions in published peaks and gaps, and what they find in the thesis."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pounding.experiments.published import consistency
from pounding.experiments.published.consistency import Contradiction, Pair

signal = st.lists(st.floats(-50, 50), min_size=3, max_size=30)


@given(signal, signal, st.booleans())
def test_bounds_hold_for_any_two_motions(first, second, turned):
    count = min(len(first), len(second))
    u, v = (np.append(np.array(s[:count]), 0.0) for s in (first, second))
    needed = (u - v).max()
    peaks = [(float(s.max()), float(-s.min())) for s in (u, v)]
    if turned:  # sensors that read the other way round swap max and min of both
        peaks = [side[::-1] for side in peaks]
    lower, upper = consistency.bounds_mm(*peaks)
    assert lower - 1e-9 <= needed <= upper + 1e-9


def test_bounds_are_reached():
    # in step: the lower one; in opposite phase: the upper one
    assert consistency.bounds_mm((30.0, 30.0), (5.0, 5.0)) == (25.0, 35.0)


def test_the_published_tables_contradict_15b_under_hachinohe_at_all_three_floors():
    found = consistency.check_published()
    blamed = consistency.contested(found)
    assert blamed == {("15B", "hachinohe")}
    floors = {item.pair.floor for item in found if ("15B", "hachinohe") in item.histories}
    assert floors == {5, 10, 15}
    gap = next(item for item in found if item.rule == "gap too small")
    assert (gap.pair, gap.printed_mm) == (Pair("15B", "10", 10, "hachinohe"), 21)
    assert gap.expected_mm == pytest.approx(28.3 - 4.7)


def test_the_other_contradictions_are_the_known_two():
    rest = [c for c in consistency.check_published() if ("15B", "hachinohe") not in c.histories]
    assert {(str(c.pair), c.rule) for c in rest} == {
        ("10 beside 5B at floor 5 under elcentro", "gap too large"),
        ("5A beside 5B at floor 5 under hachinohe", "abs"),
        ("5A beside 5B at floor 5 under hachinohe", "srss"),
        ("5A beside 5B at floor 5 under hachinohe", "abs against srss"),
    }


def test_sap2000s_own_numbers_have_the_same_contradiction():
    peaks = consistency.published_peaks("numerical")
    found = consistency.check_gaps(peaks, consistency.published_gaps("4.2", "numerical"))
    assert consistency.contested(found) == {("15B", "hachinohe")}


def test_a_slip_of_a_decimal_in_anybodys_table_is_found():
    rng = np.random.default_rng(1)
    frames = {name: rng.normal(size=400).cumsum() for name in "abc"}
    frames = {name: 10 * motion / np.abs(motion).max() for name, motion in frames.items()}
    peaks = {(n, 1, "r"): (float(max(0, m.max())), float(max(0, -m.min()))) for n, m in frames.items()}
    pairs = [Pair(a, b, 1, "r") for a, b in ("ab", "bc", "ac")]
    gaps = {p: float((frames[p.left] - frames[p.right]).max()) for p in pairs}
    assert consistency.check_gaps(peaks, gaps) == []
    high, low = peaks["b", 1, "r"]
    assert consistency.contested(
        consistency.check_gaps(peaks | {("b", 1, "r"): (10 * high, 10 * low)}, gaps)
    ) == {("b", "r")}


def test_one_contradicted_pair_blames_neither_side():
    alone = Contradiction("gap too large", Pair("a", "b", 1, "r"), 12.0, 10.0, "")
    assert consistency.contested([alone, alone]) == set()


def test_rules_are_computed_again():
    peaks = {("a", 1, "r"): (3.0, 2.0), ("b", 1, "r"): (1.0, 4.0)}
    pair = Pair("a", "b", 1, "r")
    assert consistency.check_rule(peaks, {pair: 7.1}, "abs") == []
    assert consistency.check_rule(peaks, {pair: 5.1}, "srss") == []
    assert [c.expected_mm for c in consistency.check_rule(peaks, {pair: 6.4}, "abs")] == [7.0]
    assert consistency.check_rules_together({pair: 7.0}, {pair: math.hypot(3, 4)}) == []
    assert len(consistency.check_rules_together({pair: 7.0}, {pair: 4.5})) == 1


def test_pairs_without_peaks_are_left_out():
    assert consistency.check_gaps({}, {Pair("a", "b", 1, "r"): 3.0}) == []
    assert len(list(consistency.check_published())) == 11
