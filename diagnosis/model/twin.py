"""The diagnosed model on the exudyn rig: the same effects, as matrices, connectors, loads and inputs of the engine.

What the report calls 'after' is a run of this. The frames are the calibrated storeys; laws are connectors between
floors, whose force is the compiled function that the prediction has too. What a law remembers advances before each step
of the engine, so that a step that is taken back leaves no trace.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from exudyn import itemInterface as items
from scipy.interpolate import CubicSpline
from scipy.linalg import eigh

from pounding import frames
from pounding.contact.connector import ContactConnector
from pounding.contact.laws import Law as ContactLaw
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.forked import forked
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.predictor import TABLE_VELOCITY
from pounding.diagnosis.model.tilt import tilt_series
from pounding.diagnosis.model.twin_channels import channels
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.contacts import Within
from pounding.experiments.rig.exact import ExactRig
from pounding.experiments.rig.law_connector import LawConnector, Series, partly, resting
from pounding.experiments.rig.laws import filled
from pounding.experiments.rig.motion import FrameMotion
from pounding.experiments.rig.rig import COLLIDING, Rig
from pounding.experiments.rig.storeys import KnownForce, StoreyLaw

FINER, FINEST_S = 4, 2.5e-4
"""The table's samples are interpolated smoothly to at least so many steps, and to steps of at most this [s], because the rig
connects samples by lines: on a grid of a millisecond impacts put the motion up to half a per cent off."""
FORCE_HZ = 5e4
"""Rate at which a contact's force is taken before it is averaged over the logger's samples."""


@dataclass(frozen=True)
class Between:
    """A contact: its left and right floor among all, its law, its gap [m]."""

    left: int
    right: int
    law: ContactLaw
    gap_m: float


def simulate_engine(
    model: Model,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    runs: Sequence[int],
    seen: Mapping[int, Callable[[FrameMotion], None]] | None = None,
) -> list[np.ndarray]:
    """Return the channels (samples, channels) in SI of each run as the exudyn rig gives them.

    Args:
        model: The baseline model.
        values: Its nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        runs: Numbers of the runs.
        seen: What is called with the motion of all frames in a run, as one body, by the number of the run. The body's first
            coordinates are the floors' displacements relative to the table, frame by frame.

    Raises:
        CaseError: The engine did not get through a run.
    """
    systems = dict(zip(runs, model.systems(values, effects, runs), strict=True))
    asked = seen or {}

    def shaken(run: int) -> tuple[np.ndarray, FrameMotion | None]:
        assembly, _ = systems[run]
        motion = _shaken(model, assembly, run, values, effects)
        # The motions of all long runs would fill the memory.
        return channels(model, assembly, run, motion, values, effects), motion if run in asked else None

    outputs = []
    for run, (series, motion) in zip(runs, forked(shaken, runs, at_once=model.is_light(runs)), strict=True):
        outputs.append(series)
        if motion is not None:
            asked[run](motion)
    return outputs


def simulate_pair(
    model: Model,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    number: int,
    between: Between,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the channels (samples, channels) in SI of a run in which two floors may touch, and the force (samples,) [N].

    Accelerations and force are means over a sample, as a logger's filter makes them: an impact is shorter. The exact
    solver runs it with the laws in storeys; exudyn does where a law is such that the exact solver finds no step, as one
    that jumps with the rate.

    Args:
        model: The baseline model, without contact forces.
        values: Its nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        number: Number of the run.
        between: The contact.

    Raises:
        CaseError: The engine did not get through the run.
    """
    assembly = model.assemble(values, effects)
    run = model.observed.runs[number]
    motion = _shaken(model, assembly, number, values, effects, between)
    shown = channels(model, assembly, number, motion, values, effects, run.step_s)
    return shown, _mean_force(motion, between, len(run.table), run.step_s)


def _mean_force(motion: FrameMotion, between: Between, samples: int, step_s: float) -> np.ndarray:
    """Return the contact's mean force [N] over each sample, shape (samples,)."""
    apart = [
        series[:, between.left] - series[:, between.right]
        for series in (motion.displacement_m, motion.velocity_m_s, motion.acceleration_m_s2)
    ]
    history = ContactHistory(
        0, "left", "right", between.gap_m, 0.0, between.law,
        motion.time_s, apart[0] - between.gap_m, apart[1], apart[2],
    )  # fmt: skip
    finer = max(1, round(step_s * FORCE_HZ))
    offsets = ((np.arange(finer) + 0.5) / finer - 0.5) * step_s
    at = np.arange(samples)[:, None] * step_s + offsets
    forces = history.at(np.clip(at.ravel(), 0.0, motion.time_s[-1]))[2]
    return np.asarray(forces.reshape(samples, finer).mean(axis=1))


