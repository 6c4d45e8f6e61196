"""Candidates of the user's as effects: the same scoring, refinement and engine run as the catalogue's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

import numpy as np

from pounding.diagnosis.effects.candidate_file import UserForce, UserParameter
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, Quantity, Scales
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, force_term

SHAPES = {0: 1, 1: 5, 2: 4, 3: 3, 4: 2}
"""How many values of each parameter but the first are scored, by how many such parameters there are."""
SPREAD = 3.0
"""Factor on either side of a single typical size within which such a parameter is scored."""


@dataclass(frozen=True)
class UserEffect(Effect):
    """A force of the user's in a storey or on a floor; its first parameter is the amplitude."""

    source: ClassVar[UserForce]

    def grid(self, scales: Scales) -> list[tuple[float, ...]]:
        """Return values [SI] of the parameters but the first."""
        del scales
        others = self.source.parameters[1:]
        return list(product(*(_values(parameter, SHAPES[len(others)]) for parameter in others)))

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return the typical size of the first parameter [SI]."""
        return float(np.max(np.abs(self.source.parameters[0].sizes)))

    def row(self, model: Model) -> np.ndarray:
        """Return the row of floors that makes the drift or displacement on which the force acts, shape (floors,)."""
        if self.where == "floor":
            return np.asarray(np.eye(model.structure.floors)[self.index])
        return np.asarray(model.structure.drift[self.index])

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the force for a unit of the first parameter."""

        def pull(m: Motion) -> np.ndarray:
            x, v = (m.floor, m.floor_rate) if self.where == "floor" else (m.drift, m.drift_rate)
            time = np.arange(len(x)) * motion.run.step_s
            return -self.source.law.along((1.0, *shape), x[:, self.index], v[:, self.index], time)

        return [force_term(motion, pull, self.row(model) @ modes.floors)]

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the parameters in SI."""
        return np.array([amplitude, *shape])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Add the function as a law."""
        parameters = tuple(float(value) for value in values)
        assembly.laws.append(PlacedLaw(self.source.law, self.row(model), parameters))

    def logarithmic(self) -> tuple[bool, ...]:
        """What may change its sign is refined as it is, the rest as logarithms."""
        others = self.source.parameters[1:]
        return (not self.source.either_sign, *(_one_sign(parameter) for parameter in others))


def user_kinds(asked: Sequence[UserForce | type[Effect]]) -> list[type[Effect]]:
    """Return a kind of effect for each function of a user's, and the effects of the catalogue that they ask for.

    Raises:
        CaseError: A function has the name of an effect of the catalogue.
    """
    taken = {kind.name for kind in kinds() if not kind.rival}
    found: list[type[Effect]] = []
    for force in asked:
        if not isinstance(force, UserForce):
            found.append(force)
            continue
        if force.name in taken:
            raise CaseError(
                f"the candidate {force.name!r} has the name of an effect of the catalogue; rename the function"
            )
        quantities = tuple(Quantity(one.name, one.unit, 1 / one.to_si) for one in force.parameters)
        sign = 0 if force.either_sign else int(np.sign(force.parameters[0].sizes[0]))
        described = {
            "name": force.name,
            "quantities": quantities,
            "where": force.where,
            "sign": sign,
            "source": force,
            "__doc__": force.what,
        }
        found.append(type(force.name, (UserEffect,), described))
    return found


def _one_sign(parameter: UserParameter) -> bool:
    return parameter.sizes[0] * parameter.sizes[-1] > 0


def _values(parameter: UserParameter, count: int) -> list[float]:
    low, high = parameter.sizes[0], parameter.sizes[-1]
    if len(parameter.sizes) == 1:
        low, high = low / SPREAD, high * SPREAD
    points = np.geomspace(low, high, count) if low * high > 0 else np.linspace(low, high, count)
    return [float(point) for point in points]
