"""One inference for every kind of data: Gaussian parameters, sums of squares, one descent, one evidence.

The parameters theta are nuisance parameters and effects (or the numbers of a contact), each in units of its prior's
standard deviation and centred on the prior's mean. Each kind of data is a `Likelihood`: histories, impacts, modal data
and peaks are terms of one sum. The maximum is found by damped Gauss-Newton steps inside bounds (Levenberg 1944,
Marquardt 1963), and the evidence is Laplace's approximation about it (MacKay 1992).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np
from scipy.optimize import lsq_linear
from scipy.special import log_ndtr

from pounding.diagnosis.settings import SETTINGS


class Trials(Protocol):
    """Which steps a descent tries in turn."""

    def steps(self, last: float | None) -> Sequence[tuple[float, float]]:
        """Return damping, as a share of the information's diagonal, and share of the step taken, of each step.

        Args:
            last: Damping of the last step that helped; None before the first.
        """


@dataclass(frozen=True)
class Afresh:
    """The same steps at each iteration, whatever helped before."""

    each: tuple[tuple[float, float], ...]

    def steps(self, last: float | None) -> Sequence[tuple[float, float]]:
        """Return the steps."""
        del last
        return self.each


@dataclass(frozen=True)
class Marquardt:
    """Damping that goes on from where it helped: a tenth of it, then six times as much in turn (Marquardt 1963)."""

    first: float = 1e-2
    least: float = 1e-6
    less: float = 10.0
    more: float = 6.0
    tries: int = 6

    def steps(self, last: float | None) -> Sequence[tuple[float, float]]:
        """Return whole steps of growing damping."""
        start = self.first if last is None else max(last / self.less, self.least)
        return [(start * self.more**number, 1.0) for number in range(self.tries)]


DAMPED = Afresh(((0.0, 1.0), (0.1, 1.0), (1.0, 1.0), (10.0, 1.0)))
SHORTENED = Afresh(((0.0, 1.0), (0.0, 0.5), (0.0, 0.2), (0.0, 0.05)))
"""Damping turns a step towards the slope, which helps about kinks; far from a maximum, as a calibration begins, shorter
steps in the direction of Gauss and Newton get further."""
PIECE = 2048
"""Rows of which products are taken at a time."""
CORRECTIONS = 3
"""Times that a step which left a bent valley is led back into it."""
PIVOTS = 30
"""Guesses which parameters end at a bound, before it is asked of one after the other."""


class Likelihood(Protocol):
    """One kind of data: minus its log likelihood is half a sum of squares of whitened residuals, less `log_normaliser`."""

    @property
    def log_normaliser(self) -> float:
        """What the log likelihood has beside the sum of squares, up to a constant of the data."""
        return 0.0

    def cost(self, theta: np.ndarray) -> float:
        """Return half the sum of squares; infinite where the model blows up.

        Args:
            theta: The parameters in units of their priors, shape (parameters,).
        """

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield whitened residuals, measured less predicted, (n,), and the prediction's whitened slopes, (n, parameters).

        Args:
            theta: The parameters in units of their priors, shape (parameters,).
        """

    def normal_equations(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return information (parameters, parameters) and slope (parameters,) of the data.

        Args:
            theta: The parameters in units of their priors, shape (parameters,).
        """
        gram, slope = np.zeros((len(theta), len(theta))), np.zeros(len(theta))
        for residual, columns in self.blocks(theta):
            add_products(gram, slope, columns, residual)
        return gram, slope

    def slope_from(self, theta: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Return the slope (parameters,) that residuals at another point have by the prediction's slopes at theta.

        Args:
            theta, there: The parameters in units of their priors, shape (parameters,).
        """
        both = zip(self.blocks(theta), self.blocks(there), strict=True)
        return np.sum([columns.T @ residual for (_, columns), (residual, _) in both], axis=0)  # type: ignore[no-any-return]

    def settled(self, theta: np.ndarray) -> Self | None:
        """Return the term as it is about theta, itself if it does not change, None if it is much less likely there.

        Args:
            theta: The parameters in units of their priors, shape (parameters,).
        """
        del theta
        return self


def add_products(gram: np.ndarray, slope: np.ndarray, columns: np.ndarray, residual: np.ndarray) -> None:
    """Add the products of columns with themselves and with residuals in double precision, in place.

    Args:
        gram: Takes columns' columns, shape (parameters, parameters).
        slope: Takes columns' residual, shape (parameters,).
        columns: Whitened slopes, shape (n, parameters).
        residual: Whitened residuals, shape (n,).
    """
    # Piece by piece: a copy of them all in double precision would leave the processor's cache.
    for first in range(0, len(columns), PIECE):
        wide = columns[first : first + PIECE].astype(float, copy=False)
        # What blows up is no optimum, as its information is not finite.
        with np.errstate(over="ignore", invalid="ignore"):
            gram += wide.T @ wide
            slope += wide.T @ residual[first : first + PIECE]


def product(columns: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Return columns' residual in double precision, shape (parameters,).

    Args:
        columns: Whitened slopes, shape (n, parameters).
        residual: Whitened residuals, shape (n,).
    """
    found = np.zeros(columns.shape[1])
    for first in range(0, len(columns), PIECE):
        piece = slice(first, first + PIECE)
        found += columns[piece].astype(float, copy=False).T @ residual[piece]
    return found


@dataclass(frozen=True)
class Posterior:
    """Terms of a sum, and how far the parameters may go.

    Attributes:
        terms: The kinds of data.
        lower, upper: Bounds of the parameters in prior standard deviations, shape (parameters,).
        reach: Largest change of each in one step, (parameters,).
        truncated: Numbers of the parameters whose prior ends at their bounds: the evidence counts what lies inside.
    """

    terms: tuple[Likelihood, ...]
    lower: np.ndarray
    upper: np.ndarray
    reach: np.ndarray
    truncated: tuple[int, ...] = ()

    def cost(self, theta: np.ndarray) -> float:
        """Return minus the log posterior at `theta`, shape (parameters,), up to the normalisers."""
        total = 0.5 * float(theta @ theta) + sum(term.cost(theta) for term in self.terms)
        return total if np.isfinite(total) else float("inf")

    def normal_equations(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the information (parameters, parameters) and the slope (parameters,) of the data, the prior left out."""
        each = [term.normal_equations(theta) for term in self.terms]
        none = np.zeros((len(theta), len(theta))), np.zeros(len(theta))
        return none[0] + sum(gram for gram, _ in each), none[1] + sum(slope for _, slope in each)

    def settled(self, theta: np.ndarray) -> Posterior | None:
        """Return the posterior with its terms about `theta`, shape (parameters,), None if one is much less likely there."""
        terms = [term.settled(theta) for term in self.terms]
        kept = [term for term in terms if term is not None]
        return replace(self, terms=tuple(kept)) if len(kept) == len(terms) else None

    def log_evidence(self, theta: np.ndarray, gram: np.ndarray, slope: np.ndarray | None = None) -> float:
        """Return Laplace's log evidence about a maximum.

        Args:
            theta: The maximum, shape (parameters,).
            gram: Information there, shape (parameters, parameters), as of `normal_equations`.
            slope: Slope of the data there, shape (parameters,); it is wanted where parameters are `truncated`, and may
                lie at the end of their prior.
        """
        information = gram + np.eye(len(gram))
        found = sum(term.log_normaliser for term in self.terms) - self.cost(theta)
        found -= 0.5 * float(np.linalg.slogdet(information)[1])
        if not self.truncated or slope is None:
            return found
        known = posterior_covariance(gram)
        pull = slope - theta
        centre = theta + known @ pull
        found += 0.5 * float(pull @ known @ pull)
        for j in self.truncated:
            spread = float(np.sqrt(known[j, j]))
            inside = _log_inside((self.lower[j] - centre[j]) / spread, (self.upper[j] - centre[j]) / spread)
            found += inside - _log_inside(float(self.lower[j]), float(self.upper[j]))
        return found

    def step(self, gram: np.ndarray, slope: np.ndarray, theta: np.ndarray, damping: float) -> np.ndarray:
        """Return the damped Gauss-Newton step inside the bounds, shape (parameters,).

        Args:
            gram: Information of the data, shape (parameters, parameters).
            slope: Slope of the data, shape (parameters,).
            theta: Where the step begins, shape (parameters,).
            damping: Damping as a share of the information's diagonal.
        """
        information = gram + np.eye(len(gram))
        precision = information + damping * np.diag(np.diag(information))
        lower = np.maximum(self.lower - theta, -self.reach)
        upper = np.minimum(self.upper - theta, self.reach)
        return bounded_step(precision, slope - theta, lower, upper)

    def led_back(
        self, gram: np.ndarray, theta: np.ndarray, trial: np.ndarray, cost: float
    ) -> tuple[np.ndarray, float]:
        """Return a step's end (parameters,) and its cost after corrections with the slopes of its beginning.

        Where parameters stand for one another, as mass and stiffness do on a shaken table, the valley of good fits is
        long, narrow and bent: a straight step leaves it, however short, and the chords of the residuals there lead back
        (the simplified Newton iteration; Deuflhard 2011, section 2.1).

        Args:
            gram: Information of the data at the beginning, shape (parameters, parameters).
            theta, trial: Beginning and end of the step, shape (parameters,).
            cost: Cost at its end.
        """
        last = float(np.linalg.norm(trial - theta))
        for _ in range(CORRECTIONS):
            slope = sum(term.slope_from(theta, trial) for term in self.terms)
            if not np.isfinite(slope).all():
                break
            correction = self.step(gram, np.asarray(slope), trial, 0.0)
            size = float(np.linalg.norm(correction))
            if size > 0.5 * last:
                # It does not contract: there is no valley here, or it is another one.
                break
            there, last = trial + correction, size
            tried = self.cost(there)
            if not tried < cost:
                break
            trial, cost = there, tried
        return trial, cost


def descend(
    posterior: Posterior,
    theta: np.ndarray,
    iterations: int,
    trials: Trials = DAMPED,
    enough: float = SETTINGS.refinement.enough,
) -> tuple[Posterior, np.ndarray]:
    """Return the posterior about the end of a descent, and the parameters there, shape (parameters,).

    Args:
        posterior: Where to descend.
        theta: Parameters to start from, shape (parameters,).
        iterations: Steps at most.
        trials: Steps that are tried until one helps.
        enough: Gain below which the descent ends.
    """
    last: float | None = None
    for _ in range(iterations):
        before = posterior.cost(theta)
        if not np.isfinite(before):
            # Where an effect blows up there is no direction to go.
            break
        gram, slope = posterior.normal_equations(theta)
        if not (np.isfinite(gram).all() and np.isfinite(slope).all()):
            break
        for damping, share in trials.steps(last):
            step = posterior.step(gram, slope, theta, damping)
            trial = theta + share * step
            after = posterior.cost(trial)
            bent = damping == 0.0 and share == 1.0 and np.isfinite(after) and after >= before
            if bent and 0.5 * float((slope - theta) @ step) > enough:
                trial, after = posterior.led_back(gram, theta, trial, after)
            # What helps as long as nothing else follows the parameters may be of no help when all does.
            if after < before and (settled := posterior.settled(trial)) is not None:
                posterior, theta, last = settled, trial, damping
                break
        else:
            break
        if before - after < enough:
            break
    return posterior, theta


def posterior_covariance(gram: np.ndarray) -> np.ndarray:
    """Return the covariance of parameters that have unit priors, (parameters, parameters), not a number where they blow up.

    What sticks may have 1e20 times the information of its prior: on the scale of its diagonal, by eigenvalues, no rounding
    makes a variance negative.

    Args:
        gram: Information of the data, shape (parameters, parameters).
    """
    information = gram + np.eye(len(gram))
    if not np.isfinite(information).all():
        return np.full_like(information, np.nan)
    scale = 1.0 / np.sqrt(np.diag(information))
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    least = len(gram) * np.finfo(float).eps
    root = scale[:, None] * vectors / np.sqrt(np.maximum(values, least))
    return np.asarray(root @ root.T)


def _log_inside(lower: float, upper: float) -> float:
    """Return the logarithm of a standard normal's probability between two bounds."""
    if lower > 0:
        lower, upper = -upper, -lower
    high, low = float(log_ndtr(upper)), float(log_ndtr(lower))
    return high + float(np.log1p(-np.exp(low - high)))


def bounded_step(precision: np.ndarray, pull: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return the least of s' precision s / 2 - pull' s between bounds, shape (n,).

    All parameters that a guess has on the wrong side of a bound change sides at once (block principal pivoting: Judice and
    Pires 1994). Where that does not end soon, it is bounded least squares on the factor, with one change at a time.

    Args:
        precision: Positive definite, shape (n, n).
        pull: Slope at zero, (n,).
        lower, upper: Bounds, (n,).
    """
    least = step = np.linalg.solve(precision, pull)
    side = np.zeros(len(pull), int)
    for _ in range(PIVOTS):
        if not np.isfinite(step).all():
            break
        outside = np.sign(step - np.clip(step, lower, upper)).astype(int)
        back = side * (pull - precision @ step) < 0.0
        if not (outside.any() or back.any()):
            return np.asarray(step)
        side = np.where(back, 0, side + outside)
        free, ends = side == 0, np.where(side < 0, lower, np.where(side > 0, upper, 0.0))
        step = ends.copy()
        step[free] = np.linalg.solve(precision[np.ix_(free, free)], (pull - precision @ ends)[free])
    return _one_at_a_time(precision, least, lower, upper)


def _one_at_a_time(
    precision: np.ndarray, free: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> np.ndarray:
    """Return what `bounded_step` does, one parameter changing sides after the other.

    `free` is the least without bounds, shape (n,).
    """
    try:
        factor = np.linalg.cholesky(precision).T
    except np.linalg.LinAlgError:
        # Slopes of a law that sticks and slips may be too large for its digits: the step is judged by its cost anyhow.
        return np.asarray(np.clip(np.nan_to_num(free), lower, upper))
    # The start may lie on a bound, or past it by a rounding.
    bounds = (np.minimum(lower, -1e-9), np.maximum(upper, 1e-9))
    found = lsq_linear(factor, factor @ free, bounds, method="bvls").x
    return np.asarray(np.clip(found, lower, upper))
