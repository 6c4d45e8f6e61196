"""Candidates of the user's as effects: the same scoring, refinement and engine run as the catalogue's own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar

import numpy as np

from pounding.diagnosis.effects.bases import LawEffect
from pounding.diagnosis.effects.candidate_file import UserForce, UserParameter
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, Quantity, Scales
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.model import Model

SHAPES = {0: 1, 1: 5, 2: 4, 3: 3, 4: 2}
"""How many values of each parameter but the first are scored, by how many such parameters there are."""
SPREAD = 3.0
"""Factor on either side of a single typical size within which such a parameter is scored."""


@dataclass(frozen=True)
class UserEffect(LawEffect):
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

    def numbers(self, model: Model, values: np.ndarray) -> tuple[float, ...]:
        """Return the parameters, of whatever sign."""
        return tuple(float(value) for value in values)


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
        # What may change its sign is refined as it is, the rest as logarithms.
        signed = [force.either_sign, *(one.sizes[0] * one.sizes[-1] <= 0 for one in force.parameters[1:])]
        quantities = tuple(
            Quantity(one.name, one.unit, 1 / one.to_si, logarithmic=not either)
            for one, either in zip(force.parameters, signed, strict=True)
        )
        sign = 0 if force.either_sign else int(np.sign(force.parameters[0].sizes[0]))
        described = {
            "name": force.name,
            "quantities": quantities,
            "where": force.where,
            "sign": sign,
            "source": force,
            "law": force.law,
            "__doc__": force.what,
        }
        found.append(type(force.name, (UserEffect,), described))
    return found


def _values(parameter: UserParameter, count: int) -> list[float]:
    low, high = parameter.sizes[0], parameter.sizes[-1]
    if len(parameter.sizes) == 1:
        low, high = low / SPREAD, high * SPREAD
    points = np.geomspace(low, high, count) if low * high > 0 else np.linspace(low, high, count)
    return [float(point) for point in points]
