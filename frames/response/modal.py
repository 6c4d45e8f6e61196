"""Modal analysis of the full model: every motion, not only the one along x."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pounding.frames.definition import Frame, StickFrame
from pounding.frames.fe.assembly import Model, Options, assemble
from pounding.frames.fe.mesh import Mesh
from pounding.frames.fe.shells import DOFS
from pounding.frames.reduction.craig_bampton import lowest_modes
from pounding.frames.stick import build as build_stick

Real = NDArray[np.float64]

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""Unit motions of the base: translations, and rotations about the axes through the centre of the base."""

UP_TO_HZ = 60.0
"""The laboratory's sweeps ended at 50 Hz; what the reduced frames promise ends here [Hz]."""

KINDS = ("bending in x", "bending in y", "torsion", "bending of the floor plates")


@dataclass(frozen=True)
class Modes:
    """Natural modes of a frame, lowest first.

    Attributes:
        frequencies_hz: (m,) [Hz].
        shapes: Mass-normalised (coordinates, m).
        damping_ratios: (m,), fractions.
        participation: Participation factor of each mode in each direction (m, 6) [sqrt(kg), sqrt(kg) m].
        rigid_mass: Mass and moments of inertia about the base's centre (6,) [kg, kg m^2].
        descriptions: What each mode is, such as "1st bending in x".
    """

    frequencies_hz: Real
    shapes: Real
    damping_ratios: Real
    participation: Real
    rigid_mass: Real
    descriptions: list[str]

    @property
    def effective_mass(self) -> Real:
        """Effective modal mass in each direction (m, 6) [kg, kg m^2]."""
        return self.participation**2

    @property
    def effective_mass_ratio(self) -> Real:
        """Effective modal mass over the frame's mass or moment of inertia (m, 6)."""
        return self.effective_mass / self.rigid_mass


def analyse(
    frame: Frame, options: Options | None = None, *, up_to_hz: float = UP_TO_HZ, damping: float | None = None
) -> Modes:
    """Return the natural modes of a frame.

    Args:
        frame: A plate frame, or a stick (which moves along x, and turns if it has an eccentricity).
        options: How a plate frame is modelled; the baseline model when None.
        up_to_hz: Modes up to this frequency [Hz].
        damping: Damping ratio of all modes, a fraction; the frame's own when None.

    Raises:
        FrameError: The frame cannot be built so.
    """
    if isinstance(frame, StickFrame):
        return _of_stick(frame, up_to_hz, damping)
    ratio = frame.damping_ratio if damping is None else damping
    return modes_of(assemble(frame, options), up_to_hz, ratio)


def modes_of(model: Model, up_to_hz: float, damping_ratio: float = 0.0) -> Modes:
    """Return the natural modes of an assembled model up to a frequency [Hz].

    Args:
        model: The assembled model.
        up_to_hz: Highest frequency [Hz].
        damping_ratio: Damping ratio of every mode [-].
    """
    frequencies, shapes = lowest_modes(model.stiffness.tocsc(), model.mass.tocsc(), keep_hz=up_to_hz)
    motion = rigid_motions(model.mesh)
    return Modes(
        frequencies,
        shapes,
        np.full(len(frequencies), damping_ratio),
        shapes.T @ model.inertia_of(motion),
        np.einsum("ij,ij->j", motion, model.node_mass @ motion),
        describe(_energies(model, shapes)),
    )


def rigid_motions(mesh: Mesh) -> Real:
    """Return the displacements of all nodes (6 nodes, 6) in unit motions of the base."""
    x, y, z = mesh.nodes.T
    motion = np.zeros((len(mesh.nodes), DOFS, 6))
    motion[:, np.arange(6), np.arange(6)] = 1.0
    motion[:, 1, 3], motion[:, 2, 3] = -z, y
    motion[:, 0, 4], motion[:, 2, 4] = z, -x
    motion[:, 0, 5], motion[:, 1, 5] = -y, x
    return motion.reshape(-1, 6)


def mac(first: Real, second: Real) -> Real:
    """Return the modal assurance criterion (m, k) of shapes (n, m) and (n, k): 1 for equal, 0 for unlike."""
    cross = first.T @ second
    own = np.einsum("ij,ij->j", first, first)[:, None] * np.einsum("ij,ij->j", second, second)
    return np.asarray(cross**2 / own)


def describe(energies: Real) -> list[str]:
    """Return a name for each mode from its kinetic energy in each of `KINDS` (m, 4)."""
    seen: Counter[str] = Counter()
    names = []
    for row in energies:
        kind = KINDS[int(row.argmax())]
        seen[kind] += 1
        names.append(f"{ordinal(seen[kind])} {kind}")
    return names


def ordinal(number: int) -> str:
    """Return 1st, 2nd, 3rd, 4th, ..."""
    teen = 10 <= number % 100 <= 20
    return f"{number}{'th' if teen else {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')}"


def _energies(model: Model, shapes: Real) -> Real:
    """Return each mode's kinetic energy in the floors' sway along x and y, their torsion, and vertically."""
    motion = (model.coordinates.to_nodes @ shapes).reshape(len(model.mesh.nodes), DOFS, shapes.shape[1])
    node_mass = model.node_mass.diagonal().reshape(-1, DOFS)[:, 0]
    part, nodes = model.mesh.node_part, model.mesh.nodes
    energies = np.zeros((shapes.shape[1], len(KINDS)))
    energies[:, 3] = np.einsum("i,im->m", node_mass, motion[:, 2] ** 2)
    for floor, (along_x, along_y, about_z) in enumerate(model.coordinates.floor, 1):
        on = part == floor
        mass, polar = node_mass[on], node_mass[on] @ (nodes[on, 0] ** 2 + nodes[on, 1] ** 2)
        energies[:, 0] += mass.sum() * shapes[along_x] ** 2
        energies[:, 1] += mass.sum() * shapes[along_y] ** 2
        energies[:, 2] += polar * shapes[about_z] ** 2
    return energies


def _of_stick(frame: StickFrame, up_to_hz: float, damping: float | None) -> Modes:
    reduced = build_stick(frame, damping)
    wanted = reduced.frequencies_hz <= up_to_hz
    shapes = reduced.shapes[:, wanted]
    mass, heights = reduced.mass, reduced.heights_m
    motion = np.zeros((len(mass), 6))
    motion[reduced.floor_x, 0], motion[reduced.floor_x, 4] = 1.0, heights
    motion[reduced.floor_rz, 5] = 1.0
    total, _, _, _, tilt, turn = np.einsum("ij,ij->j", motion, mass @ motion)
    energies = np.zeros((shapes.shape[1], len(KINDS)))
    energies[:, 0] = _energy(shapes, mass, reduced.floor_x)
    energies[:, 2] = _energy(shapes, mass, reduced.floor_rz)
    return Modes(
        reduced.frequencies_hz[wanted],
        shapes,
        reduced.damping_ratios[wanted],
        shapes.T @ mass @ motion,
        np.array([total, total, total, tilt, tilt, turn or 1.0]),
        describe(energies),
    )


def _energy(shapes: Real, mass: Real, rows: NDArray[np.int64]) -> Real:
    """Return the share of some coordinates in each mode's kinetic energy (m,)."""
    return np.asarray(np.einsum("im,ij,jm->m", shapes[rows], mass[np.ix_(rows, rows)], shapes[rows]))
