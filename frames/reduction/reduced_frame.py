"""`ReducedFrame`: what the rest of the software knows of a frame."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.frames.definition import Frame, PlateFrame
from pounding.frames.errors import FrameError
from pounding.frames.fe.mesh import Mesh
from pounding.frames.reduction.craig_bampton import condense
from pounding.frames.reduction.recovery import Recovery

Real = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True)
class ReducedFrame:
    """A frame on few coordinates q, relative to the table: ``M q'' + C q' + K q = -M r a_table + forces``.

    Attributes:
        name: Name of the frame.
        storeys: Number of storeys.
        heights_m: Height of each floor (storeys,) [m].
        plan_m: Sides along x and y [m].
        definition: The frame it was made of.
        options: How it was made, for provenance.
        mass: M (n, n) [kg] (kg m, kg m^2 where rotations are kept).
        stiffness: K (n, n) [N/m].
        damping: C (n, n) [N s/m], modal.
        influence: r (n,), for which M r is the load of a unit acceleration of the base along -x: the full
            model's load on these coordinates. It is their motion under a unit translation of the base as
            near as they can follow it, so the lowest floors' entries are 1 within 0.2 %.
        floor_x: Coordinate that is each floor's displacement along x, at y = 0 (storeys,).
        floor_rz: Coordinate that is each floor's rotation about z (storeys,), or empty when not kept.
        frequencies_hz: All natural frequencies of the reduced frame (n,) [Hz], rising.
        shapes: Its mode shapes (n, n), mass-normalised, a column each.
        damping_ratios: Damping ratio of each mode (n,).
        moving_mass_kg: Mass without base plate [kg].
    """

    name: str
    storeys: int
    heights_m: Real
    plan_m: tuple[float, float]
    definition: Frame
    options: dict[str, Any]
    mass: Real
    stiffness: Real
    damping: Real
    influence: Real
    floor_x: Index
    floor_rz: Index
    frequencies_hz: Real
    shapes: Real
    damping_ratios: Real
    moving_mass_kg: float
    basis: Real = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"ReducedFrame({self.name!r}, {self.storeys} storeys, {self.size} coordinates, "
            f"first frequency {self.frequencies_hz[0]:.4g} Hz)"
        )

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.mass)

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of the first mode."""
        return float(self.damping_ratios[0])

    @cached_property
    def roof_stiffness_n_per_m(self) -> float:
        """Force on the roof along x for a unit displacement of the roof [N/m]."""
        push = np.zeros(self.size)
        push[self.floor_x[-1]] = 1.0
        return float(1.0 / np.linalg.solve(self.stiffness, push)[self.floor_x[-1]])

    def point_row(self, floor: int, y_m: float = 0.0) -> Real:
        """Return the row (n,) that gives the displacement along x of a floor's edge at y.

        Args:
            floor: Floor, 1 to storeys.
            y_m: Place along the edge [m], from the middle.

        Raises:
            FrameError: No such floor or place, or y is not 0 and the floors' rotation was not kept.
        """
        if not 1 <= floor <= self.storeys:
            raise FrameError(f"frame {self.name}: no floor {floor}, it has 1 to {self.storeys}")
        if abs(y_m) > self.plan_m[1] / 2.0 + 1e-9:
            raise FrameError(
                f"frame {self.name}: y = {y_m:g} m is off its floors, which are {self.plan_m[1]:g} m wide; correct y_m, or "
                "the width in its file (the second of plan_m of a stick)"
            )
        row = np.zeros(self.size)
        row[self.floor_x[floor - 1]] = 1.0
        if y_m:
            if not len(self.floor_rz):
                raise FrameError(f"frame {self.name}: rotations were not kept; build it with planar=False")
            row[self.floor_rz[floor - 1]] = -y_m
        return row

    @property
    def turns(self) -> bool:
        """Whether the floors' rotation about the vertical is among the coordinates."""
        return len(self.floor_rz) > 0

    def mass_at(self, floor: int, y_m: float = 0.0) -> float:
        """Return the mass [kg] that a push on a floor's edge finds.

        A floor carries its row of the mass matrix condensed to the floors, half of its columns included. The floor of a
        stick that turns is a rigid body: off the middle less than its mass resists, 1 / (1 / m + y^2 / J).

        Args:
            floor: Floor, 1 to storeys.
            y_m: Place along the edge [m], from the middle.
        """
        if self.is_mesh or not self.turns:
            return float(self.storey_model()[0][floor - 1].sum())
        mass = self.mass[np.ix_(self.floor_x, self.floor_x)][floor - 1].sum()
        inertia = self.mass[np.ix_(self.floor_rz, self.floor_rz)][floor - 1].sum()
        return float(1.0 / (1.0 / mass + y_m**2 / inertia))

    def storey_model(self) -> tuple[Real, Real, Real]:
        """Return mass, stiffness and damping (storeys, storeys) condensed to the floors' motion along x.

        The stiffness is exact for forces on floors; mass and damping are Guyan's.
        """
        mass, stiffness = condense(self.stiffness, self.mass, self.floor_x)
        basis = self.floor_shapes
        return mass, stiffness, basis.T @ self.damping @ basis

    @property
    def floor_shapes(self) -> Real:
        """Static displacement of all coordinates when one floor moves by one along x and no other does (n, storeys)."""
        others = np.setdiff1d(np.arange(self.size), self.floor_x)
        basis = np.zeros((self.size, self.storeys))
        basis[self.floor_x, np.arange(self.storeys)] = 1.0
        if len(others):
            inner = self.stiffness[np.ix_(others, others)]
            basis[others] = -np.linalg.solve(inner, self.stiffness[np.ix_(others, self.floor_x)])
        return basis

    @property
    def is_mesh(self) -> bool:
        """Whether there is a mesh behind it; a stick has none."""
        return isinstance(self.definition, PlateFrame)

    @cached_property
    def recovery(self) -> Recovery:
        """Mesh, displacements and stresses behind the coordinates.

        Raises:
            FrameError: The frame is a stick.
        """
        if not isinstance(self.definition, PlateFrame):
            raise FrameError(f"frame {self.name}: a stick has no plates; it has no mesh and no stress")
        return Recovery.of(self.definition, self.options, self.basis)

    @property
    def mesh(self) -> Mesh:
        """Nodes and elements of the full mesh."""
        return self.recovery.mesh

    def expand(self, q: Real) -> Real:
        """Return the displacement (nodes, 3) [m] of all nodes for coordinates q (n,), from the table."""
        return self.recovery.displacement(q)
