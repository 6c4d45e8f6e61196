"""Plane frames of beams and columns with springs at their joints, condensed to the sway of the floors.

A storey is one column with the properties of all four: a cubic beam element of the sway of its two floors and the turn of
its two ends, with the geometric stiffness of the weight above it. Its ends turn on a node through a stiff spring, the end
fitting; the node turns on the floor through a softer one, the joint. Floors rise and fall on either column line as columns
stretch, which turns a floor as far as its plate does not bend. The foot of the frame stands on the table, or rocks on it.
Turns and lifts have little or no inertia of their own, so they follow the sway statically (Guyan 1965).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tests.planar_world.baseline import Baseline, Real

GRAVITY = 9.81
YOUNG = 200e9
STOREY_M, HALF_SPAN_M, PLATE_M = 0.1, 0.2, 0.4
"""Height of a storey, half the distance between the column lines, and length of a floor [m]."""
COLUMNS_BENDING = YOUNG * 4 * 0.040 * 0.002**3 / 12
"""Of the four columns of a storey, strips of 40 mm by 2 mm [N m^2]."""
COLUMNS_STRETCHING = YOUNG * 4 * 0.040 * 0.002
"""Of the same [N]."""
PLATE_BENDING = YOUNG * 0.4 * 0.005**3 / 12
"""Of a floor, a plate of 400 mm by 5 mm [N m^2]."""


@dataclass(frozen=True)
class Build:
    """How a frame is built, where it may differ from its drawing; every factor is one without a difference.

    Attributes:
        joint: Stiffness of the joints of a floor [N m/rad].
        fitting: Stiffness of the end fittings of a storey's columns, one end [N m/rad].
        foot: Factor on the joint at the table [-].
        roof: Factor on the joint at the roof [-].
        weight: Share of the weight that softens the columns (P-delta) [-].
        columns: Factors on the bending stiffness of each storey's columns (storeys,) [-].
        joints: Factors on the joints from the table to the roof (storeys + 1,) [-].
        masses: Factors on the masses of the floors (floors,) [-].
    """

    joint: float
    fitting: float = 3e4
    foot: float = 1.0
    roof: float = 1.0
    weight: float = 1.0
    columns: Real = field(default_factory=lambda: np.ones(0))
    joints: Real = field(default_factory=lambda: np.ones(0))
    masses: Real = field(default_factory=lambda: np.ones(0))


@dataclass(frozen=True)
class _Places:
    """Where the degrees of freedom stand; floors and storeys are counted from 0, floor -1 is the table."""

    storeys: int

    @property
    def count(self) -> int:
        return 6 * self.storeys + 2

    @property
    def rocking(self) -> int:
        return self.storeys

    def sway(self, floor: int) -> int:
        return floor

    def lift(self, floor: int) -> int:
        return self.storeys + 1 + floor

    def turn(self, floor: int) -> int:
        return 2 * self.storeys + 1 + floor

    def head(self, storey: int) -> int:
        return 3 * self.storeys + 1 + storey

    def foot(self, storey: int) -> int:
        return 4 * self.storeys + 1 + storey

    def node(self, floor: int) -> int:
        return 6 * self.storeys + 1 if floor < 0 else 5 * self.storeys + 1 + floor


def floor_masses(belief: Baseline, build: Build) -> Real:
    """Return the masses of the floors (floors,) [kg]: those of the baseline model, lumped, with the build's own factors."""
    diagonal = np.diag(belief.mass).copy()
    diagonal += belief.mass.sum(1) - diagonal
    return diagonal * build.masses if build.masses.size else diagonal


def matrices(
    belief: Baseline, build: Build, storeys: Real | None = None, rocking: float | None = None
) -> tuple[Real, Real]:
    """Return mass (floors, floors) [kg] and stiffness (floors, floors) [N/m] of the sway relative to the table.

    Args:
        belief: Gives the number of storeys and the masses.
        build: How the frame is built.
        storeys: Factors on each storey's columns together with their end fittings (storeys,) [-].
        rocking: Stiffness against rocking of the foot [N m/rad]; the foot does not rock where None.
    """
    masses = floor_masses(belief, build)
    places = _Places(len(masses))
    factors = np.ones(places.storeys) if storeys is None else storeys
    stiffness = _assembled(masses, build, factors, places)
    mass = np.zeros_like(stiffness)
    for floor, kilograms in enumerate(masses):
        mass[places.sway(floor), places.sway(floor)] = kilograms
        mass[places.lift(floor), places.lift(floor)] = kilograms * PLATE_M**2 / 12 / HALF_SPAN_M**2
    kept, cut = list(range(places.storeys)), list(range(places.storeys, places.count))
    if rocking is None:
        cut.remove(places.rocking)
    else:
        stiffness[places.rocking, places.rocking] += rocking
    return _condensed(mass, stiffness, kept, cut)


