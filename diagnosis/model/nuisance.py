"""The nuisance parameters: what may vary inside the priors, how wide, and what each changes in the baseline model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.model.kalman import DISCREPANCY
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.storeys import Structure, solve_modes

CHANNEL_GAIN = 0.003
CHANNEL_DELAY_S = 2e-4
COMMON_DAMPING = 0.7
STRUCK_DAMPING = 2.0
"""What a case does not state: prior standard deviations of a sensor's gain and delay, and how much of the damping's
goes to all modes together; half the variance of the first mode, which is the one that was measured; and how many times
wider that of the higher modes is where frames collide, because an impact shows those that a shaking hardly does."""

DAMPING_POWER = 2.5
"""Power of a mode's frequency with which its damping ratio may grow or fall, over the prior of the damping [-]: half by
default. It is 1 where damping is proportional to stiffness, -1 where it is to mass, and a test of free vibration says
nothing of it."""

USUAL_DRIFT = 0.005
"""Share of its height by which a storey drifts when it is shaken in earnest: a third to twice as much here."""


CHANNEL_DELAY = "channel_delay"
"""Kind of the parameters that say how late the channels are."""
MODAL_DAMPING = "modal_damping"
"""Kind of the parameters that say how much damping couples modes, over the geometric mean of the baseline's: a damper in
one storey couples as much as it damps, and where a frame's damping is no test of its modes says. The prior's is the
damping's."""
MODAL_STIFFNESS = "modal_stiffness"
"""Kind of the parameters of the model discrepancy, whose prior's scale is estimated (`inference.discrepancy`)."""


@dataclass(frozen=True)
class Parameter:
    """A nuisance parameter: what it is, of which place (an index), and its prior standard deviation."""

    kind: str
    place: int
    std: float


@dataclass
class Assembly:
    """What a set of parameters and effects amounts to, before it is made modal; effects change it in place."""

    mass: np.ndarray
    stiffness: np.ndarray
    log_damping: np.ndarray
    coupling: np.ndarray
    """How much damping couples each of the structure's pairs of modes, over the geometric mean of the baseline's."""
    table_gain: float
    table_delay_s: float
    table_clock: float
    """Relative change of the rate of the table's clock, which was right when the run began."""
    table_tilt: float
    channel_gain: np.ndarray
    channel_delay_s: np.ndarray
    channel_clock: np.ndarray
    """Relative change of the rate of each channel's clock, which was right when the run began."""
    channel_offset: np.ndarray
    event_gain: np.ndarray
    """Relative change of the contact force in each of the observations' contact events."""
    laws: list[PlacedLaw] = field(default_factory=list)
    """Forces of the effects."""
    extensions: list[
        Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    ] = field(default_factory=list)
    """Each turns mass, stiffness and damping matrices into larger ones: coordinates that the floors do not have."""
    influence: list[float] = field(default_factory=list)
    """Motion of each such coordinate when the table moves by one."""
    dampers: int = 0
    """How many of these coordinates hang on a damper of their own."""

    def differs_in_laws_alone(self, other: Assembly) -> bool:
        """Return whether another assembly has the same laws at the same places, of other parameters, and is else the same.

        Args:
            other: The other assembly.
        """
        pairs = [
            (vars(self)[key], vars(other)[key]) for key in vars(self) if key not in ("laws", "extensions")
        ]
        placed = len(self.laws) == len(other.laws) and all(
            one.law is two.law and one.in_room == two.in_room and np.array_equal(one.row, two.row)
            for one, two in zip(self.laws, other.laws, strict=False)
        )
        extended = self.extensions or other.extensions
        return placed and not extended and all(np.array_equal(one, two) for one, two in pairs)

    def numbers(self) -> np.ndarray:
        """Return all numbers but those of laws and of added coordinates one after the other, shape (numbers,)."""
        return np.concatenate(
            [np.ravel(one) for one in vars(self).values() if not isinstance(one, list | int)]
        )

    def with_numbers(self, numbers: np.ndarray) -> Assembly:
        """Return a copy with other `numbers`.

        Args:
            numbers: The numbers, shape (numbers,).
        """
        changed: dict[str, Any] = {}
        taken = 0
        for key, one in vars(self).items():
            if isinstance(one, float):
                changed[key] = float(numbers[taken])
                taken += 1
            elif isinstance(one, np.ndarray):
                changed[key] = numbers[taken : taken + one.size].reshape(one.shape)
                taken += one.size
            elif isinstance(one, list):
                changed[key] = [*one]
        return replace(self, **changed)

    def copy(self) -> Assembly:
        """Return a copy that shares nothing which changes."""
        changing: dict[str, Any] = {
            key: one.copy() for key, one in vars(self).items() if isinstance(one, np.ndarray | list)
        }
        return replace(self, **changing)


