"""What the impacts say of a contact: that of the baseline model against another gap, stiffness, loss or law.

All impacts share the contact's numbers and an unknown filter; each has its own small errors of relative displacement and
velocity. All have Gaussian priors; descent and evidence are those of every kind of data (`inference.posterior`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.contact_force.hypotheses import STIFFNESS, Hypothesis, at, near
from pounding.diagnosis.contact_force.impacts import Bodies, Law
from pounding.diagnosis.contact_force.striking import differences
from pounding.diagnosis.inference.coordinates import box_of
from pounding.diagnosis.inference.posterior import Likelihood, Marquardt, Posterior, descend
from pounding.diagnosis.settings import SETTINGS

GAIN, DELAY_S = 0.01, 1.5e-4
BEND, UNEVEN, CURVE = 0.1, (0.02, 0.04), 0.3
"""The filter: gain, delay, logarithmic magnitude that grows with the square of frequency, what departs from that, and
phase that grows with the cube [rad], at the highest frequency."""
REACH = 30.0
"""Prior standard deviations that an unknown may move in one step."""
REGAINED = np.array([(moved, faster) for moved in np.linspace(-5.0, 5.0, 41) for faster in (-1.5, 0.0, 1.5)])
"""Errors of displacement and velocity, in prior standard deviations, with which lost impacts are looked for."""


@dataclass(frozen=True)
class Fitted:
    """A fitted hypothesis: its law, standard errors of gap, log stiffness and loss, log evidence, and residuals."""

    hypothesis: Hypothesis
    law: Law
    std: tuple[float, float, float]
    log_evidence: float
    cost: float
    freedom: int
    distance: np.ndarray
    unknowns: np.ndarray

    @property
    def misfit(self) -> float:
        """Root mean square of the residuals of the impacts [standard deviations]."""
        return float(np.sqrt(2 * self.cost / max(self.freedom, 1)))


FILTER = 6
"""Unknowns of the filter; after them gap, stiffness and loss of the contact, then two of each impact."""
COMMON = FILTER + 3


def _filter_terms() -> np.ndarray:
    """Return what the unknowns of the filter add to a logarithmic spectrum; the delay's column is per second."""
    share = np.array([0.0, 1 / 3, 2 / 3, 1.0])
    terms = np.zeros((7, FILTER))
    terms[:4, 0] = GAIN
    terms[:4, 2] = BEND * share**2
    terms[2, 3], terms[3, 4] = UNEVEN
    terms[4:, 5] = CURVE * share[1:] ** 3
    return terms


def fit(
    bodies: Bodies,
    hypothesis: Hypothesis,
    start: Sequence[float] = (0.0, 0.0, 0.0),
    others: np.ndarray | None = None,
) -> Fitted:
    """Return the likeliest contact of a hypothesis from a start in units of its spreads.

    Args:
        bodies: The two floors and their impacts.
        hypothesis: The hypothesis.
        start: Its gap, stiffness and loss to start from.
        others: All unknowns of another fit, shape (unknowns,), of which the filter's and the impacts' are taken over.
    """
    x = np.zeros(COMMON + 2 * len(bodies.impacts))
    x[FILTER:COMMON] = start
    law = at(hypothesis, x[FILTER:COMMON])
    for i, impact in enumerate(bodies.impacts):
        # The free motion has to arrive when the force does.
        first = impact.free[min(impact.onset, len(impact.free) - 1)]
        x[COMMON + 2 * i] = (law.gap_m - first) / impact.prior[0]
    if others is not None:
        x[:FILTER], x[COMMON:] = others[:FILTER], others[COMMON:]
    impacts = Impacts(bodies, hypothesis)
    x = _descended(impacts, x)
    for _ in range(SETTINGS.impacts.searches):
        regained = _regained(bodies, hypothesis, x)
        if regained is None:
            break
        x = _descended(impacts, regained)
    counted = _robust(_residuals(bodies, hypothesis, x)[0]) < SETTINGS.impacts.most
    if not counted.all():
        impacts = Impacts(bodies, hypothesis, counted)
        x = _descended(impacts, x)
    gram = impacts.posterior().normal_equations(x)[0] + np.eye(len(x))
    residual, _ = _residuals(bodies, hypothesis, x)
    cost = float(np.minimum(_robust(residual), SETTINGS.impacts.most).sum() + 0.5 * x @ x)
    freedom = int(sum(np.any(impact.whiten != 0, axis=1).sum() for impact in bodies.impacts))
    inverse = np.linalg.inv(gram)
    scale = (hypothesis.gap, hypothesis.stiffness, hypothesis.loss)
    gap, stiffness, loss = (float(scale[j] * np.sqrt(inverse[FILTER + j, FILTER + j])) for j in range(3))
    return Fitted(
        hypothesis,
        at(hypothesis, x[FILTER:COMMON]),
        (float(np.hypot(gap, bodies.common_m)), stiffness, loss),
        -cost - 0.5 * float(np.linalg.slogdet(gram)[1]),
        cost,
        freedom,
        np.sqrt(np.sum(residual**2, axis=1)),
        x,
    )


