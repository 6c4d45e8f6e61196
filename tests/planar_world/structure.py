"""What is shaken: the matrices of a frame, the laws that act beside them, and the faults of its sensors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tests.planar_world.baseline import Real
from tests.planar_world.laws import Law

Fault = tuple[str, float]
"""A channel, and its gain [-] or delay [s]."""


@dataclass(frozen=True)
class Structure:
    """A structure, linear but for its laws.

    Attributes:
        mass, damping, stiffness: (freedoms, freedoms) [kg], [N s/m], [N/m]; the floors first, then what hangs on them.
        laws: Forces beside the linear ones.
        loosening: First and second derivative of the stiffness (freedoms, freedoms) [N/m] by the share of a storey's
            columns, for a law that loosens them; none where None.
        gain: A channel that reads too much or too little, and by which factor [-].
        delay: A channel that is late, and by how much [s].
    """

    mass: Real
    damping: Real
    stiffness: Real
    laws: tuple[Law, ...] = ()
    loosening: tuple[Real, Real] | None = None
    gain: Fault | None = None
    delay: Fault | None = None

    @property
    def freedoms(self) -> int:
        """Number of degrees of freedom."""
        return len(self.mass)

    def with_law(self, law: Law) -> Structure:
        """Return the structure with one more law."""
        return replace(self, laws=(*self.laws, law))

    def with_hung(self, kilograms: float) -> Structure:
        """Return the structure with a mass [kg] as its last degree of freedom, not yet held by anything."""

        def grown(matrix: Real, corner: float = 0.0) -> Real:
            larger = np.zeros((self.freedoms + 1, self.freedoms + 1))
            larger[:-1, :-1] = matrix
            larger[-1, -1] = corner
            return larger

        return replace(
            self,
            mass=grown(self.mass, kilograms),
            damping=grown(self.damping),
            stiffness=grown(self.stiffness),
        )


def drift(floors: int, storey: int) -> Real:
    """Return what makes the drift of a storey, counted from 1, of the floors' displacements (floors,) [-]."""
    direction = np.zeros(floors)
    direction[storey - 1] = 1.0
    if storey > 1:
        direction[storey - 2] = -1.0
    return direction


def hung(freedoms: int, floor: int) -> Real:
    """Return what makes the way of the last degree of freedom from a floor, counted from 1 (freedoms,) [-]."""
    direction = np.zeros(freedoms)
    direction[-1], direction[floor - 1] = 1, -1
    return direction
