"""What is really on the table: frames, hidden laws and loads, faults of table and sensors; and its motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.contacts import Contact, Touch
from pounding.diagnosis.hidden.modes import Modes, joined, modes
from pounding.diagnosis.hidden.motions import Motion
from pounding.diagnosis.hidden.stepping import Law, Local, Response, integrate


@dataclass(frozen=True)
class Spring:
    """A law between two floors (0 is the table): it acts on floor `upper` of `frame` against `lower`.

    `absolute` stretches it against the room instead of against `lower`. Laws remember, so `make` gives a new
    one for each run of a length [s].
    """

    frame: str
    upper: int
    lower: int
    make: Callable[[float], Law]
    absolute: bool = False


@dataclass(frozen=True)
class Load:
    """A force [N] on a floor as a function of time [s]: `history(run, time) -> force`."""

    frame: str
    floor: int
    history: Callable[[int, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Scenario:
    """The whole truth of a case; the sensor faults are by channel name.

    Attributes:
        frames: Frames by name, in the case's order.
        springs: Local laws.
        touches: Contacts between the frames, those of the case first.
        loads: Forces that nobody measured.
        table_gain: What shook the frames over what the table channel says, minus 1.
        table_delay_s: How much later the frames were shaken than the channel says [s].
        table_clock: Relative change of the rate of the table channel's clock.
        table_tilt: Pitch of the table over its acceleration [rad s^2/m], top towards +x.
        sensor_gain: Fault of a channel: it reads (1 + x) times the truth.
        sensor_delay_s: Fault of a channel: it reads later by so much [s].
        sensor_clock: Fault of a channel: its clock runs at (1 + x) times the true rate, right when a run begins.
        sensor_offset: Fault of a channel: a constant beside the truth, in SI.
    """

    frames: Mapping[str, Beams]
    springs: tuple[Spring, ...] = ()
    touches: tuple[Touch, ...] = ()
    loads: tuple[Load, ...] = ()
    table_gain: float = 0.0
    table_delay_s: float = 0.0
    table_clock: float = 0.0
    table_tilt: float = 0.0
    sensor_gain: Mapping[str, float] = field(default_factory=dict)
    sensor_delay_s: Mapping[str, float] = field(default_factory=dict)
    sensor_clock: Mapping[str, float] = field(default_factory=dict)
    sensor_offset: Mapping[str, float] = field(default_factory=dict)

    def row(self, frame: str, floor: int) -> int:
        """Return the row of a floor among the floors of all frames."""
        before = 0
        for name, beams in self.frames.items():
            if name == frame:
                return before + floor - 1
            before += beams.storeys
        raise KeyError(frame)


@dataclass(frozen=True)
class Happened:
    """A run as it really was, on the fine grid of its motion.

    Attributes:
        motion: What the table channel says.
        table: Acceleration of the table as it shook the frames [m/s^2], shape (samples,).
        displacement: Of every floor relative to the table [m], shape (floors, samples).
        velocity: Of every floor relative to the table [m/s], shape (floors, samples).
        acceleration: Of every floor in the room [m/s^2], shape (floors, samples).
        contact_force: Of every contact, mean over the step before [N], shape (contacts, samples).
    """

    motion: Motion
    table: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    contact_force: np.ndarray


def happen(scenario: Scenario, motion: Motion, run: int) -> Happened:
    """Let a run happen.

    Args:
        scenario: What is on the table.
        motion: What the table channel says.
        run: Number of the run, for the loads.
    """
    whole = joined([modes(beams) for beams in scenario.frames.values()])
    step, count = motion.step_s, len(motion.acceleration)
    table, pitch, pitching = table_motion(scenario, motion)
    drive = -np.outer(whole.gamma, table - STANDARD_GRAVITY * pitch) - np.outer(whole.pitch, pitching)
    time = step * np.arange(count)
    for load in scenario.loads:
        drive += np.outer(whole.floors[scenario.row(load.frame, load.floor)], load.history(run, time))
    velocity = Motion(motion.source, step, table).velocity
    contacts = [_contact(scenario, touch, whole) for touch in scenario.touches]
    springs = [_local(scenario, spring, whole, velocity, time[-1]) for spring in scenario.springs]
    response = integrate(whole, drive, step, contacts + springs)
    return _floors(scenario, whole, response, motion, table, pitch, pitching)


def table_motion(scenario: Scenario, motion: Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how the table really moved: acceleration [m/s^2], pitch [rad] and its acceleration, (samples,) each.

    Args:
        scenario: What is on the table, with the table's faults.
        motion: What the table channel says.
    """
    step = motion.step_s
    said = at_rate(motion.acceleration, 1 + scenario.table_clock)
    table = (1 + scenario.table_gain) * shifted(said, scenario.table_delay_s / step)
    pitch = scenario.table_tilt * table
    return table, pitch, np.gradient(np.gradient(pitch, step), step)