class Impacts(Likelihood):
    """The impacts of a contact as a term of the inference: the residual of each counts by Huber's measure.

    Args:
        bodies: The two floors and their impacts.
        hypothesis: What the contact may be.
        counted: Which impacts count, all by default, shape (impacts,).
    """

    def __init__(self, bodies: Bodies, hypothesis: Hypothesis, counted: np.ndarray | None = None) -> None:
        self.bodies, self.hypothesis = bodies, hypothesis
        self.counts = np.ones(len(bodies.impacts)) if counted is None else counted.astype(float)

    def posterior(self) -> Posterior:
        """Return the posterior of the filter's, the contact's and the impacts' unknowns."""
        unknowns = COMMON + 2 * len(self.bodies.impacts)
        free = np.full(unknowns, np.inf)
        return Posterior((self,), -free, free, np.full(unknowns, REACH))

    def cost(self, theta: np.ndarray) -> float:
        """Return minus the log likelihood of the impacts for a contact."""
        return float(self.counts @ _robust(_residuals(self.bodies, self.hypothesis, theta)[0]))

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield weighted residuals of all impacts, measured less made, (7 impacts,), and slopes, (7 impacts, unknowns)."""
        residual, weight = _residuals(self.bodies, self.hypothesis, theta)
        scale = np.repeat(np.sqrt(weight * self.counts), 7)
        slopes = _slopes(self.bodies, self.hypothesis, theta, residual)
        yield -scale * residual.ravel(), scale[:, None] * slopes


def _descended(impacts: Impacts, x: np.ndarray) -> np.ndarray:
    """Return the unknowns at the end of a descent on the impacts that count."""
    return descend(impacts.posterior(), x, SETTINGS.impacts.steps, Marquardt(), SETTINGS.impacts.enough)[1]


def _regained(bodies: Bodies, hypothesis: Hypothesis, x: np.ndarray) -> np.ndarray | None:
    """Return the unknowns with impacts that a descent lost where they fit best; None if it lost none.

    Two floors that just miss each other make no force, and nothing then tells a descent which way to go.
    """
    law, found = at(hypothesis, x[FILTER:COMMON]), x.copy()
    size = np.sqrt(np.sum(_residuals(bodies, hypothesis, x)[0] ** 2, axis=1))
    for i in np.flatnonzero(size > SETTINGS.impacts.off):
        own = slice(COMMON + 2 * i, COMMON + 2 * i + 2)
        tried = _whitened(bodies, law, x, REGAINED, np.full(len(REGAINED), i))
        left = np.sum(tried**2, axis=1)
        if left.min() < size[i] ** 2:
            found[own] = REGAINED[left.argmin()]
    return None if np.array_equal(found, x) else found


def _robust(residual: np.ndarray) -> np.ndarray:
    """Return minus the log likelihood of each impact, shape (impacts,), growing slowly from `impacts.off` on (Huber)."""
    square = np.sum(residual**2, axis=1)
    size = np.sqrt(square)
    off = SETTINGS.impacts.off
    return np.asarray(np.where(size <= off, 0.5 * square, off * size - 0.5 * off**2))


def _made(
    bodies: Bodies, law: Law, x: np.ndarray, errors: np.ndarray, which: np.ndarray | None = None
) -> np.ndarray:
    """Return logarithmic spectra as a law and the filter make them less those seen, of all impacts or some, (rows, 7)."""
    filtered = TERMS @ x[:FILTER]
    asked = np.arange(len(bodies.impacts)) if which is None else which
    return np.asarray(
        differences(*bodies.packed, law.numbers(), filtered, float(DELAY_S * x[1]), asked, errors)
    )


def _whitened(
    bodies: Bodies, law: Law, x: np.ndarray, errors: np.ndarray, which: np.ndarray | None = None
) -> np.ndarray:
    # A law that makes no force at all is as wrong as can be, not infinitely so.
    made = np.clip(_made(bodies, law, x, errors, which), -4.0, 4.0)
    whiten = bodies.whiten if which is None else bodies.whiten[which]
    return np.asarray((whiten @ made[:, :, None])[:, :, 0])


def _errors(x: np.ndarray) -> np.ndarray:
    """Return the errors of displacement and velocity before each impact, shape (impacts, 2)."""
    return x[COMMON:].reshape(-1, 2)


def spectra(bodies: Bodies, law: Law) -> np.ndarray:
    """Return the logarithmic spectra of impacts as a law makes them, shape (impacts, 7).

    Args:
        bodies: The two floors and their impacts.
        law: The contact law.
    """
    blank = tuple(replace(one, seen=np.zeros(7)) for one in bodies.impacts)
    still = np.zeros((len(blank), 2))
    return _made(replace(bodies, impacts=blank), law, np.zeros(FILTER), still)


def as_fitted(bodies: Bodies, fitted: Fitted) -> Bodies:
    """Return impacts as a fit makes them, with the errors that the measured ones have.

    Args:
        bodies: The two floors and their impacts.
        fitted: The fit.
    """
    x = fitted.unknowns
    made = _made(bodies, fitted.law, x, _errors(x))
    each = zip(bodies.impacts, made, strict=True)
    return replace(bodies, impacts=tuple(replace(impact, seen=impact.seen + more) for impact, more in each))


TERMS = _filter_terms()


def _residuals(bodies: Bodies, hypothesis: Hypothesis, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    found = _whitened(bodies, at(hypothesis, x[FILTER:COMMON]), x, _errors(x))
    size = np.sqrt(np.sum(found**2, axis=1))
    off = SETTINGS.impacts.off
    return found, np.where(size > off, off / np.maximum(size, off), 1.0)


def _slopes(bodies: Bodies, hypothesis: Hypothesis, x: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Return the derivative of all residuals, (7 impacts, unknowns)."""
    count, errors = len(bodies.impacts), _errors(x)
    slope = np.zeros((count, 7, len(x)))
    shared = x[FILTER:COMMON]
    law = at(hypothesis, shared)
    prior, hertz = bodies.packed.prior, bodies.packed.hertz
    each = np.arange(count)
    for j, step in enumerate((1e-7, 1e-5)):
        small = step / prior[:, j]
        nudged = errors.copy()
        nudged[:, j] += small
        own = (_whitened(bodies, law, x, nudged) - residual) / small[:, None]
        slope[each, :, COMMON + 2 * each + j] = own
        if j == 0:
            # A wider gap is a smaller displacement.
            slope[:, :, FILTER] = -own * (hypothesis.gap / prior[:, :1])
    for j, spread in ((1, hypothesis.stiffness), (2, hypothesis.loss)):
        if spread > 0:
            moved = shared.copy()
            moved[j] += _small(spread)
            changed = _whitened(bodies, at(hypothesis, moved), x, errors)
            slope[:, :, FILTER + j] = (changed - residual) / _small(spread)
    slope[:, :, :FILTER] = bodies.whiten @ TERMS
    slope[:, :, 1] = (bodies.whiten[:, :, 4:] @ (-hertz * DELAY_S)[:, :, None])[:, :, 0]
    return slope.reshape(-1, len(x))


