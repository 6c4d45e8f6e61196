"""A frame's finite elements on the displacements of its nodes alone, for codes whose nodes have no rotations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.sparse import csr_matrix, diags_array

from pounding.frames.errors import FrameError
from pounding.frames.fe.assembly import Model
from pounding.frames.fe.shells import DOFS
from pounding.frames.reduction.craig_bampton import factorise

Real = NDArray[np.float64]
Index = NDArray[np.int64]

MOST = 10_000
"""Displacements that are allowed: the condensed stiffness is full, 0.8 GB with so many."""


@dataclass(frozen=True)
class Translations:
    """A frame on three displacements a node, the base's nodes last.

    Attributes:
        nodes: Places of the nodes at rest (nodes, 3) [m].
        stiffness: K (3 nodes, 3 nodes) [N/m], x, y, z of each node; nothing at the base, which does not move.
        mass: M (3 nodes, 3 nodes) [kg], diagonal.
        base: The nodes of the base.
        floor: The node in the middle of each floor (storeys,).
    """

    nodes: Real
    stiffness: csr_matrix
    mass: csr_matrix
    base: Index
    floor: Index


def without_rotations(model: Model) -> Translations:
    """Return a model with its rotations condensed statically.

    The rotations' inertia is left out: with lumped masses it is that of plates a few millimetres thick.

    Args:
        model: A model with floors that are not rigid in their plane, so that every coordinate is a node's.

    Raises:
        FrameError: A base that rocks, rigid floors, or a mesh too fine for a full matrix.
    """
    place = model.coordinates.place
    if np.any(place < 0):
        raise FrameError(f"frame {model.frame.name}: needs a fixed base and floors that can stretch")
    moved, turned = np.flatnonzero(place % DOFS < 3), np.flatnonzero(place % DOFS >= 3)
    if len(moved) > MOST:
        raise FrameError(
            f"frame {model.frame.name}: {len(moved)} displacements on this mesh, at most {MOST} can be "
            "condensed; take a coarser mesh"
        )
    stiffness = model.stiffness.tocsc()
    across = stiffness[turned][:, moved].toarray()
    full = stiffness[moved][:, moved].toarray()
    full -= across.T @ factorise(stiffness[turned][:, turned].tocsc()).solve(across)
    base = np.flatnonzero(model.mesh.node_part == 0)
    free = place[moved].reshape(-1, 3)[:, 0] // DOFS
    nodes = np.concatenate([free, base])
    held = np.zeros((3 * len(base), 3 * len(base)))
    mass = model.node_mass.diagonal().reshape(-1, DOFS)[base, :3].ravel()
    mass = np.concatenate([model.mass.diagonal()[moved], mass])
    return Translations(
        model.mesh.nodes[nodes],
        csr_matrix(block_diag((full + full.T) / 2.0, held)),
        diags_array(mass).tocsr(),
        len(free) + np.arange(len(base)),
        _middles(model, free),
    )


def _middles(model: Model, free: Index) -> Index:
    """Return the place among the free nodes of the node nearest the middle of each floor (storeys,)."""
    part, off = model.mesh.node_part[free], np.hypot(*model.mesh.nodes[free, :2].T)
    floors = [np.flatnonzero(part == floor) for floor in range(1, model.frame.storeys + 1)]
    return np.array([nodes[off[nodes].argmin()] for nodes in floors])
