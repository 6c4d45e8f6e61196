"""The diagnosed model on the exudyn rig: the same effects, as matrices, connectors, loads and inputs of the engine.

What the report calls 'after' is a run of this. The frames are the calibrated storeys; laws are connectors between
floors, those with a memory keep it as a first-order coordinate of the engine, so that its step control sees it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from scipy.interpolate import CubicSpline
from scipy.linalg import eigh

from pounding import frames
from pounding.contact.connector import ContactConnector
from pounding.contact.laws import Law as ContactLaw
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.calling import called
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.predictor import DRAG, FRICTION, HYSTERESIS, USER, law
from pounding.diagnosis.model.tilt import tilt_series
from pounding.diagnosis.model.twin_channels import channels
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.motion import ContactHistory, FrameMotion
from pounding.experiments.rig.rig import COLLIDING, Accuracy, Rig

FINER, FINEST_S = 4, 2.5e-4
"""The table's samples are interpolated smoothly to at least so many steps, and to steps of at most this [s], because the rig
connects samples by lines: on a grid of a millisecond impacts put the motion up to half a per cent off."""
ACCURACY = Accuracy(1e-6, 1e-8, 2.5e-4)
FORCE_HZ = 5e4
"""Rate at which a contact's force is taken before it is averaged over the logger's samples."""


@dataclass(frozen=True)
class Between:
    """A contact: its left and right floor among all, its law, its gap [m]."""

    left: int
    right: int
    law: ContactLaw
    gap_m: float


@dataclass(frozen=True)
class _Law:
    """A law of an assembly: kind, row of floors, SI parameters, floors it drags."""

    kind: int
    row: np.ndarray
    parameters: np.ndarray
    span: tuple[int, int]


def simulate_engine(
    model: Model,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    runs: Sequence[int],
) -> list[np.ndarray]:
    """Return the channels (samples, channels) in SI of each run as the exudyn rig gives them.

    Args:
        model: The baseline model.
        values: Its nuisance parameters.
        effects: Effects with their SI parameters.
        runs: Numbers of the runs.

    Raises:
        CaseError: The engine did not get through a run.
    """
    assembly = model.assemble(values, effects)
    found = []
    for number in runs:
        try:
            found.append(_run(model, assembly, number, values, effects))
        except ExperimentError as error:
            name = model.observed.runs[number].name
            raise CaseError(
                f"{name}: the exudyn model with the effect in it did not finish: {error}"
            ) from error
    return found


def simulate_touching(
    model: Model,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    number: int,
    between: Between,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the channels (samples, channels) in SI of a run in which two floors may touch, and the force (samples,) [N].

    Accelerations and force are means over a sample, as a logger's filter makes them: an impact is shorter.

    Args:
        model: The baseline model, without contact forces.
        values: Its nuisance parameters.
        effects: Effects with their SI parameters.
        number: Number of the run.
        between: The contact.

    Raises:
        CaseError: The engine did not get through the run.
    """
    assembly = model.assemble(values, effects)
    run = model.observed.runs[number]
    try:
        motion = _shaken(model, assembly, number, between)
    except ExperimentError as error:
        raise CaseError(
            f"{run.name}: the exudyn model with the contact in it did not finish: {error}"
        ) from error
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
    mass, stiffness = assembly.mass, assembly.stiffness
    plain = model.plain_modes(assembly)
    weighted = mass @ plain.floors
    damping = weighted @ np.diag(2 * plain.ratio * plain.omega) @ weighted.T
    for extend in assembly.extensions:
        mass, stiffness, damping = extend(mass, stiffness, damping)
    squares, shapes = eigh(stiffness, mass)
    floors = model.structure.floors
    influence = np.concatenate([np.ones(floors), assembly.influence])
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


def _run(
    model: Model,
    assembly: Assembly,
    number: int,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
) -> np.ndarray:
    motion = _shaken(model, assembly, number)
    return channels(model, assembly, number, motion, values, effects)


def _shaken(model: Model, assembly: Assembly, number: int, between: Between | None = None) -> FrameMotion:
    """Return the motion of all frames as one body through a run."""
    run = model.observed.runs[number]
    finer = max(FINER, int(np.ceil(run.step_s / FINEST_S - 1e-9)))
    step = run.step_s / finer
    at = np.arange(finer * (len(run.table) - 1) + 1) * step
    spline = CubicSpline(np.arange(len(run.table)) * run.step_s, run.table)
    table = (1 + assembly.table_gain) * spline(np.clip(at - assembly.table_delay_s, 0.0, at[-1]))
    reduced = reduced_frame(model, assembly)
    laws = [_Law(kind, row, _padded(numbers, at[-1]), span) for kind, row, numbers, span in assembly.laws]
    rate = np.concatenate([[0.0], np.cumsum((table[1:] + table[:-1]) / 2) * step])
    loads = _known_forces(model, assembly, number, at)
    additions: list[Any] = [_Addition(reduced, laws, rate.tolist(), 1 / step, loads)]
    if between is not None:
        additions.append(partial(_touching, between))
    accuracy = ACCURACY if between is None else COLLIDING
    return Rig([reduced], additions=additions).run(table, step, accuracy=accuracy).frames[0]


def _touching(between: Between, rig: Any) -> ContactConnector:
    markers = [rig.bodies[0].marker(floor + 1) for floor in (between.left, between.right)]
    return ContactConnector(rig.mbs, between.law, between.gap_m, *markers)


