"""Shell elements against thin-plate theory, beam theory and rigid-body mechanics.

A bilinear element converges with the square of its size: a fitted slope of 1.85 or more tells it from the
first order and from none. Thin-plate theory leaves out shear and rotary inertia; the plates are 1/200 thin,
so that this counts for 0.02 % (what is left at 64 elements a side).
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh, spsolve

from pounding.frames.definition import Material
from pounding.frames.errors import FrameError
from pounding.frames.fe.shells import Sections, assemble, element_matrices, surface_stress_rows, von_mises

STEEL = Material()
E, NU, RHO = 200e9, 0.3, 7850.0


def grid(nx, ny, lx, ly):
    x, y = np.meshgrid(np.linspace(0, lx, nx + 1), np.linspace(0, ly, ny + 1))
    nodes = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    n = np.arange(x.size).reshape(x.shape)
    quads = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1).reshape(-1, 4)
    return nodes, quads


def matrices(nodes, quads, thickness):
    ones = np.ones(len(quads))
    return assemble(nodes, quads, Sections(STEEL, thickness * ones, ones, 0.0 * ones))


def plate_frequency(n, clamped, side=0.4, thickness=0.002):
    nodes, quads = grid(n, n, side, side)
    k, m = matrices(nodes, quads, thickness)
    on_x, on_y = (np.abs(nodes[:, axis] - side / 2) > side / 2 - 1e-9 for axis in (0, 1))
    # Bending alone: in-plane motion and drilling are held everywhere. A thin plate's support holds the
    # rotation that is the slope along the edge.
    held = np.tile([True, True, False, False, False, True], (len(nodes), 1))
    held[on_x | on_y, 2] = True
    held[on_x | (clamped & on_y), 3] = True
    held[on_y | (clamped & on_x), 4] = True
    free = np.flatnonzero(~held.ravel())
    square = eigsh(k[free][:, free].tocsc(), 1, m[free][:, free].tocsc(), sigma=0.0)[0][0]
    return np.sqrt(square) / (2 * np.pi)


def thin_plate(coefficient, side=0.4, thickness=0.002):
    rigidity = E * thickness**3 / (12 * (1 - NU**2))
    return coefficient / (2 * np.pi * side**2) * np.sqrt(rigidity / (RHO * thickness))


def rate(sizes, errors):
    return np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0]


# Leissa, Vibration of Plates (NASA SP-160, 1969): 2 pi^2 supported, 35.985 clamped.
@pytest.mark.parametrize(("clamped", "coefficient"), [(False, 2 * np.pi**2), (True, 35.9852)])
def test_thin_plate_converges_with_the_square_of_the_size(clamped, coefficient):
    counts = np.array([4, 8, 16, 32])
    exact = thin_plate(coefficient)
    errors = np.array([plate_frequency(n, clamped) / exact - 1 for n in counts])
    assert rate(1 / counts, errors) > 1.85
    assert abs(errors[-1]) < 1e-3


def cantilever(n, length=0.4, width=0.04, thickness=0.002, nu=NU):
    nodes, quads = grid(n, 2, length, width)
    ones = np.ones(len(quads))
    k, m = assemble(nodes, quads, Sections(Material(poissons_ratio=nu), thickness * ones, ones, 0.0 * ones))
    return nodes, k, m, np.flatnonzero((nodes[:, 0] > 1e-9).repeat(6))


def tip_deflection(nodes, k, free):
    """Deflection of the tip's middle under a unit force spread over the tip."""
    load, u = np.zeros(k.shape[0]), np.zeros(k.shape[0])
    tip = np.flatnonzero(nodes[:, 0] > nodes[:, 0].max() - 1e-9)
    load[6 * tip + 2] = np.array([0.25, 0.5, 0.25])
    u[free] = spsolve(k[free][:, free].tocsc(), load[free])
    return u[6 * tip[1] + 2]


def test_cantilever_converges_to_the_beam_with_the_square_of_the_size():
    # Without Poisson's ratio the strip is a beam exactly.
    length, counts = 0.4, np.array([4, 8, 16, 32])
    beam = length**3 / (3 * E * 0.04 * 0.002**3 / 12)
    first = 1.875104**2 / (2 * np.pi * length**2) * np.sqrt(E * 0.002**2 / 12 / RHO)
    deflection, frequency = [], []
    for n in counts:
        nodes, k, m, free = cantilever(n, length, nu=0.0)
        square = eigsh(k[free][:, free].tocsc(), 1, m[free][:, free].tocsc(), sigma=0.0)[0][0]
        deflection.append(tip_deflection(nodes, k, free) / beam - 1)
        frequency.append(np.sqrt(square) / (2 * np.pi) / first - 1)
    for errors in (deflection, frequency):
        assert rate(1 / counts, errors) > 1.85
        assert abs(errors[-1]) < 5e-4


def test_a_wide_strip_is_between_a_beam_and_a_plate():
    nodes, k, _, free = cantilever(32)
    beam = 0.4**3 / (3 * E * 0.04 * 0.002**3 / 12)
    # The clamped end keeps the strip from curling; fully kept, 1 - nu^2 = 0.91 of the beam would be left.
    assert 0.98 * beam < tip_deflection(nodes, k, free) < beam


