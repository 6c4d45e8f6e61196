"""The motion of a structure: its linear part exactly, its laws as impulses in the middle of each step (Strang 1968).

Half a step of the linear system under an acceleration of the table that is linear over it, by the matrix exponential;
then the impulse of every law over the whole step at that position; then the other half. The error falls with the square
of the step where the laws are smooth. A direction that friction holds creeps between two impulses, by a way in proportion to
the step, so that a case is computed in ever smaller steps until its readings stay (`making.converged`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.linalg import expm

from tests.planar_world.baseline import Index, Real
from tests.planar_world.laws import DRAG, LOOSENING, STATES, force_along
from tests.planar_world.structure import Structure

DURATION_S, STEP_S, STORED_HZ = 8.0, 5e-5, 4000
"""Length of a run [s], the usual step [s], and the rate at which the motion is kept [Hz]."""
MOST_VALUES = 8

Shaken = Callable[[Real], Real]
"""The table's acceleration [m/s^2] at times [s]."""


@dataclass(frozen=True)
class Motion:
    """How the degrees of freedom move; arrays are (times, freedoms).

    Attributes:
        displacement: Relative to the table [m].
        acceleration: Absolute, that is in the room [m/s^2].
    """

    displacement: Real
    acceleration: Real


def half_step(structure: Structure, step: float) -> tuple[Real, Real, Real]:
    """Return what moves a state over a step: of the state, of the table's acceleration before, and after.

    Args:
        structure: Its linear part is moved.
        step: Half a step of the integration [s].

    Returns:
        The matrix (2 freedoms, 2 freedoms) of displacements [m] and velocities [m/s], and two vectors (2 freedoms,).
    """
    count, inverse = structure.freedoms, np.linalg.inv(structure.mass)
    # Beside the state: the table's acceleration, and its slope.
    slope = np.zeros((2 * count + 2, 2 * count + 2))
    slope[:count, count : 2 * count] = np.eye(count)
    slope[count : 2 * count, :count] = -inverse @ structure.stiffness
    slope[count : 2 * count, count : 2 * count] = -inverse @ structure.damping
    slope[count : 2 * count, 2 * count] = -1.0
    slope[2 * count, 2 * count + 1] = 1.0
    moved = expm(slope * step)
    constant, rising = moved[: 2 * count, 2 * count].copy(), moved[: 2 * count, 2 * count + 1].copy()
    after = rising / step
    return np.ascontiguousarray(moved[: 2 * count, : 2 * count]), constant - after, after


def respond(
    structure: Structure, shaken: Sequence[Shaken], step: float = STEP_S, duration: float = DURATION_S
) -> list[Motion]:
    """Return the motion of a structure in every run, from rest, at `STORED_HZ`.

    Args:
        structure: What is shaken.
        shaken: The table's acceleration in each run.
        step: Of the integration [s].
        duration: Of a run [s]; a law that changes with time does so over it.
    """
    laws, count = structure.laws, structure.freedoms
    kinds = np.array([law.kind for law in laws], dtype=np.int64)
    directions, values = np.zeros((len(laws), count)), np.zeros((len(laws), MOST_VALUES))
    for number, law in enumerate(laws):
        directions[number] = law.direction
        values[number, : len(law.values)] = law.values
    softer = structure.loosening or (np.zeros((count, count)), np.zeros((count, count)))
    steps = round(duration / step)
    times: Real = np.arange(2 * steps + 1, dtype=np.float64) * step / 2
    every = round(1 / STORED_HZ / step)
    inverse = np.asarray(np.linalg.inv(structure.mass), dtype=np.float64)
    linear = (
        *half_step(structure, step / 2),
        inverse,
        np.ascontiguousarray(structure.stiffness),
        np.ascontiguousarray(structure.damping),
    )
    return [
        Motion(*_move(*linear, *softer, kinds, directions, values, one(times), step, every, duration))
        for one in shaken
    ]


