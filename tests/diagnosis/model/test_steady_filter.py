"""The steady filter is the Kalman filter of its system: its Riccati equation, its optimality, white innovations.

Each property is asserted of the filter's gain and denied of no gain and of gains 10 % off, so that a test which any gain
would pass is noticed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.kalman import (
    Gain,
    Noise,
    SteadyFilter,
    discretise,
    linear_system,
    noise_density,
    steady_filter,
)
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.predictor import ABSOLUTE_DISPLACEMENT
from tests.diagnosis.models import STEP_S, in_the_room, measured

WRONG = (0.0, 0.9, 1.1)
"""Factors on the gain."""
SAMPLES = 6000


@dataclass(frozen=True)
class Sampled:
    """The system x' = A x + w, y = C x + v sampled at `STEP_S`, with the filter that is tested.

    Attributes:
        step: A (states, states). driving: Covariance of w. output: C (channels, states). noise: Covariance of v.
        size: Standard deviation of each state, by which it is scaled to one.
        filter: The filter. whole: That of all states, of which those that no channel sees are not estimated.
    """

    step: np.ndarray
    driving: np.ndarray
    output: np.ndarray
    noise: np.ndarray
    size: np.ndarray
    filter: SteadyFilter
    whole: SteadyFilter

    def is_stable(self, gain: np.ndarray) -> bool:
        """Return whether errors of the prediction fade."""
        closed = self.step @ (np.eye(len(self.step)) - gain @ self.output)
        return bool(np.abs(np.linalg.eigvals(closed)).max() < 1.0)

    def predicted(self, gain: np.ndarray) -> np.ndarray:
        """Return the covariance of the one-step prediction that any stable gain has (Joseph's form, scaled)."""
        a, q = self.step * self.size / self.size[:, None], self.driving / np.outer(self.size, self.size)
        c, k = self.output * self.size, gain / self.size[:, None]
        return solve_discrete_lyapunov(a @ (np.eye(len(a)) - k @ c), q + a @ k @ self.noise @ k.T @ a.T)

    def innovation(self, gain: np.ndarray) -> np.ndarray:
        """Return the covariance of the innovations that any stable gain has (channels, channels)."""
        c = self.output * self.size
        return c @ self.predicted(gain) @ c.T + self.noise


@pytest.fixture(scope="module", params=["from the table", "in the room"])
def model(request: pytest.FixtureRequest) -> Model:
    found = measured(samples=SAMPLES, runs=1)
    return found if request.param == "from the table" else in_the_room(found)


@pytest.fixture(scope="module")
def sampled(model: Model) -> Sampled:
    """Latent forces of some newtons, so that predictions without a gain are far off."""
    modes = model.modes(model.assemble(np.zeros(len(model.std))))
    rms = model.observed.rms(model.observed.runs[0])
    noise = Noise(latent=np.array([5.0, 3.5, 2.0]), table=0.005, channel=0.02 * rms)
    system = linear_system(
        modes, model.structure.drift @ modes.floors, model.observed.quantity, model.observed.floor
    )
    step, driving = discretise(system.rate, noise_density(len(system.rate), noise), STEP_S)
    whole = steady_filter(system, noise, STEP_S)
    # The table's displacement and velocity are estimated where a channel sees them, and else drift for themselves.
    count = len(step) - (0 if ABSOLUTE_DISPLACEMENT in model.observed.quantity else 2)
    step, driving, output = step[:count, :count], driving[:count, :count], system.output[:, :count]
    assert not np.any(system.output[:, count:])
    assert not np.any(whole.gain[count:])
    found = replace(
        whole, gain=whole.gain[:count], step=whole.step[:count, :count], updated=whole.updated[:count, :count]
    )
    size = np.sqrt(np.diag(solve_discrete_lyapunov(step, driving)))
    assert found.step == pytest.approx(step)
    return Sampled(step, driving, output, np.diag(noise.channel**2), size, found, whole)


def riccati_residual(sampled: Sampled, gain: np.ndarray) -> float:
    """Return the largest of A P A' - A P C' (C P C' + R)^-1 C P A' + Q - P, states scaled to one."""
    p = sampled.predicted(gain)
    a = sampled.step * sampled.size / sampled.size[:, None]
    c = sampled.output * sampled.size
    q = sampled.driving / np.outer(sampled.size, sampled.size)
    seen = c @ p @ a.T
    residual = a @ p @ a.T - seen.T @ np.linalg.solve(c @ p @ c.T + sampled.noise, seen) + q - p
    return float(np.abs(residual).max())


def test_the_covariance_of_its_gain_solves_the_riccati_equation(sampled: Sampled) -> None:
    # 1e-15 on this machine; a gain 1 % off leaves 2e-5.
    assert riccati_residual(sampled, sampled.filter.gain) < 1e-10
    for factor in WRONG:
        assert riccati_residual(sampled, factor * sampled.filter.gain) > 1e-4


def test_its_covariances_are_those_that_its_gain_has(sampled: Sampled) -> None:
    steady = sampled.filter
    p = sampled.predicted(steady.gain)
    assert steady.covariance == pytest.approx(sampled.innovation(steady.gain), rel=1e-9)
    # K S = P C'.
    crossed = steady.gain @ steady.covariance / sampled.size[:, None]
    assert crossed == pytest.approx(p @ (sampled.output * sampled.size).T, abs=1e-9 * np.abs(crossed).max())
    left = p - crossed @ np.linalg.solve(steady.covariance, crossed.T)
    assert np.diag(steady.updated) / sampled.size**2 == pytest.approx(np.diag(left), rel=1e-6)


def test_noise_that_leaves_no_filter_is_said_in_one_sentence(model: Model) -> None:
    system = model.linear_system(model.modes(model.assemble(np.zeros(len(model.std)))))
    noise = Noise(np.full(3, 1e200), 0.005, 0.02 * model.observed.rms(model.observed.runs[0]))
    with (
        np.errstate(all="ignore"),
        pytest.raises(CaseError, match="no filter follows from the noise of the channels"),
    ):
        steady_filter(system, noise, STEP_S)


def test_no_other_gain_has_smaller_innovations(sampled: Sampled) -> None:
    weight = np.linalg.inv(sampled.noise)  # channels have different units
    gain = sampled.filter.gain
    least = np.trace(weight @ sampled.innovation(gain))
    rng = np.random.default_rng(11)
    others = [factor * gain for factor in WRONG]
    others += [gain * (1.0 + 0.1 * rng.standard_normal(gain.shape)) for _ in range(20)]
    others += [gain + 1e-3 * sampled.size[:, None] * rng.standard_normal(gain.shape) for _ in range(5)]
    stable = [other for other in others if sampled.is_stable(other)]
    assert len(stable) > 10
    for other in stable:
        assert np.trace(weight @ sampled.innovation(other)) > least * (1.0 + 1e-6)


@pytest.fixture(scope="module")
def innovations(model: Model, sampled: Sampled) -> Callable[[float], np.ndarray]:
    """The program's own prediction of data that the system made, its innovations whitened, by the factor on the gain."""
    rng = np.random.default_rng(3)
    scaled = sampled.driving / np.outer(sampled.size, sampled.size)
    driven = np.linalg.cholesky(scaled + 1e-13 * np.eye(len(scaled))) * sampled.size[:, None]
    series = rng.standard_normal((SAMPLES, len(sampled.output))) * np.sqrt(np.diag(sampled.noise))
    state = np.zeros(len(sampled.step))
    for k in range(SAMPLES):
        series[k] += sampled.output @ state
        state = sampled.step @ state + driven @ rng.standard_normal(len(state))
    run = replace(model.observed.runs[0], table=np.zeros(SAMPLES), measured=series)
    at_rest = Model(model.structure, replace(model.observed, runs=(run,)), model.prior)
    factor = np.linalg.inv(np.linalg.cholesky(sampled.filter.covariance))

    def whitened(share: float) -> np.ndarray:
        modes = at_rest.modes(at_rest.assemble(np.zeros(len(at_rest.std))))
        gains = [Gain(share * sampled.whole.gain, modes)]
        found = at_rest.predict(np.zeros(len(at_rest.std)), gains, (), (0,)).innovations[0]
        return np.asarray(found @ factor.T)

    return whitened


def correlation(white: np.ndarray) -> float:
    """Return the largest correlation of neighbouring samples in units of its standard deviation, were they white."""
    return float(np.abs(white[1:].T @ white[:-1]).max() / np.sqrt(len(white)))


def test_innovations_of_data_from_the_system_are_white_and_of_the_stated_size(
    innovations: Callable[[float], np.ndarray],
) -> None:
    white = innovations(1.0)
    # Four standard deviations of a variance or covariance of so many samples.
    assert white.T @ white / SAMPLES == pytest.approx(np.eye(white.shape[1]), abs=4 * np.sqrt(2 / SAMPLES))
    assert correlation(white) < 4
    for factor in WRONG:
        # A gain 10 % off is six standard deviations from white, no gain tens of thousands.
        assert correlation(innovations(factor)) > 5
