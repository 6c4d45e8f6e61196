"""The mesh of a plate frame: structured rectangles, floors and column strips.

Floors and columns do not share nodes. Where a column meets a floor (or the base, floor 0) each of its end
nodes is paired with the floor's node at the same place, and `pounding.frames.fe.kinematics` decides what the pair shares.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pounding import bounds
from pounding.frames.definition import PlateFrame
from pounding.frames.errors import FrameError

Real = NDArray[np.float64]
Index = NDArray[np.int64]

SAME_PLACE = 1e-7
"""Two nodes closer than this stand at one place [m]."""


@dataclass(frozen=True)
class Density:
    """How fine the mesh is.

    Attributes:
        floor_m: Longest side of a floor's elements [m].
        across: Elements across a column's width; one alone would be far too soft in torsion.
        along: Elements along a column in one storey.
    """

    floor_m: float = 0.02
    across: int = 2
    along: int = 6

    def __post_init__(self) -> None:
        if self.across < 2 or self.along < 2 or not self.floor_m > 0.0:
            raise FrameError(
                f"mesh: {self}; needs two elements or more across and along, and floor_m above 0"
            )


DEFAULT = Density()
"""Within 0.5 % of a mesh four times as fine in the first three frequencies and the roof stiffness."""


@dataclass(frozen=True)
class Mesh:
    """Nodes and four-node elements of a frame.

    Attributes:
        nodes: Coordinates (nodes, 3) [m].
        quads: Node indices of each element (elements, 4).
        level: Floor or storey of each element (elements,), counted from 1.
        is_column: Whether an element belongs to a column (elements,).
        node_part: Part each node belongs to (nodes,): floor 0 (base), 1, 2, ...; a column's storey s is -s.
        joints: Pairs (floor node, column node) at one place (joints, 2).
        joint_share: Each pair's share of its joint (joints,), by tributary width.
        ends: End of column for each pair (joints, 3): column, storey, 0 for its lower or 1 for its upper end.
    """

    nodes: Real
    quads: Index
    level: Index
    is_column: NDArray[np.bool_]
    node_part: Index
    joints: Index
    joint_share: Real
    ends: Index


def build_mesh(frame: PlateFrame, density: Density | None = None) -> Mesh:
    """Return the mesh of a plate frame.

    Args:
        frame: The frame.
        density: How fine; `DEFAULT` when None.
    """
    density = density or DEFAULT
    node_count(frame, density)  # refuses what would not fit into memory
    parts = _Parts()
    xs, ys = _floor_lines(frame, density)
    grid = _floor_grids(frame, parts, xs, ys)
    joints, share, ends = [], [], []
    weights = np.full(density.across + 1, 1.0 / density.across)
    weights[[0, -1]] /= 2.0
    for column, place in enumerate(frame.places_m):
        for storey in range(1, frame.storeys + 1):
            patch = _strip(frame, parts, place, storey, density)
            for upper, row in enumerate((patch[0], patch[-1])):
                below = grid[storey - 1 + upper]
                joints.append(np.column_stack([_at(parts, below, row), row]))
                share.append(weights)
                ends.append(np.tile([column, storey, upper], (len(row), 1)))
    return Mesh(
        np.vstack(parts.nodes),
        np.vstack(parts.quads),
        np.concatenate(parts.level),
        np.concatenate(parts.is_column),
        np.concatenate(parts.node_part),
        np.vstack(joints),
        np.concatenate(share),
        np.vstack(ends),
    )


def node_count(frame: PlateFrame, density: Density | None = None) -> int:
    """Return how many nodes the mesh of a frame has above its base, without making it.

    Args:
        frame: The frame.
        density: How fine; `DEFAULT` when None.

    Raises:
        FrameError: They are more than can be computed with.
    """
    density = density or DEFAULT
    xs, ys = _floor_lines(frame, density)
    column = (density.across + 1) * (density.along + 1)
    nodes = frame.storeys * (len(xs) * len(ys) + column * len(frame.places_m))
    where = f"frame {frame.name}: the number of nodes at {density.floor_m:g} m apart"
    bounds.MESH_NODES.check(nodes, where, FrameError)
    return nodes


class _Parts:
    """Patches collected so far, with nodes counted on."""

    def __init__(self) -> None:
        self.nodes: list[Real] = []
        self.quads: list[Index] = []
        self.level: list[Index] = []
        self.is_column: list[NDArray[np.bool_]] = []
        self.node_part: list[Index] = []
        self.count = 0

    def points(self, coordinates: Real, part: int) -> Index:
        first, self.count = self.count, self.count + len(coordinates)
        self.nodes.append(coordinates)
        self.node_part.append(np.full(len(coordinates), part))
        return np.arange(first, self.count)

    def patch(self, grid: Index, level: int, is_column: bool) -> None:
        quads = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4)
        self.quads.append(quads)
        self.level.append(np.full(len(quads), level))
        self.is_column.append(np.full(len(quads), is_column))


def _floor_lines(frame: PlateFrame, density: Density) -> tuple[Real, Real]:
    """Return grid lines in x and y that pass through every column's nodes."""
    half_x, half_y = frame.plate.length_m / 2.0, frame.plate.width_m / 2.0
    across = np.linspace(-0.5, 0.5, density.across + 1) * frame.columns.width_m
    fixed_x = np.array([-half_x, half_x] + [x for x, _ in frame.places_m])
    fixed_y = np.concatenate([[-half_y, half_y]] + [y + across for _, y in frame.places_m])
    return _subdivide(fixed_x, density.floor_m), _subdivide(fixed_y, density.floor_m)


