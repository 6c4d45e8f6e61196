"""The baseline model: its system for given nuisance parameters and effects, and the prediction that follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.model.kalman import (
    DISCREPANCY,
    LATENT_RATE,
    TABLE_NOISE_RATE,
    Gain,
    LinearSystem,
    linear_system,
)
from pounding.diagnosis.model.known_forces import KnownForces
from pounding.diagnosis.model.last import Last
from pounding.diagnosis.model.laws import placed_arrays
from pounding.diagnosis.model.nuisance import (
    MODAL_STIFFNESS,
    Assembly,
    baseline,
    changes,
    nuisance_parameters,
)
from pounding.diagnosis.model.observations import Observations, RunData
from pounding.diagnosis.model.predictor import predict
from pounding.diagnosis.model.sensor_faults import SensorFaults
from pounding.diagnosis.model.side_by_side import side_by_side
from pounding.diagnosis.model.storeys import Coupling, Modes, Structure, solve_modes
from pounding.diagnosis.model.table_motion import TableMotion
from pounding.diagnosis.model.tangents import Tangents
from pounding.diagnosis.model.tilt import tilt_inputs
from pounding.diagnosis.settings import SETTINGS


class Acting(Protocol):
    """An effect that can be put on an assembly."""

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change an assembly by the effect.

        Args:
            assembly: The assembly, which is changed in place.
            values: SI parameters of the effect, shape (parameters,).
            model: The baseline model.
        """


@dataclass(frozen=True)
class Prediction:
    """Innovations (or residuals), predicted and filtered states and outputs of each run.

    `middles` has drift [m] and rate [m/s] on which each law acts at the middle of each substep, of each run, shape (samples,
    substeps, laws, 2).
    """

    innovations: list[np.ndarray]
    before: list[np.ndarray]
    after: list[np.ndarray]
    outputs: list[np.ndarray]
    middles: list[np.ndarray]

    def of(self, numbers: Sequence[int]) -> Prediction:
        """Return the prediction of some of the runs, which are given by their numbers among these."""

        def some(series: list[np.ndarray]) -> list[np.ndarray]:
            return [series[number] for number in numbers]

        return Prediction(
            some(self.innovations),
            some(self.before),
            some(self.after),
            some(self.outputs),
            some(self.middles),
        )


