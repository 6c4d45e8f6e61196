"""Shell elements: the only module that knows pyfe3d.

The element is pyfe3d's `Quad4` (bilinear Mindlin plate with one-point shear, Hughes, Taylor and
Kanoknukulchai, Int. J. Numer. Meth. Eng. 11(10), 1977; membrane with drilling rotations after Ibrahimbegovic,
Taylor and Wilson, same journal 30(3), 1990) with the lumped mass of its nodal quadrature. Six degrees of freedom
a node: u, v, w, then the rotations about x, y, z.

A frame has thousands of elements of very few shapes. Each shape is computed once and copied.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pyfe3d import DOUBLE, INT, Quad4, Quad4Data, Quad4Probe
from pyfe3d.shellprop_utils import isotropic_plate
from scipy.sparse import coo_matrix, csr_matrix

from pounding.frames.definition import Material
from pounding.frames.errors import FrameError

Real = NDArray[np.float64]
Index = NDArray[np.int64]

DOFS = 6
"""Degrees of freedom of a node."""

LUMPED = 1
"""Mass by nodal quadrature: exact in sum, and right on rectangles; the consistent one is wrong on others."""

SQUARENESS = 1e-6
"""Largest error of a rectangle's corners, as a share of its diagonal."""


@dataclass(frozen=True)
class Sections:
    """What each element is made of.

    Attributes:
        material: The material of all elements.
        thickness_m: Thickness of each element (elements,) [m].
        elasticity: Factor on Young's modulus of each element (elements,).
        tension_n_per_m: Membrane force along the element's second side (elements,) [N/m]; compression is
            negative. It makes the geometric stiffness.
    """

    material: Material
    thickness_m: Real
    elasticity: Real
    tension_n_per_m: Real


def assemble(nodes: Real, quads: Index, sections: Sections) -> tuple[csr_matrix, csr_matrix]:
    """Return stiffness [N/m, N, N m] and mass [kg, kg m^2] of a mesh, both (6 nodes, 6 nodes).

    Args:
        nodes: Coordinates (nodes, 3) [m].
        quads: Corner nodes of each element (elements, 4), rectangles.
        sections: What they are made of.

    Raises:
        FrameError: An element is not a rectangle, or a thickness is not positive.
    """
    stiffness = np.empty((len(quads), 24, 24))
    mass = np.empty((len(quads), 24, 24))
    for members in same_shape(nodes, quads, sections.thickness_m):
        first = members[0]
        elastic, inertia, geometric = element_matrices(
            nodes[quads[first]], sections.thickness_m[first], sections.material
        )
        stiffness[members] = (
            sections.elasticity[members, None, None] * elastic
            + sections.tension_n_per_m[members, None, None] * geometric
        )
        mass[members] = inertia
    return _scatter(quads, stiffness, len(nodes)), _scatter(quads, mass, len(nodes))


def same_shape(nodes: Real, quads: Index, thickness: Real) -> list[Index]:
    """Return the numbers of the elements, each (members,), in groups of equal corners (but for their place) and thickness.

    Args:
        nodes: Coordinates (nodes, 3) [m].
        quads: Nodes of each element (elements, 4).
        thickness: Thickness of each element (elements,) [m].

    Raises:
        FrameError: An element is not a rectangle.
    """
    sides = nodes[quads[:, 1:]] - nodes[quads[:, :1]]
    _refuse_distorted(sides, nodes, quads)
    scale = np.abs(sides).max()
    keys = np.column_stack([np.round(sides.reshape(len(quads), 9) / scale, 9), thickness])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    return [np.flatnonzero(group.ravel() == number) for number in range(group.max() + 1)]


def element_matrices(corners: Real, thickness_m: float, material: Material) -> tuple[Real, Real, Real]:
    """Return stiffness, mass and geometric stiffness of one element, each (24, 24), in global axes.

    Args:
        corners: Coordinates of the four corners (4, 3) [m].
        thickness_m: Thickness [m].
        material: The material.

    Returns:
        Elastic stiffness, lumped mass, and the stiffness of a unit membrane force along the element's second
        side [1 N/m].
    """
    element, _ = _element(corners)
    prop = _property(thickness_m, material)
    data = Quad4Data()
    arrays = []
    for size, update, extra in (
        (data.KC0_SPARSE_SIZE, element.update_KC0, (prop,)),
        (data.M_SPARSE_SIZE, element.update_M, (prop, LUMPED)),
    ):
        rows, columns, values = _triplet(size)
        update(rows, columns, values, *extra)
        arrays.append(_dense(rows, columns, values))
    rows, columns, values = _triplet(data.KG_SPARSE_SIZE)
    element.update_KG_given_stress(0.0, 1.0, 0.0, rows, columns, values)
    arrays.append(_dense(rows, columns, values))
    return arrays[0], arrays[1], arrays[2]


