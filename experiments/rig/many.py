"""Many pounding runs at once by the exact solver: threads on all cores that share frames and records without copying.

The compiled loop lets go of Python's lock, so that threads run side by side. Of each run only a few numbers are kept,
read from the rows of the loop itself, for a run of the whole motion would cost more to keep than to compute.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.cores import cores
from pounding.experiments.rig.contacts import Contact, check
from pounding.experiments.rig.exact import ExactRig, Solution
from pounding.experiments.rig.exact_peaks import largest

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating]


class Case(NamedTuple):
    """A run that is asked for.

    Attributes:
        frames: Reduced frames, from left to right.
        contacts: Contacts between neighbours.
        acceleration: Acceleration of the table (m,) [m/s^2].
        step_s: Its sample step [s].
    """

    frames: Sequence[ReducedFrame]
    contacts: Sequence[Contact]
    acceleration: ArrayLike
    step_s: float

    def __repr__(self) -> str:
        names = " beside ".join(repr(frame.name) for frame in self.frames)
        samples = len(np.asarray(self.acceleration))
        return f"Case({names}, contacts: {len(self.contacts)}, {samples} samples at {self.step_s:.4g} s)"


@dataclass(frozen=True, eq=False)
class Outcome:
    """What is kept of a run.

    Attributes:
        displacement_m: Largest displacement of each floor relative to the table (storeys,) [m], one array a frame.
        drift_m: Largest drift of each storey (storeys,) [m], one array a frame.
        peak_force_n: Largest force of each contact (c,) [N]; 0 where nothing touched.
        impulse_n_s: Impulse of each contact over the run (c,) [N s].
        touches: How often each contact closed (c,).
        first_touch_s: When each first closed (c,) [s]; NaN where it did not.
        closest_m: Smallest clearance of each contact (c,) [m]; negative where it touched: the deepest overlap.
        steps: Steps that the run took.
    """

    displacement_m: tuple[Real, ...]
    drift_m: tuple[Real, ...]
    peak_force_n: Real
    impulse_n_s: Real
    touches: NDArray[np.int64]
    first_touch_s: Real
    closest_m: Real
    steps: int

    def __repr__(self) -> str:
        forces = ", ".join(f"{force:.4g} N" for force in self.peak_force_n) or "no contact"
        return f"Outcome({len(self.displacement_m)} frames, {int(sum(self.touches))} touches, {forces}, {self.steps} steps)"


def many(
    cases: Iterable[Case], *, workers: int | None = None, progress: Callable[[int], None] | None = None
) -> Iterator[Outcome]:
    """Run cases on all cores and return their outcomes in order, as they become ready.

    Args:
        cases: The runs; taken as they are needed, so that they may be made one by one.
        workers: Threads; default: one a core.
        progress: Called with the number of runs that are done.

    Raises:
        ExperimentError: A contact that the frames cannot have, or a run that grows without bound.
        ContactError: A law that cannot be recorded.
    """
    threads = workers or cores()
    waiting: deque[Future[Outcome]] = deque()
    done = 0
    with ThreadPoolExecutor(threads) as pool:
        try:
            for case in cases:
                waiting.append(pool.submit(run_one, case))
                # Few wait: cases, rows and outcomes of thousands would fill the memory.
                while len(waiting) > 4 * threads:
                    yield waiting.popleft().result()
                    done += 1
                    if progress is not None:
                        progress(done)
            while waiting:
                yield waiting.popleft().result()
                done += 1
                if progress is not None:
                    progress(done)
        finally:
            for future in waiting:
                future.cancel()


def run_one(case: Case) -> Outcome:
    """Run one case.

    Args:
        case: The run.

    Raises:
        ExperimentError, ContactError: As `many`.
    """
    for contact in case.contacts:
        check(contact, case.frames)
    rig = ExactRig(case.frames, case.contacts)
    return outcome(rig, rig.solve(case.acceleration, case.step_s))


def outcome(rig: ExactRig, solution: Solution) -> Outcome:
    """Return what is kept of a run.

    Args:
        rig: The rig.
        solution: What it left.
    """
    displacement, drift = [], []
    for index, frame in enumerate(rig.frames):
        value, rate = rig.coordinates(solution, index, frame.floor_x)
        floors, storeys = np.zeros((2, frame.storeys))
        largest(solution.time_s, value, rate, floors, storeys)
        displacement.append(floors)
        drift.append(storeys)
    overlap = rig.deformations(solution)
    begins = (overlap[1:] > 0.0) & (overlap[:-1] <= 0.0)
    first = np.where(begins.any(axis=0), solution.time_s[1:][begins.argmax(axis=0)], np.nan)
    return Outcome(
        tuple(displacement),
        tuple(drift),
        np.array([_peak(solution.time_s, force) for force in solution.forces.T]),
        _impulse(solution.time_s, overlap, solution.forces),
        begins.sum(axis=0),
        first,
        -overlap.max(axis=0, initial=-np.inf),
        len(solution.time_s) - 1,
    )


TOUCHING_M = 1e-12
"""Overlap beyond the round-off of a located touch or parting [m]."""


def _impulse(time_s: Real, overlap: Real, force: Real) -> Real:
    """Return the impulses (c,) [N s]; a force that begins with a jump does not count in the step before it."""
    closed = (overlap[1:] > TOUCHING_M) | (overlap[:-1] > TOUCHING_M)
    parts = 0.5 * np.diff(time_s)[:, None] * (force[1:] + force[:-1])
    return np.asarray(np.where(closed, parts, 0.0).sum(axis=0))


def _peak(time_s: Real, force: Real) -> float:
    """Return the top of the parabola through the largest force and its neighbours [N]."""
    place = int(force.argmax())
    if not 0 < place < len(force) - 1 or force[place - 1] <= 0.0 or force[place + 1] <= 0.0:
        return float(force[place])
    (t0, t1, t2), (f0, f1, f2) = time_s[place - 1 : place + 2], force[place - 1 : place + 2]
    rise, fall = (f1 - f0) / (t1 - t0), (f2 - f1) / (t2 - t1)
    bend = (fall - rise) / (t2 - t0)
    if bend >= 0.0:
        return float(f1)
    slope = rise + bend * (t1 - t0)
    return float(f1 - 0.25 * slope**2 / bend)
