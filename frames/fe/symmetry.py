"""Symmetry: the motions of a frame that a shaking along x can excite, and no others.

A frame whose plan is its own mirror image in x = 0 and in y = 0 answers a shaking along x with motions that
are even in y and odd in x (as displacement fields under reflection). They live on a quarter of the
coordinates. The other three quarters (sway along y, torsion, three of four families of plate modes) stay at
rest exactly.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix, eye_array

from pounding.frames.definition import PlateFrame
from pounding.frames.fe.kinematics import Kinematics
from pounding.frames.fe.mesh import Mesh
from pounding.frames.fe.shells import DOFS

Index = NDArray[np.int64]

# Displacements and rotations at the mirror image, for a unit one here; rotations are axial vectors.
ODD_IN_X = np.array([1.0, -1.0, -1.0, -1.0, 1.0, 1.0])
EVEN_IN_Y = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])


def is_symmetric(frame: PlateFrame) -> bool:
    """Return whether a frame's plan is its own mirror image in x = 0 and in y = 0."""
    places = {(round(x, 9) + 0.0, round(y, 9) + 0.0) for x, y in frame.places_m}
    mirrored_x = {(-x + 0.0, y) for x, y in places}
    mirrored_y = {(x, -y + 0.0) for x, y in places}
    return frame.mass_eccentricity_m == 0.0 and places == mirrored_x and places == mirrored_y


def planar_basis(mesh: Mesh, coordinates: Kinematics) -> csr_matrix:
    """Return the motions that a shaking along x can excite (coordinates, a quarter of them).

    Columns have a largest entry of 1, so that a floor's motion along x stays the coordinate it was.
    """
    in_x = _reflection(mesh, coordinates, 0, ODD_IN_X)
    in_y = _reflection(mesh, coordinates, 1, EVEN_IN_Y)
    identity = eye_array(in_x.shape[0], format="csr")
    projector = ((identity + in_x) @ (identity + in_y)).tocsc()
    projector.eliminate_zeros()
    largest = abs(projector).max(axis=0).toarray().ravel()
    # Of the (up to four) images of a coordinate, the first speaks for all.
    starts = projector.indptr[:-1]
    first = np.array(
        [
            projector.indices[a:b].min() if b > a else -1
            for a, b in zip(starts, projector.indptr[1:], strict=True)
        ]
    )
    wanted = np.flatnonzero((first == np.arange(len(first))) & (largest > 0.5))
    basis = projector[:, wanted]
    return (basis / largest[wanted]).tocsr()


def _reflection(mesh: Mesh, coordinates: Kinematics, axis: int, signs: NDArray[np.float64]) -> csr_matrix:
    """Return the reflection of coordinates as a matrix with one +-1 a row."""
    image = _image_nodes(mesh, axis)
    place = coordinates.place
    whole = place < 0
    component = np.where(whole, -1 - place, place % DOFS)
    target = np.where(whole, -1, DOFS * image[np.where(whole, 0, place // DOFS)] + component)
    order = np.argsort(place)
    found = order[np.searchsorted(place[order], target)]
    columns = np.where(whole, np.arange(len(place)), found)
    return coo_matrix((signs[component], (np.arange(len(place)), columns))).tocsr()


def _image_nodes(mesh: Mesh, axis: int) -> Index:
    """Return the node at each node's mirror image, within the same part."""
    mirrored = mesh.nodes.copy()
    mirrored[:, axis] *= -1.0
    here, there = _sorted(mesh, mesh.nodes), _sorted(mesh, mirrored)
    image = np.empty(len(here), int)
    image[there] = here
    return image


def _sorted(mesh: Mesh, nodes: NDArray[np.float64]) -> Index:
    # + 0.0 turns -0.0 into 0.0, which would sort apart.
    x, y, z = np.round(nodes, 7).T + 0.0
    return np.lexsort((x, y, z, mesh.node_part))
