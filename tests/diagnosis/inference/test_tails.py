"""The upper tail of what nulls show: the rate that is asked for is met, with few nulls on the safe side."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.inference.tails import FalseAlarms, Tail

RNG = np.random.default_rng(20261123)


def tail(values: np.ndarray) -> Tail:
    return Tail(tuple(sorted(float(value) for value in values)))


@pytest.mark.parametrize("rate", [0.01, 0.05, 0.1])
@pytest.mark.parametrize("count", [20, 60])
def test_the_rate_is_met_by_fresh_nulls_in_most_sets(rate: float, count: int) -> None:
    """ln Bayes factors of nulls: half a chi-square less what the free parameter costs."""
    fresh = 0.5 * RNG.standard_normal(200_000) ** 2 - 1.5
    alarms = [
        float(np.mean(fresh > tail(0.5 * RNG.standard_normal(count) ** 2 - 1.5).exceeded_by(rate)))
        for _ in range(300)
    ]
    assert np.mean(np.array(alarms) <= rate) > 0.7
    if rate * count >= 1:
        # On the safe side, but not out of reach, where so many nulls can say so.
        assert np.median(alarms) > rate / 10


def test_many_nulls_give_the_quantile_of_their_law() -> None:
    known = tail(RNG.exponential(3.0, 20_000))
    for rate in (0.001, 0.05, 0.5):
        assert known.exceeded_by(rate) == pytest.approx(-3.0 * np.log(rate), rel=0.05)


def test_a_probability_below_the_rate_is_a_figure_above_what_the_rate_asks_for() -> None:
    known = tail(RNG.normal(1.0, 0.01, 40))
    for rate in (0.002, 0.02, 0.05, 0.2):
        limit = known.exceeded_by(rate)
        assert known.probability(limit + 1e-6) < rate < known.probability(limit - 1e-6)
    figures = np.linspace(0.9, 1.2, 100)
    chances = [known.probability(float(one)) for one in figures]
    assert chances == sorted(chances, reverse=True)


def test_nulls_that_all_show_the_same_leave_no_tail() -> None:
    same = Tail((1.0,) * 10)
    assert same.exceeded_by(0.05) == 1.0
    assert same.probability(1.0) == 1.0
    assert same.probability(1.1) == pytest.approx(1 / 11)


def test_names_and_remainders_raise_half_of_the_false_alarms_each() -> None:
    evidence, left = tail(RNG.exponential(5.0, 100)), tail(RNG.normal(1.0, 0.01, 100))
    alarms = FalseAlarms(0.05, evidence, left, "")
    assert alarms.needed == evidence.exceeded_by(0.025)
    limit = alarms.most_by_chance
    assert limit == left.exceeded_by(0.025)
    assert not alarms.too_much(limit - 1e-6)
    assert alarms.too_much(limit + 1e-6)
    nothing = tail(-RNG.exponential(1.0, 100) - 50.0)
    assert FalseAlarms(0.05, nothing, left, "").needed == pytest.approx(np.log(40))


def test_more_candidates_ask_for_more_where_nulls_show_little() -> None:
    """With one half for nothing beforehand and the other for 80 effects alike, one must be 3200 times as likely."""
    nothing, loud = tail(-RNG.exponential(1.0, 100)), tail(RNG.exponential(5.0, 100))
    assert FalseAlarms(0.05, nothing, nothing, "", 80).needed == pytest.approx(np.log(3200))
    assert FalseAlarms(0.05, loud, nothing, "", 80).needed == loud.exceeded_by(0.025) > np.log(3200)
