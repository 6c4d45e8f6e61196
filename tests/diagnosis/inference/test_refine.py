"""Refinement by what it must do: find the parameters that made the data from any start, and nothing where nothing is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.refine import ALONE, Race, refine
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.predictor import ACCELERATION
from tests.benchmarks.diagnosis_cost import BASE, made, modelled, stiffening
from tests.diagnosis.inference.problems import NOTHING, PROBLEMS, Problem, catalogue

STARTS = (0.7, 1.4)
"""Multiples of the true size from which a refinement starts."""


@pytest.mark.parametrize("problem", PROBLEMS, ids=str)
def test_the_parameters_that_made_the_data_are_found(problem: Problem) -> None:
    fit = problem.fitted(STARTS[0])
    (values,), (std,) = fit.values, fit.std
    stated, truth = slice(problem.reported), np.array(problem.truth)
    assert (std[stated] < 0.15 * np.abs(truth[stated])).all()
    assert (np.abs(values - truth)[stated] < 3.5 * std[stated]).all()
    assert fit.log_posterior > problem.null().log_posterior + 30.0


@pytest.mark.parametrize("problem", PROBLEMS, ids=str)
def test_another_start_leads_to_the_same_optimum(problem: Problem) -> None:
    one, other = (problem.fitted(factor) for factor in STARTS)
    assert one.log_posterior == pytest.approx(other.log_posterior, abs=0.5)
    assert (np.abs(one.values[0] - other.values[0]) < 0.1 * one.std[0])[: problem.reported].all()


@pytest.mark.parametrize("storey", [1, 3])
def test_a_bad_start_leaves_no_noise_behind(storey: int) -> None:
    """What is far off at the start was taken for noise, and a good fit had thousands less likelihood than none."""
    weak = Problem("stiffness_change", storey, (-0.15,))
    fits = [weak.fitted(factor) for factor in (1.0, 1.4, 3.0, -1.0)]
    assert fits[0].log_posterior > weak.null().log_posterior + 3.0
    for fit in fits[1:]:
        assert fit.log_posterior == pytest.approx(fits[0].log_posterior, abs=0.5)


@pytest.mark.parametrize("problem", PROBLEMS, ids=str)
def test_an_effect_that_is_not_in_the_data_gets_no_evidence(problem: Problem) -> None:
    null, size = NOTHING.null(), np.array(problem.truth)
    fit = refine(NOTHING.model(), null.filtered, (problem.effect,), (0.3 * size,), (np.abs(size),))
    assert fit.log_posterior < null.log_posterior + 1.0
    assert abs(fit.values[0][0]) < 0.1 * abs(size[0]) or abs(fit.values[0][0]) < 3 * fit.std[0][0]


@pytest.mark.parametrize(
    ("ahead", "reached", "before", "lost"),
    [(1000.0, 240.0, 0.0, True), (1000.0, 260.0, 0.0, False), (1000.0, 999.0, 1200.0, True), (900.0, 999.0, 1200.0, False)],
)  # fmt: skip
def test_what_gained_less_than_a_quarter_of_another_has_lost(
    ahead: float, reached: float, before: float, lost: bool
) -> None:
    assert Race(ahead).lost(reached, before) == lost
    assert not ALONE.lost(reached, before)


@pytest.mark.parametrize(
    ("reached", "last", "stopped"),
    [(600.0, 500.0, True), (600.0, 460.0, False), (760.0, 759.0, False), (740.0, 700.0, True), (1001.0, 1000.0, False)],
)  # fmt: skip
def test_what_lacks_much_and_gains_little_has_stopped(reached: float, last: float, stopped: bool) -> None:
    """More than a third of what it has gained must be lacking, and more than three times what it gained last."""
    assert Race(1000.0).stopped(reached, 0.0, last) == stopped
    assert not ALONE.stopped(reached, 0.0, last)


def test_what_explains_little_beside_another_is_not_converged_and_what_may_come_near_is() -> None:
    problem = Problem("cubic_stiffness", 1, (4e8,))
    model, null = problem.model(), problem.null()
    right = problem.fitted(STARTS[0])
    wrong = next(one for one in catalogue() if one.name == "cubic_stiffness" and one.storey == 3)
    about, ahead = null.filtered.log_likelihood, right.filtered.log_likelihood

    def refined(race: Race) -> tuple[float, bool]:
        fit = refine(model, null.filtered, (wrong,), (np.array(problem.truth),), race=race)
        return fit.filtered.log_likelihood, fit.to_the_end

    whole, ended = refined(ALONE)
    assert ended
    little, ended = refined(Race(ahead, about))
    assert little < whole
    assert not ended
    # The same fit of the same data, but little is ahead of it.
    assert refined(Race(whole + 5.0, about)) == (pytest.approx(whole, abs=0.5), True)


def test_the_null_model_of_its_own_data_stays_at_the_baseline() -> None:
    null = NOTHING.null()
    assert np.abs(null.filtered.values / NOTHING.model().std).max() < 0.5
    again = refine(NOTHING.model(), null.filtered, (), (), ())
    assert again.log_posterior == pytest.approx(null.log_posterior, abs=0.5)


@pytest.mark.parametrize("problem", PROBLEMS[:3], ids=str)
def test_latent_forces_give_back_what_they_took_of_the_noise(problem: Problem) -> None:
    """Noise of accelerations and latent forces are hard to tell apart: fits ended with all of it in the forces."""
    model, start = problem.model(), problem.null().filtered
    (noise,) = starting_noise(model, (0,), 0.1)
    taken = replace(
        noise, channel=np.where(model.observed.quantity == ACCELERATION, 0.02, 1.0) * noise.channel
    )
    size = np.array(problem.truth)
    fits = [
        refine(
            model,
            run_filter(model, start.values, [one], start.runs),
            (problem.effect,),
            (size,),
            (np.abs(size),),
        )
        for one in (noise, taken)
    ]
    assert fits[1].log_posterior == pytest.approx(fits[0].log_posterior, abs=5.0)


@pytest.mark.slow
@pytest.mark.guard
def test_where_a_fit_of_a_tall_frame_begins_does_not_matter() -> None:
    """Slopes that were not the likelihood's ended it in places that depended on the forces it began with."""
    model = modelled(made(replace(BASE, frame="10")))
    effect, truth = stiffening(model)
    begins = (
        run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1), level), (0, 1))
        for level in (0.1, 0.003)
    )
    one, other = (refine(model, begin, (effect,), (1.04 * truth,)) for begin in begins)
    assert one.log_posterior == pytest.approx(other.log_posterior, abs=5.0)
    for fit in (one, other):
        assert fit.std[0][0] < 0.025 * fit.values[0][0]
        assert abs(fit.values[0][0] - truth[0]) < 2 * fit.std[0][0]
