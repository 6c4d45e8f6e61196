"""The modes of a frame of beams, of several on one table, and what a test would measure of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigh

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.beams import Beams

HIGHEST_HZ = 400.0
"""Modes above are left out [Hz]."""


@dataclass(frozen=True)
class Modes:
    """A frame in modal coordinates q: q'' + damping q' + omega^2 q = -gamma a + shapes of the floors' forces.

    Attributes:
        omega: Circular frequencies [rad/s], shape (modes,).
        damping: Modal damping matrix [1/s], shape (modes, modes).
        floors: Deflection of each floor relative to the table per modal coordinate, shape (storeys, modes).
        gamma: Participation of a table acceleration, shape (modes,).
        pitch: Participation of an angular table acceleration (top towards +x), shape (modes,).
    """

    omega: np.ndarray
    damping: np.ndarray
    floors: np.ndarray
    gamma: np.ndarray
    pitch: np.ndarray


def modes(beams: Beams) -> Modes:
    """Return the frame in its modes up to `HIGHEST_HZ`, at least as many as storeys."""
    matrices = beams.matrices()
    squared, shapes = eigh(matrices.stiffness, matrices.mass)
    if squared[0] <= 0:
        raise CaseError(f"the hidden frame {beams.name} buckles; hide a smaller effect")
    omega = np.sqrt(squared)
    count = max(beams.storeys, int(np.searchsorted(omega, 2 * np.pi * HIGHEST_HZ)))
    omega, shapes = omega[:count], shapes[:, :count]
    floors = matrices.floors @ shapes
    damping = _own_damping(beams, omega, shapes)
    if beams.dashpots.any():
        drifts = np.diff(floors, axis=0, prepend=0.0)
        damping = damping + drifts.T @ (beams.dashpots[:, None] * drifts)
    if beams.appendage:
        stretch = shapes[-1] - floors[beams.appendage.floor - 1]
        damper = 4 * np.pi * beams.appendage.frequency_hz * beams.appendage.ratio * beams.appendage.mass
        damping = damping + damper * np.outer(stretch, stretch)
    inertia = matrices.mass @ np.column_stack([matrices.push, matrices.turn])
    gamma, pitch = (shapes.T @ inertia).T
    return Modes(omega, damping, floors, gamma, pitch)


def _own_damping(beams: Beams, omega: np.ndarray, shapes: np.ndarray) -> np.ndarray:
    """Return the frame's own damping in its modes [1/s], shape (modes, modes).

    It is that of the frame without an appendage: what hangs on a floor is damped where it is fixed and nowhere else.
    """
    if beams.appendage is None:
        return np.diag(2 * _ratios(beams, len(omega)) * omega)
    bare = replace(beams, appendage=None).matrices()
    squared, own = eigh(bare.stiffness, bare.mass)
    rates = 2 * _ratios(beams, len(squared)) * np.sqrt(squared)
    moved = own.T @ bare.mass @ shapes[: len(squared)]
    return np.asarray(moved.T @ (rates[:, None] * moved))


def _ratios(beams: Beams, count: int) -> np.ndarray:
    """Return damping ratios of so many modes, shape (count,)."""
    return np.asarray(beams.ratios[np.minimum(np.arange(count), len(beams.ratios) - 1)])


def joined(parts: Sequence[Modes]) -> Modes:
    """Return several frames on one table as one set of modes; their floors follow each other."""
    return Modes(
        np.concatenate([part.omega for part in parts]),
        block_diag(*(part.damping for part in parts)),
        block_diag(*(part.floors for part in parts)),
        np.concatenate([part.gamma for part in parts]),
        np.concatenate([part.pitch for part in parts]),
    )


def frequencies_hz(beams: Beams, count: int) -> np.ndarray:
    """Return the lowest frequencies [Hz], shape (count,)."""
    matrices = beams.matrices()
    squared = eigh(matrices.stiffness, matrices.mass, eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(np.maximum(squared, 0)) / (2 * np.pi))


def storey_stiffness(beams: Beams) -> np.ndarray:
    """Return shear over drift of each storey [N/m] under loads in proportion to height, shape (storeys,)."""
    matrices = beams.matrices()
    load = beams.heights_m
    drift = np.diff(
        matrices.floors @ np.linalg.solve(matrices.stiffness, matrices.floors.T @ load), prepend=0.0
    )
    return np.cumsum(load[::-1])[::-1] / drift


def lone_storey_stiffness(beams: Beams) -> np.ndarray:
    """Return the shear for a unit drift of one storey alone, the floors above it moving along [N/m]."""
    matrices = beams.matrices()
    floors = np.linalg.inv(matrices.floors @ np.linalg.solve(matrices.stiffness, matrices.floors.T))
    above = np.tril(np.ones((beams.storeys, beams.storeys)))
    return np.asarray(np.einsum("is,ij,js->s", above, floors, above))
