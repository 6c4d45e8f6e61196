"""Reduced frames as flexible bodies of exudyn on one moving table.

The table is a very heavy mass driven by a force. Each frame is one body whose coordinates are relative to the
table and whose mass matrix couples them to it, so the base acceleration reaches every coordinate without a
load on each, and two frames on one table can touch through plain coordinate markers.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import ArrayLike, NDArray

from pounding.errors import heed_interruption
from pounding.frames.errors import FrameError
from pounding.frames.response.exact import checked
from pounding.frames.response.points import bordered, checked_floor, coupled, point_basis

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]

TABLE_MASS_KG = 1e9
"""Least mass of the table: frames of 100 kg at 5 g then disturb its acceleration by 5e-6 m/s^2."""

TABLE_OVER_FRAMES = 3e6
"""Least mass of the table over that of all frames on it: a building of 5,000 t would move a table of 1e9 kg with it."""

LONGEST_STEP_S = 5e-4
"""Default longest integration step; docs/theory/engine.md shows the error it leaves."""

STABLE = 2.0
"""Largest circular frequency times step; the limit of the classical Runge-Kutta method is 2.83."""


def table_mass(frames: Iterable[ReducedFrame]) -> float:
    """Return the mass [kg] of a table that frames (kg to many thousand tonnes) do not move."""
    return max(TABLE_MASS_KG, TABLE_OVER_FRAMES * sum(frame.moving_mass_kg for frame in frames))


class Table:
    """A table that follows an acceleration history, straight between its samples and still after the last.

    Args:
        mbs: The exudyn system to add it to.
        acceleration_m_s2: Acceleration (m,) [m/s^2], positive in +x; the first sample is at time zero.
        step_s: Sample step [s].
        mass_kg: Mass [kg] that makes the frames' reactions negligible.
        node: A node that has this mass already and moves with its first coordinate; a node of its own when None.

    Raises:
        FrameError: The history has fewer than two samples or one that is not finite.
    """

    def __init__(
        self,
        mbs: Any,
        acceleration_m_s2: ArrayLike,
        step_s: float,
        *,
        mass_kg: float = TABLE_MASS_KG,
        node: Any = None,
    ) -> None:
        self.samples = checked(acceleration_m_s2, step_s)
        self.step_s = float(step_s)
        self.duration_s = (len(self.samples) - 1) * self.step_s
        self.node = node
        if node is None:
            self.node = mbs.AddNode(items.Node1D(referenceCoordinates=[0.0]))
            mbs.AddObject(items.ObjectMass1D(mass=mass_kg, nodeNumber=self.node))
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=self.node, coordinate=0))
        # exudyn keeps no reference to a user function: the table must.
        self._load = self._force(mass_kg)
        mbs.AddLoad(items.LoadCoordinate(markerNumber=marker, load=1.0, loadUserFunction=self._load))

    def _force(self, mass_kg: float) -> Any:
        # Plain lists and floats: indexing an array costs more than the whole interpolation.
        force: list[float] = (mass_kg * self.samples).tolist()
        rise: list[float] = [*np.diff(force).tolist(), 0.0]
        last, per_step = len(force) - 1, 1.0 / self.step_s

        def load(_mbs: Any, t: float, _load: float) -> float:
            place = t * per_step
            index = int(place)
            if index < last:
                return force[index] + rise[index] * (place - index)
            # Round-off at the end of the last step must not drop the last sample.
            return force[last] if place - last < 1e-6 else 0.0

        return load

    def acceleration(self, times_s: ArrayLike) -> Real:
        """Return the table's acceleration [m/s^2] at times [s]."""
        grid = self.step_s * np.arange(len(self.samples))
        return np.asarray(np.interp(np.asarray(times_s, float), grid, self.samples, right=0.0))