def _padded(numbers: Sequence[float], end: float) -> np.ndarray:
    filled = [end if np.isnan(number) else number for number in numbers]
    return np.array(filled + [0.0] * (5 - len(filled)))


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


class _Addition:
    """Puts laws and known forces on the rig's one body; called by the rig with the assembled items."""

    def __init__(
        self,
        reduced: frames.ReducedFrame,
        laws: Sequence[_Law],
        table_rate: list[float],
        per_step: float,
        loads: np.ndarray | None,
    ) -> None:
        self.reduced, self.laws = reduced, laws
        self.table_rate, self.per_step, self.loads = table_rate, per_step, loads

    def __call__(self, rig: Any) -> list[Any]:
        mbs, body = rig.mbs, rig.bodies[0]
        kept: list[Any] = []
        ground = mbs.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
        self.ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for one in self.laws:
            if one.kind == DRAG:
                kept += [self._drag(mbs, body, floor, one) for floor in range(*one.span)]
            elif one.kind in (FRICTION, HYSTERESIS):
                kept.append(self._with_memory(mbs, body, one))
            else:
                kept.append(self._plain(mbs, body, one))
        if self.loads is not None:
            kept += [
                self._load(mbs, body, int(floor)) for floor in np.flatnonzero(np.any(self.loads != 0, axis=0))
            ]
        return kept

    def _ends(self, body: Any, row: np.ndarray) -> tuple[int, int]:
        """Return the markers below and above a storey."""
        above, below = int(np.argmax(row)), np.flatnonzero(row < 0)
        lower = body.marker(int(below[0]) + 1) if len(below) else self.ground
        return lower, body.marker(above + 1)

    def _plain(self, mbs: Any, body: Any, one: _Law) -> Any:
        memory = np.zeros(4)

        def force(_mbs: Any, t: float, _item: int, d: float, v: float, *_: float) -> float:
            if one.kind == USER:
                return float(called(one.span[0], one.parameters, d, v, t))
            return float(law(one.kind, one.parameters, memory, d, v, t))

        return self._connector(mbs, self._ends(body, one.row), force)

    def _with_memory(self, mbs: Any, body: Any, one: _Law) -> Any:
        """Add an elastoplastic law; its elastic drift is a coordinate of the engine that stops at the yield drift."""
        limit, stiffness, third = (float(p) for p in one.parameters[:3])
        yield_drift = limit / stiffness
        # The third is a stuck joint's damping, or the sharpness of a yielding part's knee.
        damping, sharpness = (third, 0.0) if one.kind == FRICTION else (0.0, third)
        elastic = mbs.AddNode(
            items.NodeGenericODE1(
                referenceCoordinates=[0.0], initialCoordinates=[0.0], numberOfODE1Coordinates=1
            )
        )
        kind = exudyn.OutputVariableType
        above, below = int(np.argmax(one.row)), np.flatnonzero(one.row < 0)
        node = body.node

        def drift_rate(system: Any) -> float:
            rates = system.GetNodeOutput(node, kind.Coordinates_t)
            return float(rates[above] - (rates[below[0]] if len(below) else 0.0))

        def flow(system: Any, t: float, _item: int, z: Any) -> list[float]:
            v = drift_rate(system)
            if z[0] * v <= 0:
                return [v]
            share = min(abs(z[0]) / yield_drift, 1.0)
            return [v * (1.0 - share**sharpness)] if sharpness else [v if share < 1.0 else 0.0]

        memory = mbs.AddObject(items.ObjectGenericODE1(nodeNumbers=[elastic], rhsUserFunction=flow))

        def force(system: Any, t: float, _item: int, d: float, v: float, *_: float) -> float:
            z = float(np.atleast_1d(system.GetNodeOutput(elastic, kind.Coordinates))[0])
            held = min(max(stiffness * z, -limit), limit)
            if one.kind == FRICTION:
                return min(max(held + damping * v, -limit), limit)
            return held - stiffness * d

        return flow, memory, self._connector(mbs, self._ends(body, one.row), force)

    def _drag(self, mbs: Any, body: Any, floor: int, one: _Law) -> Any:
        rate, per_step, last = self.table_rate, self.per_step, len(self.table_rate) - 1
        coefficient = float(one.parameters[0])

        def force(_mbs: Any, t: float, _item: int, d: float, v: float, *_: float) -> float:
            index = min(int(t * per_step), last)
            w = v + rate[index]
            return coefficient * w * abs(w)

        return self._connector(mbs, (self.ground, body.marker(floor + 1)), force)

    def _load(self, mbs: Any, body: Any, floor: int) -> Any:
        assert self.loads is not None
        series, per_step = self.loads[:, floor].tolist(), self.per_step
        last = len(series) - 1

        def load(_mbs: Any, t: float, _load: float) -> float:
            place = min(t * per_step, float(last))
            index = min(int(place), last - 1)
            return series[index] + (series[index + 1] - series[index]) * (place - index)

        mbs.AddLoad(
            items.LoadCoordinate(markerNumber=body.marker(int(floor) + 1), load=1.0, loadUserFunction=load)
        )
        return load

    @staticmethod
    def _connector(mbs: Any, ends: tuple[int, int], force: Any) -> Any:
        item = mbs.AddObject(
            items.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=list(ends), stiffness=1.0, springForceUserFunction=force
            )
        )
        return force, item
