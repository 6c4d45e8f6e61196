"""The null model by its own motion: what a filter takes of a model's error is no merit of its parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.benchmark.nulls import draw
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.findings import fit_misfits
from pounding.diagnosis.inference.model_checks import strain
from pounding.diagnosis.inference.null_model import by_its_motion
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.inference.problems import PROBLEMS
from tests.diagnosis.models import measured

PROBLEM = {problem.name: problem for problem in PROBLEMS}


@pytest.mark.parametrize("name", ["coulomb_friction", "hysteresis"])
def test_a_frame_that_is_no_linear_one_is_moved_more_like(name: str) -> None:
    model, likeliest = PROBLEM[name].model(), PROBLEM[name].null()
    moved = by_its_motion(model, likeliest)
    before, after = (fit_misfits(model, fit.filtered, (0,)) for fit in (likeliest, moved))
    assert np.median(after) < 0.95 * np.median(before)
    assert moved.log_posterior == likeliest.log_posterior
    assert moved.filtered.noise == likeliest.filtered.noise


def test_the_filter_bends_a_frame_with_friction_more_than_its_motion_asks_for() -> None:
    model, likeliest = PROBLEM["coulomb_friction"].model(), PROBLEM["coulomb_friction"].null()
    moved = by_its_motion(model, likeliest)
    assert strain(model, moved.filtered.values)[0] < strain(model, likeliest.filtered.values)[0]


@pytest.mark.slow
@pytest.mark.guard
def test_a_calibration_does_not_creep_in_the_valley_between_masses_and_the_discrepancy() -> None:
    """Of fifteen storeys; with steps that begin afresh alone the sum is 141, and 285 are lost in log posterior."""
    null = draw(14, 20261123)
    fit = refine(null.model, calibrated(null.model, null.training))
    squares, count = strain(null.model, fit.filtered.values)
    assert squares < count


def test_effects_stay_as_they_are_where_the_frame_is_moved_more_like() -> None:
    model, null = PROBLEM["hysteresis"].model(), PROBLEM["hysteresis"].null()
    cubic = next(one for one in candidates(model) if one.name == "cubic_stiffness" and one.storey == 1)
    values = cubic.values(1e6, ())
    likeliest = refine(model, null.filtered, (cubic,), (values,), thorough=False)
    moved = by_its_motion(model, likeliest)
    before, after = (np.median(fit_misfits(model, fit.filtered, (0,))) for fit in (likeliest, moved))
    assert after < before
    ((effect, kept),) = moved.filtered.effects
    assert effect == cubic
    assert kept == pytest.approx(likeliest.values[0])


def test_a_null_model_that_leaves_noise_stays() -> None:
    model = measured()
    null = refine(model, calibrated(model, [0]))
    assert by_its_motion(model, null) is null


def test_it_stays_where_contacts_push_and_with_reference_runs() -> None:
    model, null = PROBLEM["coulomb_friction"].model(), PROBLEM["coulomb_friction"].null()
    runs = model.observed.runs
    for other in (
        [replace(run, contact=np.zeros((len(run.measured), 1))) for run in runs],
        [replace(run, reference=True) for run in runs],
    ):
        observed = replace(model.observed, runs=tuple(other))
        assert by_its_motion(Model(model.structure, observed, model.prior), null) is null
