"""The exact solver: frames that are linear apart from contacts and laws in storeys, without the engine and much quicker.

Between touches every mode follows the table by a closed formula; touches and partings are located; in contact, and where
a law acts in a storey, the step follows an error control (`exact_loop` has the method). What it leaves is the same
`Motion` as a run of the engine.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.calling import MEMORY, NUMBERS, called
from pounding.contact.recorded import recorded
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig import exact_loop as loop
from pounding.experiments.rig.compiling import announce
from pounding.experiments.rig.contacts import Contact, Within, history_of, sides_of
from pounding.experiments.rig.energy import balance
from pounding.experiments.rig.exact_arrays import Contacts, Modes, Shaking, State, Storeys
from pounding.experiments.rig.frame_laws import frame_laws
from pounding.experiments.rig.laws import filled
from pounding.experiments.rig.motion import FrameMotion, Motion, end_of_run, stop_if_unbounded, unbounded
from pounding.experiments.rig.storeys import KnownForce, StoreyLaw, check, coordinate_row, no_law_twice
from pounding.experiments.rig.storeys import history_of as storey_history
from pounding.frames.response.exact import checked, poles, select

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.float64]

announce(loop.__name__)

STEPS_A_PERIOD = 20.0
"""Steps in a period of the fastest mode that counts; the motion between them is read from cubics."""

COUNTS = 1e-4
"""Share in the sway under a steady acceleration from which a mode counts for the longest step [-]."""

FINEST_A_PERIOD = 20.0
"""Finest steps in flight in a period of the fastest mode of all: so close a cubic sees every touch."""

DEEPER = 12
"""A step in contact may be the finest step in flight over two to this power."""

CHUNK = 8192
"""Steps between two looks at whether the motion is bounded and the user wants to stop."""

LEAST_GAP_M = 1e-12
"""[m] Floors that lie against each other are so far apart: at no distance at all rounding alone would say whether they
touch, and a run would begin with touches without end."""
LOOK_EVERY = 16
"""Of a chunk each step of so many, from the last one back, is looked at: what grows without bound stays."""

STUCK_S = 1e-6
"""Shortest time that a chunk must cover [s]."""

TOLERANCE = 1e-5
"""Velocity by which a step in contact may be wrong by the error estimate, as a share of the largest in it [-]. The step
is of two orders higher than the estimate: forces and impulses are then right to some 1e-6."""


class Solution(NamedTuple):
    """What the loop leaves.

    Attributes:
        time_s: Times of the steps (m,) [s].
        states: Poles of all frames (m, 2, p), real and imaginary parts.
        forces: Contact forces (m, c) [N].
        acceleration: The table's acceleration at the times (m,) [m/s^2].
        storey_forces: Forces of the laws in storeys (m, l) [N].
        storey_middles: The same in the middle of the step that ends at the time (m, l) [N]; the first do not count.
    """

    time_s: Real
    states: Real
    forces: Real
    acceleration: Real
    storey_forces: Real
    storey_middles: Real


class _Rows:
    """Rows that the loop fills: times (k,), states (k, 2, p), forces (k, f). The first is rest, with its forces (f,)."""

    def __init__(self, rows: int, poles: int, forces: Real) -> None:
        self.times, self.states, self.forces = (
            np.empty(rows),
            np.empty((rows, 2, poles)),
            np.empty((rows, len(forces))),
        )
        self.times[0] = self.states[0] = 0.0
        self.forces[0] = forces

    def make_room(self, rows: int) -> None:
        """Let there be at least so many rows."""
        if rows > len(self.times):
            more = max(rows, 2 * len(self.times)) - len(self.times)
            self.times, self.states, self.forces = (
                np.concatenate([one, np.empty((more, *one.shape[1:]))])
                for one in (self.times, self.states, self.forces)
            )


class ExactRig:
    """Frames in a row and their contacts as the flat arrays of the compiled loop.

    Args:
        frames: Reduced frames, from left to right.
        contacts: Contacts, checked by `Rig`.
        storeys: Laws in storeys and known forces beside those of the frames' files; the attribute has the laws first.

    Raises:
        ContactError: A law that cannot be recorded.
        ExperimentError: A law in a storey that the frames cannot have.
        FrameError: A frame whose damping leaves no poles.
    """

    def __init__(
        self,
        frames: Sequence[ReducedFrame],
        contacts: Sequence[Contact | Within],
        storeys: Sequence[StoreyLaw | KnownForce] = (),
    ) -> None:
        self.frames, self.contacts = tuple(frames), tuple(contacts)
        stated, given = frame_laws(self.frames), [one for one in storeys if isinstance(one, StoreyLaw)]
        no_law_twice(given, stated, self.frames)
        self._laws = (*given, *stated)
        self._known = tuple(one for one in storeys if isinstance(one, KnownForce))
        self.storeys: tuple[StoreyLaw | KnownForce, ...] = (*self._laws, *self._known)
        for storey in self.storeys:
            check(storey, self.frames)
        self.poles = [poles(frame) for frame in self.frames]
        ends = np.cumsum([0, *(len(one.rates) for one in self.poles)])
        self.spans = [(int(a), int(b)) for a, b in pairwise(ends)]
        self.rates = np.concatenate([one.rates for one in self.poles])
        self._load = _parts(np.concatenate([one.load for one in self.poles]))
        self._loop_contacts = self._contacts()

    def _sides(self) -> list[list[tuple[int, Real, float]]]:
        """Return for each connection the frames on which it acts, with the row of coordinates and its sign in the drift."""
        found = [
            [(*side, sign) for side, sign in zip(sides_of(self.frames, one), (1.0, -1.0), strict=True)]
            for one in self.contacts
        ]
        return found + [[(one.body, coordinate_row(self.frames, one), 1.0)] for one in self.storeys]

    def _contacts(self) -> Contacts:
        connections, size = self._sides(), len(self.rates)
        rows, gains = (np.zeros((len(connections), size), complex) for _ in range(2))
        spans, mobility = np.zeros((len(connections), 2), np.int64), np.zeros(len(connections))
        for c, sides in enumerate(connections):
            spans[c] = self.spans[sides[0][0]][0], self.spans[sides[-1][0]][1]
            for body, row, sign in sides:
                frame, one, span = self.frames[body], self.poles[body], slice(*self.spans[body])
                pushed = np.linalg.solve(frame.mass, row)
                rows[c, span] += sign * (one.output @ row)
                gains[c, span] -= sign * (one.from_velocity @ pushed)
                mobility[c] += float(row @ pushed)
        rate = rows * self.rates
        return Contacts(
            spans,
            _parts(rows),
            _parts(rate),
            _parts(gains),
            np.array(
                [*(max(one.gap_m, LEAST_GAP_M) for one in self.contacts), *(0.0 for _ in self.storeys)], float
            ),
            np.abs(rate),
            np.abs(rate) @ np.abs(np.concatenate([one.load for one in self.poles])),
            mobility,
            *_programs(self.contacts),
        )

    def _storeys(self, shaking: Shaking, table_rate: Real) -> Storeys | None:
        """Return the laws in storeys and the known forces at the start of a run."""
        if not self.storeys:
            return None
        first, laws, intervals = len(self.contacts), self._laws, len(shaking.starts)
        end_s = shaking.dt_s * (intervals - 1) + shaking.last_s
        gains = np.hypot(*np.moveaxis(self._loop_contacts.gain[first:], 1, 0))
        memory = np.zeros((5, len(laws), MEMORY))
        before, after = np.zeros((2, intervals, len(self._known)))
        for law, one in enumerate(laws):
            memory[0, law] = one.memory
        for force, pushed in enumerate(self._known):
            before[:, force], after[:, force] = _ends(np.asarray(pushed.force_n, np.float64), intervals)
        return Storeys(
            first,
            np.array([one.address for one in laws], np.int64),
            np.array([filled(tuple(one.parameters), end_s) for one in laws]).reshape(len(laws), NUMBERS),
            np.array([one.in_room for one in laws], np.float64),
            np.array([one.remembers for one in laws], np.bool_),
            np.ascontiguousarray(self._loop_contacts.weight @ gains.T),
            table_rate,
            before,
            after,
            memory,
            np.zeros((len(self.storeys), 6)),
            np.zeros(4),
            np.zeros((len(self._known), 2)),
            shaking.dt_s / shaking.parts,
        )

    def solve(
        self,
        acceleration: ArrayLike,
        step_s: float,
        *,
        duration_s: float | None = None,
        longest_s: float | None = None,
        tolerance: float = TOLERANCE,
        contact_level: int = -1,
        table_rate: ArrayLike | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Solution:
        """Shake the frames and return every step.

        Args:
            acceleration: Acceleration of the table (m,) [m/s^2], straight between samples, zero after the last.
            step_s: Sample step [s].
            duration_s: End of the run [s]; default: the last sample.
            longest_s: Longest step [s]; default: `longest_step`.
            tolerance: See `TOLERANCE`.
            contact_level: All steps in contact, and with laws in storeys all steps, are the longest over two to this power,
                without error control, for studies of convergence; -1 for the control.
            table_rate: Velocity of the table at the samples (m,) [m/s], for laws that act in the room; default: the
                acceleration's integral from rest.
            progress: Called now and then with the model time [s].

        Raises:
            ExperimentError: The motion grew without bound, or contacts stiffer or more damped than any step can follow.
            FrameError: An acceleration that is not finite.
        """
        samples = np.asarray(checked(acceleration, step_s), np.float64)
        shaking = self._shaking(samples, step_s, duration_s, longest_s, tolerance, contact_level)
        modes = self._modes(shaking)
        rate = _velocities(shaking) if table_rate is None else _lengthened(table_rate, len(shaking.starts))
        rows = self._run(shaking, modes, self._storeys(shaking, rate), progress)
        grid = step_s * np.arange(len(samples))
        # Two events closer to each other than the clock can tell leave a step of no length.
        advanced = np.append(np.diff(rows[0]) > 0.0, True)
        times, states, all_forces = (of_step[advanced] for of_step in rows)
        forces, *storeys = np.split(all_forces, np.cumsum([len(self.contacts), len(self.storeys)]), axis=1)
        return Solution(times, states, forces, np.interp(times, grid, samples, right=0.0), *storeys)

    def _run(
        self,
        shaking: Shaking,
        modes: Modes,
        storeys: Storeys | None,
        progress: Callable[[float], None] | None,
    ) -> tuple[Real, Real, Real]:
        """Return times, states and forces of all steps: chunk after chunk into rows that grow when they are full."""
        state = self._rest(shaking, storeys)
        expected = len(shaking.starts) * shaking.parts
        begins = np.concatenate([state.force[:, 0], np.zeros(len(self.storeys))])
        rows = _Rows(expected + expected // 8 + CHUNK, len(self.rates), begins)
        ended, filled = loop.FULL, 1
        while ended == loop.FULL:
            rows.make_room(filled + CHUNK)
            part = slice(filled - 1, filled + CHUNK - 1)
            ended, gone = loop.advance(
                shaking,
                modes,
                self._loop_contacts,
                storeys,
                state,
                rows.times[part],
                rows.states[part],
                rows.forces[part],
            )
            last, now = rows.times[filled - 1], float(rows.times[filled + gone - 2])
            self._check(rows.times[filled : filled + gone - 1], rows.states[filled : filled + gone - 1])
            if ended == loop.STUCK or (ended == loop.FULL and now - last < STUCK_S):
                jumps = "a law in a storey may jump, which exudyn can run; else " if self.storeys else ""
                raise ExperimentError(
                    f"the run was stopped at {now:.4f} s: {gone - 1} steps have covered {now - last:.1g} s only; "
                    f"{jumps}lower the contact's stiffness or damping, or loosen the relative tolerance"
                )
            filled += gone - 1
            if progress is not None:
                progress(now)
        return rows.times[:filled], rows.states[:filled], rows.forces[:filled]

    def _check(self, times: Real, states: Real) -> None:
        """Stop a run that has moved by more than its frames are high; of all rows some tell soon enough."""
        for frame, one, span in zip(self.frames, self.poles, self.spans, strict=True):
            floors, inside = one.output[:, frame.floor_x], states[:, :, slice(*span)]
            if unbounded(frame, _moved(inside[::-LOOK_EVERY], floors).max(axis=0, initial=0.0)):
                stop_if_unbounded(frame, times, _moved(inside, floors))

    def _shaking(
        self,
        samples: Real,
        step_s: float,
        duration_s: float | None,
        longest_s: float | None,
        tolerance: float,
        contact_level: int,
    ) -> Shaking:
        end_s = end_of_run((len(samples) - 1) * step_s, duration_s)
        intervals = max(1, math.ceil(end_s / step_s - 1e-9))
        starts, ends = _ends(samples, intervals)
        parts = max(1, math.ceil(step_s / (longest_s or longest_step(self.frames)) - 1e-9))
        finest = 2.0 * np.pi / np.abs(self.rates).max() / FINEST_A_PERIOD
        fine = max(0, math.ceil(math.log2(step_s / parts / finest)))
        strongest = float(np.abs(samples).max())
        last_s = end_s - (intervals - 1) * step_s
        return Shaking(
            starts,
            ends,
            float(step_s),
            float(last_s),
            strongest,
            parts,
            fine,
            float(tolerance),
            contact_level,
        )

    def _modes(self, shaking: Shaking) -> Modes:
        levels = max(shaking.fine + DEEPER, shaking.forced_level) + 2
        tables, pushed = np.empty((levels, 8, len(self.rates))), np.empty((levels, 4, len(self.rates)))
        for level in range(levels):
            step = shaking.dt_s / shaking.parts / 2.0**level
            loop.fill(self.rates, step, tables[level])
            loop.push(tables[level], self._load, step, pushed[level])
        return Modes(self.rates, self._load, tables, pushed)

    def _rest(self, shaking: Shaking, storeys: Storeys | None) -> State:
        count, first = len(self._loop_contacts.gap), len(self.contacts)
        force = np.zeros((count, 3))
        if storeys is not None:
            for law, address in enumerate(storeys.address):
                rate = float(storeys.in_room[law] * storeys.table_rate[0])
                numbers, memory = storeys.parameters[law], storeys.memory[0, law]
                force[first + law] = called(address, numbers, memory, 0.0, rate, 0.0, np.zeros(MEMORY))
            if self._known:
                force[first + len(self._laws) :] = -storeys.before[0][:, None]
        return State(
            np.array([0, 0, max(shaking.forced_level, 0)]), np.zeros(1), np.arange(count) >= first,
            np.zeros(count), np.zeros(count), np.full(count, -1.0), force,
        )  # fmt: skip

    def coordinates(self, solution: Solution, index: int, chosen: ArrayLike) -> tuple[Real, Real]:
        """Return displacements (m, k) [m] and velocities (m, k) [m/s] of some coordinates or places of a frame.

        Args:
            solution: What `solve` returned.
            index: Number of the frame, from 0.
            chosen: Coordinates (k,), or rows that combine coordinates (k, n).
        """
        one, states = self.poles[index], solution.states[:, :, slice(*self.spans[index])]
        output = select(one.output, chosen)
        both = np.hstack([output, one.rates[:, None] * output])
        moved = states[:, 0] @ both.real - states[:, 1] @ both.imag
        value, rate = np.split(moved, 2, axis=1)
        return value, rate

    def deformations(self, solution: Solution) -> Real:
        """Return how far the sides of each contact overlap at the steps (m, c) [m]; negative while apart.

        Args:
            solution: What `solve` returned.
        """
        count = len(self.contacts)
        row = self._loop_contacts.row[:count]
        moved = solution.states[:, 0] @ row[:, 0].T - solution.states[:, 1] @ row[:, 1].T
        return np.asarray(moved - self._loop_contacts.gap[:count])

    def motion(self, solution: Solution, cost_s: tuple[float, float]) -> Motion:
        """Return a solution as the frames' motions and the contacts' histories.

        Args:
            solution: What `solve` returned.
            cost_s: Wall and processor time that it took [s].
        """
        motions = tuple(self.frame_motion(index, solution) for index in range(len(self.frames)))
        histories = tuple(history_of(self.frames, motions, contact) for contact in self.contacts)
        storeys = tuple(
            storey_history(self.frames, motions, *each)
            for each in zip(self.storeys, solution.storey_forces.T, solution.storey_middles.T, strict=True)
        )
        energy = balance(motions, histories, storeys)
        return Motion(motions, histories, energy, *cost_s, len(solution.time_s) - 1, "exact", storeys)

    def frame_motion(self, index: int, solution: Solution) -> FrameMotion:
        """Return the motion of one frame, without histories and energies.

        Args:
            index: Number of the frame, from 0.
            solution: What `solve` returned.
        """
        frame, one, span = self.frames[index], self.poles[index], self.spans[index]
        states = solution.states[:, :, slice(*span)]
        rates = one.rates[:, None]
        output = np.hstack([one.output, rates * one.output, rates**2 * one.output])
        all_three = states[:, 0] @ output.real
        all_three -= states[:, 1] @ output.imag
        u, v, a = np.split(all_three, 3, axis=1)
        stop_if_unbounded(frame, solution.time_s, np.abs(u[:, frame.floor_x]))
        # What acts at once: the table on all coordinates, the connections' forces on those of their floors.
        connections = self._sides()
        pushed = np.zeros((1 + len(connections), len(frame.mass)))
        pushed[0] = ((rates * one.output).T @ one.load).real
        for c, sides in enumerate(connections):
            for body, row, sign in sides:
                if body == index:
                    pushed[1 + c] -= sign * np.linalg.solve(frame.mass, row)
        forces = np.column_stack([solution.acceleration, solution.forces, solution.storey_forces])
        a += forces @ pushed
        return FrameMotion(frame, solution.time_s, u, v, a, solution.acceleration)


def run_exact(
    frames: Sequence[ReducedFrame],
    contacts: Sequence[Contact | Within],
    acceleration: ArrayLike,
    step_s: float,
    *,
    storeys: Sequence[StoreyLaw | KnownForce] = (),
    **options: Any,
) -> Motion:
    """Return the motion of frames in a row, with contacts, on a table; options as for `ExactRig.solve`.

    Args:
        frames: Reduced frames, from left to right.
        contacts: Contacts between neighbours.
        acceleration: Acceleration of the table (m,) [m/s^2].
        step_s: Sample step [s].
        storeys: Laws in storeys and known forces beside those that the frames state.
        options: Those of `ExactRig.solve`.
    """
    rig = ExactRig(frames, contacts, storeys)
    started, worked = time.perf_counter(), time.thread_time()
    solution = rig.solve(acceleration, step_s, **options)
    return rig.motion(solution, (time.perf_counter() - started, time.thread_time() - worked))


def longest_step(frames: Sequence[ReducedFrame]) -> float:
    """Return the longest step [s] that shows the frames' motion: `STEPS_A_PERIOD` of the fastest mode that counts."""
    fastest = 0.0
    for frame in frames:
        sway = (frame.shapes.T @ frame.mass @ frame.influence / frame.frequencies_hz) ** 2
        fastest = max(fastest, float(frame.frequencies_hz[sway >= COUNTS * sway.sum()].max()))
    return 1.0 / (STEPS_A_PERIOD * fastest)


