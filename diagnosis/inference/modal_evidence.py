"""Evidence of effects in modal data alone: the one inference (`inference.posterior`), for effects in all tests or in one.

The logarithms of the data are Gaussian about what the model with the effect would show. Nuisance parameters act on them
linearly, by their slopes in the baseline model: those hardly change with an effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import ClassVar

import numpy as np

from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.catalogue import Effect, Quantity, Scales, places
from pounding.diagnosis.effects.frame import AddedMass, BaseRocking, FrameEffect, PDelta
from pounding.diagnosis.effects.storey import StiffnessChange
from pounding.diagnosis.inference.modal_model import Joints
from pounding.diagnosis.inference.numbers import NONE
from pounding.diagnosis.inference.posterior import Likelihood, Posterior, descend
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.numbers_shown import modal_numbers
from pounding.diagnosis.settings import SETTINGS

WIDEST = 4.0
"""Prior standard deviations that a size may reach."""
STEPS = 40
LINEAR = ("frame_stiffness", "storey_stiffness", "floor_mass")
"""Nuisance parameters that a frequency depends on."""
NUDGE = 1e-4


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
        acting: The effects. log_evidence: Of the data with them.
        value, std: Likeliest size of each and its standard error, SI.
        fitted: Data as the model with these sizes and the likeliest nuisance parameters inside shows them, SI.
        misfit: Chi-square of the data and nuisance parameters at these sizes.
    """

    acting: tuple[Acting, ...]
    log_evidence: float
    value: np.ndarray
    std: np.ndarray
    fitted: np.ndarray
    misfit: float


def modal_candidates(model: Model, joints: Joints | None, data: Sequence[ModalDatum]) -> list[Acting]:
    """Return the effects of the catalogue that a frame's modal data can show, everywhere and in single tests.

    Args:
        model: The baseline model.
        joints: Joints of the frame as an effect, or None for a frame without any.
        data: Modal data of the frame.
    """
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


