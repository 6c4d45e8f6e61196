"""Evidence of effects in modal data: the likelihood over a grid of their sizes, weighed by the priors of these sizes.

The logarithms of the data are Gaussian about what the model with the effect would show, with the covariance of
`modal_model.scatter`: their own uncertainty and the nuisance parameters inside their priors. With one or two sizes the
integral over the prior is a sum over a grid, with no approximation but the grid's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

import numpy as np
from scipy.special import logsumexp

from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.catalogue import Effect, Quantity, Scales, places
from pounding.diagnosis.effects.frame import AddedMass, BaseRocking, FrameEffect, PDelta
from pounding.diagnosis.effects.storey import StiffnessChange
from pounding.diagnosis.inference.modal_model import Joints, predicted, scatter
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly

POINTS = {1: 121, 2: 31}
"""Grid points of a size, by how many sizes there are."""
QUANTILES = (0.16, 0.5, 0.84)
WIDEST = 4.0
"""Prior standard deviations to which the grid reaches."""


@dataclass(frozen=True)
class Softening(FrameEffect):
    """The first mode is softer in one test, as where friction, yielding or softening tell at larger amplitude.

    A modal test gives no amplitude, so that the three cannot be told apart: `alike` names them.
    """

    name = "hysteresis"
    quantities = (Quantity("first_mode_stiffness_change", "1"),)
    sign = -1
    alike: ClassVar[tuple[str, ...]] = ("hysteresis", "coulomb_friction", "cubic_stiffness")

    def size(self, model: Model, scales: Scales | None, shape: tuple[float, ...]) -> float:
        """Return 0.2."""
        return 0.2

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change nothing here: the first mode's frequency is changed afterwards."""


@dataclass(frozen=True)
class Acting:
    """An effect, in all tests or in one of them only."""

    effect: Effect
    test: str | None = None

    def label(self) -> str:
        """Return effect, place and test in words."""
        name = "softer first mode" if isinstance(self.effect, Softening) else self.effect.label()
        return name + (f", only in the {self.test.replace('_', ' ')}" if self.test else "")


@dataclass(frozen=True)
class Weighed:
    """What modal data say of a set of effects.

    Attributes:
        acting: The effects. log_evidence: Of the data with them [nats].
        value, std: Posterior median of each size and half its 68 % interval, SI.
        fitted: Data as the model with the posterior's best sizes shows them, SI.
        foretold: Each datum as foretold from the others, SI. surprise: Its distance in standard deviations.
        log_predictive: Log density of each datum's logarithm given the others [nats].
        misfit: Chi-square of the data at the best sizes.
    """

    acting: tuple[Acting, ...]
    log_evidence: float
    value: np.ndarray
    std: np.ndarray
    fitted: np.ndarray
    foretold: np.ndarray
    surprise: np.ndarray
    log_predictive: np.ndarray
    misfit: float


def modal_candidates(model: Model, joints: Joints | None, data: Sequence[ModalDatum]) -> list[Acting]:
    """Return the effects of the catalogue that a frame's modal data can show, everywhere and in single tests."""
    frame = model.structure.frames[0].name
    whole: list[Effect] = [joints] if joints is not None else []
    whole += [BaseRocking(frame=frame), PDelta(frame=frame)]
    found = [Acting(effect) for effect in whole]
    found += [Acting(effect) for kind in (StiffnessChange, AddedMass) for effect in places(kind, model)]
    tests = list(dict.fromkeys(datum.test for datum in data if datum.quantity == "frequency"))
    if len(tests) > 1:
        for test in tests:
            found += [Acting(effect, test) for effect in whole]
            roof = model.structure.floors
            found.append(Acting(AddedMass(index=roof - 1, frame=frame, floor=roof), test))
            if any(datum.test == test and datum.mode == 1 for datum in data):
                found.append(Acting(Softening(frame=frame), test))
    return found


def weigh(
    model: Model,
    data: Sequence[ModalDatum],
    acting: Sequence[Acting] = (),
    covariance: np.ndarray | None = None,
) -> Weighed:
    """Return what data say of effects that act together (none for the baseline model)."""
    covariance = scatter(model, data) if covariance is None else covariance
    z, prior = grid(acting)
    sizes = np.array([_size(one, model) for one in acting])
    values = [_values(acting, model, row * sizes) for row in z]
    shown = np.log(np.array([shows(model, data, acting, each) for each in values]))
    measured = np.log([datum.value for datum in data])
    # A frame that has buckled was not tested.
    stands = np.isfinite(shown).all(axis=1)
    shown, z, values = (
        shown[stands],
        z[stands],
        [each for each, one in zip(values, stands, strict=True) if one],
    )
    prior = prior[stands] - logsumexp(prior[stands])
    residual = measured - shown
    log_joint = prior + gaussian(residual, covariance)
    evidence = float(logsumexp(log_joint))
    weight = np.exp(log_joint - evidence)
    best = int(np.argmax(log_joint))
    flat = np.array([[float(v[0]) for v in each] for each in values]).reshape(len(z), len(acting))
    low, middle, high = (
        np.array([_quantile(flat[:, j], weight, q) for j in range(flat.shape[1])]) for q in QUANTILES
    )
    foretold, surprise, predictive = _left_out(shown, residual, prior, covariance)
    return Weighed(
        acting=tuple(acting),
        log_evidence=evidence,
        value=middle,
        std=(high - low) / 2,
        fitted=np.exp(shown[best]),
        foretold=foretold,
        surprise=surprise,
        log_predictive=predictive,
        misfit=float(residual[best] @ np.linalg.solve(covariance, residual[best])),
    )