def nuisance_parameters(structure: Structure, observed: Observations, prior: Prior) -> list[Parameter]:
    """Return the nuisance parameters of a structure and of what was measured on it.

    Args:
        structure: The frames.
        observed: What was measured: sensors and contact events have nuisance parameters, too.
        prior: Prior standard deviations that the case states.
    """
    floors = structure.floors
    frames = range(len(structure.frames))
    first = {structure.first(frame) for frame in frames}
    found = [Parameter("frame_stiffness", frame, prior.frame_stiffness) for frame in frames]
    common = COMMON_DAMPING * prior.damping_ratio
    found += [Parameter("frame_damping", frame, common) for frame in frames]
    tall = [number for number, frame in enumerate(structure.frames) if len(frame.floor_mass) > 1]
    found += [Parameter("damping_power", frame, DAMPING_POWER * prior.damping_ratio) for frame in tall]
    found += [Parameter("storey_stiffness", storey, prior.storey_stiffness) for storey in range(floors)]
    found += [
        Parameter("base_stiffness", structure.first(number), prior.base_stiffness)
        for number, frame in enumerate(structure.frames)
        if frame.joint_derivative is not None
    ]
    found += [
        Parameter("joint_stiffness", number, prior.joint_stiffness)
        for number, frame in enumerate(structure.frames)
        if frame.joint_derivative is not None
    ]
    higher = STRUCK_DAMPING if observed.contact_floors else 1.0
    found += [Parameter("floor_mass", floor, prior.floor_mass) for floor in range(floors)]
    found += [
        Parameter("mode_damping", mode, (COMMON_DAMPING if mode in first else higher) * prior.damping_ratio)
        for mode in range(floors)
    ]
    if observed.runs:
        # Real frames are never quite the model; only histories can tell by how much.
        count = len(structure.discrepancies)
        found += [Parameter(MODAL_STIFFNESS, number, DISCREPANCY) for number in range(count)]
        count = len(structure.couplings)
        found += [Parameter(MODAL_DAMPING, number, prior.damping_ratio) for number in range(count)]
    found += [Parameter("table_gain", 0, prior.table_gain)]
    found += [Parameter("table_delay", 0, prior.table_delay_ms / 1000)]
    channels = range(len(observed.names))
    found += [Parameter("channel_gain", channel, CHANNEL_GAIN) for channel in channels]
    # One channel keeps the time: all of them late together are a table that is early; contact forces keep their own.
    first_free = 0 if observed.touching else 1
    found += [Parameter(CHANNEL_DELAY, channel, CHANNEL_DELAY_S) for channel in channels[first_free:]]
    found += [
        Parameter("event_gain", number, event.std) for number, event in enumerate(observed.contact_events)
    ]
    return found


def baseline(structure: Structure, channels: int, contact_events: int) -> Assembly:
    """Return what the frames amount to when all nuisance parameters are zero and no effect acts.

    Args:
        structure: The frames.
        channels, contact_events: How many there are.
    """
    floors = structure.floors
    assembly = Assembly(
        mass=np.zeros((floors, floors)),
        stiffness=np.zeros((floors, floors)),
        log_damping=np.log(np.concatenate([frame.damping_ratio for frame in structure.frames])),
        coupling=np.zeros(len(structure.couplings)),
        table_gain=0.0,
        table_delay_s=0.0,
        table_clock=0.0,
        table_tilt=0.0,
        channel_gain=np.zeros(channels),
        channel_delay_s=np.zeros(channels),
        channel_clock=np.zeros(channels),
        channel_offset=np.zeros(channels),
        event_gain=np.zeros(contact_events),
    )
    for number, frame in enumerate(structure.frames):
        span = structure.span(number)
        assembly.mass[span, span] += frame.mass
        assembly.stiffness[span, span] += frame.stiffness
    return assembly


def changes(assembly: Assembly, structure: Structure, parameters: Sequence[Parameter]) -> np.ndarray:
    """Return what a unit of each nuisance parameter adds to the numbers of an assembly, shape (parameters, numbers).

    `vary` adds in proportion to the parameter's value, whatever the assembly.

    Args:
        assembly: An assembly of these frames.
        structure: The frames.
        parameters: The nuisance parameters.
    """
    none = assembly.with_numbers(np.zeros_like(assembly.numbers()))
    found = []
    for parameter in parameters:
        alone = none.copy()
        vary(alone, structure, parameter.kind, parameter.place, 1.0)
        found.append(alone.numbers())
    return np.array(found)