def test_cantilever_frequencies_are_those_of_a_beam():
    length, width, thickness = 0.4, 0.04, 0.002
    _, k, m, free = cantilever(40, length, width, thickness)
    squares = eigsh(k[free][:, free].tocsc(), 3, m[free][:, free].tocsc(), sigma=0.0)[0]
    roots = np.array([1.875104, 4.694091])
    beam = roots**2 / (2 * np.pi * length**2) * np.sqrt(E * thickness**2 / 12 / RHO)
    assert np.sqrt(np.sort(squares)[:2]) / (2 * np.pi) == pytest.approx(beam, rel=0.02)


def tube(length, side, thickness, along, across):
    """A folded square tube, four walls joined at their edges, with its axis along x."""
    corners = np.array([[0, 0], [side, 0], [side, side], [0, side], [0, 0]], float) - side / 2
    share = np.linspace(0, 1, across + 1)[:-1, None]
    ring = np.vstack([a + share * (b - a) for a, b in pairwise(corners)])
    x = np.linspace(0, length, along + 1)
    nodes = np.array([[position, y, z] for position in x for y, z in ring])
    n = np.arange(len(nodes)).reshape(along + 1, len(ring))
    right = np.roll(n, -1, axis=1)
    quads = np.stack([n[:-1], n[1:], right[1:], right[:-1]], axis=-1).reshape(-1, 4)
    return nodes, quads


def test_folded_square_tube_bends_as_a_beam():
    length, side, thickness = 1.0, 0.04, 0.002
    nodes, quads = tube(length, side, thickness, 50, 4)
    k, m = matrices(nodes, quads, thickness)
    free = np.flatnonzero((nodes[:, 0] > 1e-9).repeat(6))
    squares = eigsh(k[free][:, free].tocsc(), 2, m[free][:, free].tocsc(), sigma=0.0)[0]
    area, inertia = (
        4 * side * thickness,
        4 * (thickness * side**3 / 12 + side * thickness * (side / 2) ** 2) / 2,
    )
    beam = 1.875104**2 / (2 * np.pi * length**2) * np.sqrt(E * inertia / (RHO * area))
    # Shear and rotary inertia lower a beam this slender by 0.6 %.
    assert np.sqrt(squares) / (2 * np.pi) == pytest.approx([beam, beam], rel=0.012)


def test_mass_and_moments_of_a_folded_tube_are_exact():
    nodes, quads = tube(1.0, 0.04, 0.002, 10, 4)
    _, m = matrices(nodes, quads, 0.002)
    for direction in range(3):
        translation = np.zeros(m.shape[0])
        translation[direction::6] = 1.0
        assert translation @ m @ translation == pytest.approx(4 * 0.04 * 0.002 * RHO, rel=1e-12)


def test_six_motions_cost_no_energy():
    nodes, quads = tube(0.3, 0.04, 0.002, 6, 2)
    k, m = matrices(nodes, quads, 0.002)
    # Drilling rotations have no mass; a little makes the problem regular and changes no rigid motion's zero.
    lowest = eigh(k.toarray(), m.toarray() + 1e-9 * np.eye(k.shape[0]), eigvals_only=True)[:7]
    assert np.abs(lowest[:6]).max() < 1e-6 * lowest[6]


def test_geometric_stiffness_is_that_of_a_string():
    # A unit tension along the second side: energy of a unit slope in that direction is area / 2.
    corners = np.array([[0, 0, 0], [0.02, 0, 0], [0.02, 0.01, 0], [0, 0.01, 0]], float)
    _, _, geometric = element_matrices(corners, 0.002, STEEL)
    slope = np.zeros(24)
    slope[2::6] = corners[:, 1]
    assert slope @ geometric @ slope == pytest.approx(0.02 * 0.01)
    across = np.zeros(24)
    across[2::6] = corners[:, 0]
    assert across @ geometric @ across == pytest.approx(0.0, abs=1e-12)


def test_surface_stress_of_pure_bending():
    corners = np.array([[0, 0, 0], [0.02, 0, 0], [0.02, 0.01, 0], [0, 0.01, 0]], float)
    rows = surface_stress_rows(corners, 0.002, STEEL)
    u, curvature = np.zeros(24), 0.3
    u[2::6] = -0.5 * curvature * corners[:, 0] ** 2
    u[4::6] = curvature * corners[:, 0]
    stress = rows @ u
    bending = E / (1 - NU**2) * 0.001 * curvature
    assert stress[1] == pytest.approx([bending, NU * bending, 0.0], abs=1e-6 * bending)
    assert stress[0] == pytest.approx(-stress[1], abs=1e-6 * bending)
    expected = bending * np.sqrt(1 - NU + NU**2)
    assert von_mises(stress[1]) == pytest.approx(expected)


def test_a_plate_without_thickness_is_refused():
    nodes, quads = grid(2, 2, 0.1, 0.1)
    with pytest.raises(FrameError, match="must be positive"):
        matrices(nodes, quads, 0.0)
