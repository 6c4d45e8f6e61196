"""Stiffness and mass of a whole frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix, diags_array

from pounding.frames.definition import PlateFrame
from pounding.frames.errors import FrameError
from pounding.frames.fe import shells
from pounding.frames.fe.kinematics import RY, Kinematics, kinematics
from pounding.frames.fe.mesh import DEFAULT, Density, Mesh, build_mesh
from pounding.frames.fe.shells import DOFS, Sections

Real = NDArray[np.float64]

JOINTS = ("calibrated", "rigid")


@dataclass(frozen=True)
class Options:
    """How a frame is modelled.

    Attributes:
        joints: "calibrated": rotational springs between columns and floors; "rigid": none.
        p_delta: Whether gravity's geometric stiffness counts.
        calibration: Name of the joints' calibration; the frame's default when None.
        rigid_floors: Whether floors are rigid in their plane.
        density: How fine the mesh is.
    """

    joints: Literal["calibrated", "rigid"] = "calibrated"
    p_delta: bool = True
    calibration: str | None = None
    rigid_floors: bool = True
    density: Density = DEFAULT

    def __post_init__(self) -> None:
        if self.joints not in JOINTS:
            raise FrameError(f"joints: {self.joints!r} is not known, use one of {', '.join(JOINTS)}")


@dataclass(frozen=True)
class Model:
    """The finite-element model of a frame, before any reduction.

    Attributes:
        frame: What it is a model of.
        options: How.
        mesh: Nodes and elements.
        coordinates: What the nodes share.
        stiffness: K (coordinates, coordinates) [N/m, N, N m].
        mass: M (coordinates, coordinates) [kg, kg m, kg m^2].
        node_mass: Mass of all nodes (6 nodes, 6 nodes), the base's included.
    """

    frame: PlateFrame
    options: Options
    mesh: Mesh
    coordinates: Kinematics
    stiffness: csr_matrix
    mass: csr_matrix
    node_mass: csr_matrix

    def inertia_of(self, motion: Real) -> Real:
        """Return the coordinates' inertia forces (coordinates, k) for unit accelerations of all nodes.

        Args:
            motion: Accelerations of all nodes (6 nodes, k).
        """
        return np.asarray(self.coordinates.to_nodes.T @ (self.node_mass @ motion))


def assemble(frame: PlateFrame, options: Options | None = None) -> Model:
    """Return the finite-element model of a plate frame.

    Raises:
        FrameError: The frame has no such calibration, or a value that cannot be.
    """
    options = options or Options()
    mesh = build_mesh(frame, options.density)
    flexible = options.joints == "calibrated"
    coordinates = kinematics(frame, mesh, flexible_joints=flexible, rigid_floors=options.rigid_floors)
    stiffness, mass = shells.assemble(mesh.nodes, mesh.quads, _sections(frame, mesh, options))
    mass = (mass + diags_array(_extra_mass(frame, mesh, mass.diagonal()))).tocsr()
    if flexible:
        stiffness = stiffness + joint_springs(frame, mesh, options.calibration)
    t = coordinates.to_nodes
    reduced = (t.T @ stiffness @ t).tocsr()
    if frame.base_rotational_stiffness_n_m_per_rad is not None:
        base = int(np.flatnonzero(coordinates.place == -1 - RY)[0])
        spring = np.zeros(reduced.shape[0])
        spring[base] = frame.base_rotational_stiffness_n_m_per_rad
        reduced = reduced + diags_array(spring)
    return Model(frame, options, mesh, coordinates, reduced.tocsr(), (t.T @ mass @ t).tocsr(), mass)


def joint_springs(frame: PlateFrame, mesh: Mesh, calibration: str | None = None) -> csr_matrix:
    """Return the springs between columns and floors (6 nodes, 6 nodes) [N m/rad].

    A column that runs through the floors has one joint at each floor, counted at the upper end of the storey
    below, and one at the base.

    Args:
        frame: The frame.
        mesh: Its mesh.
        calibration: Name of the joints' calibration; the frame's default when None.
    """
    at_top, lowest = mesh.ends[:, 2] == 1, mesh.ends[:, 1] == 1
    counted = at_top | lowest | (not frame.columns.continuous)
    floor, column = (DOFS * mesh.joints[counted] + RY).T
    spring = frame.joint_stiffness(calibration) * mesh.joint_share[counted]
    rows = np.concatenate([floor, column, floor, column])
    columns = np.concatenate([floor, column, column, floor])
    values = np.concatenate([spring, spring, -spring, -spring])
    size = DOFS * len(mesh.nodes)
    return coo_matrix((values, (rows, columns)), shape=(size, size)).tocsr()


def _sections(frame: PlateFrame, mesh: Mesh, options: Options) -> Sections:
    thickness = np.where(mesh.is_column, frame.columns.thickness_m, frame.plate.thickness_m)
    storey = np.array(frame.storey_stiffness_factor or [1.0] * frame.storeys)
    elasticity = frame.stiffness_factor * np.where(mesh.is_column, storey[mesh.level - 1], 1.0)
    tension = np.zeros(len(mesh.quads))
    if options.p_delta:
        # Every column carries an equal share; the sway of a rigid floor sees the sum alone.
        carried = -np.array(frame.weights_n()) / (len(frame.places_m) * frame.columns.width_m)
        tension = np.where(mesh.is_column, carried[mesh.level - 1], 0.0)
    return Sections(frame.material, thickness, elasticity, tension)


def _extra_mass(frame: PlateFrame, mesh: Mesh, plain: Real) -> Real:
    """Return what stands on the floors beside the plates, and what an eccentricity moves (6 nodes,) [kg]."""
    extra = np.zeros((len(mesh.nodes), DOFS))
    for floor in range(1, frame.storeys + 1):
        nodes = np.flatnonzero(mesh.node_part == floor)
        plate = plain.reshape(-1, DOFS)[nodes, 0]
        spread = plate * frame.nonstructural_mass_kg / (frame.storeys * plate.sum())
        y = mesh.nodes[nodes, 1]
        total = plate + spread
        # A density that rises along y moves the centre of mass and leaves mass and inertia as they are.
        tilt = total * frame.mass_eccentricity_m * y * total.sum() / (total @ y**2)
        added = frame.added_by_floor_kg[floor - 1] * _shares(mesh.nodes[nodes], frame.mass_eccentricity_m)
        extra[nodes, :3] += (spread + tilt + added)[:, None]
    return extra.ravel()


def _shares(points: Real, y: float) -> Real:
    """Return the nodes' shares in a mass at (0, y) on a floor, which keep its place."""
    return _hat(points[:, 0], 0.0) * _hat(points[:, 1], y)


def _hat(values: Real, at: float) -> Real:
    """Return linear interpolation weights of a grid's lines for one place."""
    lines = np.unique(np.round(values, 9))
    upper = int(np.clip(np.searchsorted(lines, at), 1, len(lines) - 1))
    share = (at - lines[upper - 1]) / (lines[upper] - lines[upper - 1])
    low, high = np.isclose(values, lines[upper - 1]), np.isclose(values, lines[upper])
    return np.asarray((1.0 - share) * low + share * high)
