"""Frames of the second world: two column lines with floors across and joint springs, in OpenSees.

They take the numbers of `Beams`, so that what changes a frame of the own world changes these alike; what they
are made of is another thing: floors that bend, columns that shorten, one element a storey with P-Delta, lumped
masses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.baseline import designed
from pounding.diagnosis.hidden.beams import Beams, Matrices, with_appendage
from pounding.diagnosis.hidden.modes import frequencies_hz
from pounding.diagnosis.hidden.opensees.domain import Domain

STRETCHLESS = 20
"""Cross-section of a floor over that of the columns of a side: it hardly stretches."""

SOFTEST, STIFFEST = np.log(0.05), np.log(50.0)
"""Range of the joints' factor within which a frame is tuned (logarithms)."""

SLIPPED, KNEE, KNEE_LATER = 0.02, 2.0, (0.5, 0.15)
"""Of joints that slip: stiffness afterwards over before, and how round the knee is at first and later (`Steel02`)."""


@dataclass(frozen=True)
class PlaneFrame(Beams):
    """A frame of two column lines.

    Attributes:
        span_m: Distance between the column lines [m].
        youngs: Young's modulus [Pa].
        side_area: Cross-section of the columns of one line [m^2].
        floor_bending: Bending stiffness of each floor across the span [N m^2], shape (storeys,).
        rayleigh: Damping in proportion to mass [1/s] and to initial stiffness [s].
        modal: Damping ratio of each lateral mode beside it; empty for Rayleigh's alone.
        tuned_hz: The first frequency to which the frame was tuned [Hz].
        slip_share: Of each level's joints, how much of the stiffness slips, shape (storeys + 1,); empty for none.
        slip_rotation: Rotation about which it does [rad].
    """

    span_m: float = 0.4
    youngs: float = 2e11
    side_area: float = 0.0
    floor_bending: np.ndarray = field(default_factory=lambda: np.zeros(0))
    rayleigh: tuple[float, float] = (0.0, 0.0)
    modal: np.ndarray = field(default_factory=lambda: np.zeros(0))
    tuned_hz: float = np.nan
    slip_share: np.ndarray = field(default_factory=lambda: np.zeros(0))
    slip_rotation: float = 0.0

    def matrices(self) -> Matrices:
        """Return the matrices of the frame as OpenSees has it under its weight, without its massless unknowns."""
        domain = Domain()
        standing = raise_frame(domain, self)
        domain.stand(standing.weights)
        return _condensed(domain, standing)


@dataclass(frozen=True)
class Standing:
    """A frame in a domain.

    Attributes:
        frame: The frame.
        floors: Node of each floor that carries its motion along x.
        corners: Both nodes of each floor.
        masses: Mass [kg] of a node in a direction, (node, direction) -> mass.
        weights: Dead loads (node, along x, along y) [N].
        elements: All elements, for Rayleigh's damping.
    """

    frame: PlaneFrame
    floors: tuple[int, ...]
    corners: tuple[tuple[int, int], ...]
    masses: dict[tuple[int, int], float]
    weights: tuple[tuple[int, float, float], ...]
    elements: tuple[int, ...]


@lru_cache
def plane_frame(name: str) -> PlaneFrame:
    """Return a frame of the thesis, its joints tuned to the first frequency that the software believes.

    Args:
        name: A plate frame that `frames.load` knows.

    Raises:
        CaseError: The frame is none of plates.
    """
    frame = designed(name)
    plates, beams = frame.plates, frame.beams
    columns, youngs = len(plates.places_m), plates.material.youngs_modulus_gpa * 1e9
    floor_bending = youngs * plates.plate.width_m * plates.plate.thickness_m**3 / 12
    lines = [x for x, _ in plates.places_m]
    start = PlaneFrame(
        **{one.name: getattr(beams, one.name) for one in fields(Beams)},
        span_m=max(lines) - min(lines),
        youngs=youngs,
        side_area=columns / 2 * plates.columns.width_m * plates.columns.thickness_m,
        floor_bending=np.full(plates.storeys, floor_bending),
        tuned_hz=float(frame.frequencies_hz[0]),
    )
    return tuned(start)


def tuned(frame: PlaneFrame) -> PlaneFrame:
    """Return a frame whose joints are all stiffened alike until its first frequency is `tuned_hz`.

    Raises:
        CaseError: No stiffness of the joints does it.
    """

    def stiffened(log: float) -> PlaneFrame:
        return replace(frame, joint=frame.joint * np.exp(log))

    def above(log: float) -> float:
        return float(frequencies_hz(stiffened(log), 1)[0]) / frame.tuned_hz - 1

    if above(SOFTEST) > 0 or above(STIFFEST) < 0:
        raise CaseError(
            f"no joints bring the hidden frame {frame.name} to {frame.tuned_hz:.2f} Hz; ask for less model error"
        )
    return stiffened(float(brentq(above, SOFTEST, STIFFEST, xtol=1e-4)))


