"""From reduced coordinates back to the plates: displacements of all nodes, stresses of all elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from pounding.frames.definition import PlateFrame
from pounding.frames.fe import shells
from pounding.frames.fe.kinematics import kinematics
from pounding.frames.fe.mesh import Density, Mesh, build_mesh
from pounding.frames.fe.shells import DOFS
from pounding.frames.fe.symmetry import planar_basis

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Recovery:
    """Mesh, displacements and stresses behind the coordinates of a reduced frame.

    Attributes:
        frame: The frame.
        mesh: Its mesh.
        to_nodes: Displacements of all nodes for unit model coordinates (6 nodes, m).
        basis: Model coordinates for unit reduced ones (m, n).
    """

    frame: PlateFrame
    mesh: Mesh
    to_nodes: csr_matrix
    basis: Real

    @classmethod
    def of(cls, frame: PlateFrame, options: dict[str, Any], basis: Real) -> Recovery:
        """Return the recovery of a frame that was built with these options and reduced to this basis.

        Args:
            frame: The frame.
            options: The options of its build.
            basis: Model coordinates for unit reduced ones (m, n).
        """
        mesh = build_mesh(frame, Density(**options["density"]))
        flexible = options["joints"] == "calibrated"
        coordinates = kinematics(frame, mesh, flexible_joints=flexible, rigid_floors=options["rigid_floors"])
        to_nodes = coordinates.to_nodes
        if options["planar"]:
            to_nodes = to_nodes @ planar_basis(mesh, coordinates)
        return cls(frame, mesh, to_nodes.tocsr(), basis)

    def motion(self, q: Real) -> Real:
        """Return displacements and rotations (nodes, 6) [m, rad] for coordinates q (n,)."""
        return np.asarray(self.to_nodes @ (self.basis @ q)).reshape(-1, DOFS)

    def displacement(self, q: Real) -> Real:
        """Return displacements (nodes, 3) [m] for coordinates q (n,)."""
        return self.motion(q)[:, :3]

    def surface_stress(self, q: Real) -> Real:
        """Return the stresses (elements, 2, 3) [Pa] at the centres of both surfaces, in element axes."""
        values = self.motion(q).ravel()[shells.dofs_of(self.mesh.quads)]
        stress = np.empty((len(values), 2, 3))
        for members, rows in self._elements:
            stress[members] = np.einsum("sij,ej->esi", rows, values[members])
        return stress

    def von_mises(self, q: Real) -> Real:
        """Return von Mises' stress (elements,) [Pa] at the elements' centres, of the worse surface."""
        return np.asarray(shells.von_mises(self.surface_stress(q)).max(axis=1))

    @cached_property
    def _thickness(self) -> Real:
        return np.where(self.mesh.is_column, self.frame.columns.thickness_m, self.frame.plate.thickness_m)

    @cached_property
    def _elements(self) -> list[tuple[NDArray[np.intp], Real]]:
        """Elements of one shape (members,), and their stresses for unit displacements of an element's nodes (2, 3, 24)."""
        mesh, thickness = self.mesh, self._thickness
        groups = shells.same_shape(mesh.nodes, mesh.quads, thickness)
        return [
            (
                members,
                shells.surface_stress_rows(
                    mesh.nodes[mesh.quads[members[0]]], thickness[members[0]], self.frame.material
                ),
            )
            for members in groups
        ]