def _moved(states: Real, floors: Any) -> Real:
    """Return how far floors have moved in some rows [m], (rows, floors), from their shares in the states of a frame."""
    return np.asarray(np.abs(states[:, 0] @ floors.real - states[:, 1] @ floors.imag))


def _ends(samples: Real, intervals: int) -> tuple[Real, Real]:
    """Return a series at the start and the end of so many intervals (intervals,); nothing after its last sample."""
    padded = np.zeros(intervals + 1)
    kept = min(len(padded), len(samples))
    padded[:kept] = samples[:kept]
    starts, ends = padded[:-1].copy(), padded[1:].copy()
    starts[len(samples) - 1 :] = 0.0
    return starts, ends


def _velocities(shaking: Shaking) -> Real:
    """Return the table's velocity at the intervals' ends (m + 1,) [m/s]: its acceleration is straight in each."""
    gained = 0.5 * shaking.dt_s * (shaking.starts + shaking.ends)
    return np.concatenate([[0.0], np.cumsum(gained)])


def _lengthened(series: ArrayLike, intervals: int) -> Real:
    """Return a series at so many intervals' ends (intervals + 1,), constant after its last sample."""
    samples = np.asarray(series, np.float64)
    return samples[np.minimum(np.arange(intervals + 1), len(samples) - 1)]


def _parts(values: Any) -> Real:
    """Return complex values (..., p) as real and imaginary parts (..., 2, p)."""
    return np.ascontiguousarray(np.stack([values.real, values.imag], axis=-2))


def _programs(contacts: Sequence[Contact | Within]) -> tuple[Any, Any, Any, Any]:
    """Return the laws' instructions one after the other, where each begins, results and registers."""
    programs = [recorded(contact.law) for contact in contacts]
    first = np.cumsum([0, *(len(one.instructions) for one in programs)])
    code = np.concatenate([np.zeros((0, 5), np.int64), *(one.instructions for one in programs)])
    width = max((len(one.registers) for one in programs), default=0)
    registers = np.zeros((len(programs), width))
    for row, one in zip(registers, programs, strict=True):
        row[: len(one.registers)] = one.registers
    return code, first, np.array([one.result for one in programs], np.int64), registers