def surface_stress_rows(corners: Real, thickness_m: float, material: Material) -> Real:
    """Return the stresses at an element's centre for unit displacements of its nodes.

    Args:
        corners: Coordinates of the four corners (4, 3) [m].
        thickness_m: Thickness [m].
        material: The material.

    Returns:
        Rows (2, 3, 24): lower and upper surface (against and along the element's normal); normal stress along
        its first and second side and shear stress, in element axes [Pa/m, Pa/rad].
    """
    element, probe = _element(corners)
    probe.update_BL(0.0, 0.0)
    membrane = np.array([probe.BLexx, probe.BLeyy, probe.BLgxy])
    curvature = np.array([probe.BLkxx, probe.BLkyy, probe.BLkxy])
    axes = np.array(
        [
            [element.r11, element.r12, element.r13],
            [element.r21, element.r22, element.r23],
            [element.r31, element.r32, element.r33],
        ]
    )
    to_local = np.kron(np.eye(8), axes.T)
    nu = material.poissons_ratio
    plane = 1e9 * material.youngs_modulus_gpa / (1.0 - nu**2)
    law = plane * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, (1.0 - nu) / 2.0]])
    half = thickness_m / 2.0
    return np.stack([law @ (membrane + side * half * curvature) @ to_local for side in (-1.0, 1.0)])


def von_mises(stress: Real) -> Real:
    """Return von Mises' equivalent of plane stresses (..., 3): two normal stresses and the shear stress."""
    first, second, shear = stress[..., 0], stress[..., 1], stress[..., 2]
    return np.sqrt(first**2 - first * second + second**2 + 3.0 * shear**2)


def dofs_of(quads: Index) -> Index:
    """Return the degrees of freedom of each element (elements, 24)."""
    return (quads[:, :, None] * DOFS + np.arange(DOFS)).reshape(len(quads), -1)


def _element(corners: Real) -> tuple[Quad4, Quad4Probe]:
    probe = Quad4Probe()
    element = Quad4(probe)
    element.c1, element.c2, element.c3, element.c4 = 0, 6, 12, 18
    flat = np.ascontiguousarray(corners, DOUBLE).ravel()
    element.update_rotation_matrix(flat)
    element.update_probe_xe(flat)
    return element, probe


def _property(thickness_m: float, material: Material):  # type: ignore[no-untyped-def]
    if not thickness_m > 0.0:
        raise FrameError(f"plate: thickness is {thickness_m} m, must be positive")
    modulus = 1e9 * material.youngs_modulus_gpa
    return isotropic_plate(thickness_m, modulus, material.poissons_ratio, rho=material.density_kg_per_m3)


def _triplet(size: int) -> tuple[Index, Index, Real]:
    return np.zeros(size, INT), np.zeros(size, INT), np.zeros(size, DOUBLE)


def _dense(rows: Index, columns: Index, values: Real) -> Real:
    return np.asarray(coo_matrix((values, (rows, columns)), shape=(24, 24)).toarray())


def _scatter(quads: Index, blocks: Real, nodes: int) -> csr_matrix:
    dofs = dofs_of(quads)
    rows = np.repeat(dofs, 24, axis=1).ravel()
    columns = np.tile(dofs, (1, 24)).ravel()
    return coo_matrix((blocks.ravel(), (rows, columns)), shape=(DOFS * nodes, DOFS * nodes)).tocsr()


def _refuse_distorted(sides: Real, nodes: Real, quads: Index) -> None:
    """Check that corner 3 closes a parallelogram and that its sides stand upright on each other."""
    diagonal = np.linalg.norm(sides[:, 1], axis=1)
    closure = np.linalg.norm(sides[:, 0] + sides[:, 2] - sides[:, 1], axis=1)
    lengths = np.linalg.norm(sides[:, [0, 2]], axis=2)
    upright = np.abs(np.einsum("ij,ij->i", sides[:, 0], sides[:, 2]))
    flat = lengths.min(axis=1) <= SQUARENESS * diagonal.max()
    bad = (closure > SQUARENESS * diagonal) | (upright > SQUARENESS * diagonal**2) | flat
    if bad.any():
        worst = int(np.flatnonzero(bad)[0])
        corner = ", ".join(f"{value:.4g}" for value in nodes[quads[worst, 0]])
        raise FrameError(
            f"mesh: element {worst} at ({corner}) m is not a rectangle ({int(bad.sum())} of {len(quads)} are "
            "not); the element's mass is wrong on distorted shapes, use a rectangular mesh"
        )
