"""Problems with known answers for refinement and search: an effect at its place, its size, and data that it made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured


@dataclass(frozen=True)
class Problem:
    """An effect that is in the data.

    Attributes:
        name: Of the effect. place: Its storey, floor or channel; None for the whole frame.
        truth: Its parameters in SI, sizes first.
        reported: How many of them a report states; what is left only helps the simulation.
    """

    name: str
    place: int | str | None
    truth: tuple[float, ...]
    reported: int = 1

    def __str__(self) -> str:
        return self.name

    @property
    def effect(self) -> Effect:
        """The effect at its place."""
        return next(one for one in catalogue() if one.name == self.name and self.place in _places(one))

    def model(self) -> Model:
        """Return the model with two short runs that it made with the effect in it; the second is for holding out."""
        return _model(self)

    def null(self) -> Fit:
        """Return the null model, fitted to the first run."""
        return _null(self)

    def fitted(self, factor: float) -> Fit:
        """Return the effect refined from a multiple of its size."""
        return _fitted(self, factor)


NOTHING = Problem("nothing", None, ())

PROBLEMS = (
    Problem("coulomb_friction", 2, (1.0, 10.0, 0.0, 0.3)),
    Problem("cubic_stiffness", 1, (4e8,)),
    Problem("hysteresis", 1, (6.0, 2e4, 2.0, 0.0), reported=2),
    # A smaller one is within the priors of the modes' damping and of what couples them.
    Problem("damping_change", 1, (40.0, 0.0)),
    Problem("stiffness_change", 2, (-0.4,)),
    Problem("air_drag", None, (8.0, 0.0, 0.0), reported=1),
    Problem("added_mass", 3, (0.8,)),
    Problem("sensor_gain", "a2", (-0.1,)),
)


def catalogue() -> tuple[Effect, ...]:
    """Return the effects of these problems at every place on the bench."""
    names = {problem.name for problem in PROBLEMS}
    return tuple(one for one in candidates(measured(samples=50, runs=1)) if one.name in names)


def _places(effect: Effect) -> tuple[int | str | None, ...]:
    inside = (effect.storey, effect.floor, effect.channel)
    return tuple(one for one in inside if one is not None) or (None,)


@lru_cache(maxsize=len(PROBLEMS) + 1)
def _model(problem: Problem) -> Model:
    effects = [] if problem is NOTHING else [(problem.effect, np.array(problem.truth))]
    return measured(effects, samples=1000, runs=2)


@lru_cache(maxsize=len(PROBLEMS) + 1)
def _null(problem: Problem) -> Fit:
    model = problem.model()
    return refine(model, calibrated(model, (0,)), (), (), ())


@lru_cache(maxsize=2 * len(PROBLEMS))
def _fitted(problem: Problem, factor: float) -> Fit:
    size = np.array(problem.truth)
    filtered = problem.null().filtered
    return refine(problem.model(), filtered, (problem.effect,), (factor * size,), (np.abs(size),))
