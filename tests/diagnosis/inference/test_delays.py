"""Slopes of delays: with the noise of the readings they are those of the likelihood, and nothing tells of a shift of all."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.delays import late_channels, slopes_of_noise
from pounding.diagnosis.inference.evidence import Score, scales, score
from pounding.diagnosis.inference.filtering import (
    Filtered,
    log_likelihood,
    run_signatures,
    whitened_innovations,
)
from pounding.diagnosis.inference.motions import motions
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured

NUDGE_S = 1e-6


def delays(model: Model) -> list[Effect]:
    return [one for one in candidates(model) if one.name == "sensor_delay"]


def slope(model: Model, filtered: Filtered, effect: Effect) -> float:
    """The slope of the log likelihood by a delay, by differences."""
    early, late = (
        log_likelihood(
            model,
            model.predict(
                filtered.values, filtered.gains, [(effect, np.array([by]))], filtered.runs
            ).innovations,
            filtered.filters,
            filtered.runs,
        )
        for by in (-NUDGE_S, NUDGE_S)
    )
    return (late - early) / (2 * NUDGE_S)


@pytest.mark.parametrize("noise", [0.01, 0.2])
def test_with_the_noise_of_the_readings_a_slope_is_the_likelihoods(noise: float) -> None:
    model = measured(noise=noise, runs=1)
    filtered = calibrated(model, [0])
    (residual,), (motion,) = whitened_innovations(model, filtered), motions(model, filtered)
    added = slopes_of_noise(model, filtered, 0, motion, residual)
    for effect in delays(model):
        terms = effect.terms(model, filtered.run_modes[0], motion, ())
        column = run_signatures(model, filtered, 0, [terms])[:, 0].astype(float)
        ours = late_channels(model, [effect])[-1]
        told, truth = float(column @ residual), slope(model, filtered, effect)
        informed = float(np.linalg.norm(column))
        assert told + added @ ours == pytest.approx(truth, abs=1e-3 * informed)


@pytest.mark.parametrize(("heard_in", "moved"), [(0, False), (1, True)], ids=["reference run", "run since"])
def test_a_score_counts_the_noise_of_the_runs_in_which_an_effect_acts(
    heard_in: int, moved: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first channel's delay is no nuisance parameter, so that nothing but its effect has the slope."""
    model = measured(runs=2, reference=1)
    filtered = calibrated(model, [0, 1])
    first = next(one for one in delays(model) if one.place()["channel"] == "a1")
    sizes = scales(model, filtered)

    def scored(slope: float) -> Score:
        def heard(model: Model, filtered: Filtered, number: int, *rest: object) -> np.ndarray:
            return slope * (number == heard_in) * np.eye(len(model.observed.names))[0]

        monkeypatch.setattr("pounding.diagnosis.inference.evidence.slopes_of_noise", heard)
        return score(model, filtered, [first], sizes).ranked[0]

    without, beside = scored(0.0), scored(1e5)
    assert beside.amplitude - without.amplitude == pytest.approx(moved * 1e5 * without.std**2, rel=1e-6)
