"""A frame as planar Euler-Bernoulli beam-columns with rotational joint springs and geometric stiffness.

Unknowns: deflection and rotation of the columns at every floor and half-way between (two elements a storey,
consistent mass), and if asked for the turning of the whole base and the floors' torsion. Antisymmetry makes
one column line of all four; a floor is rigid in its plane and its bending acts in series with the joint.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

PER_STOREY = 2
"""Column elements in a storey."""

GYRATION_RADIUS_M = 0.4 / 6**0.5
"""Radius of gyration of a square floor of 0.4 m about its vertical axis [m]."""


@dataclass(frozen=True)
class Appendage:
    """A mass [kg] on a spring and damper on a floor (from 1), by its own frequency [Hz] and damping ratio."""

    floor: int
    mass: float
    frequency_hz: float
    ratio: float


@dataclass(frozen=True)
class Beams:
    """A frame's physical parameters; arrays run from the first storey or floor up.

    Attributes:
        name: Name of the frame.
        height_m: Height of a storey [m].
        bending: Bending stiffness of all columns of each storey together [N m^2].
        joint: Rotational stiffness between columns and each floor, the base first [N m/rad], all columns.
        floor_mass: Mass of each floor [kg].
        column_mass: Mass of the columns of one storey [kg].
        gyration: Rotational inertia of each floor about y [kg m^2].
        axial: Weight in the columns of each storey [N], for the geometric stiffness.
        ratios: Damping ratio of each kept mode; the last one serves all modes above.
        base: Stiffness on which the whole base turns [N m/rad]; infinite: fixed.
        dashpots: Viscous dampers between the floors of each storey [N s/m].
        eccentricity_m: Distance in y from the centre of stiffness to that of mass [m].
        torsion_ratio: Torsional over lateral frequency of the frame without eccentricity.
        appendage: A mass on a spring on one of the floors.
        joint_stated: What the frame's definition states for one joint [N m/rad].
    """

    name: str
    height_m: float
    bending: np.ndarray
    joint: np.ndarray
    floor_mass: np.ndarray
    column_mass: float
    gyration: np.ndarray
    axial: np.ndarray
    ratios: np.ndarray
    base: float = np.inf
    dashpots: np.ndarray = field(default_factory=lambda: np.zeros(0))
    eccentricity_m: float = 0.0
    torsion_ratio: float = 1.5
    appendage: Appendage | None = None
    joint_stated: float = np.nan

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return len(self.floor_mass)

    @property
    def heights_m(self) -> np.ndarray:
        """Height of each floor above the base [m]."""
        return self.height_m * np.arange(1, self.storeys + 1)

    def matrices(self) -> Matrices:
        """Return the matrices of the frame."""
        return assemble(self)


@dataclass(frozen=True)
class Matrices:
    """Mass and stiffness (n, n), floors' rows (storeys, n), unknowns under a unit push and turn (n,)."""

    mass: np.ndarray
    stiffness: np.ndarray
    floors: np.ndarray
    push: np.ndarray
    turn: np.ndarray


def assemble(beams: Beams) -> Matrices:
    """Return the matrices of a frame."""
    nodes = PER_STOREY * beams.storeys + 1
    mass, stiffness = np.zeros((2 * nodes, 2 * nodes)), np.zeros((2 * nodes, 2 * nodes))
    length = beams.height_m / PER_STOREY
    for element in range(nodes - 1):
        storey = element // PER_STOREY
        at = np.arange(2 * element, 2 * element + 4)
        stiffness[np.ix_(at, at)] += beams.bending[storey] * _bending(length)
        stiffness[np.ix_(at, at)] -= beams.axial[storey] * _geometric(length)
        mass[np.ix_(at, at)] += beams.column_mass / PER_STOREY * _consistent_mass(length)
    floors = np.arange(PER_STOREY, nodes, PER_STOREY)
    mass[2 * floors, 2 * floors] += beams.floor_mass
    joints = np.concatenate([[0], floors])
    stiffness[2 * joints + 1, 2 * joints + 1] += beams.joint
    turn, push = np.zeros(2 * nodes), np.zeros(2 * nodes)
    push[0::2] = 1.0
    turn[0::2] = length * np.arange(nodes)
    turn[1::2] = 1.0
    rows = np.zeros((beams.storeys, 2 * nodes))
    rows[np.arange(beams.storeys), 2 * floors] = 1.0
    # The foot does not move against the table; its rotation stays free on the base joint.
    free = np.ix_(np.arange(1, 2 * nodes), np.arange(1, 2 * nodes))
    matrices = Matrices(mass[free], stiffness[free], rows[:, 1:], push[1:], turn[1:])
    if np.isfinite(beams.base):
        matrices = _on_a_rocking_base(beams, matrices)
    if beams.eccentricity_m:
        matrices = _with_torsion(beams, matrices)
    return with_appendage(beams.appendage, beams, matrices) if beams.appendage else matrices


