"""The smallest change that a calibration cannot hide: just beyond what its parameters may do."""

import numpy as np
import pytest

from pounding.diagnosis.design.detectability import _raised, reach_beyond, threshold

REACH, NEEDED = 3.3, 20.0


def information(data: float, own: float) -> float:
    """Return what data of some information say of a change while a parameter that is the same is free within its prior."""
    return 1.0 / (1.0 / data + own**2)


def test_sharp_data_show_what_is_just_beyond_the_priors_however_small_it_is():
    own = np.array([0.1])
    sharp = reach_beyond(information(1e8, 0.1), own, REACH, NEEDED)
    blunt = reach_beyond(information(1e3, 0.1), own, REACH, NEEDED)
    assert sharp == pytest.approx(0.33, rel=1e-2)
    assert blunt > 1.2 * sharp
    # With a prior that ends nowhere it would have to be much larger.
    assert threshold(np.array(information(1e8, 0.1)), NEEDED) > 2 * sharp


def test_what_is_beyond_has_the_evidence_that_is_asked_for():
    data, own = 1e5, 0.1
    size = reach_beyond(information(data, own), np.array([own]), REACH, NEEDED)
    beyond = size - REACH * own
    assert 0.5 * data * beyond**2 == pytest.approx(NEEDED + 0.5 * np.log1p(data), rel=1e-2)


def test_data_that_say_no_more_than_the_prior_show_nothing_beyond_it():
    assert reach_beyond(100.0, np.array([0.1]), REACH, NEEDED) == np.inf


def test_an_amplitude_that_is_imitated_up_to_a_bound_is_raised_just_past_it():
    """Nothing is seen up to 1, and then ten times what is beyond: a stride in proportion would end at 4."""
    raised = _raised(0.5, 100.0, 0.2, lambda amplitude: 0.01 * amplitude + 10.0 * max(amplitude - 1.0, 0.0))
    assert raised == pytest.approx(1.02, rel=0.15)
    assert raised >= 1.018
    assert _raised(0.5, 0.9, 0.2, lambda amplitude: 0.0) is None
