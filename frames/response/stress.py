"""Stresses of a frame in motion, with those of the columns carried to their ends where they are largest.

An element knows its stress at its centre. A column between two floors bends with a moment that is linear in
height, so the straight line through the centres of its two outermost elements gives the stress at its end;
the centre alone would miss one part in twice the number of elements along the column.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pounding.frames.errors import FrameError
from pounding.frames.fe.shells import von_mises

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

CANDIDATES = 200
"""Places looked at over the whole history, the worst at the instants when a coordinate peaks."""


BLOCK = 2000
"""Instants looked at together; a long run would not fit in memory at once."""

ROUNDING = 1e-9
"""Stresses so close to each other are equal."""


class StressMap(NamedTuple):
    """Stresses for unit coordinates.

    Attributes:
        rows: Stresses (elements, 2, 3, n) [Pa/m]: lower and upper surface; normal stress along the element's
            first and second side and shear stress. Outermost elements of a column: at the column's end.
    """

    rows: Real

    def von_mises(self, q: Real) -> Real:
        """Return von Mises' stress (elements,) [Pa], of the worse surface, for coordinates q (n,)."""
        return np.asarray(von_mises(self.rows @ q).max(axis=1))


class Largest(NamedTuple):
    """The largest stress of a motion.

    Attributes:
        stress_pa: Von Mises' stress [Pa].
        instant: Index of the instant in the motion.
        element: Element of the mesh.
        place: Where it is, in words.
    """

    stress_pa: float
    instant: int
    element: int
    place: str


def stress_map(reduced: ReducedFrame) -> StressMap:
    """Return the stresses of a plate frame for unit coordinates.

    Raises:
        FrameError: The frame is a stick; it has no plates.
    """
    recovery = reduced.recovery
    rows = np.stack([recovery.surface_stress(unit) for unit in np.eye(len(reduced.mass))], axis=-1)
    for end, inner in _column_ends(reduced):
        rows[end] += 0.5 * (rows[end] - rows[inner])
    return StressMap(rows)


def largest_stress(reduced: ReducedFrame, displacement: Real) -> Largest:
    """Return the largest stress of a motion.

    Args:
        reduced: A plate frame.
        displacement: Its coordinates (m, n) [m].

    Raises:
        FrameError: The frame is a stick.
    """
    rows = stress_map(reduced).rows
    instants = np.unique(np.concatenate([displacement.argmax(axis=0), displacement.argmin(axis=0)]))
    worst = np.max([StressMap(rows).von_mises(displacement[i]) for i in instants], axis=0)
    chosen = np.argsort(worst)[-CANDIDATES:]
    reached = _reaching(reduced, rows[chosen], displacement, worst.max())
    history = np.concatenate(
        [
            _histories(rows[chosen], displacement[reached[start : start + BLOCK]])
            for start in range(0, len(reached), BLOCK)
        ]
    )
    instant, place = np.unravel_index(int(history.argmax()), history.shape)
    element = int(chosen[place])
    return Largest(float(history.max()), int(reached[instant]), element, _words(reduced, element))


def _reaching(reduced: ReducedFrame, rows: Real, displacement: Real, stress_pa: float) -> NDArray[np.intp]:
    """Return the instants at which a stress may be reached: the modes' largest stresses add up to it there.

    Von Mises' stress is a norm of the stresses, so that of a sum of modes is at most the sum of theirs. A
    first mode far above the others leaves few instants.
    """
    modal = displacement @ (reduced.mass @ reduced.shapes)
    unit = _histories(rows, reduced.shapes.T).max(axis=1)
    return np.flatnonzero(np.abs(modal) @ unit >= stress_pa * (1.0 - ROUNDING))


def _histories(rows: Real, displacement: Real) -> Real:
    """Return von Mises' stress (m, elements) of the worse surface for coordinates (m, n)."""
    stress = displacement @ rows.reshape(-1, rows.shape[-1]).T
    return np.asarray(von_mises(stress.reshape(len(displacement), *rows.shape[:-1])).max(axis=2))


def _column_ends(reduced: ReducedFrame) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Return the outermost elements of all columns and their neighbours inwards, for lower and upper ends."""
    mesh, density = reduced.mesh, reduced.options["density"]
    elements = np.flatnonzero(mesh.is_column)
    shape = (-1, density["along"], density["across"])
    if elements.size % (density["along"] * density["across"]):
        raise FrameError(f"{reduced.name}: the columns' elements are not {shape[1]} by {shape[2]}")
    strips = elements.reshape(shape)
    return [(strips[:, 0], strips[:, 1]), (strips[:, -1], strips[:, -2])]


def _words(reduced: ReducedFrame, element: int) -> str:
    mesh = reduced.mesh
    if not mesh.is_column[element]:
        return f"floor {mesh.level[element]}"
    middle = mesh.nodes[mesh.quads[element]].mean(axis=0)
    storey = int(mesh.level[element])
    bottom = reduced.heights_m[storey - 1] - middle[2] > middle[2] - (
        reduced.heights_m[storey - 2] if storey > 1 else 0.0
    )
    return f"column at x = {1e3 * middle[0]:.0f} mm, {'foot' if bottom else 'head'} of storey {storey}"
