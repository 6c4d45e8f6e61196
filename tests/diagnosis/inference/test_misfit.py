"""How far a simulation is from what was measured, and what that is at the rate of the logger."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.misfit import by_frame, expected_noise, over_floor
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData
from tests.diagnosis.models import measured
from tests.diagnosis.pair_models import CONTACT, colliding, model_of


def slowed(model: Model, slower: int) -> Model:
    return Model(model.structure, replace(model.observed, slower=slower), model.prior)


def test_a_gap_over_its_floor_is_their_ratio() -> None:
    model = measured(runs=1)
    assert over_floor(model, np.array([0.02, 0.06]), np.array([0.02, 0.03])) == pytest.approx([1.0, 2.0])


def test_a_model_error_stands_out_less_of_the_noise_that_was_recorded() -> None:
    """White noise of 4 units and an error of 3: at a quarter of the rate the noise is 2, the error as before."""
    recorded = over_floor(measured(runs=1), np.array([5.0]), np.array([4.0]))
    fewer = over_floor(slowed(measured(runs=1), 4), np.array([np.hypot(2.0, 3.0)]), np.array([2.0]))
    assert fewer == pytest.approx(recorded)


@pytest.mark.parametrize(("sizes", "of_range"), [((1.0, 0.3, 0.1), False), ((1.0, 0.9, 0.1), True)])
@pytest.mark.parametrize("is_level", [True, False])
def test_a_run_that_was_not_fitted_is_as_noisy_as_the_others_or_by_the_same_share(
    sizes: tuple[float, ...], of_range: bool, is_level: bool
) -> None:
    """What the three runs show above the modes says which it is, also where the first two, which are fitted, move alike.

    These two do not tell: with `of_range` the noise that is fitted to them is a share of what they measure in any case.
    """
    model = measured(runs=3)
    first, rng = model.observed.runs[0], np.random.default_rng(3)
    still = model.predict(np.zeros(len(model.std)), None, (), [0]).outputs[0]

    def run(size: float) -> RunData:
        loud = 0.02 * (1.0 if is_level else size)
        noise, of_table = (
            loud * one.std(axis=0) * rng.standard_normal(one.shape) for one in (still, first.table)
        )
        return replace(first, measured=size * still + noise, table=size * first.table + of_table)

    model = model.seeing(replace(model.observed, runs=tuple(run(size) for size in sizes)))
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1)), (0, 1))
    loud = filtered.noise[0]
    weak = 1.0 if is_level and not of_range else sizes[1]
    noise = (loud, replace(loud, channel=weak * loud.channel, table=weak * loud.table))
    (unseen,) = expected_noise(model, replace(filtered, noise=noise), [2])
    expected = 0.5 * (1.0 + weak) if is_level else sizes[2]
    assert unseen.channel == pytest.approx(expected * loud.channel, rel=0.05)
    assert unseen.table == pytest.approx(expected * loud.table, rel=0.05)


def test_what_was_not_measured_stays_so() -> None:
    assert np.isnan(over_floor(measured(runs=1), np.array([np.nan]), np.array([0.1]))).all()


def test_what_one_frame_lacks_shows_in_its_own_channels_however_many_others_there_are() -> None:
    model = model_of(colliding(CONTACT))
    stiff = model.observed.floor >= 3
    over = np.where(stiff, 3.0, 1.0)
    over[np.flatnonzero(stiff)[:2]] = np.nan
    assert np.nanmedian(over) == 1.0
    assert by_frame(model, over) == pytest.approx([1.0, 3.0])
    both = by_frame(model, np.stack([over, np.where(stiff, np.nan, 2.0)]))
    np.testing.assert_array_equal(both, [[1.0, 3.0], [2.0, np.nan]])


def test_a_single_frame_has_all_channels() -> None:
    model = measured(runs=1)
    over = np.arange(1.0, len(model.observed.names) + 1)
    assert by_frame(model, over) == pytest.approx([np.median(over)])