def _local(
    scenario: Scenario, spring: Spring, whole: Modes, velocity: np.ndarray, duration_s: float
) -> Local:
    row = whole.floors[scenario.row(spring.frame, spring.upper)].copy()
    if spring.lower and not spring.absolute:
        row -= whole.floors[scenario.row(spring.frame, spring.lower)]
    return Local(spring.make(duration_s), row, velocity if spring.absolute else None)


def _contact(scenario: Scenario, touch: Touch, whole: Modes) -> Local:
    sides = [whole.floors[scenario.row(frame, touch.floor)] for frame in (touch.left, touch.right)]
    masses = [scenario.frames[frame].floor_mass[touch.floor - 1] for frame in (touch.left, touch.right)]
    return Local(Contact(touch, float(1 / sum(1 / mass for mass in masses))), sides[0] - sides[1])


def _floors(
    scenario: Scenario,
    whole: Modes,
    response: Response,
    motion: Motion,
    table: np.ndarray,
    pitch: np.ndarray,
    pitching: np.ndarray,
) -> Happened:
    height = np.concatenate([beams.heights_m for beams in scenario.frames.values()])
    rate = np.gradient(pitch, motion.step_s)
    return Happened(
        motion,
        table,
        whole.floors @ response.q + np.outer(height, pitch),
        whole.floors @ response.rate + np.outer(height, rate),
        whole.floors @ response.acceleration + table + np.outer(height, pitching),
        response.forces[: len(scenario.touches)],
    )


def shifted(values: np.ndarray, samples: float) -> np.ndarray:
    """Return a signal later by a number of samples that need not be whole (linear phase, zeros come in)."""
    if samples == 0:
        return values
    at = np.arange(len(values)) - samples
    return np.asarray(np.interp(at, np.arange(len(values)), values, left=0.0, right=values[-1]))


def at_rate(values: np.ndarray, rate: float) -> np.ndarray:
    """Return a signal that goes by at another rate from the same start on, shape (samples,); its last value is held.

    Args:
        values: The signal in any unit, shape (samples,).
        rate: Its new rate over its own [-].
    """
    if rate == 1:
        return values
    at = np.arange(len(values))
    return np.asarray(np.interp(rate * at, at, values))


def observed(scenario: Scenario, happened: Happened, channels: tuple[Channel, ...]) -> np.ndarray:
    """Return what perfect sensors with the scenario's faults would see, in SI, shape (samples, channels).

    Args:
        scenario: What was simulated, with the sensors' faults.
        happened: How everything moved.
        channels: Channels of the case.
    """
    return np.column_stack([_seen(scenario, happened, channel) for channel in channels])


def _seen(scenario: Scenario, happened: Happened, channel: Channel) -> np.ndarray:
    values = _true(scenario, happened, channel)
    delay = scenario.sensor_delay_s.get(channel.name, 0.0) / happened.motion.step_s
    values = at_rate(shifted(values, delay), 1 / (1 + scenario.sensor_clock.get(channel.name, 0.0)))
    values = (1 + scenario.sensor_gain.get(channel.name, 0.0)) * values
    return values + scenario.sensor_offset.get(channel.name, 0.0)


def _true(scenario: Scenario, happened: Happened, channel: Channel) -> np.ndarray:
    if channel.quantity == "table_acceleration":
        return happened.motion.acceleration
    if channel.quantity == "table_displacement":
        return happened.motion.displacement
    if channel.quantity == "contact_force":
        number = int(channel.contact or 1) - 1
        apart = number >= len(happened.contact_force)
        return np.zeros_like(happened.table) if apart else happened.contact_force[number]
    row = scenario.row(str(channel.frame), int(channel.floor or 0))
    if channel.quantity == "absolute_acceleration":
        return np.asarray(happened.acceleration[row])
    if channel.quantity == "relative_velocity":
        return np.asarray(happened.velocity[row])
    if channel.quantity == "absolute_displacement":
        moved = Motion("", happened.motion.step_s, happened.table).displacement
        return np.asarray(happened.displacement[row] + moved)
    return np.asarray(happened.displacement[row])