def _assembled(masses: Real, build: Build, factors: Real, places: _Places) -> Real:
    """Return the stiffness matrix of all degrees of freedom, in N/m, N and N m/rad."""
    count = places.storeys
    columns = build.columns if build.columns.size else np.ones(count)
    joints = build.joints if build.joints.size else np.ones(count + 1)
    whole = np.zeros((places.count, places.count))
    for storey in range(count):
        weight = masses[storey:].sum() * GRAVITY * build.weight
        _add_column(
            whole, places, storey, column(COLUMNS_BENDING * columns[storey] * factors[storey], weight)
        )
        fitting = build.fitting * factors[storey]
        _add_spring(whole, {places.foot(storey): 1.0, places.node(storey - 1): -1.0}, fitting)
        _add_spring(whole, {places.head(storey): 1.0, places.node(storey): -1.0}, fitting)
        if storey == 0:
            at_table = build.joint * build.foot * joints[0]
            _add_spring(whole, {places.node(-1): 1.0, places.rocking: -1.0}, at_table)
        joint = build.joint * joints[storey + 1] * (build.roof if storey == count - 1 else 1.0)
        _add_spring(whole, {places.node(storey): 1.0, places.turn(storey): -1.0}, joint)
        under = {places.lift(storey - 1): -1.0} if storey else {places.rocking: -HALF_SPAN_M}
        stretching = COLUMNS_STRETCHING / STOREY_M * factors[storey]
        _add_spring(whole, {places.lift(storey): 1.0, **under}, stretching)
        plate = 12 * PLATE_BENDING / (2 * HALF_SPAN_M)
        _add_spring(whole, {places.turn(storey): 1.0, places.lift(storey): -1 / HALF_SPAN_M}, plate)
    return whole


def _add_spring(whole: Real, terms: dict[int, float], stiffness: float) -> None:
    """Add a spring to a matrix; its deformation is the sum of degrees of freedom times factors."""
    at, factors = list(terms), np.array(list(terms.values()))
    whole[np.ix_(at, at)] += stiffness * np.outer(factors, factors)


def _add_column(whole: Real, places: _Places, storey: int, element: Real) -> None:
    """Add the columns of a storey (4, 4) to a matrix; the table does not sway relative to itself."""
    ends = [places.foot(storey), places.sway(storey), places.head(storey)]
    if storey == 0:
        whole[np.ix_(ends, ends)] += element[1:, 1:]
        return
    ends.insert(0, places.sway(storey - 1))
    whole[np.ix_(ends, ends)] += element


def column(bending: float, weight: float) -> Real:
    """Return the stiffness of a column (4, 4) in N/m, N and N m/rad: sway and turn of its foot, then of its head.

    Args:
        bending: Bending stiffness [N m^2].
        weight: What it carries [N], which softens it.
    """
    h = STOREY_M
    elastic = np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h * h, -6 * h, 2 * h * h],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h * h, -6 * h, 4 * h * h],
        ]
    )
    geometric = np.array(
        [
            [36, 3 * h, -36, 3 * h],
            [3 * h, 4 * h * h, -3 * h, -h * h],
            [-36, -3 * h, 36, -3 * h],
            [3 * h, -h * h, -3 * h, 4 * h * h],
        ]
    )
    softened: Real = bending / h**3 * elastic - weight / (30 * h) * geometric
    return softened


def _condensed(mass: Real, stiffness: Real, kept: list[int], cut: list[int]) -> tuple[Real, Real]:
    """Return mass and stiffness (kept, kept) where what is cut follows statically."""
    follow = -np.linalg.solve(stiffness[np.ix_(cut, cut)], stiffness[np.ix_(cut, kept)])
    stiff = stiffness[np.ix_(kept, kept)] + stiffness[np.ix_(kept, cut)] @ follow
    heavy = mass[np.ix_(kept, kept)] + follow.T @ mass[np.ix_(cut, cut)] @ follow
    return (heavy + heavy.T) / 2, (stiff + stiff.T) / 2
