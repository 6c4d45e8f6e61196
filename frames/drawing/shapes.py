"""What a frame looks like: the mesh of a plate frame, or plates and columns that stand for a stick."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]
Index = NDArray[np.integer[Any]]

PIECES = 8
"""Pieces of a stick's column in one storey."""

COLUMN = 0.1
"""Width of a stick's columns, as a share of the plan's width."""

THICKNESS, RIM = 0.025, 0.05
"""Thickness at which the table is drawn, and how far it reaches beyond the frames [m]."""


@dataclass(frozen=True)
class Shape:
    """Quadrilaterals in space that follow a frame's coordinates.

    Attributes:
        nodes: Places at rest (nodes, 3) [m]; the table's top is z = 0, the frame's middle x = y = 0.
        quads: Corners of each element (elements, 4).
        level: Floor or storey of each element (elements,), from 1.
        is_column: Whether an element belongs to a column (elements,).
        follows: Displacement of the nodes for unit coordinates (3 nodes, n).
    """

    nodes: Real
    quads: Index
    level: Index
    is_column: NDArray[np.bool_]
    follows: Any

    @cached_property
    def outline(self) -> Index:
        """Edges that belong to one element only, as pairs of nodes (edges, 2)."""
        sides = np.sort(np.concatenate([self.quads[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1)
        pairs, count = np.unique(sides, axis=0, return_counts=True)
        return np.asarray(pairs[count == 1])

    def moved(self, q: Real) -> Real:
        """Return the displacement (nodes, 3) [m] for coordinates q (n,), relative to the table."""
        return np.asarray(self.follows @ q).reshape(-1, 3)


def shape_of(reduced: ReducedFrame) -> Shape:
    """Return the mesh of a plate frame, or a drawing of a stick: floors, and columns that bend in an S."""
    if not reduced.is_mesh:
        return _stick(reduced)
    mesh = reduced.mesh
    follows = np.column_stack([reduced.expand(unit).ravel() for unit in np.eye(len(reduced.mass))])
    return Shape(mesh.nodes, mesh.quads, mesh.level, mesh.is_column, follows)


def plan(reduced: ReducedFrame) -> tuple[float, float, float, float]:
    """Return least and largest x and y of a frame's plan [m]."""
    length, width = reduced.plan_m
    return -length / 2.0, length / 2.0, -width / 2.0, width / 2.0


def box(reduced: ReducedFrame, moved: float = 0.0) -> tuple[Real, Real]:
    """Return the corners of the box around a frame on its table that moves by so much along x [m]."""
    left, right, front, back = plan(reduced)
    reach = max(moved, RIM)
    low = np.array([left - reach, front - RIM, -THICKNESS])
    return low, np.array([right + reach, back + RIM, float(reduced.heights_m[-1])])


def _stick(reduced: ReducedFrame) -> Shape:
    length, width = reduced.plan_m
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2.0 * [length, width]
    nodes: list[Real] = []
    quads: list[Index] = []
    level: list[int] = []
    column: list[bool] = []
    rows: list[Real] = []
    heights = np.concatenate([[0.0], reduced.heights_m])
    # Guided at both ends, a column bends in a cubic.
    along = np.linspace(0.0, 1.0, PIECES + 1)
    bend = 3.0 * along**2 - 2.0 * along**3
    for storey in range(1, reduced.storeys + 1):
        first = sum(len(part) for part in nodes)
        nodes.append(np.column_stack([corners, np.full(4, heights[storey])]))
        rows += [_blend(reduced, storey, 1.0, corner) for corner in corners]
        quads.append(first + np.arange(4)[None, :])
        level.append(storey)
        column.append(False)
        for x, y in corners:
            first = sum(len(part) for part in nodes)
            z = heights[storey - 1] + along * (heights[storey] - heights[storey - 1])
            inwards = y - np.sign(y) * COLUMN * width
            strip = np.array([[x, side, level_z] for level_z in z for side in (y, inwards)])
            nodes.append(strip)
            shares = np.repeat(bend, 2)
            rows += [_blend(reduced, storey, share, node) for share, node in zip(shares, strip, strict=True)]
            start = first + 2 * np.arange(PIECES)[:, None]
            quads.append(start + np.array([0, 1, 3, 2]))
            level.extend([storey] * PIECES)
            column.extend([True] * PIECES)
    follows = np.concatenate(rows)
    return Shape(np.vstack(nodes), np.vstack(quads), np.array(level), np.array(column), csr_matrix(follows))


def _blend(reduced: ReducedFrame, storey: int, share: float, place: Real) -> Real:
    """Return the rows (3, n) of a place in plan between the floor below (0) and above (1) a storey."""
    rows = np.zeros((3, len(reduced.mass)))
    for floor, weight in ((storey - 1, share), (storey - 2, 1.0 - share)):
        if floor >= 0:
            rows[0, reduced.floor_x[floor]] += weight
            if reduced.turns:
                rows[:2, reduced.floor_rz[floor]] += weight * np.array([-place[1], place[0]])
    return rows
