"""Shear buildings: one mass a floor, one spring a storey, and damping of every mode."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Real = NDArray[np.float64]

STOREY, FRAME, MASS, DAMPING = 0.03, 0.08, 0.01, 0.2
"""Standard deviations of the true frame about the stated one, as fractions: each storey's stiffness, all storeys'
together, each floor's mass, the damping ratios (all together, and each mode's as much again)."""


@dataclass(frozen=True)
class Building:
    """A shear building, as stated or as it is.

    Attributes:
        masses: Of the floors, from the first to the roof [kg].
        stiffnesses: Of the storeys, from the lowest [N/m].
        ratios: Damping ratios of all modes, the lowest first [-].
        storey_height: [m].
    """

    masses: Real
    stiffnesses: Real
    ratios: Real
    storey_height: float = 0.3

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return len(self.masses)

    def drifts(self) -> Real:
        """Return the matrix (storeys, floors) that makes drifts of floor displacements [-]."""
        return np.eye(self.storeys) - np.eye(self.storeys, k=-1)

    def stiffness(self) -> Real:
        """Return the stiffness matrix (floors, floors) [N/m]."""
        drifts = self.drifts()
        return drifts.T @ (self.stiffnesses[:, None] * drifts)

    def modes(self) -> tuple[Real, Real]:
        """Return circular frequencies [rad/s] and mode shapes (floors, modes) of unit modal mass [1/sqrt(kg)]."""
        squares, shapes = eigh(self.stiffness(), np.diag(self.masses))
        return np.sqrt(squares), shapes

    def damping(self) -> Real:
        """Return the damping matrix (floors, floors) that gives every mode its ratio [N s/m]."""
        frequencies, shapes = self.modes()
        weighed = self.masses[:, None] * shapes
        return (2 * self.ratios * frequencies * weighed) @ weighed.T


def stated(masses: list[float], stiffnesses: list[float], ratio: float = 0.01) -> Building:
    """Return a building as it is stated before the test, one damping ratio for all modes.

    Args:
        masses: Of the floors [kg].
        stiffnesses: Of the storeys [N/m].
        ratio: Damping ratio of all modes [-].
    """
    return Building(np.array(masses), np.array(stiffnesses), np.full(len(masses), ratio))


def scattered(believed: Building, rng: np.random.Generator) -> Building:
    """Return a building as it is: it differs from the stated one by about what the default priors say."""
    count = believed.storeys
    return replace(
        believed,
        stiffnesses=believed.stiffnesses
        * np.exp(FRAME * rng.standard_normal() + STOREY * rng.standard_normal(count)),
        masses=believed.masses * np.exp(MASS * rng.standard_normal(count)),
        ratios=believed.ratios
        * np.exp(DAMPING * rng.standard_normal() + DAMPING * rng.standard_normal(count)),
    )
