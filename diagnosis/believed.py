"""The believed model with its ordinary parameters: what may vary inside the priors, and the prediction that follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from scipy.fft import next_fast_len
from scipy.interpolate import CubicSpline

from diagnosis.case import Prior
from diagnosis.kalman import LATENT_RATE, TABLE_NOISE_RATE
from diagnosis.observations import Observations, RunData
from diagnosis.predictor import predict
from diagnosis.storeys import Modes, Structure, solve_modes
from diagnosis.tilt import tilt_inputs

CHANNEL_GAIN = 0.003
CHANNEL_DELAY_S = 2e-4
COMMON_DAMPING = 0.7
"""What a case does not state: prior standard deviations of a sensor's gain and delay, and how much of the damping's
goes to all modes together; half the variance of the first mode, which is the one that was measured."""


BASE_STIFFNESS = 0.04
JOINT_STIFFNESS = 0.05
"""The same of a plate frame's first storey beyond the other storeys', and of its joints' stiffness (a logarithm): how
rigidly a base is clamped, and how a frame's flexibility is shared by columns and joints, no test of the thesis says;
models that agree in all frequencies differ in both."""


@dataclass(frozen=True)
class Parameter:
    """An ordinary parameter: what it is, of which place (an index), and its prior standard deviation."""

    kind: str
    place: int
    std: float


@dataclass
class Assembly:
    """What a set of parameters and effects amounts to, before it is made modal; effects change it in place."""

    mass: np.ndarray
    stiffness: np.ndarray
    log_damping: np.ndarray
    table_gain: float
    table_delay_s: float
    table_tilt: float
    channel_gain: np.ndarray
    channel_delay_s: np.ndarray
    channel_offset: np.ndarray
    laws: list[tuple[int, np.ndarray, tuple[float, ...], tuple[int, int]]] = field(default_factory=list)
    """Kind, row of floors that gives the drift, SI parameters, floor range (drag)."""
    extensions: list[
        Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    ] = field(default_factory=list)
    """Each turns mass, stiffness and damping matrices into larger ones: coordinates that the floors do not have."""
    influence: list[float] = field(default_factory=list)
    """Motion of each such coordinate when the table moves by one."""


class Acting(Protocol):
    """An effect that can be put on an assembly."""

    def apply(self, assembly: Assembly, values: np.ndarray, believed: Believed) -> None:
        """Change the assembly by the effect with SI parameter `values`."""


@dataclass(frozen=True)
class Prediction:
    """Innovations (or residuals), predicted and filtered states and outputs of each run."""

    innovations: list[np.ndarray]
    before: list[np.ndarray]
    after: list[np.ndarray]
    outputs: list[np.ndarray]


class Believed:
    """A structure, what was measured on it, and the priors of its ordinary parameters."""

    def __init__(self, structure: Structure, observed: Observations, prior: Prior) -> None:
        self.structure = structure
        self.observed = observed
        self.prior = prior
        self.parameters = _parameters(structure, observed, prior)
        self.std = np.array([parameter.std for parameter in self.parameters])
        self._splines = [
            CubicSpline(np.arange(len(run.table)) * run.step_s, run.table) for run in observed.runs
        ]
        self._shifted: dict[tuple[int, int, float], np.ndarray] = {}
        self._own: np.ndarray | None = None

    def table_slope(self, run: RunData) -> np.ndarray:
        """Return the rate of change of a run's table acceleration [m/s^3], shape (samples,)."""
        number = next(i for i, one in enumerate(self.observed.runs) if one is run)
        return np.asarray(self._splines[number](np.arange(len(run.table)) * run.step_s, 1))

    def assemble(self, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]] = ()) -> Assembly:
        """Return the believed system with parameter `values` (in units of their own) and effects."""
        structure = self.structure
        floors = structure.floors
        channels = len(self.observed.names)
        assembly = Assembly(
            mass=np.zeros((floors, floors)),
            stiffness=np.zeros((floors, floors)),
            log_damping=np.log(np.concatenate([frame.damping_ratio for frame in structure.frames])),
            table_gain=0.0,
            table_delay_s=0.0,
            table_tilt=0.0,
            channel_gain=np.zeros(channels),
            channel_delay_s=np.zeros(channels),
            channel_offset=np.zeros(channels),
        )
        for number, frame in enumerate(structure.frames):
            span = structure.span(number)
            assembly.mass[span, span] += frame.mass
            assembly.stiffness[span, span] += frame.stiffness
        for parameter, value in zip(self.parameters, values, strict=True):
            _vary(assembly, structure, parameter, float(value))
        for effect, numbers in effects:
            effect.apply(assembly, np.asarray(numbers, float), self)
        return assembly

    def modes(self, assembly: Assembly) -> Modes:
        """Return the modes of an assembly, with the coordinates that effects added."""
        plain = self.plain_modes(assembly)
        return _extended(assembly, plain) if assembly.extensions else plain

    def plain_modes(self, assembly: Assembly) -> Modes:
        """Return the modes of an assembly's floors alone, frame by frame."""
        mass, stiffness, log_damping = assembly.mass, assembly.stiffness, assembly.log_damping
        floors = len(mass)
        omegas, rows = [], []
        shapes = np.zeros((floors, floors))
        for number in range(len(self.structure.frames)):
            span = self.structure.span(number)
            omega, block = solve_modes(mass[span, span], stiffness[span, span])
            omegas.append(omega)
            shapes[span, span] = block
            rows.append(block.T @ mass[span, span].sum(axis=1))
        return Modes(np.concatenate(omegas), np.exp(log_damping), shapes, np.concatenate(rows))

    def overlap(self, modes: Modes) -> np.ndarray:
        """Return which part of each of `modes` is each of the believed frames' own modes, shape (floors, modes)."""
        if self._own is None:
            assembly = self.assemble(np.zeros(len(self.std)))
            self._own = self.plain_modes(assembly).floors.T @ assembly.mass
        return np.square(self._own @ modes.floors)

    def predict(
        self,
        values: np.ndarray,
        gains: Sequence[np.ndarray] | None = None,
        effects: Sequence[tuple[Acting, np.ndarray]] = (),
        runs: Sequence[int] | None = None,
    ) -> Prediction:
        """Run the predictor over `runs` (all by default) with a filter gain for each; without gains it simulates."""
        assembly = self.assemble(values, effects)
        modes = self.modes(assembly)
        result = Prediction([], [], [], [])
        for number, run in enumerate(runs if runs is not None else range(len(self.observed.runs))):
            pieces = self._run(assembly, modes, run, None if gains is None else gains[number])
            for store, piece in zip(
                (result.innovations, result.before, result.after, result.outputs), pieces, strict=True
            ):
                store.append(piece)
        return result

    def _run(
        self, assembly: Assembly, modes: Modes, number: int, gain: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        run = self.observed.runs[number]
        storeys = self.structure.floors
        states = 2 * len(modes.omega) + storeys + 3
        substep = run.step_s / run.substeps
        kinds, rows, parameters, drag = _laws(assembly, modes, run.step_s * (len(run.table) - 1))
        known_mid, known_at, table_mid, added = self._inputs(assembly, modes, number, run)
        measured = self._corrected(assembly, number, run, added)
        innovations, before, after, outputs = predict(
            np.stack([modes.omega, modes.ratio], axis=1),
            _steps(modes, substep / 2),
            _steps(modes, substep),
            modes.participation,
            np.ascontiguousarray(modes.floors),
            np.ascontiguousarray(self.structure.drift @ modes.floors),
            known_mid,
            known_at,
            table_mid,
            self.observed.quantity,
            self.observed.floor,
            measured,
            np.zeros((states, len(self.observed.names))) if gain is None else np.ascontiguousarray(gain),
            np.array([LATENT_RATE, TABLE_NOISE_RATE]),
            run.step_s,
            kinds,
            rows,
            parameters,
            drag,
        )
        if gain is None:
            for channel in np.flatnonzero(assembly.channel_delay_s):
                outputs[:, channel] = shift(
                    outputs[:, channel], run.step_s, -assembly.channel_delay_s[channel]
                )
        factor = 1.0 + assembly.channel_gain
        return innovations * factor, before, after, (outputs + added) * factor + assembly.channel_offset

    def _inputs(
        self, assembly: Assembly, modes: Modes, number: int, run: RunData
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return known modal forces at midpoints and samples, the table at midpoints, and what the tilt adds."""
        samples, substeps = len(run.table), run.substeps
        middle = (np.arange(samples)[:, None] + (np.arange(substeps)[None, :] + 0.5) / substeps) * run.step_s
        end = (samples - 1) * run.step_s
        table_mid = (1 + assembly.table_gain) * self._splines[number](
            np.clip(middle - assembly.table_delay_s, 0.0, end)
        )
        known_mid = np.zeros((samples, substeps, len(modes.omega)))
        known_at = np.zeros((samples, len(modes.omega)))
        added = np.zeros((samples, len(self.observed.names)))
        at = np.arange(samples) * run.step_s
        for column, (left, right) in enumerate(self.observed.contact_floors):
            direction = modes.floors[right] - modes.floors[left]
            force = run.contact[:, column]
            known_at += force[:, None] * direction
            known_mid += run.contact_at(middle, column)[..., None] * direction
        if assembly.table_tilt:
            tilt_inputs(self, assembly, modes, number, middle, at, known_mid, known_at, added)
        return known_mid, known_at, table_mid, added

    def _corrected(self, assembly: Assembly, number: int, run: RunData, added: np.ndarray) -> np.ndarray:
        """Return the measured channels without the gain, delay and offset that the assembly gives their sensors."""
        measured = run.measured
        delayed = np.flatnonzero(assembly.channel_delay_s)
        if len(delayed):
            measured = measured.copy()
            for channel in delayed:
                measured[:, channel] = self._shift(
                    number, int(channel), float(assembly.channel_delay_s[channel])
                )
        return (measured - assembly.channel_offset) / (1 + assembly.channel_gain) - added

    def _shift(self, number: int, channel: int, delay_s: float) -> np.ndarray:
        key = (number, channel, round(delay_s, 8))
        if key not in self._shifted:
            if len(self._shifted) > 400:
                self._shifted.clear()
            run = self.observed.runs[number]
            self._shifted[key] = shift(run.measured[:, channel], run.step_s, delay_s)
        return self._shifted[key]


def shift(series: np.ndarray, step_s: float, delay_s: float) -> np.ndarray:
    """Return a series as it was before a delay [s]; NaN samples stay NaN.

    The shift is a phase and nothing else: an interpolation between samples would average their noise away, and a
    likelihood would pay for that.
    """
    good = np.isfinite(series)
    if good.sum() < 4:
        return series
    index = np.arange(len(series))
    filled = np.interp(index, index[good], series[good])
    pad = min(256, len(series) - 1)
    padded = np.concatenate(
        [2 * filled[0] - filled[pad:0:-1], filled, 2 * filled[-1] - filled[-2 : -pad - 2 : -1]]
    )
    length = next_fast_len(len(padded), real=True)
    ramp = np.linspace(padded[-1], padded[0], length - len(padded) + 2)[1:-1]
    frequency = np.fft.rfftfreq(length, step_s)
    spectrum = np.fft.rfft(np.concatenate([padded, ramp])) * np.exp(2j * np.pi * frequency * delay_s)
    moved = np.fft.irfft(spectrum, length)[pad : pad + len(series)]
    moved[~good] = np.nan
    return moved


def _parameters(structure: Structure, observed: Observations, prior: Prior) -> list[Parameter]:
    floors = structure.floors
    frames = range(len(structure.frames))
    first = {structure.first(frame) for frame in frames}
    found = [Parameter("frame_stiffness", frame, prior.frame_stiffness) for frame in frames]
    common = COMMON_DAMPING * prior.damping_ratio
    found += [Parameter("frame_damping", frame, common) for frame in frames]
    found += [Parameter("storey_stiffness", storey, prior.storey_stiffness) for storey in range(floors)]
    found += [
        Parameter("base_stiffness", structure.first(number), BASE_STIFFNESS)
        for number, frame in enumerate(structure.frames)
        if frame.joint_derivative is not None
    ]
    found += [
        Parameter("joint_stiffness", number, JOINT_STIFFNESS)
        for number, frame in enumerate(structure.frames)
        if frame.joint_derivative is not None
    ]
    found += [Parameter("floor_mass", floor, prior.floor_mass) for floor in range(floors)]
    found += [
        Parameter("mode_damping", mode, (COMMON_DAMPING if mode in first else 1.0) * prior.damping_ratio)
        for mode in range(floors)
    ]
    found += [Parameter("table_gain", 0, prior.table_gain)]
    found += [Parameter("table_delay", 0, prior.table_delay_ms / 1000)]
    channels = range(len(observed.names))
    found += [Parameter("channel_gain", channel, CHANNEL_GAIN) for channel in channels]
    # One channel keeps the time: all of them late together are a table that is early; a force cell keeps its own.
    first_free = 0 if observed.force_cell else 1
    found += [Parameter("channel_delay", channel, CHANNEL_DELAY_S) for channel in channels[first_free:]]
    return found


def _vary(assembly: Assembly, structure: Structure, parameter: Parameter, value: float) -> None:
    place = parameter.place
    if parameter.kind == "frame_stiffness":
        span = structure.span(place)
        assembly.stiffness[span, span] += value * structure.frames[place].stiffness
    elif parameter.kind == "frame_damping":
        assembly.log_damping[structure.span(place)] += value
    elif parameter.kind == "mode_damping":
        assembly.log_damping[place] += value
    elif parameter.kind in ("storey_stiffness", "base_stiffness"):
        assembly.stiffness += value * storey_pattern(structure, place)
    elif parameter.kind == "joint_stiffness":
        span, derivative = structure.span(place), structure.frames[place].joint_derivative
        assembly.stiffness[span, span] += value * np.asarray(derivative)
    elif parameter.kind == "floor_mass":
        assembly.mass[place, place] += value * floor_mass(structure, place)
    elif parameter.kind == "table_gain":
        assembly.table_gain += value
    elif parameter.kind == "table_delay":
        assembly.table_delay_s += value
    elif parameter.kind == "channel_gain":
        assembly.channel_gain[place] += value
    elif parameter.kind == "channel_delay":
        assembly.channel_delay_s[place] += value


def storey_stiffness(structure: Structure, storey: int) -> float:
    """Return the stiffness [N/m] of a storey counted among all frames."""
    name, number = structure.place(storey)
    return float(structure.frames[structure.index(name)].storey_stiffness[number - 1])


def storey_pattern(structure: Structure, storey: int) -> np.ndarray:
    """Return the change of the whole stiffness for a unit relative change of a storey's, (floors, floors) [N/m]."""
    name, number = structure.place(storey)
    frame = structure.index(name)
    span = structure.span(frame)
    pattern = np.zeros((structure.floors, structure.floors))
    pattern[span, span] = structure.frames[frame].storey_pattern(number - 1)
    return pattern


def floor_mass(structure: Structure, floor: int) -> float:
    """Return the mass [kg] of a floor counted among all frames."""
    name, number = structure.place(floor)
    return float(structure.frames[structure.index(name)].floor_mass[number - 1])


def _extended(assembly: Assembly, plain: Modes) -> Modes:
    """Return the modes with the coordinates that effects added; coupling by damping between modes is left out."""
    mass, stiffness = assembly.mass, assembly.stiffness
    weighted = mass @ plain.floors
    damping = weighted @ np.diag(2 * plain.ratio * plain.omega) @ weighted.T
    for extend in assembly.extensions:
        mass, stiffness, damping = extend(mass, stiffness, damping)
    omega, shapes = solve_modes(mass, stiffness)
    ratio = np.einsum("im,ij,jm->m", shapes, damping, shapes) / (2 * omega)
    influence = np.concatenate([np.ones(len(plain.floors)), assembly.influence])
    return Modes(omega, ratio, shapes[: len(plain.floors)], shapes.T @ (mass @ influence))


def _steps(modes: Modes, step: float) -> np.ndarray:
    """Return the exact step of each mode under a constant force, shape (modes, 6)."""
    omega, ratio = modes.omega, np.minimum(modes.ratio, 0.95)
    damped = omega * np.sqrt(1 - ratio**2)
    decay = np.exp(-ratio * omega * step)
    cosine, sine = decay * np.cos(damped * step), decay * np.sin(damped * step)
    a11 = cosine + ratio * omega / damped * sine
    a12 = sine / damped
    return np.stack(
        [a11, a12, -(omega**2) * a12, cosine - ratio * omega / damped * sine, (1 - a11) / omega**2, a12],
        axis=1,
    )


def _laws(
    assembly: Assembly, modes: Modes, end: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    count = len(assembly.laws)
    rows = np.zeros((count, len(modes.omega)))
    parameters = np.zeros((count, 5))
    drag = np.zeros((count, 2), np.int64)
    kinds = np.zeros(count, np.int64)
    for j, (kind, row, numbers, span) in enumerate(assembly.laws):
        kinds[j] = kind
        rows[j] = row @ modes.floors
        parameters[j, : len(numbers)] = [end if np.isnan(number) else number for number in numbers]
        drag[j] = span
    return kinds, rows, parameters, drag
