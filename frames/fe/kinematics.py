"""What the nodes of a frame share: rigid floors, joints, the base.

All six displacements ``u`` of all nodes follow from fewer coordinates ``q`` by ``u = T q``:

- a floor moves in its plane as a rigid body (thesis, section 3.5): two translations and one rotation a floor;
- the end of a column shares everything with the floor it stands on or hangs from, but for the rotation about
  y when the joint is flexible. A column that runs on through the floor has one such rotation there for the
  strips below and above, and one rotational spring ties it to the floor, as a panel zone does;
- the base is fixed, or turns about y as a rigid body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix

from pounding.frames.definition import PlateFrame
from pounding.frames.fe.mesh import Mesh
from pounding.frames.fe.shells import DOFS

Real = NDArray[np.float64]
Index = NDArray[np.int64]

RY = 4
"""Component of the rotation about y, the one that a joint's spring and a rocking base leave free."""

PLANE = (0, 1, 5)
"""Components of a floor's rigid motion in its plane: along x, along y, about z."""


@dataclass(frozen=True)
class Kinematics:
    """The coordinates of a frame.

    Attributes:
        to_nodes: T, displacements of all nodes for unit coordinates (6 nodes, coordinates).
        floor: Coordinates that are a floor's motion along x, along y and about z (storeys, 3); the node at
            the plan's centre stands for the floor when floors are not rigid.
        place: Displacement (node * 6 + component) that a coordinate is, or -1 - component for the motion of
            a whole floor or base (coordinates,).
    """

    to_nodes: csr_matrix
    floor: Index
    place: Index

    def translation(self) -> Real:
        """Return the coordinates (coordinates,) when every node but the base's moves along x by 1."""
        whole = self.place < 0
        component = np.where(whole, -1 - self.place, self.place % DOFS)
        return np.asarray(component == 0, float)


def kinematics(
    frame: PlateFrame, mesh: Mesh, *, flexible_joints: bool = True, rigid_floors: bool = True
) -> Kinematics:
    """Return the coordinates of a frame.

    Args:
        frame: The frame.
        mesh: Its mesh.
        flexible_joints: Whether the joints have a rotation of their own.
        rigid_floors: Whether floors are rigid in their plane.
    """
    master = _masters(frame, mesh, flexible_joints)
    own = np.zeros(len(master), bool)
    own[master] = True
    components = np.tile(np.arange(DOFS), len(mesh.nodes))
    part = np.repeat(mesh.node_part, DOFS)
    own &= part != 0
    if rigid_floors:
        own &= ~((part > 0) & np.isin(components, PLANE))
    place = np.flatnonzero(own)
    rigid = 3 * frame.storeys if rigid_floors else 0
    rocking = int(frame.base_rotational_stiffness_n_m_per_rad is not None)
    entries = [(place, rigid + rocking + np.arange(len(place)), np.ones(len(place)))]
    if rigid_floors:
        entries += _rigid_floors(frame, mesh)
    if rocking:
        entries += _rocking_base(mesh, rigid)
    rows, columns, values = (np.concatenate(column) for column in zip(*entries, strict=True))
    shape = (len(master), rigid + rocking + len(place))
    masters = coo_matrix((values, (rows, columns)), shape=shape).tocsr()
    whole = [-1 - component for component in PLANE] * (frame.storeys if rigid_floors else 0)
    place = np.concatenate([np.array(whole + [-1 - RY] * rocking, int), place])
    floor = np.arange(rigid).reshape(-1, 3) if rigid_floors else _central(frame, mesh, place)
    return Kinematics(masters[master], floor, place)


def _masters(frame: PlateFrame, mesh: Mesh, flexible_joints: bool) -> Index:
    """Return for each displacement (6 nodes,) the one that it is a copy of, or itself."""
    master = np.arange(DOFS * len(mesh.nodes))
    floor, column = mesh.joints.T
    for component in range(DOFS):
        if component != RY or not flexible_joints:
            master[DOFS * column + component] = DOFS * floor + component
    if flexible_joints and frame.columns.continuous:
        # Pairs are stored column by column and storey by storey, lower end before upper end.
        across = len(column) // (2 * frame.storeys * len(frame.places_m))
        ends = column.reshape(len(frame.places_m), frame.storeys, 2, across)
        master[DOFS * ends[:, 1:, 0] + RY] = DOFS * ends[:, :-1, 1] + RY
    return master


def _rigid_floors(frame: PlateFrame, mesh: Mesh) -> list[tuple[Index, Index, Real]]:
    nodes = np.flatnonzero(mesh.node_part > 0)
    first = 3 * (mesh.node_part[nodes] - 1)
    x, y = mesh.nodes[nodes, 0], mesh.nodes[nodes, 1]
    one = np.ones(len(nodes))
    return [
        (DOFS * nodes, first, one),
        (DOFS * nodes, first + 2, -y),
        (DOFS * nodes + 1, first + 1, one),
        (DOFS * nodes + 1, first + 2, x),
        (DOFS * nodes + 5, first + 2, one),
    ]


def _rocking_base(mesh: Mesh, coordinate: int) -> list[tuple[Index, Index, Real]]:
    nodes = np.flatnonzero(mesh.node_part == 0)
    column = np.full(len(nodes), coordinate)
    return [
        (DOFS * nodes + 2, column, -mesh.nodes[nodes, 0]),
        (DOFS * nodes + RY, column, np.ones(len(nodes))),
    ]


def _central(frame: PlateFrame, mesh: Mesh, place: Index) -> Index:
    column_of = {int(p): number for number, p in enumerate(place) if p >= 0}
    rows = []
    for floor in range(1, frame.storeys + 1):
        nodes = np.flatnonzero(mesh.node_part == floor)
        middle = int(nodes[np.hypot(mesh.nodes[nodes, 0], mesh.nodes[nodes, 1]).argmin()])
        rows.append([column_of[DOFS * middle + component] for component in PLANE])
    return np.array(rows)
