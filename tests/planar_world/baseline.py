"""The baseline model of a frame: taken from the project, and all that is taken of its model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from pounding.diagnosis.case.case import Case, CaseFrame
from pounding.diagnosis.model.frames import baseline_frames

Real = NDArray[np.float64]
Index = NDArray[np.int64]

STOREYS = {"5A": 5, "5B": 5, "10": 10, "15A": 15, "15B": 15}
"""The frames, and how many storeys they have."""


@dataclass(frozen=True)
class Baseline:
    """The baseline model of a frame.

    Attributes:
        mass: Mass matrix (floors, floors) [kg].
        stiffness: Stiffness matrix (floors, floors) [N/m].
        ratios: Damping ratios of all modes (modes,), the lowest first [-].
        joint: Stiffness of a joint [N m/rad].
        patterns: Change of the stiffness matrix (storeys, floors, floors) by a unit change of each storey [N/m].
    """

    mass: Real
    stiffness: Real
    ratios: Real
    joint: float
    patterns: Real

    def frequencies(self) -> Real:
        """Return the natural frequencies (modes,) [Hz]."""
        return modes(self.mass, self.stiffness)[0]


@cache
def baseline_of(name: str) -> Baseline:
    """Return the baseline model of a frame of the project."""
    case = Case(
        title=name,
        folder=Path("."),
        frames=(CaseFrame(name=name, storeys=STOREYS[name]),),
        runs=(),
        channels=(),
    )
    (frame,) = baseline_frames(case)
    assert frame.patterns is not None
    return Baseline(
        frame.mass, frame.stiffness, frame.damping_ratio, float(frame.joint_stiffness), frame.patterns
    )


def modes(mass: Real, stiffness: Real) -> tuple[Real, Real]:
    """Return natural frequencies (modes,) [Hz] and mode shapes (floors, modes) of unit modal mass [1/sqrt(kg)].

    Args:
        mass: Mass matrix (floors, floors) [kg].
        stiffness: Stiffness matrix (floors, floors) [N/m].
    """
    squares, shapes = eigh(stiffness, mass)
    return np.sqrt(squares) / 2 / np.pi, shapes
