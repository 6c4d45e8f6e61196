"""The motion of a shear building with forces in its storeys, by `scipy.integrate.solve_ivp`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from tests.shear_world.building import Building, Real
from tests.shear_world.laws import Law

RELATIVE, ABSOLUTE = 1e-6, 1e-8
"""Tolerances of a step; the absolute one in m, m/s and N."""
LONGEST_S = 2e-3
"""Longest step [s]: no touch of a stop falls between two steps."""


@dataclass(frozen=True)
class Response:
    """How the floors move, relative to the table; arrays are (floors, times).

    Attributes:
        displacement: [m].
        velocity: [m/s].
        acceleration: Absolute, that is in the room [m/s^2].
    """

    displacement: Real
    velocity: Real
    acceleration: Real


def respond(
    building: Building,
    laws: Sequence[tuple[int, Law]],
    shaken: Callable[[float], float],
    times: Real,
    start: Real | None = None,
    damping: Real | None = None,
) -> Response:
    """Return the motion of a building on a table.

    Args:
        building: The building.
        laws: Storeys, counted from 1, and the forces in them.
        shaken: The table's acceleration [m/s^2] at a time [s].
        times: When the motion is wanted, from the start on [s].
        start: Displacements [m] and velocities [m/s] of the floors at the start; at rest where None.
        damping: Damping matrix [N s/m]; the building's own where None.
    """
    count, drifts = building.storeys, building.drifts()
    stiffness = building.stiffness()
    damped = building.damping() if damping is None else damping
    remembering = [number for number, (_, law) in enumerate(laws) if law.remembers]

    def inner(state: Real) -> tuple[Real, Real]:
        """Return the accelerations of the floors in the room, and the rates of what the laws remember."""
        moved, velocity = state[:count], state[count : 2 * count]
        memory = np.zeros(len(laws))
        memory[remembering] = state[2 * count :]
        forces, flows = stiffness @ moved + damped @ velocity, np.zeros(len(laws))
        if laws:
            drift, rate = drifts @ moved, drifts @ velocity
            for number, (storey, law) in enumerate(laws):
                at = drift[storey - 1], rate[storey - 1], memory[number]
                forces = forces + law.force(*at) * drifts[storey - 1]
                flows[number] = law.flow(at[1], at[2])
        return -forces / building.masses, flows[remembering]

    def slope(time: float, state: Real) -> Real:
        accelerations, flows = inner(state)
        return np.concatenate([state[count : 2 * count], accelerations - shaken(time), flows])

    begun = np.zeros(2 * count + len(remembering))
    if start is not None:
        begun[: 2 * count] = start
    done = solve_ivp(
        slope,
        (times[0], times[-1]),
        begun,
        method="RK45",
        t_eval=times,
        rtol=RELATIVE,
        atol=ABSOLUTE,
        max_step=LONGEST_S,
    )
    if not done.success:
        raise RuntimeError(f"solve_ivp: {done.message}")
    absolute = np.stack([inner(state)[0] for state in done.y.T], axis=1)
    return Response(done.y[:count], done.y[count : 2 * count], absolute)
