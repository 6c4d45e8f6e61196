"""The laws that a frame's file states, as laws of the rig: storeys that yield, and every `[[storey_law]]`.

`STATED` says for each kind of a frame file which force it is, and which keyword becomes which parameter of it. It is read
in both directions: the diagnosis writes a law that it has found into a frame file by it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig import storey_forces as forces
from pounding.experiments.rig.drifts import storey_drift, storey_row
from pounding.experiments.rig.laws import Law, along, filled
from pounding.experiments.rig.motion import FrameMotion, StoreyHistory
from pounding.experiments.rig.storeys import StoreyLaw, history_of
from pounding.experiments.rig.yielding import yielding_laws
from pounding.frames import storey_laws as stated
from pounding.frames.storey_laws import StatedLaw

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


class Key(NamedTuple):
    """A keyword of a frame file that becomes a parameter: its value times a factor, less a number.

    Attributes:
        name: The keyword.
        factor: Unit of the keyword in SI.
        less: What the parameter is less than that.
    """

    name: str
    factor: float = 1.0
    less: float = 0.0


class Kind(NamedTuple):
    """A force, and the keywords that become its parameters, in their order."""

    law: Law
    keys: tuple[Key, ...]


STATED: dict[type[StatedLaw], Kind] = {
    stated.Friction: Kind(
        forces.friction,
        (
            Key("force_n"),
            Key("sticking_stiffness_n_per_m"),
            Key("sticking_damping_n_s_per_m"),
            Key("half_worn_m_per_s"),
            Key("breakaway_share"),
        ),
    ),
    stated.DahlFriction: Kind(forces.bristles, (Key("force_n"), Key("build_up_mm", 1e-3))),
    stated.Damper: Kind(forces.damper, (Key("damping_n_s_per_m"), Key("power", less=1.0), Key("at_m_per_s"))),
    stated.QuadraticDamper: Kind(forces.quadratic_damper, (Key("damping_n_s2_per_m2"),)),
    stated.Cubic: Kind(forces.cubic_spring, (Key("stiffness_n_per_m3"),)),
    stated.Hysteresis: Kind(
        forces.yielding,
        (Key("yield_force_n"), Key("stiffness_n_per_m"), Key("sharpness"), Key("unloading")),
    ),
    stated.Loosening: Kind(forces.growing_spring, (Key("stiffness_change_n_per_m"), Key("whole_at_s"))),
    stated.Bumper: Kind(
        forces.stop,
        (
            Key("gap_mm", 1e-3),
            Key("stiffness_n_per_m"),
            Key("loss_s_per_m"),
            Key("power", less=1.0),
            Key("dashpot"),
        ),
    ),
    stated.Drag: Kind(forces.drag, (Key("coefficient_n_s2_per_m2"), Key("power", less=2.0))),
}


def parameters(law: StatedLaw) -> tuple[float, ...]:
    """Return the parameters [SI] of a stated law's force; NaN stands for the end of the run."""
    return tuple(_parameter(getattr(law, key.name), key) for key in STATED[type(law)].keys)


def _parameter(value: float | None, key: Key) -> float:
    return float("nan") if value is None else value * key.factor - key.less


def statement(
    law: Law,
    numbers: Sequence[float],
    place: tuple[str, int],
    in_room: float = 0.0,
    shares: tuple[float, ...] | None = None,
) -> StatedLaw | None:
    """Return a law as a frame file states it, the inverse of `parameters`; None for a force that none can state.

    Args:
        law: The law.
        numbers: Its parameters in SI; those left out are nothing.
        place: ``storey`` or ``floor``, and its number from 1.
        in_room: Share of the table's rate in the rate that it sees.
        shares: What each storey's drift contributes to the deformation that it sees; None: its own storey's alone.
    """
    for kind, (force, keys) in STATED.items():
        if force is not law:
            continue
        given = dict(zip(keys, numbers, strict=False))
        fields: dict[str, Any] = {
            key.name: None if np.isnan(number) else (number + key.less) / key.factor
            for key, number in given.items()
        }
        at, fields[place[0]] = place
        if kind is stated.Drag:
            fields["air_at_rest"] = in_room
        elif in_room:
            return None
        if shares is not None:
            if "drift_shares" not in kind.__struct_fields__:
                return None
            fields["drift_shares"] = shares
        return kind(**fields) if at in kind.__struct_fields__ else None
    return None


def frame_laws(frames: Sequence[ReducedFrame]) -> list[StoreyLaw]:
    """Return the laws of frames that yield or whose files state laws.

    Args:
        frames: Reduced frames, from left to right.
    """
    found = yielding_laws(frames)
    for body, frame in enumerate(frames):
        found += [_on_the_rig(law, frame, body) for law in frame.definition.storey_law]
    return found


