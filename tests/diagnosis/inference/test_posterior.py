"""The one inference: its descent and its evidence on problems whose answers are known."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from pounding.diagnosis.inference import posterior as posterior_module
from pounding.diagnosis.inference.posterior import (
    DAMPED,
    PIVOTS,
    SHORTENED,
    Likelihood,
    Marquardt,
    Posterior,
    Trials,
    add_products,
    bounded_step,
    descend,
    posterior_covariance,
)

RNG = np.random.default_rng(3)
COLUMNS = RNG.normal(size=(40, 3)) * [3.0, 1.0, 0.2]
TRUTH = np.array([0.8, -1.5, 0.4])


class Curve(Likelihood):
    """Data y = J theta + bend (J theta)^2 + unit noise, in two blocks."""

    log_normaliser = -0.5 * 40 * np.log(2 * np.pi)

    def __init__(self, bend: float = 0.0) -> None:
        self.bend = bend
        self.data = self.shown(TRUTH) + np.random.default_rng(4).normal(size=40)

    def shown(self, theta: np.ndarray) -> np.ndarray:
        line = COLUMNS @ theta
        return np.asarray(line + self.bend * line**2)

    def cost(self, theta: np.ndarray) -> float:
        return 0.5 * float(np.sum((self.data - self.shown(theta)) ** 2))

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        slopes = COLUMNS * (1 + 2 * self.bend * (COLUMNS @ theta))[:, None]
        for rows in (slice(0, 15), slice(15, 40)):
            yield (self.data - self.shown(theta))[rows], slopes[rows]

    def settled(self, theta: np.ndarray) -> Curve:
        del theta
        return self


def posterior(*terms: Curve, box: float = np.inf, reach: float = np.inf) -> Posterior:
    return Posterior(tuple(terms), np.full(3, -box), np.full(3, box), np.full(3, reach))


def exact(*terms: Curve) -> np.ndarray:
    information = len(terms) * COLUMNS.T @ COLUMNS + np.eye(3)
    return np.linalg.solve(information, COLUMNS.T @ sum(term.data for term in terms))


@pytest.mark.parametrize("terms", [(Curve(),), (Curve(), Curve())], ids=["one term", "two terms"])
def test_a_linear_problem_is_solved_in_one_step(terms: tuple[Curve, ...]) -> None:
    _, theta = descend(posterior(*terms), np.zeros(3), 1)
    assert theta == pytest.approx(exact(*terms), rel=1e-9)


def test_the_evidence_of_a_linear_problem_is_exact() -> None:
    whole, term = posterior(Curve()), Curve()
    theta = exact(term)
    gram, _ = whole.normal_equations(theta)
    known = multivariate_normal(np.zeros(40), COLUMNS @ COLUMNS.T + np.eye(40)).logpdf(term.data)
    assert whole.log_evidence(theta, gram) == pytest.approx(known, abs=1e-8)


@pytest.mark.parametrize("bend", [0.02, 0.1])
@pytest.mark.parametrize("reach", [0.3, np.inf])
@pytest.mark.parametrize("trials", [DAMPED, SHORTENED, Marquardt()], ids=["damped", "shortened", "Marquardt"])
def test_a_bent_problem_ends_where_its_slope_is_zero(bend: float, reach: float, trials: Trials) -> None:
    whole = posterior(Curve(bend), reach=reach)
    whole, theta = descend(whole, np.zeros(3), 60, trials, enough=1e-10)
    _, slope = whole.normal_equations(theta)
    assert slope - theta == pytest.approx(np.zeros(3), abs=1e-3)
    assert theta == pytest.approx(TRUTH, abs=0.5)


def test_bounds_hold_and_the_rest_makes_the_best_of_it() -> None:
    whole = posterior(Curve(), box=1.0)
    _, theta = descend(whole, np.zeros(3), 20)
    assert theta[1] == pytest.approx(-1.0)
    assert np.abs(theta).max() <= 1.0 + 1e-9
    _, slope = whole.normal_equations(theta)
    free = np.abs(theta) < 1.0 - 1e-6
    assert (slope - theta)[free] == pytest.approx(np.zeros(free.sum()), abs=1e-6)


class Explosive(Curve):
    """A model that blows up a little beyond its start."""

    def cost(self, theta: np.ndarray) -> float:
        return float("nan") if np.abs(theta).max() > 0.2 else super().cost(theta)


def test_a_step_at_which_the_model_blows_up_is_not_taken() -> None:
    _, theta = descend(posterior(Explosive()), np.zeros(3), 10)
    assert np.abs(theta).max() <= 0.2


class Exploded(Explosive):
    """A model whose slopes cannot be had where it blows up."""

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        assert np.isfinite(self.cost(theta))
        return super().blocks(theta)


def test_a_descent_ends_where_it_begins_if_the_model_blows_up_there() -> None:
    _, theta = descend(posterior(Exploded()), np.full(3, 0.5), 10)
    assert theta == pytest.approx(np.full(3, 0.5))


class Worse(Curve):
    """A term that is much less likely wherever it is settled again."""

    def settled(self, theta: np.ndarray) -> Worse | None:  # type: ignore[override]
        return None


def test_a_step_that_a_term_does_not_stand_by_is_taken_back() -> None:
    _, theta = descend(posterior(Worse()), np.zeros(3), 10)
    assert theta == pytest.approx(np.zeros(3))


def test_marquardt_goes_on_from_the_damping_that_helped() -> None:
    policy = Marquardt(first=0.01, least=1e-3, less=10.0, more=6.0, tries=3)
    assert [damping for damping, _ in policy.steps(None)] == pytest.approx([0.01, 0.06, 0.36])
    assert [damping for damping, _ in policy.steps(0.36)] == pytest.approx([0.036, 0.216, 1.296])
    assert policy.steps(0.002)[0] == (pytest.approx(1e-3), 1.0)


def test_products_of_a_long_run_need_no_copy_of_it() -> None:
    columns = np.ones((200_000, 20), np.float32)
    gram, slope, residual = np.zeros((20, 20)), np.zeros(20), np.ones(len(columns))
    tracemalloc.start()
    add_products(gram, slope, columns, residual)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.1 * columns.nbytes
    assert np.all(gram == len(columns))
    assert np.all(slope == len(columns))


def test_products_of_what_blows_up_are_not_finite_and_no_warning() -> None:
    columns = np.array([[1.0, np.inf], [1.0, -np.inf]])
    gram, slope = np.zeros((2, 2)), np.zeros(2)
    add_products(gram, slope, columns, np.ones(2))
    assert gram[0, 0] == 2.0
    assert not np.isfinite(gram[0, 1])
    assert not np.isfinite(slope[1])


def test_slopes_that_are_too_large_for_their_digits_still_give_a_step_inside_the_bounds() -> None:
    """As those of friction that sticks and slips: a crash of the whole diagnosis before."""
    blown = np.array([1e12, 3e11, 7e10])
    precision = np.outer(blown, blown) - 20.0 * np.eye(3)
    lower, upper = -np.ones(3), np.full(3, 0.5)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(precision)
    step = bounded_step(precision, np.array([1e13, -1e13, 1e14]), lower, upper)
    assert np.all((step >= lower) & (step <= upper))


@pytest.mark.parametrize("pivots", [PIVOTS, 0], ids=["all sides at once", "one after the other"])
def test_a_step_between_bounds_is_the_least_of_its_square(
    pivots: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No parameter inside its bounds has a slope left, none at a bound one that leads inside."""
    monkeypatch.setattr(posterior_module, "PIVOTS", pivots)
    rng = np.random.default_rng(3)
    at_bounds = 0
    for count in (1, 5, 40) * 10:
        root = rng.standard_normal((2 * count, count)) * 10.0 ** rng.uniform(-3.0, 3.0, count)
        precision, pull = root.T @ root + np.eye(count), 30.0 * root.T @ rng.standard_normal(2 * count)
        lower, upper = -rng.uniform(0.0, 3.0, count), rng.uniform(0.0, 3.0, count)
        step = bounded_step(precision, pull, lower, upper)
        slope = (pull - precision @ step) / np.sqrt(np.diag(precision))
        inside = (step > lower) & (step < upper)
        assert np.all((step >= lower) & (step <= upper))
        assert np.all(np.abs(slope[inside]) < 1e-6 * np.abs(pull / np.sqrt(np.diag(precision))).max())
        assert np.all(slope[step == lower] <= 0.0)
        assert np.all(slope[step == upper] >= 0.0)
        at_bounds += int((~inside).sum())
    assert at_bounds > 100