class ModalTerm(Likelihood):
    """Modal data as a likelihood of nuisance parameters and sizes of effects.

    Args:
        model: The baseline model of one frame.
        data: The data.
        acting: Effects, each in all tests or in one.
        known: Which data count, all by default.
    """

    def __init__(
        self,
        model: Model,
        data: Sequence[ModalDatum],
        acting: Sequence[Acting] = (),
        known: Sequence[int] | None = None,
    ) -> None:
        self.model, self.data, self.acting = model, tuple(data), tuple(acting)
        self.known = list(range(len(data))) if known is None else list(known)
        self.measured = np.log([datum.value for datum in data])
        self.own = np.array([datum.std / datum.value for datum in data])
        self.sizes = np.array([one.effect.size(model, None, ()) for one in acting])  # type: ignore[arg-type]

    @property
    def log_normaliser(self) -> float:
        """Of the Gaussian density of the logarithms that count."""
        return -float(np.sum(np.log(self.own[self.known] * np.sqrt(2 * np.pi))))

    @cached_property
    def nuisance(self) -> np.ndarray:
        """Slopes of the logarithms for the nuisance parameters in prior standard deviations, (data, nuisance)."""
        return nuisance_slopes(self.model, self.data)

    def values(self, theta: np.ndarray) -> list[np.ndarray]:
        """Return the SI parameters of each effect at theta, shape (nuisance + effects,)."""
        amplitudes = theta[self.nuisance.shape[1] :] * self.sizes
        return [one.effect.values(float(a), ()) for one, a in zip(self.acting, amplitudes, strict=True)]

    def shown(self, theta: np.ndarray) -> np.ndarray:
        """Return the logarithms of all data as the model shows them, shape (data,)."""
        alone = shows(self.model, self.data, self.acting, self.values(theta))
        good = np.isfinite(alone) & (alone > 0)
        logs = np.where(good, np.log(np.where(good, alone, 1.0)), NONE)
        return np.asarray(logs + self.nuisance @ theta[: self.nuisance.shape[1]])

    def columns(self, theta: np.ndarray) -> np.ndarray:
        """Return the slopes of all logarithms, (data, parameters)."""
        found = [self.nuisance]
        for j in range(self.nuisance.shape[1], len(theta)):
            moved = [theta.copy(), theta.copy()]
            for sign, one in zip((1.0, -1.0), moved, strict=True):
                one[j] += sign * NUDGE
            found.append(((self.shown(moved[0]) - self.shown(moved[1])) / (2 * NUDGE))[:, None])
        return np.hstack(found)

    def cost(self, theta: np.ndarray) -> float:
        """Return half the sum of squares of the data that count."""
        left = ((self.measured - self.shown(theta)) / self.own)[self.known]
        return 0.5 * float(left @ left)

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield residuals and slopes of the data that count."""
        left = (self.measured - self.shown(theta)) / self.own
        yield left[self.known], (self.columns(theta) / self.own[:, None])[self.known]

    def settled(self, theta: np.ndarray) -> ModalTerm:
        """Return the term itself."""
        del theta
        return self

    def posterior(self) -> Posterior:
        """Return the posterior; a size whose sign is known has a prior cut in half."""
        count = self.nuisance.shape[1]
        signs = np.array([one.effect.sign for one in self.acting], int)
        lower = np.where(signs > 0, 0.0, -WIDEST)
        upper = np.where(signs < 0, 0.0, WIDEST)
        free = np.full(count, np.inf)
        cut = tuple(count + j for j in np.flatnonzero(signs))
        return Posterior(
            (self,),
            np.concatenate([-free, lower]),
            np.concatenate([free, upper]),
            np.concatenate([free, np.ones(len(signs))]),
            truncated=cut,
        )

    def likeliest(self) -> tuple[Posterior, np.ndarray]:
        """Return the posterior and its maximum, shape (nuisance + effects,), from several sizes."""
        posterior = self.posterior()
        axes = []
        for one in self.acting:
            sides = (1.0, -1.0) if one.effect.sign == 0 else (float(one.effect.sign),)
            axes.append([side * start for side in sides for start in SETTINGS.modal.starts])
        ends = []
        for sizes in product(*axes):
            theta = np.concatenate([np.zeros(self.nuisance.shape[1]), sizes])
            end = descend(posterior, theta, STEPS, enough=1e-6)[1]
            # A step to a bound may end past it by a rounding.
            ends.append(np.clip(end, posterior.lower, posterior.upper))
        return posterior, min(ends, key=posterior.cost)


def nuisance_slopes(model: Model, data: Sequence[ModalDatum]) -> np.ndarray:
    """Return slopes of the logarithms of data for the nuisance parameters in prior standard deviations, (data, nuisance)."""
    columns = []
    for number, parameter in enumerate(model.parameters):
        if parameter.kind in LINEAR:
            ends = []
            for sign in (1.0, -1.0):
                values = np.zeros(len(model.std))
                values[number] = sign * NUDGE
                ends.append(np.log(modal_numbers(model.structure, model.assemble(values), data)))
            columns.append((ends[0] - ends[1]) / (2 * NUDGE) * parameter.std)
    return np.array(columns).T


def weigh(model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting] = ()) -> Weighed:
    """Return what data say of effects that act together (none for the baseline model).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one; none for the baseline model.
    """
    term = ModalTerm(model, data, acting)
    posterior, theta = term.likeliest()
    gram, slope = posterior.normal_equations(theta)
    count = term.nuisance.shape[1]
    spread = np.sqrt(np.diag(np.linalg.inv(gram + np.eye(len(gram)))))[count:]
    value = np.array([float(one[0]) for one in term.values(theta)])
    moved = theta.copy()
    moved[count:] += NUDGE
    slopes = (np.array([float(one[0]) for one in term.values(moved)]) - value) / NUDGE
    at_size = theta.copy()
    at_size[:count] = 0.0
    return Weighed(
        acting=tuple(acting),
        log_evidence=posterior.log_evidence(theta, gram, slope),
        value=value,
        std=np.abs(slopes) * spread,
        fitted=np.exp(term.shown(at_size)),
        misfit=2 * term.cost(theta) + float(theta[:count] @ theta[:count]),
    )


def foretell(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting], known: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Return all data in SI as predicted from some of them, and how far each lies off [standard deviations], each (data,).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one.
        known: Numbers of the data from which all are predicted.
    """
    term = ModalTerm(model, data, acting, known)
    posterior, theta = term.likeliest()
    gram, _ = posterior.normal_equations(theta)
    columns, told = term.columns(theta), term.shown(theta)
    uncertain = np.einsum("ij,jk,ik->i", columns, np.linalg.inv(gram + np.eye(len(gram))), columns)
    return np.exp(told), (term.measured - told) / np.sqrt(term.own**2 + uncertain)


def foretold_from_others(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting]
) -> tuple[np.ndarray, np.ndarray]:
    """Return each datum in SI as predicted from all others, and how far it lies off [standard deviations], each (data,).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one.
    """
    numbers = range(len(data))
    each = [foretell(model, data, acting, [i for i in numbers if i != j]) for j in numbers]
    return (
        np.array([told[j] for j, (told, _) in enumerate(each)]),
        np.array([surprise[j] for j, (_, surprise) in enumerate(each)]),
    )


def shows(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Acting], values: Sequence[np.ndarray]
) -> np.ndarray:
    """Return the data in SI as the baseline model with effects shows them, shape (data,).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one.
        values: SI parameters of each effect, each of shape (parameters,).
    """
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
        found[which] = modal_numbers(model.structure, model.assemble(nuisance, present), chosen)
        for effect, value in present:
            if isinstance(effect, Softening):
                first = [i for i in which if data[i].mode == 1]
                found[first] *= np.sqrt(max(1.0 + float(value[0]), 0.01))
    return found