def foretell(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting], known: Sequence[int]
) -> np.ndarray:
    """Return all data, SI, as foretold from the `known` ones alone, shape (data,)."""
    covariance = scatter(model, data)
    z, prior = grid(acting)
    sizes = np.array([_size(one, model) for one in acting])
    shown = np.log([shows(model, data, acting, _values(acting, model, row * sizes)) for row in z])
    stands = np.isfinite(shown).all(axis=1)
    shown, prior = shown[stands], prior[stands]
    seen = list(known)
    residual = np.log([data[i].value for i in seen]) - shown[:, seen]
    within = covariance[np.ix_(seen, seen)]
    log_weight = prior + gaussian(residual, within)
    weight = np.exp(log_weight - logsumexp(log_weight))
    told = shown + residual @ np.linalg.solve(within, covariance[seen])
    return np.exp(weight @ told)


def _quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    order = np.argsort(values)
    below = np.cumsum(weight[order]) - weight[order] / 2
    return float(np.interp(share, below, values[order]))


def grid(acting: Sequence[Acting]) -> tuple[np.ndarray, np.ndarray]:
    """Return sizes in prior standard deviations (points, effects) and the logarithm of their prior weights."""
    if not acting:
        return np.zeros((1, 0)), np.zeros(1)
    axes = []
    for one in acting:
        ends = {0: (-WIDEST, WIDEST), 1: (0.0, WIDEST), -1: (-WIDEST, 0.0)}[one.effect.sign]
        axes.append(np.linspace(*ends, POINTS[len(acting)]))
    z = np.array(list(product(*axes)))
    prior = -0.5 * np.sum(z**2, axis=1)
    return z, prior - logsumexp(prior)


def gaussian(residual: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return the log density of residuals (points, data) [nats]."""
    factor = np.linalg.cholesky(covariance)
    scaled = np.linalg.solve(factor, residual.T)
    constant = np.log(np.diag(factor)).sum() + 0.5 * len(covariance) * np.log(2 * np.pi)
    return np.asarray(-0.5 * np.sum(scaled**2, axis=0) - constant)


def _size(one: Acting, model: Model) -> float:
    return one.effect.size(model, None, ())  # type: ignore[arg-type]


def _values(acting: Sequence[Acting], model: Model, amplitudes: np.ndarray) -> list[np.ndarray]:
    return [one.effect.values(float(a), ()) for one, a in zip(acting, amplitudes, strict=True)]


def shows(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting], values: Sequence[np.ndarray]
) -> np.ndarray:
    """Return the data as the baseline model with effects shows them, each test with the effects that act in it."""
    found = np.zeros(len(data))
    nuisance = np.zeros(len(model.std))
    # A test in which nothing acts alone shows what all the others show.
    own = {one.test for one in acting if one.test}
    for test in {datum.test if datum.test in own else None for datum in data}:
        which = [i for i, datum in enumerate(data) if (datum.test if datum.test in own else None) == test]
        present = [
            (one.effect, value) for one, value in zip(acting, values, strict=True) if one.test in (None, test)
        ]
        chosen = [data[i] for i in which]
        found[which] = predicted(model, model.assemble(nuisance, present), chosen)
        for effect, value in present:
            if isinstance(effect, Softening):
                first = [i for i in which if data[i].mode == 1]
                found[first] *= np.sqrt(max(1.0 + float(value[0]), 0.01))
    return found


def _left_out(
    shown: np.ndarray, residual: np.ndarray, prior: np.ndarray, covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return each datum as foretold from the others, its surprise, and the log density of what was measured."""
    count = residual.shape[1]
    mean, surprise, density = np.zeros(count), np.zeros(count), np.zeros(count)
    for i in range(count):
        rest = np.flatnonzero(np.arange(count) != i)
        if not len(rest):
            log_weight, shift, variance = prior, np.zeros(len(residual)), covariance[i, i]
        else:
            gain = np.linalg.solve(covariance[np.ix_(rest, rest)], covariance[rest, i])
            log_weight = prior + gaussian(residual[:, rest], covariance[np.ix_(rest, rest)])
            log_weight = log_weight - logsumexp(log_weight)
            shift = residual[:, rest] @ gain
            variance = covariance[i, i] - covariance[i, rest] @ gain
        left = residual[:, i] - shift
        weight, told = np.exp(log_weight), shown[:, i] + shift
        centre = weight @ told
        spread = np.sqrt(variance + weight @ (told - centre) ** 2)
        mean[i] = np.exp(centre)
        surprise[i] = (shown[0, i] + residual[0, i] - centre) / spread
        log_normal = -0.5 * left**2 / variance - 0.5 * np.log(2 * np.pi * variance)
        density[i] = logsumexp(log_normal + log_weight)
    return mean, surprise, density