class Product(Likelihood):
    """The product of two numbers, known a hundred times better than either: good fits are a long, bent valley."""

    def cost(self, theta: np.ndarray) -> float:
        return 0.5 * float(self._residual(theta) ** 2)

    def _residual(self, theta: np.ndarray) -> float:
        return float(3e4 * (1.0 - (1.0 + 0.03 * theta[0]) * (1.0 + 0.03 * theta[1])))

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        slopes = 3e4 * 0.03 * np.array([[1.0 + 0.03 * theta[1], 1.0 + 0.03 * theta[0]]])
        yield np.array([self._residual(theta)]), slopes


def test_a_descent_follows_a_bent_valley_to_where_the_prior_is_best() -> None:
    free = np.full(2, np.inf)
    start = np.array([3.0, (1.0 / 1.09 - 1.0) / 0.03])
    whole = Posterior((Product(),), -free, free, free)
    assert whole.cost(start) > 8.0
    whole, theta = descend(whole, start, 3)
    assert theta == pytest.approx(np.zeros(2), abs=0.02)
    assert whole.cost(theta) < 0.01


def test_no_rounding_makes_a_variance_negative() -> None:
    """A stuck joint's force and stiffness, with 1e22 times the information of their priors, are all but the same."""
    rng = np.random.default_rng(3)
    for spread in (1e-9, 1e-8, 1e-7):
        one, other, third = rng.normal(size=(3, 50))
        columns = np.column_stack([1e11 * one, 1e11 * (one + spread * other), third])
        variance = np.diag(posterior_covariance(columns.T @ columns))
        assert np.all((variance >= 0.0) & (variance <= 1.0 + 1e-6))
    gram = np.diag([1e22, 3.0, 0.0])
    assert np.diag(posterior_covariance(gram)) == pytest.approx([1e-22, 0.25, 1.0])
    assert np.isnan(posterior_covariance(np.diag([np.inf, 1.0]))).all()