def _small(spread: float) -> float:
    return 2e-3 / spread if spread > 0 else 0.0


def best_fit(bodies: Bodies, hypothesis: Hypothesis) -> Fitted:
    """Return the best fit from several starts."""
    starts: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0)]
    if hypothesis.effect == "gap_offset":
        onset = np.median([one.free[min(one.onset, len(one.free) - 1)] for one in bodies.impacts])
        starts = [(float(onset - hypothesis.law.gap_m) / hypothesis.gap, 0.0, 0.0)]
    elif hypothesis.stiffness > STIFFNESS:
        starts += [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    elif hypothesis.effect == "contact_damping":
        starts += [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    return max((fit(bodies, hypothesis, start) for start in starts), key=lambda one: one.log_evidence)


def again(bodies: Bodies, fitted: Fitted, others: Fitted | None = None) -> Fitted:
    """Return a hypothesis fitted once more, its contact from where it was.

    Args:
        bodies: The two floors and their impacts.
        fitted: The fit.
        others: Another fit, from whose filter and impacts the descent starts.
    """
    start = fitted.unknowns[FILTER:COMMON].tolist()
    return fit(bodies, fitted.hypothesis, start, None if others is None else others.unknowns)


def ranked(ln_bayes: Sequence[float], fits: Sequence[Fitted]) -> tuple[tuple[float, Fitted], ...]:
    """Return fits with their ln Bayes factors against the contact of the baseline model, best first.

    Another law is one effect however many laws there are: each has its share of the prior probability of that, or the many
    would win wherever impacts tell two effects apart by nothing.
    """
    laws = sum(one.hypothesis.effect == "contact_law" for one in fits)
    shares = [np.log(laws) if one.hypothesis.effect == "contact_law" else 0.0 for one in fits]
    found = [(float(value - share), one) for value, share, one in zip(ln_bayes, shares, fits, strict=True)]
    return tuple(sorted(found, key=lambda each: -each[0]))


def held(bodies: Bodies, law: Law) -> Fitted:
    """Return a contact with its numbers held, only the filter and the states before the impacts being fitted."""
    return fit(bodies, Hypothesis("", law, 0.0, 0.0, 0.0))


def within_scatter(fitted: Fitted) -> Law:
    """Return the law of a fit whose gap, stiffness and loss are no further from their centres than scatter makes them.

    Impacts pull them as far as they like; a nuisance parameter of a frame is in a box (`inference.coordinates.box_of`).

    Args:
        fitted: The fit.
    """
    shared = fitted.unknowns[FILTER:COMMON]
    return at(fitted.hypothesis, np.clip(shared, -box_of(len(shared)), box_of(len(shared))))


def warmed(bodies: Bodies, fits: Sequence[Fitted]) -> list[Fitted]:
    """Return fits that had their impacts fitted from where the best of them has its own: none is left in a bad corner."""
    found = list(fits)
    best, reach = max(found, key=lambda one: one.log_evidence), SETTINGS.impacts.plausible
    for i, one in enumerate(found):
        if one is not best and one.log_evidence > best.log_evidence - SETTINGS.impacts.warmed:
            tried = [one, again(bodies, one, best)]
            if one.law.name == best.law.name:
                tried.append(
                    fit(bodies, one.hypothesis, near(one.hypothesis, best.law, reach), best.unknowns)
                )
            found[i] = max(tried, key=lambda each: each.log_evidence)
    return found