def vary(assembly: Assembly, structure: Structure, kind: str, place: int, value: float) -> None:
    """Change an assembly by a nuisance parameter, or by an effect that is one beyond its prior.

    Args:
        assembly: The assembly, which is changed in place.
        structure: The frames.
        kind, place: Kind of the parameter, and the index of its place.
        value: Its value in units of its own.
    """
    if kind == "frame_stiffness":
        span = structure.span(place)
        assembly.stiffness[span, span] += value * structure.frames[place].stiffness
    elif kind == "frame_damping":
        assembly.log_damping[structure.span(place)] += value
    elif kind == "damping_power":
        assembly.log_damping[structure.span(place)] += value * log_frequency(structure, place)
    elif kind == "mode_damping":
        assembly.log_damping[place] += value
    elif kind == MODAL_DAMPING:
        assembly.coupling[place] += value
    elif kind in ("storey_stiffness", "base_stiffness"):
        assembly.stiffness += value * storey_pattern(structure, place)
    elif kind == "joint_stiffness":
        span, derivative = structure.span(place), structure.frames[place].joint_derivative
        assembly.stiffness[span, span] += value * np.asarray(derivative)
    elif kind == MODAL_STIFFNESS:
        number, one, other = structure.discrepancies[place]
        span, rows = structure.span(number), structure.frames[number].modal_rows
        both = value * np.outer(rows[one], rows[other])
        assembly.stiffness[span, span] += both if one == other else both + both.T
    elif kind == "floor_mass":
        assembly.mass[place, place] += value * floor_mass(structure, place)
    elif kind == "table_gain":
        assembly.table_gain += value
    elif kind == "table_delay":
        assembly.table_delay_s += value
    elif kind == "channel_gain":
        assembly.channel_gain[place] += value
    elif kind == CHANNEL_DELAY:
        assembly.channel_delay_s[place] += value
    elif kind == "channel_offset":
        assembly.channel_offset[place] += value
    elif kind == "event_gain":
        assembly.event_gain[place] += value


def log_frequency(structure: Structure, number: int) -> np.ndarray:
    """Return the logarithm of each frequency of a frame (its number) over its lowest, shape (modes,)."""
    frame = structure.frames[number]
    omega = solve_modes(frame.mass, frame.stiffness)[0]
    return np.asarray(np.log(omega / omega[0]))


def storey_stiffness(structure: Structure, storey: int) -> float:
    """Return the stiffness [N/m] of a storey counted among all frames."""
    name, number = structure.place(storey)
    return float(structure.frames[structure.index(name)].storey_stiffness[number - 1])


def usual_drift_rate(structure: Structure, storey: int) -> float:
    """Return the rate [m/s] of a storey, counted among all, that drifts by `USUAL_DRIFT` at its frame's lowest frequency."""
    name, number = structure.place(storey)
    frame = structure.frames[structure.index(name)]
    height = np.diff(frame.height_m, prepend=0.0)[number - 1]
    return USUAL_DRIFT * float(height) * float(solve_modes(frame.mass, frame.stiffness)[0][0])


def storey_pattern(structure: Structure, storey: int) -> np.ndarray:
    """Return the change of the whole stiffness for a unit relative change of a storey's, (floors, floors) [N/m]."""
    name, number = structure.place(storey)
    frame = structure.index(name)
    span = structure.span(frame)
    pattern = np.zeros((structure.floors, structure.floors))
    pattern[span, span] = structure.frames[frame].storey_pattern(number - 1)
    return pattern


def column_drift(structure: Structure, storey: int) -> np.ndarray:
    """Return the row (floors,) along which a storey's columns bend, which is its drift where no joint turns.

    What a relative change of the storey's stiffness makes of the whole (`storey_pattern`) is that stiffness times the square
    of this row, but for a few hundredths of it.
    """
    sizes, rows = np.linalg.eigh(storey_pattern(structure, storey))
    row = rows[:, -1] * np.sqrt(max(sizes[-1], 0.0) / storey_stiffness(structure, storey))
    return np.asarray(np.copysign(1.0, structure.drift[storey] @ row) * row)


def floor_mass(structure: Structure, floor: int) -> float:
    """Return the mass [kg] of a floor counted among all frames."""
    name, number = structure.place(floor)
    return float(structure.frames[structure.index(name)].floor_mass[number - 1])