class History(NamedTuple):
    """What a frame did, relative to the table, at the stored times.

    Attributes:
        time_s: Times (m,) [s].
        displacement: Coordinates of the reduced frame (m, n) [m].
        velocity: Their rates (m, n) [m/s].
        acceleration: Their second derivatives (m, n) [m/s^2].
    """

    time_s: Real
    displacement: Real
    velocity: Real
    acceleration: Real


class FrameBody:
    """A reduced frame as one flexible body on a table.

    Args:
        mbs: The exudyn system.
        reduced: The frame.
        table: The table it stands on; several frames may share it.
        points: Places ``(floor, y_m)`` off the middle of an edge that `marker` will be asked for.

    Raises:
        FrameError: A floor that the frame does not have, or more points on a floor than it can move freely.
    """

    def __init__(
        self, mbs: Any, reduced: ReducedFrame, table: Table, *, points: Iterable[tuple[int, float]] = ()
    ) -> None:
        self._mbs, self.reduced, self._table = mbs, reduced, table
        self._markers: dict[int, int] = {}
        self._basis, self._places = point_basis(reduced, points)
        back = self._basis
        size = len(reduced.mass)
        self.node = mbs.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=np.zeros(size),
                initialCoordinates=np.zeros(size),
                initialCoordinates_t=np.zeros(size),
                numberOfODE2Coordinates=size,
            )
        )
        self.body = mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[self.node, table.node],
                massMatrix=coupled(back.T @ reduced.mass @ back, np.linalg.solve(back, reduced.influence)),
                stiffnessMatrix=bordered(back.T @ reduced.stiffness @ back),
                dampingMatrix=bordered(back.T @ reduced.damping @ back),
            )
        )
        outputs = exudyn.OutputVariableType
        self._sensors = [
            mbs.AddSensor(
                items.SensorNode(
                    nodeNumber=self.node, outputVariableType=kind, storeInternal=True, writeToFile=False
                )
            )
            for kind in (outputs.Coordinates, outputs.Coordinates_t, outputs.Coordinates_tt)
        ]

    def marker(self, floor: int, y_m: float = 0.0) -> int:
        """Return the marker of a floor's displacement in x relative to the table.

        Args:
            floor: Number of the floor, from 1.
            y_m: Place along the floor's edge [m], from its middle; others than zero were given as ``points``.

        Raises:
            FrameError: There is no such floor or point.
        """
        if (floor, y_m) in self._places:
            coordinate = self._places[floor, y_m]
        elif y_m == 0.0:
            coordinate = int(self.reduced.floor_x[checked_floor(self.reduced, floor) - 1])
        else:
            raise FrameError(
                f"{self.reduced.name}: floor {floor}, y = {y_m} m is not among the points of its body"
            )
        if coordinate not in self._markers:
            self._markers[coordinate] = self._mbs.AddMarker(
                items.MarkerNodeCoordinate(nodeNumber=self.node, coordinate=coordinate)
            )
        return self._markers[coordinate]

    def history(self) -> History:
        """Return what the last run stored.

        Raises:
            FrameError: The motion grew without bound, so the step was too long.
        """
        stored = [np.asarray(self._mbs.GetSensorStoredData(sensor)) for sensor in self._sensors]
        if not all(np.isfinite(table).all() for table in stored):
            raise FrameError(f"{self.reduced.name}: the motion grew without bound; take a shorter step")
        history = History(stored[0][:, 0], *(table[:, 1:] @ self._basis.T for table in stored))
        # Explicit integrators store no acceleration at time zero; a frame at rest only feels its table.
        history.acceleration[0] = -self.reduced.influence * self._table.samples[0]
        return history


def longest_step(reduced: Iterable[ReducedFrame], *, wanted_s: float = LONGEST_STEP_S) -> float:
    """Return the longest step [s] that is neither above ``wanted_s`` nor unstable for one of the frames."""
    highest = max(float(frame.frequencies_hz.max()) for frame in reduced)
    return min(wanted_s, STABLE / (2.0 * np.pi * highest))


