"""The shaking table with frames on it, and contacts between them: one run is one integration by exudyn.

The integrator is Dormand and Prince's explicit method of order five with its error estimate: its steps grow
to `Accuracy.longest_step_s` while the frames are apart and shrink to microseconds where two floors meet or
part, because the estimate sees the force appear. So nothing has to predict a touch, and no time is lost to
starting and stopping the engine. docs/validation/chapters-5-6.md has its error and its cost.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import exudyn
import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.contact.connector import ContactConnector, PointContact, checked_gap
from pounding.contact.laws import Law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.energy import balance
from pounding.experiments.rig.motion import ContactHistory, FrameMotion, Motion, floor_coordinate
from pounding.experiments.rig.watchdog import Guard
from pounding.frames.floors import level_floors
from pounding.frames.response.body import FrameBody, Table

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """A place where two neighbouring frames may touch.

    Attributes:
        law: Impact law with its parameters.
        gap_m: Gap at rest [m]; zero means that the floors lie against each other.
        floor: Floor on both frames, or (left, right) where their numbers differ at the same height.
        pair: Which pair: 0 is between the first and the second frame of the row.
        y_m: Place along the floors' edge, from the middle [m].
    """

    law: Law
    gap_m: float
    floor: int | tuple[int, int]
    pair: int = 0
    y_m: float = 0.0

    @property
    def floors(self) -> tuple[int, int]:
        """Floor of the left and of the right frame."""
        return self.floor if isinstance(self.floor, tuple) else (self.floor, self.floor)


class Accuracy(NamedTuple):
    """How closely a run is integrated; docs/validation/chapters-5-6.md shows what the default leaves.

    Attributes:
        relative: Relative tolerance of a step [-].
        absolute: Absolute tolerance of a step [m and m/s].
        longest_step_s: Longest step [s].
    """

    relative: float = 1e-8
    absolute: float = 1e-10
    longest_step_s: float = 5e-4


COLLIDING = Accuracy()
"""Default with contacts: an early error in a touch grows with every later one, so it is kept small."""

APART = Accuracy(1e-6, 1e-8, 5e-4)
"""Default without contacts, where nothing multiplies an error."""

SHORTEST_STEP_S = 1e-13


class Assembly(NamedTuple):
    """What an addition to the rig gets: the exudyn system, the table and the frames' bodies."""

    mbs: Any
    table: Table
    bodies: tuple[FrameBody, ...]


Addition = Callable[[Assembly], Any]
"""Adds something to the assembled system before it runs; what it returns is kept alive until the run ends, and its
`latch`, if it has one, is called before each step."""


