"""Craig-Bampton reduction: a frame of thousands of coordinates as a few dozen.

The coordinates kept as themselves (the floors' motion along x, and about z and along y where asked for) carry
the instruments, the contacts and the static behaviour exactly; the rest is the lowest modes of the frame with
those coordinates held still (Craig and Bampton, AIAA Journal 6(7), 1968).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, eigh
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import LinearOperator, SuperLU, eigsh, splu

from pounding.frames.errors import FrameError

Real = NDArray[np.float64]
Index = NDArray[np.int64]

INERT = 1e-9
"""A fixed-interface mode whose coupling with everything kept is below this share of the largest is inert."""


NOTHING = 1e-10
"""A shape with less than this share of its mass left beside the others is in their span."""


@dataclass(frozen=True)
class CraigBampton:
    """A reduced system.

    Attributes:
        mass: (n, n).
        stiffness: (n, n).
        basis: Full coordinates for unit reduced ones (full, n); the first columns are the kept coordinates.
    """

    mass: Real
    stiffness: Real
    basis: Real


def craig_bampton(
    stiffness: csr_matrix,
    mass: csr_matrix,
    kept: Index,
    carried: Real,
    *,
    keep_hz: float | None = None,
    modes: int | None = None,
) -> CraigBampton:
    """Reduce a system to some of its coordinates and its lowest fixed-interface modes.

    Modes that neither the kept coordinates nor the base can excite are left out: they would rest for ever.
    The static answer to a unit acceleration of the base, with the kept coordinates held, is one shape more;
    it carries the inertia of the strips between the base and the first floor.

    Args:
        stiffness: K (full, full), positive definite.
        mass: M (full, full), positive semi-definite.
        kept: Coordinates kept as themselves (b,).
        carried: Motion of the coordinates with a translating base (full,).
        keep_hz: Keep the fixed-interface modes up to this frequency [Hz].
        modes: Or keep so many; 0 is Guyan's static reduction.

    Raises:
        FrameError: Neither or both of ``keep_hz`` and ``modes``, or too many modes.
    """
    if (keep_hz is None) == (modes is None):
        raise FrameError("reduction: give either keep_hz or modes")
    inner = np.setdiff1d(np.arange(stiffness.shape[0]), kept)
    k_ii, k_ib = stiffness[inner][:, inner].tocsc(), stiffness[inner][:, kept].toarray()
    m_ii, m_ib = mass[inner][:, inner].tocsc(), mass[inner][:, kept].toarray()
    factor = factorise(k_ii)
    static = -factor.solve(k_ib)
    shapes = lowest_modes(k_ii, m_ii, factor, keep_hz=keep_hz, count=modes)[1]
    rest = carried[inner] - static @ carried[kept]
    coupling = shapes.T @ np.column_stack([m_ib + m_ii @ static, m_ii @ rest])
    largest = np.maximum(np.abs(coupling).max(axis=0, initial=0.0), np.finfo(float).tiny)
    shapes = shapes[:, (np.abs(coupling) > INERT * largest).any(axis=1)]
    shapes = _with(shapes, factor.solve(m_ii @ rest), m_ii)
    basis = np.zeros((stiffness.shape[0], len(kept) + shapes.shape[1]))
    basis[kept, np.arange(len(kept))] = 1.0
    basis[inner] = np.hstack([static, shapes])
    small = [_symmetric(basis.T @ (matrix @ basis)) for matrix in (mass, stiffness)]
    return CraigBampton(small[0], small[1], basis)


def _with(shapes: Real, further: Real, mass: csc_matrix) -> Real:
    """Return shapes with one more, made orthogonal to them in mass, unless they hold it already."""
    weight = further @ (mass @ further)
    further = further - shapes @ (shapes.T @ (mass @ further))
    left = further @ (mass @ further)
    if left <= NOTHING * max(weight, np.finfo(float).tiny):
        return shapes
    return np.column_stack([shapes, further / np.sqrt(left)])


def factorise(stiffness: csc_matrix) -> SuperLU:
    """Return the factors of a sparse positive definite matrix."""
    return splu(
        stiffness.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def lowest_modes(
    stiffness: csc_matrix,
    mass: csc_matrix,
    factor: SuperLU | None = None,
    *,
    keep_hz: float | None = None,
    count: int | None = None,
) -> tuple[Real, Real]:
    """Return the lowest modes of a sparse system.

    Args:
        stiffness: K (n, n), positive definite.
        mass: M (n, n).
        factor: Factors of K, when at hand.
        keep_hz: Modes up to this frequency [Hz].
        count: Or so many.

    Returns:
        Frequencies (m,) [Hz], rising, and mass-normalised shapes (n, m).

    Raises:
        FrameError: More modes are asked for than a sparse solver can give.
    """
    size = stiffness.shape[0]
    if count == 0:
        return np.zeros(0), np.zeros((size, 0))
    operator = LinearOperator((size, size), (factor or factorise(stiffness)).solve)
    ask = count or 24
    while True:
        if ask > size - 2:
            raise FrameError(f"modes: {ask} asked for, the mesh has {size} coordinates; ask for fewer")
        start = np.random.default_rng(0).standard_normal(size)
        squares, shapes = eigsh(stiffness, ask, mass, sigma=0.0, OPinv=operator, v0=start)
        order = np.argsort(squares)
        frequencies = np.sqrt(np.maximum(squares[order], 0.0)) / (2.0 * np.pi)
        if keep_hz is None or frequencies[-1] > keep_hz:
            break
        ask *= 2
    wanted = frequencies <= keep_hz if keep_hz is not None else np.ones(len(order), bool)
    return frequencies[wanted], shapes[:, order][:, wanted]


def dense_modes(stiffness: Real, mass: Real) -> tuple[Real, Real]:
    """Return all frequencies [Hz] and mass-normalised shapes of a small system.

    Raises:
        FrameError: The system is unstable: its weight, say, is more than its columns carry.
    """
    squares, shapes = eigh(stiffness, mass)
    if squares[0] <= 0.0:
        raise FrameError("stiffness: not positive; the frame buckles under its weight (check weight_factor)")
    # The sign of a mode is free: let its largest entry be positive, so that runs can be compared.
    largest = np.abs(shapes).argmax(axis=0)
    return np.sqrt(squares) / (2.0 * np.pi), shapes * np.sign(shapes[largest, np.arange(len(squares))])


def condense(stiffness: Real, mass: Real, kept: Index) -> tuple[Real, Real]:
    """Return mass and stiffness condensed statically to some coordinates (Guyan), both (b, b).

    Args:
        stiffness: Stiffness (n, n) [N/m].
        mass: Mass (n, n) [kg].
        kept: Indices of the coordinates that are kept (b,).
    """
    others = np.setdiff1d(np.arange(len(stiffness)), kept)
    basis = np.zeros((len(stiffness), len(kept)))
    basis[kept, np.arange(len(kept))] = 1.0
    if len(others):
        factor = cho_factor(stiffness[np.ix_(others, others)])
        basis[others] = -cho_solve(factor, stiffness[np.ix_(others, kept)])
    return _symmetric(basis.T @ mass @ basis), _symmetric(basis.T @ stiffness @ basis)


def modal_damping(mass: Real, shapes: Real, frequencies_hz: Real, ratios: Real) -> Real:
    """Return the damping matrix [N s/m] of modes with a damping ratio each.

    Args:
        mass: Mass (n, n) [kg].
        shapes: Mass-normalised shapes, one a column (n, m) [kg^-0.5].
        frequencies_hz: Frequency of each mode (m,) [Hz].
        ratios: Damping ratio of each mode (m,) [-].
    """
    rows = mass @ shapes
    return _symmetric((rows * (4.0 * np.pi * ratios * frequencies_hz)) @ rows.T)


def _symmetric(matrix: Real) -> Real:
    return (matrix + matrix.T) / 2.0
