"""The shaking table with frames on it, and contacts between them: one run is one integration.

The engine is exudyn; frames that are linear apart from their contacts may be run by `exact` instead. In exudyn
the integrator is Dormand and Prince's explicit method of order five with its error estimate: its steps grow
to `Accuracy.longest_step_s` while the frames are apart and shrink to microseconds where two floors meet or
part, because the estimate sees the force appear. So nothing has to predict a touch, and no time is lost to
starting and stopping the engine. docs/validation/chapters-5-6.md has its error and its cost.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import exudyn
import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.contact.connector import ContactConnector, PointContact
from pounding.errors import heed_interruption
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact, check, history_of, sides_of
from pounding.experiments.rig.energy import balance
from pounding.experiments.rig.motion import FrameMotion, Motion, StoreyHistory, end_of_run
from pounding.experiments.rig.watchdog import Guard
from pounding.frames.response.body import FrameBody, Table, table_mass

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]


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


Solver = Literal["exudyn", "exact"]
"""What integrates a run: the engine, or the closed formulas of `exact` between the events of contacts."""

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
            check(contact, self.frames)

    def __repr__(self) -> str:
        names = " beside ".join(repr(frame.name) for frame in self.frames)
        return f"Rig({names}, contacts: {len(self.contacts)})"

    def run(
        self,
        shaking: Record | ArrayLike,
        step_s: float | None = None,
        *,
        duration_s: float | None = None,
        accuracy: Accuracy | None = None,
        progress: Callable[[float], None] | None = None,
        solver: Solver = "exudyn",
    ) -> Motion:
        """Shake the table and return what happened.

        Args:
            shaking: A record at the scale of the frames, or the table's acceleration (m,) [m/s^2].
            step_s: Its sample step [s], for an acceleration; a record has its own.
            duration_s: End of the run [s]; default: the end of the shaking.
            accuracy: Tolerances of exudyn; default: `COLLIDING` with contacts, `APART` without.
            progress: Called now and then with the model time [s].
            solver: `exudyn`, or `exact` for frames that are linear apart from their contacts (`exact`).

        Raises:
            ExperimentError: The motion grew without bound, or the steps became too small; says when and why. The exact
                solver was asked to run additions, or with tolerances of exudyn.
            ContactError: The exact solver cannot record a law.
            FrameError: The acceleration is not finite.
        """
        acceleration, step = _history(shaking, step_s)
        if solver == "exact":
            self._exact_can(accuracy)
            # Its compiled loop takes a second to load, which a run of the engine need not wait for.
            from pounding.experiments.rig.exact import run_exact

            return run_exact(
                self.frames, self.contacts, acceleration, step, duration_s=duration_s, progress=progress
            )
        container = exudyn.SystemContainer()
        mbs = container.AddSystem()
        try:
            table = Table(mbs, acceleration, step, mass_kg=table_mass(self.frames))
            bodies = tuple(FrameBody(mbs, frame, table) for frame in self.frames)
            # The engine keeps no reference to what it calls: these have to live until it has finished.
            connectors = [self._connect(mbs, bodies, contact) for contact in self.contacts]
            end = end_of_run(table.duration_s, duration_s)
            kept: list[Any] = [*connectors, *self._connectors(mbs, table, bodies, end)]
            kept += [addition(Assembly(mbs, table, bodies)) for addition in self.additions]
            latches = [one.latch for one in kept if getattr(one, "latch", None) is not None]
            guard = Guard(self.frames, bodies, latches, progress)
            mbs.SetPreStepUserFunction(guard)
            cost = _integrate(mbs, end, accuracy or (COLLIDING if self.contacts else APART), guard)
            return self._collect(bodies, table, end, cost)
        finally:
            # The engine and what it calls refer to each other across the languages: else no run is freed.
            mbs.SetPreStepUserFunction(0)  # type: ignore[arg-type]
            container.Reset()

    def _exact_can(self, accuracy: Accuracy | None) -> None:
        if self.additions:
            raise ExperimentError(
                "the exact solver takes no additions; run them with exudyn, or state them as laws in storeys"
            )
        if accuracy is not None:
            raise ExperimentError("the tolerances are exudyn's; the exact solver keeps its own")

    def _connect(
        self, mbs: Any, bodies: Sequence[FrameBody], contact: Contact
    ) -> ContactConnector | PointContact:
        left, right = bodies[contact.pair], bodies[contact.pair + 1]
        if contact.y_m == 0.0 and not contact.on_columns:
            markers = left.marker(int(contact.floors[0])), right.marker(int(contact.floors[1]))
            return ContactConnector(mbs, contact.law, contact.gap_m, *markers, stepped=True)
        one, other = sides_of(self.frames, contact)
        return PointContact(mbs, contact.law, contact.gap_m, (left.node, one.row), (right.node, other.row))

    def _connectors(self, mbs: Any, table: Table, bodies: Sequence[FrameBody], end_s: float) -> list[Any]:
        """Return the laws that the frames' files state, as connectors of the engine."""
        if not self._has_laws:
            return []
        # The compiler of laws takes a while to load, which a linear frame need not wait for.
        from pounding.experiments.rig.frame_laws import frame_laws, table_rate, until
        from pounding.experiments.rig.law_connector import LawConnector, partly, resting

        ground, rate = resting(mbs), table_rate(table.samples, table.step_s)
        return [
            LawConnector(mbs, bodies[law.body], ground, law, partly(rate, law.in_room))
            for law in until(frame_laws(self.frames), end_s)
        ]

    @property
    def _has_laws(self) -> bool:
        definitions = [frame.definition for frame in self.frames]
        return any(one.yielding is not None or one.storey_law for one in definitions)

    def _in_storeys(
        self, motions: Sequence[FrameMotion], table: Table, end_s: float
    ) -> tuple[StoreyHistory, ...]:
        if not self._has_laws:
            return ()
        from pounding.experiments.rig.frame_laws import frame_laws, histories, table_rate, until

        laws = until(frame_laws(self.frames), end_s)
        return histories(self.frames, motions, laws, table_rate(table.samples, table.step_s))

    def _collect(
        self, bodies: Sequence[FrameBody], table: Table, end_s: float, cost: tuple[float, float]
    ) -> Motion:
        motions = []
        for body in bodies:
            time_s, q, v, a = body.history()
            motions.append(FrameMotion(body.reduced, time_s, q, v, a, table.acceleration(time_s)))
        contacts = tuple(history_of(self.frames, motions, contact) for contact in self.contacts)
        storeys = self._in_storeys(motions, table, end_s)
        energy = balance(tuple(motions), contacts, storeys)
        steps = len(motions[0].time_s) - 1
        return Motion(tuple(motions), contacts, energy, *cost, steps, storeys=storeys)


def _history(shaking: Record | ArrayLike, step_s: float | None) -> tuple[Real, float]:
    if isinstance(shaking, Record):
        return shaking.acceleration_m_s2, shaking.step_s
    if step_s is None:
        raise ExperimentError("an acceleration without a sample step: give step_s, or a record")
    return np.asarray(shaking, float), float(step_s)


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
        heed_interruption(error)
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