def _subdivide(fixed: Real, longest: float) -> Real:
    """Return fixed lines and lines between them, not farther apart than ``longest``."""
    lines = np.sort(fixed)
    lines = lines[np.concatenate([[True], np.diff(lines) > SAME_PLACE])]
    pieces = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / longest - 1e-9))) + 1)[:-1] for a, b in pairwise(lines)
    ]
    return np.concatenate([*pieces, lines[-1:]])


def _floor_grids(frame: PlateFrame, parts: _Parts, xs: Real, ys: Real) -> list[Index]:
    """Add all floors; return their node numbers, those under the columns alone for the base."""
    across_x, across_y = np.meshgrid(xs, ys)
    plan = np.column_stack([across_x.ravel(), across_y.ravel()])
    under = np.zeros(len(plan), bool)
    for x, y in frame.places_m:
        half = frame.columns.width_m / 2.0 + SAME_PLACE
        under |= (np.abs(plan[:, 0] - x) < SAME_PLACE) & (np.abs(plan[:, 1] - y) < half)
    base = plan[under]
    grids = [parts.points(np.column_stack([base, np.zeros(len(base))]), 0)]
    for floor in range(1, frame.storeys + 1):
        height = np.full(len(plan), floor * frame.storey_height_m)
        numbers = parts.points(np.column_stack([plan, height]), floor)
        parts.patch(numbers.reshape(len(ys), len(xs)), floor, False)
        grids.append(numbers)
    return grids


def _strip(
    frame: PlateFrame, parts: _Parts, place: tuple[float, float], storey: int, density: Density
) -> Index:
    """Add one column in one storey; return its node numbers (rows upwards, across)."""
    across = place[1] + np.linspace(-0.5, 0.5, density.across + 1) * frame.columns.width_m
    height = (storey - 1 + np.linspace(0.0, 1.0, density.along + 1)) * frame.storey_height_m
    y, z = np.meshgrid(across, height)
    numbers = parts.points(np.column_stack([np.full(y.size, place[0]), y.ravel(), z.ravel()]), -storey)
    grid = numbers.reshape(y.shape)
    parts.patch(grid, storey, True)
    return grid


def _at(parts: _Parts, candidates: Index, wanted: Index) -> Index:
    """Return the candidates that stand where the wanted nodes stand."""
    nodes = np.vstack(parts.nodes)
    distance = np.abs(nodes[candidates][:, None, :] - nodes[wanted][None, :, :]).max(axis=2)
    nearest = distance.argmin(axis=0)
    if distance[nearest, np.arange(len(wanted))].max() > SAME_PLACE:
        raise FrameError(
            "mesh: a column's node has no floor node at its place; this is a bug, please report it"
        )
    return np.asarray(candidates[nearest])
