"""Histories as a term of the inference: what they keep of a long run, and for how long."""

from __future__ import annotations

import weakref

import numpy as np

from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.starting import starting_noise
from tests.diagnosis.models import measured


def test_only_those_asked_last_keep_signatures_and_others_make_the_same_again() -> None:
    model = measured([], runs=1)
    noise = starting_noise(model, (0,), 0.003)
    first, second = (
        run_filter(model, values, noise, (0,)) for values in (np.zeros(len(model.std)), 0.1 * model.std)
    )
    coordinates = Coordinates.of(model, (), (), (), discrepancy=first.discrepancy)
    one, other = (Histories(model, filtered, coordinates) for filtered in (first, second))
    theta = coordinates.theta(first.values)

    before = one.normal_equations(theta)
    kept = weakref.ref(one.nuisance_columns()[0])
    assert kept() is not None
    there = other.normal_equations(coordinates.theta(second.values))
    assert kept() is None
    assert not np.array_equal(there[0], before[0])
    again = one.normal_equations(theta)
    np.testing.assert_array_equal(again[0], before[0])
    np.testing.assert_array_equal(again[1], before[1])