def reduced_frame(model: Model, assembly: Assembly) -> frames.ReducedFrame:
    """Return all frames of an assembly as one reduced frame on the table (they share nothing but the table)."""
    modes = model.modes(assembly)
    mass, stiffness, damping, influence = model.matrices(assembly)
    squares, shapes = eigh(stiffness, mass)
    floors = model.structure.floors
    height = np.concatenate([frame.height_m for frame in model.structure.frames])
    definition = frames.StickFrame(
        name="diagnosed",
        storeys=floors,
        storey_height_m=[0.1] * floors,
        floor_mass_kg=[float(m) for m in np.maximum(assembly.mass.sum(axis=1), 1e-3)],
        damping_ratio=float(modes.ratio[0]),
        storey_stiffness_n_per_m=[1.0] * floors,
    )
    return frames.ReducedFrame(
        name="diagnosed",
        storeys=floors,
        heights_m=height,
        plan_m=(0.4, 0.4),
        definition=definition,
        options={},
        mass=mass,
        stiffness=stiffness,
        damping=damping,
        influence=influence,
        floor_x=np.arange(floors),
        floor_rz=np.arange(0),
        frequencies_hz=np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
        shapes=shapes,
        damping_ratios=np.full(len(mass), float(modes.ratio[0])),
        moving_mass_kg=float(assembly.mass.sum()),
        basis=np.eye(len(mass)),
    )


