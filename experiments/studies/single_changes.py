"""Single physical changes of the frames of the thesis, each with one parameter, and the peaks that follow.

The frames are taken as their storeys (condensed to the floors along the shaking). Changes that leave them
linear change frequencies, damping, shapes or the motion and are solved exactly. The others add a force, and
the modes are carried exactly over each step while that force runs on (exponential Adams-Bashforth of second
order: Hochbruck and Ostermann 2010, Acta Numerica 19, section 3). All values of a parameter run at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import eigh

from pounding import frames
from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.records import Record
from pounding.frames.response.exact import forced, modal_poles

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Storeys:
    """A frame condensed to its floors, each array over floors from the lowest up.

    Attributes:
        mass: (n, n) [kg].
        stiffness: (n, n) [N/m].
        ratio: Damping ratio of all modes [-].
        height_m: Of each floor above the table (n,) [m].
    """

    mass: Real
    stiffness: Real
    ratio: float
    height_m: Real

    @cached_property
    def storey_stiffness(self) -> Real:
        """Force between neighbouring floors for a unit drift (n,) [N/m].

        Floors and joints that bend couple distant floors too, so a frame is no chain of storeys: this is the
        chain in proportion to the neighbours' couplings that is as stiff as the frame in its softest shape.
        What the frame has beyond it stays elastic, and is nowhere negative.
        """
        between = -np.diag(self.stiffness, 1)
        couplings = np.append(max(float(self.stiffness[0].sum()), float(between[0])), between)
        difference = np.eye(len(couplings)) - np.eye(len(couplings), k=-1)
        chain = difference.T @ np.diag(couplings) @ difference
        return np.asarray(couplings * eigh(self.stiffness, chain, eigvals_only=True)[0])

    @property
    def floor_mass(self) -> Real:
        """Mass of each floor (n,) [kg]."""
        return np.asarray(self.mass.sum(axis=1))


def storeys(reduced: frames.ReducedFrame) -> Storeys:
    """Return a reduced frame as storeys."""
    mass, stiffness, _ = reduced.storey_model()
    return Storeys(mass, stiffness, reduced.damping_ratio, reduced.heights_m)


@dataclass(frozen=True)
class Modes:
    """Modes: circular frequencies (k,) [rad/s], mass-normalised shapes (n, k), damping ratios (k,)."""

    omega: Real
    shapes: Real
    ratio: Real


def modes(body: Storeys) -> Modes:
    """Return all modes of storeys, each with their damping ratio."""
    values, shapes = eigh(body.stiffness, body.mass)
    return Modes(np.sqrt(values), shapes, np.full(len(values), body.ratio))


Force = Callable[[Real, Real, Real], Real]
"""Extra force on the floors (values, n) [N] of displacement, relative velocity and velocity in the room."""


def respond(body: Storeys, basis: Modes, record: Record, force: Force | None, count: int) -> Real:
    """Return largest and size of smallest displacement of all floors (count, n, 2) [m].

    Args:
        body: The storeys.
        basis: Their modes.
        record: Motion of the table, at the step of the integration.
        force: Extra force for `count` values of a parameter at once.
        count: Number of values.
    """
    step = record.step_s
    damped = basis.omega * np.sqrt(1 - basis.ratio**2)
    pole = -basis.ratio * basis.omega + 1j * damped
    z = pole * step
    growth, mean = np.exp(z), np.expm1(z) / z
    late = (mean - 1) / z
    load = -basis.shapes.T @ body.mass.sum(axis=1)
    a = record.acceleration_m_s2
    # Straight between the samples: the first part goes with the old sample, the second with the new.
    drive = step * load * (np.outer(a[:-1], mean - late) + np.outer(a[1:], late))
    ground = cumulative_trapezoid(a, dx=step, initial=0)
    ground = ground - np.linspace(0, ground[-1], len(ground))
    to_displacement = (basis.shapes / damped).T
    state = np.zeros((count, len(pole)), complex)
    high, low = np.zeros((count, len(body.mass))), np.zeros((count, len(body.mass)))
    before: Real | None = None
    # A softening spring may let its frame run away: infinity or NaN is the answer then, not a warning.
    with np.errstate(over="ignore", invalid="ignore"):
        for index in range(len(a) - 1):
            if force is None:
                state = growth * state + drive[index]
            else:
                displacement = state.imag @ to_displacement
                velocity = (pole * state).imag @ to_displacement
                push = force(displacement, velocity, velocity + ground[index]) @ basis.shapes
                slope = 0.0 if before is None else push - before
                state = growth * state + drive[index] + step * (mean * push + late * slope)
                before = push
            displacement = state.imag @ to_displacement
            np.maximum(high, displacement, out=high)
            np.minimum(low, displacement, out=low)
    return np.stack([high, -low], axis=-1)


def with_stiffness(body: Storeys, change: float) -> Storeys:
    """Return storeys with stiffness times (1 + change); added mass does the same to a shaken frame."""
    return Storeys(body.mass, body.stiffness * (1 + change), body.ratio, body.height_m)


def with_yielding_base(body: Storeys, flexibility: float) -> Storeys:
    """Return storeys on a base that gives way by `flexibility` [mm/kN] along the shaking.

    The same as a softer lowest storey: two springs in series.
    """
    soft = np.linalg.inv(body.stiffness) + 1e-6 * flexibility
    return Storeys(body.mass, np.asarray(np.linalg.inv(soft), np.float64), body.ratio, body.height_m)


def with_p_delta(body: Storeys, weight_factor: float) -> Storeys:
    """Return storeys with gravity's geometric stiffness of `weight_factor` times the weight added."""
    above = np.cumsum(body.floor_mass[::-1])[::-1] * STANDARD_GRAVITY
    per_drift = above / np.diff(body.height_m, prepend=0.0)
    difference = np.eye(len(above)) - np.eye(len(above), k=-1)
    softening = difference.T @ np.diag(per_drift) @ difference
    return Storeys(body.mass, body.stiffness - weight_factor * softening, body.ratio, body.height_m)


def with_rocking(body: Storeys, flexibility: float) -> Storeys:
    """Return storeys on a base that turns by `flexibility` [rad/(kN m)] under an overturning moment."""
    soft = np.linalg.inv(body.stiffness) + 1e-3 * flexibility * np.outer(body.height_m, body.height_m)
    stiff = np.asarray(np.linalg.inv(soft), dtype=np.float64)
    return Storeys(body.mass, stiff, body.ratio, body.height_m)


def linear_histories(body: Storeys, basis: Modes, record: Record) -> Real:
    """Return the exact displacement of all floors (m, n) [m] relative to the table.

    Args:
        body: The storeys.
        basis: Their modes.
        record: Table motion at the frame's scale.
    """
    influence = np.ones(len(body.mass), dtype=np.float64)
    poles = modal_poles(basis.omega, basis.ratio, basis.shapes, body.mass, influence)
    return np.asarray(forced(poles, record.acceleration_m_s2, record.step_s)[0], dtype=np.float64)


def extremes(histories: Real) -> Real:
    """Return largest and size of smallest value of histories (m, n) as (n, 2)."""
    return np.stack([histories.max(axis=0), -histories.min(axis=0)], axis=-1).astype(np.float64)