def settings(
    table: Table, longest_step_s: float, *, stored_per_sample: int = 1, duration_s: float | None = None
) -> exudyn.SimulationSettings:
    """Return settings for a fixed-step run whose steps meet every sample of the table's acceleration.

    The acceleration has a corner at each sample; a step across a corner loses the integrator's order.

    Args:
        table: The table.
        longest_step_s: The step will be the longest that divides the stored interval and is not above it [s].
        stored_per_sample: Stored states for each sample of the acceleration.
        duration_s: End of the run [s], rounded up to a sample; default: the record's end.
    """
    samples = len(table.samples) - 1
    if duration_s is not None:
        samples = max(1, int(np.ceil(duration_s / table.step_s - 1e-9)))
    stored = table.step_s / stored_per_sample
    steps = int(np.ceil(stored / longest_step_s - 1e-9))
    chosen = exudyn.SimulationSettings()
    chosen.timeIntegration.endTime = samples * table.step_s
    chosen.timeIntegration.numberOfSteps = samples * stored_per_sample * steps
    chosen.timeIntegration.automaticStepSize = False
    chosen.timeIntegration.adaptiveStep = False
    chosen.timeIntegration.verboseMode = 0
    chosen.linearSolver.solverType = exudyn.LinearSolverType.EXUdense
    chosen.solution.file.write = False
    # A whisker early, so that round-off in the engine's clock cannot put a state off by a step.
    chosen.solution.sensors.writePeriod = stored * (1.0 - 1e-9)
    return chosen


@contextmanager
def quiet() -> Iterator[None]:
    """Keep the engine from printing on standard output, where a JSON result may be meant to stand alone."""
    before = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield
    finally:
        exudyn.config.printToConsole = before


def solve(mbs: Any, chosen: exudyn.SimulationSettings, *, solver: str = "RK44") -> float:
    """Assemble and run a system.

    Args:
        mbs: The system with its table and frames.
        chosen: Settings, as from `settings`.
        solver: Name in ``exudyn.DynamicSolverType``.

    Returns:
        Wall time of the integration [s].

    Raises:
        FrameError: The engine could not finish.
    """
    mbs.Assemble()
    started = time.perf_counter()
    try:
        with quiet():
            finished = mbs.SolveDynamic(chosen, solverType=getattr(exudyn.DynamicSolverType, solver))
    except (ValueError, exudyn.SolverError) as error:
        heed_interruption(error)
        reason = f"({str(error).splitlines()[0]}); take a shorter step"
        raise FrameError(f"engine: {solver} did not finish {reason}") from error
    if not finished:
        raise FrameError(f"engine: {solver} did not finish; take a shorter step")
    return time.perf_counter() - started


class Alone(NamedTuple):
    """A frame that was shaken alone with fixed steps: its history, their number and the wall time [s]."""

    history: History
    steps: int
    wall_s: float


def run_alone(
    reduced: ReducedFrame,
    acceleration_m_s2: ArrayLike,
    step_s: float,
    *,
    integrator: str = "RK44",
    longest_step_s: float = LONGEST_STEP_S,
    table_mass_kg: float | None = None,
) -> Alone:
    """Shake one frame with fixed steps that meet the acceleration's samples, and store it at each sample.

    Args:
        reduced: The frame.
        acceleration_m_s2: Acceleration of the table (m,) [m/s^2].
        step_s: Its sample step [s].
        integrator: Name in ``exudyn.DynamicSolverType``.
        longest_step_s: Longest integration step [s].
        table_mass_kg: Mass of the table [kg]; that of `table_mass` when None.

    Raises:
        FrameError: The acceleration cannot be used, or the motion grew without bound.
    """
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    table = Table(mbs, acceleration_m_s2, step_s, mass_kg=table_mass_kg or table_mass([reduced]))
    body = FrameBody(mbs, reduced, table)
    chosen = settings(table, longest_step_s)
    wall_s = solve(mbs, chosen, solver=integrator)
    return Alone(body.history(), int(chosen.timeIntegration.numberOfSteps), wall_s)