@njit(cache=True)
def _move(
    moves: Real,
    before: Real,
    after: Real,
    inverse: Real,
    stiffness: Real,
    damping: Real,
    softer: Real,
    softer_still: Real,
    kinds: Index,
    directions: Real,
    values: Real,
    table: Real,
    step: float,
    every: int,
    duration: float,
) -> tuple[Real, Real]:
    """Return displacements [m] and accelerations in the room [m/s^2] (times, freedoms); `table` is at half steps."""
    count, steps = inverse.shape[0], (len(table) - 1) // 2
    kept = steps // every + 1
    displacements, accelerations = np.zeros((kept, count)), np.zeros((kept, count))
    state, middle = np.zeros(2 * count), np.zeros(2 * count)
    pushed, mobilities = _pushed(inverse, directions)
    memory, forces = np.zeros((len(kinds), STATES)), np.zeros(len(kinds))
    for number in range(steps + 1):
        if number % every == 0:
            at = number // every
            force = _linear_force(stiffness, damping, state)
            for law in range(len(kinds)):
                if kinds[law] == DRAG:
                    force += _drag_force(values[law, 0], directions[law], state)
                elif kinds[law] == LOOSENING:
                    loose = values[law, 0] * (number * step) / duration
                    force += _loosened_force(loose, softer, softer_still, state)
                else:
                    force += directions[law] * forces[law]
            accelerations[at] = -_product(inverse, force)
            displacements[at] = state[:count]
        if number == steps:
            break
        _advance(moves, before, after, state, table[2 * number], table[2 * number + 1], middle)
        for law in range(len(kinds)):
            if kinds[law] == DRAG:
                spread = _drag_force(values[law, 0], directions[law], middle)
                _kick(middle, step, _product(inverse, spread))
            elif kinds[law] == LOOSENING:
                loose = values[law, 0] * ((number + 0.5) * step) / duration
                _kick(middle, step, _product(inverse, _loosened_force(loose, softer, softer_still, middle)))
            else:
                drift, rate = _along(directions[law], middle)
                mobility = mobilities[law]
                force_now = force_along(kinds[law], values[law], drift, rate, mobility, step, memory[law])
                forces[law] = force_now
                _kick(middle, step * force_now, pushed[law])
        _advance(moves, before, after, middle, table[2 * number + 1], table[2 * number + 2], state)
    return displacements, accelerations


@njit(cache=True)
def _pushed(inverse: Real, directions: Real) -> tuple[Real, Real]:
    """Return accelerations by a unit of force along each direction: (laws, freedoms), and along it (laws,) [1/kg]."""
    pushed, along = np.zeros_like(directions), np.zeros(len(directions))
    for law in range(len(directions)):
        pushed[law] = inverse @ directions[law]
        along[law] = np.dot(directions[law], pushed[law])
    return pushed, along


@njit(cache=True)
def _kick(state: Real, impulse: float, pushed: Real) -> None:
    """Slow a state down by an impulse [N s] that pushes its degrees of freedom (freedoms,) [1/kg]."""
    for row in range(len(pushed)):
        state[len(pushed) + row] -= impulse * pushed[row]


@njit(cache=True)
def _advance(
    moves: Real, before: Real, after: Real, state: Real, begun: float, ended: float, moved: Real
) -> None:
    """Move a state over half a step, into `moved`; the table's acceleration is given at both ends [m/s^2]."""
    for row in range(len(state)):
        total = before[row] * begun + after[row] * ended
        for column in range(len(state)):
            total += moves[row, column] * state[column]
        moved[row] = total


@njit(cache=True)
def _linear_force(stiffness: Real, damping: Real, state: Real) -> Real:
    """Return the force of springs and dampers (freedoms,) [N]."""
    count = len(stiffness)
    force = np.zeros(count)
    for row in range(count):
        total = 0.0
        for column in range(count):
            total += stiffness[row, column] * state[column] + damping[row, column] * state[count + column]
        force[row] = total
    return force


@njit(cache=True)
def _drag_force(coefficient: float, direction: Real, state: Real) -> Real:
    """Return the drag of every floor (freedoms,) [N]."""
    count = len(direction)
    force = np.zeros(count)
    for row in range(count):
        force[row] = coefficient * direction[row] * state[count + row] * abs(state[count + row])
    return force


@njit(cache=True)
def _loosened_force(loose: float, softer: Real, softer_still: Real, state: Real) -> Real:
    """Return the change of the springs' force (freedoms,) [N] by a share of the columns that is lost by now [-]."""
    count = len(softer)
    force = np.zeros(count)
    for row in range(count):
        total = 0.0
        for column in range(count):
            change = loose * softer[row, column] + loose * loose * softer_still[row, column]
            total += change * state[column]
        force[row] = total
    return force


@njit(cache=True)
def _product(matrix: Real, vector: Real) -> Real:
    """Return matrix times vector, summed in order: small ones are quicker so than by a library."""
    found = np.zeros(len(vector))
    for row in range(len(vector)):
        total = 0.0
        for column in range(len(vector)):
            total += matrix[row, column] * vector[column]
        found[row] = total
    return found


@njit(cache=True)
def _along(direction: Real, state: Real) -> tuple[float, float]:
    """Return drift [m] and rate [m/s] of a state along a direction (freedoms,)."""
    count, drift, rate = len(direction), 0.0, 0.0
    for row in range(count):
        drift += direction[row] * state[row]
        rate += direction[row] * state[count + row]
    return drift, rate