def _on_a_rocking_base(beams: Beams, fixed: Matrices) -> Matrices:
    """Add the turning of the base as the last unknown; the others stay relative to the turning base."""
    turned = fixed.mass @ fixed.turn
    inertia = fixed.turn @ turned + beams.gyration.sum()
    # The weight does work on the turned and bent columns: -P (turn + slope)^2 / 2 along them.
    coupling = fixed.floors.T @ np.diff(np.append(beams.axial, 0.0))
    spring = beams.base - beams.axial.sum() * beams.height_m
    return Matrices(
        _bordered(fixed.mass, turned, inertia),
        _bordered(fixed.stiffness, coupling, spring),
        np.column_stack([fixed.floors, beams.heights_m]),
        np.append(fixed.push, 0.0),
        np.append(fixed.turn, 0.0),
    )


def _bordered(matrix: np.ndarray, border: np.ndarray, corner: float) -> np.ndarray:
    return np.block([[matrix, border[:, None]], [border[None, :], np.array([[corner]])]])


def _with_torsion(beams: Beams, planar: Matrices) -> Matrices:
    """Add a rotation about z to every unknown, in the lateral shapes, coupled by the offset masses."""
    radius2, offset = GYRATION_RADIUS_M**2, beams.eccentricity_m
    mass = np.kron([[1.0, offset], [offset, radius2 + offset**2]], planar.mass)
    stiffness = np.kron([[1.0, 0.0], [0.0, beams.torsion_ratio**2 * radius2]], planar.stiffness)
    still = np.zeros_like(planar.push)
    return Matrices(
        mass,
        stiffness,
        np.column_stack([planar.floors, np.zeros_like(planar.floors)]),
        np.append(planar.push, still),
        np.append(planar.turn, still),
    )


def with_appendage(appendage: Appendage, beams: Beams, bare: Matrices) -> Matrices:
    """Add the appendage's displacement relative to the table as the last unknown.

    Args:
        appendage: What hangs on a floor.
        beams: The frame on which it hangs.
        bare: The frame's matrices without it.
    """
    spring = appendage.mass * (2 * np.pi * appendage.frequency_hz) ** 2
    stretch = np.append(-bare.floors[appendage.floor - 1], 1.0)
    grown = _bordered(bare.stiffness, np.zeros(len(bare.push)), 0.0) + spring * np.outer(stretch, stretch)
    return Matrices(
        _bordered(bare.mass, np.zeros(len(bare.push)), appendage.mass),
        grown,
        np.column_stack([bare.floors, np.zeros(beams.storeys)]),
        np.append(bare.push, 1.0),
        np.append(bare.turn, beams.heights_m[appendage.floor - 1]),
    )


def _bending(length: float) -> np.ndarray:
    """Stiffness of an Euler-Bernoulli element with unit bending stiffness (v, theta at both ends)."""
    h = length
    return np.array(
        [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
         [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
    ) / h**3  # fmt: skip


def _geometric(length: float) -> np.ndarray:
    """Consistent geometric stiffness of the same element under a unit compression."""
    h = length
    return np.array(
        [[36, 3 * h, -36, 3 * h], [3 * h, 4 * h**2, -3 * h, -(h**2)],
         [-36, -3 * h, 36, -3 * h], [3 * h, -(h**2), -3 * h, 4 * h**2]]
    ) / (30 * h)  # fmt: skip


def _consistent_mass(length: float) -> np.ndarray:
    """Consistent mass of the same element with unit mass."""
    h = length
    return np.array(
        [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
         [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
    ) / 420  # fmt: skip
