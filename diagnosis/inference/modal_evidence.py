"""Evidence of effects in modal data alone: the one inference (`inference.posterior`), for effects in all tests or in one.

An effect has one size, whose prior is that of its scoring, cut in half where its sign is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, ClassVar

import numpy as np

from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.bases import FrameEffect
from pounding.diagnosis.effects.catalogue import Effect, Quantity, places
from pounding.diagnosis.effects.frame import AddedMass, BaseRocking, PDelta
from pounding.diagnosis.effects.storey import StiffnessChange
from pounding.diagnosis.inference.coordinates import Amplitudes
from pounding.diagnosis.inference.modal_model import Joints
from pounding.diagnosis.inference.numbers import Numbers, NumbersTerm
from pounding.diagnosis.inference.posterior import Posterior, descend, posterior_covariance
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.settings import SETTINGS

STEPS = 40


@dataclass(frozen=True)
class Softening(FrameEffect):
    """The first mode is softer in one test, as where friction, yielding or softening tell at larger amplitude.

    A modal test gives no amplitude, so that the three of `alike` cannot be told apart.
    """

    name = "hysteresis"
    quantities = (Quantity("first_mode_stiffness_change", "1"),)
    sign = -1
    typical = 0.2
    alike: ClassVar[tuple[str, ...]] = ("hysteresis", "coulomb_friction", "cubic_stiffness")

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Scale the square of the first mode's frequency, those of the others staying."""
        modes, first = model.plain_modes(assembly), self.span(model).start
        weighted = assembly.mass @ modes.floors[:, first]
        change = max(float(values[0]), -0.99) * modes.omega[first] ** 2
        assembly.stiffness += change * np.outer(weighted, weighted)

    def entries(self) -> list[dict[str, Any]]:
        """Return what it stands for."""
        return [self.place() | {"effect": name} for name in self.alike]


@dataclass(frozen=True)
class Weighed:
    """What modal data say of a set of effects.

    Attributes:
        acting: The effects. log_evidence: Of the data with them.
        value, std: Likeliest size of each and its standard error, SI.
        fitted: Data as the model with these sizes and the likeliest nuisance parameters inside shows them, SI.
        misfit: Chi-square of the data and nuisance parameters at these sizes.
    """

    acting: tuple[Effect, ...]
    log_evidence: float
    value: np.ndarray
    std: np.ndarray
    fitted: np.ndarray
    misfit: float


def modal_candidates(model: Model, joints: Joints | None, data: Sequence[ModalDatum]) -> list[Effect]:
    """Return the effects of the catalogue that a frame's modal data can show, everywhere and in single tests.

    Args:
        model: The baseline model.
        joints: Joints of the frame as an effect, or None for a frame without any.
        data: Modal data of the frame.
    """
    frame = model.structure.frames[0].name
    whole: list[Effect] = [joints] if joints is not None else []
    whole += [BaseRocking(frame=frame), PDelta(frame=frame)]
    found = [*whole, *places(StiffnessChange, model), *places(AddedMass, model)]
    tests = list(dict.fromkeys(datum.test for datum in data if datum.quantity == "frequency"))
    if len(tests) > 1:
        for test in tests:
            found += [replace(effect, test=test) for effect in (*whole, places(AddedMass, model)[-1])]
            if any(datum.test == test and datum.mode == 1 for datum in data):
                found.append(Softening(frame=frame, test=test))
    return found


def _likeliest(numbers: Numbers, coordinates: Amplitudes) -> tuple[Posterior, np.ndarray]:
    """Return the posterior and its maximum from several sizes of the effects, shape (nuisance + effects,)."""
    quick = coordinates.posterior([NumbersTerm(numbers, coordinates, quick=True)])
    posterior = coordinates.posterior([NumbersTerm(numbers, coordinates)])
    axes = []
    for one in coordinates.effects:
        sides = (1.0, -1.0) if one.sign == 0 else (float(one.sign),)
        axes.append([side * start for side in sides for start in SETTINGS.modal.starts])
    ends = []
    for sizes in product(*axes):
        theta = np.concatenate([np.zeros(len(coordinates.scale)), sizes])
        ends.append(descend(quick, theta, STEPS, enough=1e-6)[1])
    theta = descend(posterior, min(ends, key=posterior.cost), STEPS, enough=1e-6)[1]
    # A step to a bound may end past it by a rounding.
    return posterior, np.clip(theta, posterior.lower, posterior.upper)


def weigh(model: Model, data: Sequence[ModalDatum], acting: Sequence[Effect] = ()) -> Weighed:
    """Return what data say of effects that act together (none for the baseline model).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one; none for the baseline model.
    """
    coordinates = Amplitudes.of_sizes(model, acting)
    numbers = Numbers(model, (), data)
    posterior, theta = _likeliest(numbers, coordinates)
    gram, slope = posterior.normal_equations(theta)
    count = len(model.std)
    spread = np.sqrt(np.diag(posterior_covariance(gram)))[count:]
    return Weighed(
        acting=tuple(acting),
        log_evidence=posterior.log_evidence(theta, gram, slope),
        value=np.array([float(one[0]) for one in coordinates.values(theta)]),
        std=np.abs(coordinates.slopes(theta)) * spread,
        fitted=np.exp(numbers.shown(np.zeros(count), coordinates.acting(theta))),
        misfit=2 * posterior.terms[0].cost(theta) + float(theta[:count] @ theta[:count]),
    )


def foretell(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Effect], known: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Return all data in SI as predicted from some of them, and how far each lies off [standard deviations], each (data,).

    Args:
        model: The baseline model.
        data: Modal data of the frame.
        acting: Effects, each in all tests or in one.
        known: Numbers of the data from which all are predicted.
    """
    coordinates = Amplitudes.of_sizes(model, acting)
    posterior, theta = _likeliest(Numbers(model, (), [data[i] for i in known]), coordinates)
    gram, _ = posterior.normal_equations(theta)
    everything = NumbersTerm(Numbers(model, (), data), coordinates)
    ((residual, columns),) = everything.blocks(theta)
    uncertain = np.einsum("ij,jk,ik->i", columns, posterior_covariance(gram), columns)
    told = everything.numbers.shown(coordinates.nuisance(theta), coordinates.acting(theta))
    return np.exp(told), residual / np.sqrt(1 + uncertain)


def foretold_from_others(
    model: Model, data: Sequence[ModalDatum], acting: Sequence[Effect]
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