def _on_the_rig(law: StatedLaw, frame: ReducedFrame, body: int) -> StoreyLaw:
    force = STATED[type(law)].law
    in_room = law.air_at_rest if isinstance(law, stated.Drag) else 0.0
    return StoreyLaw(
        force.address,
        _row(law, frame),
        _padded(parameters(law)),
        body,
        in_room=in_room,
        remembers=force.remembers,
    )


def _row(law: StatedLaw, frame: ReducedFrame) -> NDArray[np.float64]:
    """Return what the floors' displacements contribute to what a law sees of the motion (storeys,)."""
    if isinstance(law, stated.Drag):
        return np.asarray(np.eye(frame.storeys)[law.floor - 1])
    if isinstance(law, stated.Loosening) and law.drift_shares is not None:
        rows = [storey_row(frame, storey) for storey in range(1, 1 + frame.storeys)]
        return np.asarray(law.drift_shares, float) @ np.array(rows)
    return storey_row(frame, law.storey)


def _padded(numbers: tuple[float, ...]) -> NDArray[np.float64]:
    return filled(numbers, float("nan"))


def until(laws: Sequence[StoreyLaw], end_s: float) -> list[StoreyLaw]:
    """Return laws for a run that ends at a time [s], which is what NaN among their parameters stands for."""
    return [dataclasses.replace(one, parameters=filled(tuple(one.parameters), end_s)) for one in laws]


def table_rate(acceleration: Real, step_s: float) -> Callable[[float], float]:
    """Return the table's velocity [m/s] as a function of time [s]: its acceleration is straight between samples.

    Args:
        acceleration: Acceleration of the table (m,) [m/s^2]; nothing before the first and after the last sample.
        step_s: Its sample step [s].
    """
    gained = np.concatenate([[0.0], np.cumsum(0.5 * step_s * (acceleration[:-1] + acceleration[1:]))])
    # Plain floats: indexing an array costs more than the whole interpolation.
    rates, samples, last = gained.tolist(), np.asarray(acceleration, float).tolist(), len(acceleration) - 1

    def rate(t: float) -> float:
        index = min(int(t / step_s), last)
        if index == last:
            return float(rates[last])
        since = t - index * step_s
        bend = (samples[index + 1] - samples[index]) / step_s
        return float(rates[index] + since * (samples[index] + 0.5 * bend * since))

    return rate


def histories(
    frames: Sequence[ReducedFrame],
    motions: Sequence[FrameMotion],
    laws: Sequence[StoreyLaw],
    rate: Callable[[float], float],
) -> tuple[StoreyHistory, ...]:
    """Return what laws did in a run that did not keep it.

    Args:
        frames: Reduced frames, from left to right.
        motions: What they did.
        laws: Their laws, as `until` gives them.
        rate: Velocity of the table [m/s] at a time [s].
    """
    return tuple(_history(frames, motions, law, rate) for law in laws)


def _history(
    frames: Sequence[ReducedFrame],
    motions: Sequence[FrameMotion],
    law: StoreyLaw,
    rate: Callable[[float], float],
) -> StoreyHistory:
    motion = motions[law.body]
    drift, speed = storey_drift(motion, law.row)
    step = np.diff(motion.time_s)
    middle = 0.5 * (drift[:-1] + drift[1:]) + 0.125 * step * (speed[:-1] - speed[1:])
    between = 1.5 * np.diff(drift) / step - 0.25 * (speed[:-1] + speed[1:])
    after = np.arange(1, len(drift))
    times = np.insert(motion.time_s, after, motion.time_s[:-1] + 0.5 * step)
    seen = np.insert(speed, after, between)
    if law.in_room:
        seen = seen + law.in_room * np.array([rate(float(t)) for t in times])
    force = along(law.address, law.parameters, np.insert(drift, after, middle), seen, times)
    return history_of(frames, motions, law, force[::2], np.concatenate([[0.0], force[1::2]]))


def refuse_laws(frames: Sequence[ReducedFrame]) -> None:
    """Refuse frames with laws in storeys, for what holds of linear frames alone.

    Args:
        frames: The frames.

    Raises:
        ExperimentError: A frame yields, or has other laws in its storeys.
    """
    for frame in frames:
        definition = frame.definition
        key = "yielding" if definition.yielding is not None else "storey_law" if definition.storey_law else ""
        if key:
            raise ExperimentError(
                f"{frame.name} is not linear, and this holds for linear buildings alone; take '{key}' out of its file, and "
                "look with `pounding pound` what it changes"
            )