class Model:
    """A structure, what was measured on it, and the priors of its nuisance parameters.

    Args:
        structure: The frames.
        observed: What was measured.
        prior: Prior standard deviations that the case states.
        always: Effects that act in all runs, reference runs too, each with its SI parameters, shape (parameters,).

    Attributes:
        faults: What the sensors make of the motion, and what they would have read without their faults.
        tangents: Laws along the motion that was asked for last (`inference.filtering`), by the number of the run, each with
            what returns that motion as long as somebody else needs it.
        histories: Returns the term of the inference (`inference.histories`) that keeps its signatures of the nuisance
            parameters, which one at a time does; None where there is none any more.
    """

    def __init__(
        self,
        structure: Structure,
        observed: Observations,
        prior: Prior,
        always: Sequence[tuple[Acting, np.ndarray]] = (),
    ) -> None:
        self.structure = structure
        self.observed = observed
        self.prior = prior
        self.always = tuple(always)
        self.parameters = nuisance_parameters(structure, observed, prior)
        self.std = np.array([parameter.std for parameter in self.parameters])
        self.discrepant = np.array([parameter.kind == MODAL_STIFFNESS for parameter in self.parameters], bool)
        self._tables = [
            TableMotion(run.table, run.step_s, run.table_between, run.step_s / run.substeps)
            for run in observed.runs
        ]
        self.faults = SensorFaults(observed.runs)
        # Slopes and searches of effects leave the nuisance parameters alone, and most effects the modes.
        self._plain: Last[Assembly] = Last()
        self._modes: Last[Modes] = Last()
        self._between: Last[np.ndarray] = Last()
        self.tangents: dict[int, tuple[Callable[[], object | None], Tangents]] = {}
        self.histories: Callable[[], object | None] = lambda: None

    def spread(self, discrepancy: float) -> np.ndarray:
        """Return the prior standard deviations of the nuisance parameters in their own units, shape (nuisance,).

        Args:
            discrepancy: Scale of the model discrepancy [-].
        """
        return np.asarray(np.where(self.discrepant, discrepancy / DISCREPANCY, 1.0) * self.std)

    def at_frame(self, frame: int) -> np.ndarray:
        """Return which channels sit on a frame (its number), shape (channels,); the first one has the table's, too."""
        span, floor = self.structure.span(frame), self.observed.floor
        return np.asarray((floor >= span.start) & (floor < span.stop))

    def assemble(self, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]] = ()) -> Assembly:
        """Return the system of the baseline model with nuisance parameters and effects.

        Args:
            values: Nuisance parameters in their own units, shape (nuisance,).
            effects: Effects that act, each with its SI parameters, shape (parameters,).
        """
        key = np.asarray(values, float).tobytes()
        assembly = self._plain.of(key, lambda: self._without_effects(values)).copy()
        for effect, numbers in (*self.always, *effects):
            effect.apply(assembly, np.asarray(numbers, float), self)
        return assembly

    def _without_effects(self, values: np.ndarray) -> Assembly:
        still, added = self._by_parameter
        return self._baseline.with_numbers(still + np.asarray(values, float) @ added)

    @cached_property
    def _baseline(self) -> Assembly:
        return baseline(self.structure, len(self.observed.names), len(self.observed.contact_events))

    @cached_property
    def _by_parameter(self) -> tuple[np.ndarray, np.ndarray]:
        return self._baseline.numbers(), changes(self._baseline, self.structure, self.parameters)

    def acts(self, run: int) -> bool:
        """Return whether effects act in a run: in all but reference runs, which are of the frame as it was before them."""
        return not self.observed.runs[run].reference

    def since(self, runs: Sequence[int]) -> tuple[int, ...]:
        """Return those of some runs in which effects act."""
        return tuple(run for run in runs if self.acts(run))

    def systems(
        self, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]], runs: Sequence[int]
    ) -> list[tuple[Assembly, Modes]]:
        """Return system and modes of each run, with the effects that act in it.

        Args:
            values: Nuisance parameters in their own units, shape (nuisance,).
            effects: Effects, each with its SI parameters, shape (parameters,).
            runs: Numbers of the runs.
        """
        built: dict[bool, tuple[Assembly, Modes]] = {}
        for acts in {self.acts(run) for run in runs}:
            assembly = self.assemble(values, effects if acts else ())
            built[acts] = assembly, self.modes(assembly)
        return [built[self.acts(run)] for run in runs]

    def modes(self, assembly: Assembly) -> Modes:
        """Return the modes of an assembly, with the coordinates that effects added."""
        return self._extended(assembly) if assembly.extensions else self.plain_modes(assembly)

    def _extended(self, assembly: Assembly) -> Modes:
        """Return the modes with the coordinates that effects added.

        A frame's own damping is that of its modes and what couples them, however it moves. What hangs on a damper of its own
        and is tuned to a mode is coupled with it by that damper as much as it is damped; what this couples of modes far
        apart is nothing beside that.
        """
        mass, stiffness, damping, influence = self.matrices(assembly)
        omega, shapes = solve_modes(mass, stiffness)
        modal = shapes.T @ damping @ shapes
        floors, pairs = len(assembly.mass), assembly.dampers + int(np.count_nonzero(assembly.coupling))
        return Modes(
            omega,
            np.diag(modal) / (2 * omega),
            shapes[:floors],
            shapes.T @ (mass @ influence),
            shapes[floors:],
            Coupling.strongest(omega, modal, pairs),
        )

    def plain_modes(self, assembly: Assembly) -> Modes:
        """Return the modes of an assembly's floors alone, frame by frame."""
        each = assembly.mass, assembly.stiffness, assembly.log_damping, assembly.coupling
        return self._modes.of(tuple(one.tobytes() for one in each), lambda: self._by_frame(*each))

    def _by_frame(
        self, mass: np.ndarray, stiffness: np.ndarray, log_damping: np.ndarray, coupling: np.ndarray
    ) -> Modes:
        floors = len(mass)
        omegas, rows = [], []
        shapes = np.zeros((floors, floors))
        for number in range(len(self.structure.frames)):
            span = self.structure.span(number)
            omega, block = solve_modes(mass[span, span], stiffness[span, span])
            omegas.append(omega)
            shapes[span, span] = block
            rows.append(block.T @ mass[span, span].sum(axis=1))
        coupled = Coupling.of(self.structure.couplings, coupling * self.structure.coupling_size)
        return Modes(
            np.concatenate(omegas), np.exp(log_damping), shapes, np.concatenate(rows), coupling=coupled
        )

    def linear_system(self, modes: Modes) -> LinearSystem:
        """Return the linear system of these modes with the model's channels."""
        rows, observed = self.structure.drift @ modes.floors, self.observed
        return linear_system(modes, rows, observed.quantity, observed.floor)

    def matrices(self, assembly: Assembly) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return mass [kg], stiffness [N/m] and damping [N s/m] of an assembly, and how far a unit of the table moves it.

        Coordinates that effects added are included: shapes (n, n), the last (n,).
        """
        plain, mass, stiffness = self.plain_modes(assembly), assembly.mass, assembly.stiffness
        weighted = mass @ plain.floors
        modal = np.diag(2 * plain.ratio * plain.omega) + plain.coupling.matrix(len(plain.omega))
        damping = weighted @ modal @ weighted.T
        for extend in assembly.extensions:
            mass, stiffness, damping = extend(mass, stiffness, damping)
        return mass, stiffness, damping, np.concatenate([np.ones(len(plain.floors)), assembly.influence])

    def seeing(self, observed: Observations) -> Model:
        """Return the same frames and priors with other observations."""
        return Model(self.structure, observed, self.prior, self.always)

    def is_light(self, runs: Sequence[int]) -> bool:
        """Return whether there is memory for two pieces of work on some runs at a time.

        Args:
            runs: Numbers of the runs.
        """
        samples = sum(self.observed.runs[run].measured.size for run in runs)
        return bool(samples * len(self.std) < SETTINGS.search.side_by_side)

    def table_at(self, assembly: Assembly, number: int, times_s: np.ndarray) -> np.ndarray:
        """Return the table's acceleration [m/s^2] with an assembly's gain, delay and clock, shape of `times_s`.

        Args:
            assembly: The assembly.
            number: Number of the run.
            times_s: Times from the start of the run [s], any shape.
        """
        late = self._table_times(assembly, number, times_s)
        return np.asarray((1 + assembly.table_gain) * self._tables[number].at(late))

    def table_slope(self, assembly: Assembly, number: int, times_s: np.ndarray) -> np.ndarray:
        """Return by how much the table's acceleration grows with its own clock's time [m/s^3], shape of `times_s`.

        Args:
            assembly: The assembly, with the table's gain, delay and clock.
            number: Number of the run.
            times_s: Times from the start of the run [s], any shape.
        """
        late = self._table_times(assembly, number, times_s)
        return np.asarray((1 + assembly.table_gain) * self._tables[number].slope(late))

    def _table_times(self, assembly: Assembly, number: int, times_s: np.ndarray) -> np.ndarray:
        """Return times on the table's own clock [s], shape of `times_s`."""
        run = self.observed.runs[number]
        true = (times_s - assembly.table_delay_s) * (1 + assembly.table_clock)
        return np.clip(true, 0.0, (len(run.table) - 1) * run.step_s)

    @cached_property
    def own_motion(self) -> np.ndarray:
        """Rows that turn floor displacements into those of the baseline frames' own modes, shape (floors, floors)."""
        assembly = self.assemble(np.zeros(len(self.std)))
        return np.asarray(self.plain_modes(assembly).floors.T @ assembly.mass)

    def overlap(self, modes: Modes) -> np.ndarray:
        """Return which part of each of `modes` is each of the baseline frames' own modes, shape (floors, modes)."""
        return np.asarray(np.square(self.own_motion @ modes.floors))

    def carried(self, other: Model, values: np.ndarray) -> np.ndarray:
        """Return another model's nuisance parameters for this one, (nuisance,), those of its own sensors being zero.

        Args:
            other: A model with other sensors.
            values: Its nuisance parameters in their own units, shape (nuisance of the other,).
        """
        known = {
            (one.kind, one.place): value
            for one, value in zip(other.parameters, values, strict=True)
            if not one.kind.startswith("channel")
        }
        return np.array([known.get((one.kind, one.place), 0.0) for one in self.parameters])

    def predict(
        self,
        values: np.ndarray,
        gains: Sequence[Gain] | None = None,
        effects: Sequence[tuple[Acting, np.ndarray]] = (),
        runs: Sequence[int] | None = None,
        whole: bool = True,
    ) -> Prediction:
        """Return the prediction of runs: filtered where gains are given, simulated without them.

        Args:
            values: Nuisance parameters in their own units, shape (nuisance,).
            gains: Filter gain of each run; none for a simulation.
            effects: Effects that act in the runs since the reference ones, each with its SI parameters, shape (parameters,).
            runs: Numbers of the runs, all by default.
            whole: Whether states and outputs are wanted beside the innovations; else these have no samples.
        """
        numbers = list(runs if runs is not None else range(len(self.observed.runs)))
        systems = self.systems(values, effects, numbers)
        each = [
            (*system, run, None if gains is None else gains[number])
            for number, (run, system) in enumerate(zip(numbers, systems, strict=True))
        ]
        pieces = side_by_side(lambda one: self._run(*one, whole), each)
        return Prediction(*([piece[i] for piece in pieces] for i in range(5)))

    def _run(
        self, assembly: Assembly, modes: Modes, number: int, gain: Gain | None, whole: bool
    ) -> tuple[np.ndarray, ...]:
        run = self.observed.runs[number]
        storeys = self.structure.floors
        states = 2 * len(modes.omega) + storeys + 3
        substep = run.step_s / run.substeps
        laws, rows, room, parameters = placed_arrays(
            assembly.laws, modes.floors, run.step_s * (len(run.table) - 1), substep
        )
        known, table_mid, added = self._inputs(assembly, modes, number, run)
        measured = self.faults.removed(assembly, number)
        if added is not None:
            measured = measured - added
        channels = len(self.observed.names)
        innovations, before, after, outputs, middles = predict(
            np.stack([modes.omega, modes.ratio], axis=1),
            modes.coupling.pairs,
            modes.coupling.rates,
            modes.step(substep / 2),
            modes.step(substep),
            modes.participation,
            np.ascontiguousarray(modes.floors),
            np.ascontiguousarray(self.structure.drift @ modes.floors),
            known.middle,
            known.samples,
            known.directions,
            table_mid,
            self.observed.quantity,
            self.observed.floor,
            measured,
            np.zeros((channels, states)) if gain is None else np.ascontiguousarray(gain.at(modes).T),
            np.array([LATENT_RATE, TABLE_NOISE_RATE]),
            run.step_s,
            laws,
            rows,
            room,
            parameters,
            whole,
        )
        # An innovation is that of the channel as it reads.
        innovations = innovations * (1.0 + assembly.channel_gain)
        if not whole:
            return innovations, before, after, outputs, middles
        if added is not None:
            outputs += added
        outputs = self.faults.added(assembly, number, outputs, late=gain is None)
        return innovations, before, after, outputs, middles

    def _inputs(
        self, assembly: Assembly, modes: Modes, number: int, run: RunData
    ) -> tuple[KnownForces, np.ndarray, np.ndarray | None]:
        """Return known forces, the table at midpoints (samples, substeps), and what a tilt adds to the channels."""
        samples, substeps = len(run.table), run.substeps
        at, middle = run.instants
        known = KnownForces.none(samples, substeps, len(modes.omega))
        added = None
        for column, (left, right) in enumerate(self.observed.contact_floors):
            direction = modes.floors[right] - modes.floors[left]
            known = known.with_one(
                self.contact_force(assembly, number, column, middle),
                self.contact_force(assembly, number, column, at),
                direction,
            )
        if assembly.table_tilt:
            known, added = tilt_inputs(self, assembly, modes, number, middle, at, known)
        return known, self._table_between(assembly, number, middle), added

    def _table_between(self, assembly: Assembly, number: int, middle: np.ndarray) -> np.ndarray:
        """Return `table_at` at the midpoints of a run; what was asked for last is kept."""
        key = (assembly.table_delay_s, assembly.table_clock, middle.size)
        plain = replace(assembly, table_gain=0.0)
        between = self._between.of(key, lambda: self.table_at(plain, number, middle), number)
        return np.asarray((1 + assembly.table_gain) * between)

    def contact_force(self, assembly: Assembly, number: int, column: int, times_s: np.ndarray) -> np.ndarray:
        """Return a contact force [N] of a run, scaled in each contact event as the assembly says, shape of `times_s`.

        Args:
            assembly: The assembly.
            number: Number of the run.
            column: Column of the contact force.
            times_s: Times from the start of the run [s], any shape.
        """
        force = self.observed.runs[number].contact_at(times_s, column)
        for event, gain in zip(self.observed.contact_events, assembly.event_gain, strict=True):
            if gain and (event.run, event.column) == (number, column):
                force[event.within(times_s)] *= 1.0 + gain
        return force
