"""The model discrepancy by what it must do: its evidence is the exact one, its scale is found, and it is no effect."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.discrepancy import SCALES, Linearised, averaged
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured

FREE, DISCREPANT, DATA = 2, 4, 30
OURS = np.array([False] * FREE + [True] * DISCREPANT)


def linear(true_scale: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return columns for parameters in units of one, (data, parameters), and data with unit noise."""
    rng = np.random.default_rng(seed)
    columns = 3e3 * rng.standard_normal((DATA, FREE + DISCREPANT))
    spread = np.where(OURS, true_scale, 1e-3)
    return columns, columns @ (spread * rng.standard_normal(len(spread))) + rng.standard_normal(DATA)


@pytest.mark.parametrize("about", ["zero", "elsewhere"])
def test_the_evidence_at_each_scale_is_that_of_the_gaussian(about: str) -> None:
    columns, data = linear(3e-3, 5)
    scale = float(SCALES[4])
    theta = np.zeros(FREE + DISCREPANT) if about == "zero" else np.full(FREE + DISCREPANT, 0.3)
    unit = columns * np.where(OURS, scale, 1e-3)
    residual = data - unit @ theta
    found = Linearised(unit.T @ unit, unit.T @ residual, theta, OURS, scale).log_weights()
    exact = []
    for one in SCALES:
        wide = columns * np.where(OURS, one, 1e-3)
        exact.append(multivariate_normal(cov=wide @ wide.T + np.eye(DATA)).logpdf(data))
    np.testing.assert_allclose(found - found[0], np.array(exact) - exact[0], rtol=1e-6, atol=1e-6)


def test_the_likeliest_scale_is_near_the_true_one_in_the_middle_of_many() -> None:
    found = []
    for seed in range(40):
        columns, data = linear(float(SCALES[5]), seed)
        unit = columns * np.where(OURS, SCALES[3], 1e-3)
        theta = np.zeros(FREE + DISCREPANT)
        found.append(Linearised(unit.T @ unit, unit.T @ data, theta, OURS, float(SCALES[3])).likelier()[0])
    assert np.median(found) == pytest.approx(SCALES[5], rel=0.5)


def test_scales_are_likelier_than_the_own_one_in_the_order_of_their_evidence() -> None:
    columns, data = linear(float(SCALES[5]), 1)
    unit = columns * np.where(OURS, SCALES[3], 1e-3)
    found = Linearised(unit.T @ unit, unit.T @ data, np.zeros(FREE + DISCREPANT), OURS, float(SCALES[3]))
    weights = dict(zip(SCALES.tolist(), found.log_weights(), strict=True))
    in_order = sorted(weights, key=lambda scale: -weights[scale])
    assert found.likelier() == in_order[: in_order.index(float(SCALES[3]))]


def test_a_scale_is_not_taken_for_what_slopes_promise_but_for_what_it_keeps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Slopes know nothing of the ends of the priors, at which a narrow discrepancy leaves a frame that is another one."""
    model = other_frame(0.02)
    null = refine(model, calibrated(model, (0,)))
    wide = null.filtered.discrepancy
    asked = []

    def every_scale(found: Linearised) -> list[float]:
        asked.append(found.scale)
        return [float(SCALES[0]), *map(float, SCALES)]

    monkeypatch.setattr(Linearised, "likelier", every_scale)
    again = refine(model, null.filtered, thorough=False)
    assert asked == [wide]
    assert again.filtered.discrepancy > 0.2 * wide > 2 * SCALES[0]
    assert again.log_posterior > null.log_posterior - 1.0


def test_evidence_is_the_mean_over_the_scales() -> None:
    assert averaged(np.full(len(SCALES), -3.0)) == pytest.approx(-3.0)
    assert Linearised(np.eye(2), np.ones(2), np.zeros(2), np.zeros(2, bool), 1.0).gained() == 0.0


def other_frame(size: float) -> Model:
    """Return the bench with data of a frame whose modes are not quite those of the model."""
    plain = measured(samples=50, runs=1)
    values = np.where(plain.discrepant, size * np.random.default_rng(3).standard_normal(len(plain.std)), 0.0)
    return measured(values=values, noise=0.005)


def test_a_frame_that_is_not_quite_the_model_lacks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    model = other_frame(0.01)
    names = ("stiffness_change", "added_mass", "hysteresis", "cubic_stiffness")
    effects = [one for one in candidates(model) if one.name in names]
    found = search(model, effects, [0], [1], lambda what, share: None)
    assert found.null.fit.filtered.discrepancy > 2e-3
    assert max((one.ln_bayes for one in found.judged), default=0.0) < 12.0
    # Without a place for the model's error the same data are far less likely.
    monkeypatch.setattr("pounding.diagnosis.inference.discrepancy.SCALES", np.array([1e-6]))
    without = refine(model, calibrated(model, (0,)))
    assert without.log_posterior < found.null.fit.log_posterior - 30.0


def test_a_frame_that_is_the_model_has_hardly_any_discrepancy() -> None:
    model = measured()
    null = refine(model, calibrated(model, (0,)))
    assert null.filtered.discrepancy < 1e-3