def raise_frame(domain: Domain, frame: PlaneFrame) -> Standing:
    """Add a frame to a domain: its nodes, elements and masses.

    Args:
        domain: Where it is added.
        frame: The frame.
    """
    ops, half = domain.ops, frame.span_m / 2
    straight, leaning = domain.number(), domain.number()
    ops.geomTransf("Linear", straight)
    ops.geomTransf("PDelta", leaning)
    corners = [_base(domain, frame)]
    corners += [(domain.node(-half, y), domain.node(half, y)) for y in frame.heights_m.tolist()]
    elements, heads = [], []
    for level, pair in enumerate(corners):
        heads.append(
            [_head(domain, frame, level, x, corner) for x, corner in zip((-half, half), pair, strict=True)]
        )
        elements += [element for _, element in heads[-1]]
    modulus, area = frame.youngs, frame.side_area
    for storey in range(frame.storeys):
        left, right = corners[storey + 1]
        elements.append(domain.number())
        across = float(frame.floor_bending[storey]) / modulus
        ops.element(
            "elasticBeamColumn", elements[-1], left, right, STRETCHLESS * area, modulus, across, straight
        )
        for (low, _), (high, _) in zip(heads[storey], heads[storey + 1], strict=True):
            elements.append(domain.number())
            inertia = 0.5 * float(frame.bending[storey]) / modulus
            ops.element("elasticBeamColumn", elements[-1], low, high, area, modulus, inertia, leaning)
    floors = corners[1:]
    above = np.append(frame.axial[1:], 0.0)
    loads = [
        (corner, 0.0, -0.5 * float(weight))
        for pair, weight in zip(floors, frame.axial - above, strict=True)
        for corner in pair
    ]
    masses = _masses(domain, frame, floors)
    return Standing(
        frame, tuple(left for left, _ in floors), tuple(floors), masses, tuple(loads), tuple(elements)
    )


def _base(domain: Domain, frame: PlaneFrame) -> tuple[int, int]:
    """Return the feet of the column lines: held, or on a stiff bar that turns on a spring."""
    half = frame.span_m / 2
    if not np.isfinite(frame.base):
        return domain.node(-half, 0.0, (1, 1, 1)), domain.node(half, 0.0, (1, 1, 1))
    ground, pivot = domain.node(0.0, 0.0, (1, 1, 1)), domain.node(0.0, 0.0, (1, 1, 0))
    domain.spring(ground, pivot, 6, "Elastic", float(frame.base))
    left, right = domain.node(-half, 0.0), domain.node(half, 0.0)
    bar = domain.number()
    domain.ops.geomTransf("Linear", bar)
    # A thousand times what the floors are.
    inertia = 1e3 * float(frame.floor_bending[0]) / frame.youngs
    for low, high in ((left, pivot), (pivot, right)):
        domain.ops.element(
            "elasticBeamColumn", domain.number(), low, high, 100 * frame.side_area, frame.youngs, inertia, bar
        )
    return left, right


def _head(domain: Domain, frame: PlaneFrame, level: int, x: float, corner: int) -> tuple[int, int]:
    """Return the columns' node at a level, which turns against the floor on the joint's spring, and that spring."""
    held = level == 0 and not np.isfinite(frame.base)
    # OpenSees' transformation knows one constraint a node, and none that hangs on another.
    head = domain.node(x, level * frame.height_m, (1, 1, 0) if held else (0, 0, 0))
    if not held:
        domain.ops.equalDOF(corner, head, 1, 2)
    stiffness = 0.5 * float(frame.joint[level])
    slips = stiffness * float(frame.slip_share[level]) if frame.slip_share.size else 0.0
    if slips:
        # Menegotto and Pinto's law with so round a knee that bolts slip one by one.
        domain.spring(
            corner, head, 6, "Steel02", slips * frame.slip_rotation, slips, SLIPPED, KNEE, *KNEE_LATER
        )
    return head, domain.spring(corner, head, 6, "Elastic", stiffness - slips, damped=True)


def _masses(
    domain: Domain, frame: PlaneFrame, floors: Sequence[tuple[int, int]]
) -> dict[tuple[int, int], float]:
    """Give the floors their masses and half of those of the columns at them, and return them."""
    masses: dict[tuple[int, int], float] = {}
    for number, (left, right) in enumerate(floors, 1):
        columns = frame.column_mass * (0.5 if number == frame.storeys else 1.0)
        mass = float(frame.floor_mass[number - 1]) + columns
        for corner in (left, right):
            domain.ops.mass(corner, mass / 2, mass / 2, 0.0)
            masses |= {(corner, 1): mass / 2, (corner, 2): mass / 2}
    return masses


def _condensed(domain: Domain, standing: Standing) -> Matrices:
    stiffness, frame = domain.stiffness(), standing.frame
    kept = list(standing.masses)
    rows = [domain.ops.nodeDOFs(node)[direction - 1] for node, direction in kept]
    others = np.setdiff1d(np.arange(len(stiffness)), rows)
    across = stiffness[np.ix_(rows, others)]
    whole = stiffness[np.ix_(rows, rows)] - across @ np.linalg.solve(
        stiffness[np.ix_(others, others)], across.T
    )
    level = {corner: number for number, pair in enumerate(standing.corners) for corner in pair}
    floors = np.zeros((frame.storeys, len(kept)))
    along = np.zeros_like(floors)
    for column, (node, way) in enumerate(kept):
        floors[level[node], column] = float(way == 1 and node in standing.floors)
        along[level[node], column] = float(way == 1)
    bare = Matrices(
        np.diag([standing.masses[key] for key in kept]),
        0.5 * (whole + whole.T),
        floors,
        along.sum(axis=0),
        frame.heights_m @ along,
    )
    return with_appendage(frame.appendage, frame, bare) if frame.appendage else bare