class Rig:
    """Frames in a row on one table, from left to right along +x, and the contacts between neighbours.

    Args:
        frames: One or more reduced frames (`frames.build`).
        contacts: Contacts; none are needed.
        additions: Functions that add further items to the system (friction, devices, ...).

    Raises:
        ExperimentError: No frame, a pair or a floor that is not there, or floors at different heights.
        ContactError: A negative gap.
    """

    def __init__(
        self,
        frames: Sequence[ReducedFrame],
        contacts: Sequence[Contact] = (),
        *,
        additions: Sequence[Addition] = (),
    ) -> None:
        if not frames:
            raise ExperimentError("a rig needs at least one frame")
        self.frames, self.contacts, self.additions = tuple(frames), tuple(contacts), tuple(additions)
        for contact in self.contacts:
            self._check(contact)

    def _check(self, contact: Contact) -> None:
        checked_gap(contact.gap_m)
        if not 0 <= contact.pair < len(self.frames) - 1:
            raise ExperimentError(
                f"a contact in pair {contact.pair}, but {len(self.frames)} frame(s) in a row have "
                f"{max(0, len(self.frames) - 1)} pair(s), counted from 0"
            )
        pair = self.frames[contact.pair : contact.pair + 2]
        for frame, floor in zip(pair, contact.floors, strict=True):
            floor_coordinate(frame, floor)
        if contact.floors not in level_floors(pair[0].heights_m, pair[1].heights_m):
            low, high = (
                float(frame.heights_m[floor - 1]) for frame, floor in zip(pair, contact.floors, strict=True)
            )
            raise ExperimentError(
                f"floor {contact.floors[0]} of {pair[0].name} is at {low:g} m and floor {contact.floors[1]} "
                f"of {pair[1].name} at {high:g} m: only floors at one height can meet"
            )

    def run(
        self,
        shaking: Record | ArrayLike,
        step_s: float | None = None,
        *,
        duration_s: float | None = None,
        accuracy: Accuracy | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """Shake the table and return what happened.

        Args:
            shaking: A record at model scale, or the table's acceleration (m,) [m/s^2].
            step_s: Its sample step [s], for an acceleration; a record has its own.
            duration_s: End of the run [s]; default: the end of the shaking.
            accuracy: Tolerances; default: `COLLIDING` with contacts, `APART` without.
            progress: Called now and then with the model time [s].

        Raises:
            ExperimentError: The motion grew without bound, or the steps became too small; says when and why.
            FrameError: The acceleration is not finite.
        """
        acceleration, step = _history(shaking, step_s)
        container = exudyn.SystemContainer()
        mbs = container.AddSystem()
        try:
            table = Table(mbs, acceleration, step)
            bodies = tuple(FrameBody(mbs, frame, table) for frame in self.frames)
            # The engine keeps no reference to what it calls: these have to live until it has finished.
            connectors = [self._connect(mbs, bodies, contact) for contact in self.contacts]
            kept: list[Any] = list(connectors)
            kept += [addition(Assembly(mbs, table, bodies)) for addition in self.additions]
            latches = [one.latch for one in kept if getattr(one, "latch", None) is not None]
            guard = Guard(self.frames, bodies, latches, progress)
            mbs.SetPreStepUserFunction(guard)
            end = table.duration_s if duration_s is None else float(duration_s)
            cost = _integrate(mbs, end, accuracy or (COLLIDING if self.contacts else APART), guard)
            return self._collect(bodies, table, cost)
        finally:
            # The engine and what it calls refer to each other across the languages: else no run is freed.
            mbs.SetPreStepUserFunction(0)  # type: ignore[arg-type]
            container.Reset()

    def _connect(
        self, mbs: Any, bodies: Sequence[FrameBody], contact: Contact
    ) -> ContactConnector | PointContact:
        left, right = bodies[contact.pair], bodies[contact.pair + 1]
        first, second = contact.floors
        if contact.y_m == 0.0:
            markers = left.marker(first), right.marker(second)
            return ContactConnector(mbs, contact.law, contact.gap_m, *markers, stepped=True)
        rows = _rows(self.frames, contact)
        return PointContact(mbs, contact.law, contact.gap_m, (left.node, rows[0]), (right.node, rows[1]))

    def _collect(self, bodies: Sequence[FrameBody], table: Table, cost: tuple[float, float]) -> Motion:
        motions = []
        for body in bodies:
            time_s, q, v, a = body.history()
            motions.append(FrameMotion(body.reduced, time_s, q, v, a, table.acceleration(time_s)))
        histories = tuple(self._history_of(motions, contact) for contact in self.contacts)
        return Motion(
            tuple(motions), histories, balance(tuple(motions), histories), *cost, len(motions[0].time_s) - 1
        )

    def _history_of(self, motions: Sequence[FrameMotion], contact: Contact) -> ContactHistory:
        left, right = motions[contact.pair], motions[contact.pair + 1]
        rows = _rows(self.frames, contact)
        apart = [
            first @ rows[0] - second @ rows[1]
            for first, second in (
                (left.displacement_m, right.displacement_m),
                (left.velocity_m_s, right.velocity_m_s),
                (left.acceleration_m_s2, right.acceleration_m_s2),
            )
        ]
        return ContactHistory(
            contact.floors[0], left.name, right.name, contact.gap_m, contact.y_m, contact.law,
            left.time_s, apart[0] - contact.gap_m, apart[1], apart[2],
        )  # fmt: skip


def _history(shaking: Record | ArrayLike, step_s: float | None) -> tuple[Real, float]:
    if isinstance(shaking, Record):
        return shaking.acceleration_m_s2, shaking.step_s
    if step_s is None:
        raise ExperimentError("an acceleration without a sample step: give step_s, or a record")
    return np.asarray(shaking, float), float(step_s)


def _rows(frames: Sequence[ReducedFrame], contact: Contact) -> tuple[Real, Real]:
    """Return the rows that give the two points' displacements in x from the frames' coordinates."""
    pair = frames[contact.pair : contact.pair + 2]
    if contact.y_m == 0.0:
        found = []
        for frame, floor in zip(pair, contact.floors, strict=True):
            row = np.zeros(len(frame.mass))
            row[floor_coordinate(frame, floor)] = 1.0
            found.append(row)
        return found[0], found[1]
    left, right = (
        np.asarray(f.point_row(n, contact.y_m), float) for f, n in zip(pair, contact.floors, strict=True)
    )
    return left, right


def _integrate(mbs: Any, end_s: float, accuracy: Accuracy, guard: Guard) -> tuple[float, float]:
    """Run the system to `end_s` and return the wall and the processor time [s]."""
    mbs.Assemble()
    started, worked = time.perf_counter(), time.process_time()
    try:
        with _silence():
            finished = mbs.SolveDynamic(
                _settings(end_s, accuracy), solverType=exudyn.DynamicSolverType.DOPRI5
            )
    except (ValueError, exudyn.SolverError) as error:
        raise ExperimentError(
            f"the engine stopped at {guard.time_s:.4f} s ({str(error).splitlines()[0]}); lower the shaking "
            "or the contact's stiffness, or loosen the tolerances"
        ) from error
    if guard.reason or not finished:
        reason = guard.reason or "the engine did not finish; loosen the tolerances"
        raise ExperimentError(f"the run was stopped at {guard.time_s:.4f} s: {reason}")
    return time.perf_counter() - started, time.process_time() - worked


def _settings(end_s: float, accuracy: Accuracy) -> Any:
    chosen = exudyn.SimulationSettings()
    chosen.timeIntegration.endTime = end_s
    chosen.timeIntegration.numberOfSteps = max(1, int(np.ceil(end_s / accuracy.longest_step_s)))
    chosen.timeIntegration.automaticStepSize = True
    chosen.timeIntegration.adaptiveStep = True
    chosen.timeIntegration.initialStepSize = min(1e-5, accuracy.longest_step_s)
    chosen.timeIntegration.minimumStepSize = SHORTEST_STEP_S
    chosen.timeIntegration.relativeTolerance = accuracy.relative
    chosen.timeIntegration.absoluteTolerance = accuracy.absolute
    chosen.timeIntegration.verboseMode = 0
    chosen.linearSolver.solverType = exudyn.LinearSolverType.EXUdense
    chosen.solution.file.write = False
    chosen.solution.sensors.writePeriod = 1e-15  # every step
    return chosen


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Keep the engine's remarks off standard output, where `--json` prints; what matters is raised."""
    before = exudyn.config.printToConsole, exudyn.config.suppressWarnings
    exudyn.config.printToConsole, exudyn.config.suppressWarnings = False, True
    try:
        yield
    finally:
        exudyn.config.printToConsole, exudyn.config.suppressWarnings = before