def table_of(model: Model, assembly: Assembly, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how the table moves in a run, with its gain, delay and clock: times (m,) [s] and acceleration (m,) [m/s^2].

    Args:
        model: The baseline model.
        assembly: The assembly.
        number: Number of the run.
    """
    run = model.observed.runs[number]
    finer = max(FINER, int(np.ceil(run.step_s / FINEST_S - 1e-9)))
    at = np.arange(finer * (len(run.table) - 1) + 1) * (run.step_s / finer)
    return at, model.table_at(assembly, number, at)


def _shaken(
    model: Model,
    assembly: Assembly,
    number: int,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    between: Between | None = None,
) -> FrameMotion:
    """Return the motion of all frames as one body through a run."""
    run = model.observed.runs[number]
    at, table = table_of(model, assembly, number)
    step = float(at[1])
    reduced = reduced_frame(model, assembly)
    # The table's velocity is the prediction's, which forgets what is slow; a law may act on it.
    moved = model.predict(values, None, effects, [number]).before[0]
    rate = CubicSpline(np.arange(len(moved)) * run.step_s, moved[:, TABLE_VELOCITY])(at)
    loads = _known_forces(model, assembly, number, at)
    if between is not None:
        with contextlib.suppress(ExperimentError):
            return _exact(reduced, between, assembly.laws, loads, table, rate, step)
    additions: list[Any] = [
        _Addition(assembly.laws, float(at[-1]), _between_samples(rate, step), loads, step)
    ]
    if between is not None:
        additions.append(partial(_touching, between))
    accuracy = None if between is None else COLLIDING
    try:
        return Rig([reduced], additions=additions).run(table, step, accuracy=accuracy).frames[0]
    except ExperimentError as error:
        what = "effect" if between is None else "contact"
        raise CaseError(
            f"{run.name}: the exudyn model with the {what} in it did not finish: {error}"
        ) from error


def _exact(
    reduced: frames.ReducedFrame,
    between: Between,
    laws: Sequence[PlacedLaw],
    loads: np.ndarray | None,
    table: np.ndarray,
    rate: np.ndarray,
    step_s: float,
) -> FrameMotion:
    """Return the motion of all frames as one body by the exact solver.

    Args:
        reduced: The body.
        between: The contact.
        laws: The laws in storeys.
        loads: Known forces on the floors [N], shape (samples, floors), or None.
        table, rate: Acceleration (samples,) [m/s^2] and velocity (samples,) [m/s] of the table.
        step_s: Step of their samples [s].

    Raises:
        ExperimentError: It did not get through the run.
    """
    contact = Within(between.law, between.gap_m, between.left + 1, between.right + 1)
    end_s = step_s * (len(table) - 1)
    storeys: list[StoreyLaw | KnownForce] = [_of_rig(one, end_s) for one in laws]
    if loads is not None:
        floors = np.eye(reduced.storeys)
        storeys += [
            KnownForce(row, force) for row, force in zip(floors, loads.T, strict=True) if np.any(force)
        ]
    rig = ExactRig([reduced], [contact], storeys)
    return rig.frame_motion(0, rig.solve(table, step_s, table_rate=rate))


def _of_rig(placed: PlacedLaw, end_s: float) -> StoreyLaw:
    """Return a law as the rig takes it, for a run that ends at a time [s]."""
    return StoreyLaw(
        placed.law.address,
        placed.row,
        filled(placed.parameters, end_s),
        in_room=placed.in_room,
        remembers=placed.law.remembers,
    )


def _touching(between: Between, rig: Any) -> ContactConnector:
    markers = [rig.bodies[0].marker(floor + 1) for floor in (between.left, between.right)]
    return ContactConnector(rig.mbs, between.law, between.gap_m, *markers)


def _known_forces(model: Model, assembly: Assembly, number: int, at: np.ndarray) -> np.ndarray | None:
    """Return known forces on the floors, (samples, floors) [N], or None: measured contacts and the table's pitch."""
    run = model.observed.runs[number]
    times = np.arange(len(run.table)) * run.step_s
    forces = np.zeros((len(at), model.structure.floors))
    for column, (left, right) in enumerate(model.observed.contact_floors):
        pushed = model.contact_force(assembly, number, column, at)
        forces[:, left] -= pushed
        forces[:, right] += pushed
    if assembly.table_tilt:
        identity = model.plain_modes(assembly)
        pitch, pitching, inertia, weight, _ = tilt_series(model, identity, run)
        # Modal directions back to floors.
        back = np.linalg.inv(identity.floors).T
        pushed = np.interp(at, times, pitch)[:, None] * (back @ weight)
        pushed -= np.interp(at, times, pitching)[:, None] * (back @ inertia)
        forces += assembly.table_tilt * pushed
    return forces if np.any(forces) else None


def _between_samples(samples: np.ndarray, step_s: float) -> Series:
    """Return samples as a function of time, straight between them and constant after the last."""
    # Plain floats: indexing an array costs more than the whole interpolation.
    series, per_step, last = samples.tolist(), 1 / step_s, len(samples) - 1

    def at(t: float) -> float:
        place = min(t * per_step, float(last))
        index = min(int(place), last - 1)
        return float(series[index] + (series[index + 1] - series[index]) * (place - index))

    return at


class _Addition:
    """Puts laws and known forces on the rig's one body; called by the rig with the assembled items.

    Args:
        laws: The laws.
        end_s: End of the run [s].
        table_rate: Velocity of the table [m/s].
        loads: Known forces on the floors [N], shape (samples, floors), or None.
        step_s: Step of their samples [s].
    """

    def __init__(
        self,
        laws: Sequence[PlacedLaw],
        end_s: float,
        table_rate: Series,
        loads: np.ndarray | None,
        step_s: float,
    ) -> None:
        self._laws, self._end_s, self._table_rate = laws, end_s, table_rate
        self._loads, self._step_s = loads, step_s

    def __call__(self, rig: Any) -> _Addition:
        mbs, body = rig.mbs, rig.bodies[0]
        ground = resting(mbs)
        self._connectors = [
            LawConnector(mbs, body, ground, _of_rig(one, self._end_s), partly(self._table_rate, one.in_room))
            for one in self._laws
        ]
        # The engine keeps no reference to what it calls.
        self._kept = [self._load(mbs, body, floor, loads) for floor, loads in self._loaded()]
        return self

    def latch(self, mbs: Any) -> None:
        """Let the laws remember; called before each step."""
        for connector in self._connectors:
            connector.latch(mbs)

    def _loaded(self) -> list[tuple[int, np.ndarray]]:
        """Return the floors on which known forces act, with these [N], each (samples,)."""
        if self._loads is None:
            return []
        floors = np.flatnonzero(np.any(self._loads != 0, axis=0))
        return [(int(floor), self._loads[:, floor]) for floor in floors]

    def _load(self, mbs: Any, body: Any, floor: int, loads: np.ndarray) -> Any:
        at = _between_samples(loads, self._step_s)

        def load(_mbs: Any, t: float, _load: float) -> float:
            return at(t)

        marker = body.marker(floor + 1)
        mbs.AddLoad(items.LoadCoordinate(markerNumber=marker, load=1.0, loadUserFunction=load))
        return load
