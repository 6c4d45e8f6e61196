"""What a run of the rig leaves: the frames' motions, the contacts' forces, the energy and the cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicHermiteSpline

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contact_history import ContactHistory

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """Motion of one frame relative to the table, at the integrator's own steps (closer while in contact).

    Attributes:
        reduced: The frame.
        time_s: Times (m,) [s].
        displacement_m: Coordinates of the reduced frame (m, n) [m].
        velocity_m_s: Their rates (m, n) [m/s].
        acceleration_m_s2: Their second derivatives (m, n) [m/s^2].
        table_m_s2: The table's acceleration (m,) at the same times [m/s^2].
    """

    reduced: ReducedFrame
    time_s: Real
    displacement_m: Real
    velocity_m_s: Real
    acceleration_m_s2: Real
    table_m_s2: Real

    def __repr__(self) -> str:
        return f"FrameMotion({self.name!r}, {len(self.time_s)} times to {self.time_s[-1]:.4g} s)"

    @property
    def name(self) -> str:
        """Name of the frame."""
        return self.reduced.name

    def floor(self, number: int) -> int:
        """Return a floor's coordinate; `ExperimentError` if there is no such floor."""
        return floor_coordinate(self.reduced, number)

    def floor_displacement(self, number: int) -> Real:
        """Return a floor's displacement relative to the table (m,) [m]."""
        return self.displacement_m[:, self.floor(number)]

    def floor_acceleration(self, number: int) -> Real:
        """Return a floor's acceleration in the room (m,) [m/s^2]."""
        return self.acceleration_m_s2[:, self.floor(number)] + self.table_m_s2

    def sampled(self, times_s: ArrayLike) -> tuple[Real, Real]:
        """Return displacement and velocity (k, n) at any times (k,) [s], by cubic Hermite interpolation."""
        times = np.asarray(times_s, float)
        # Only the steps about these times: the coefficients of a long run take four times its memory.
        first, last = np.searchsorted(self.time_s, [times.min(), times.max()], side="right")
        first = min(max(first - 1, 0), len(self.time_s) - 2)
        part = slice(first, max(last, first + 1) + 1)
        place, rate, change = (
            one[part] for one in (self.displacement_m, self.velocity_m_s, self.acceleration_m_s2)
        )
        return (
            CubicHermiteSpline(self.time_s[part], place, rate)(times),
            CubicHermiteSpline(self.time_s[part], rate, change)(times),
        )

    def peaks(self) -> list[dict[str, Any]]:
        """Return each floor's `floor`, `max_mm`, `min_mm` (positive both), `max_acceleration_g` (room), all in its middle.

        `drift_mm` is the largest drift of the storey below it, `drift_percent` that over the storey's height.

        Floors that turn also have `edge_mm`, the largest displacement along x of the two ends of their edges, and
        `rotation_mrad`, the largest rotation.
        """
        found = []
        heights = np.diff(self.reduced.heights_m, prepend=0.0)
        for number in range(1, self.reduced.storeys + 1):
            floor = self.floor(number)
            drift_m = self._drift_m(number)
            moved = turning_points(self.time_s, self.displacement_m[:, floor], self.velocity_m_s[:, floor])
            found.append(
                {
                    "floor": number,
                    "max_mm": 1e3 * max(0.0, float(moved.max())),
                    "min_mm": 1e3 * max(0.0, -float(moved.min())),
                    "max_acceleration_g": float(np.abs(self.floor_acceleration(number)).max())
                    / STANDARD_GRAVITY,
                    "drift_mm": 1e3 * drift_m,
                    "drift_percent": 100.0 * drift_m / float(heights[number - 1]),
                    **self._turning(number),
                }
            )
        return found

    def _drift_m(self, storey: int) -> float:
        """Return the largest drift of a storey [m]."""
        row = np.zeros(self.reduced.size)
        row[self.floor(storey)] = 1.0
        if storey > 1:
            row[self.floor(storey - 1)] = -1.0
        return self._largest(row)

    def _turning(self, number: int) -> dict[str, float]:
        """Return what only floors that turn have."""
        if not self.reduced.turns:
            return {}
        half = self.reduced.plan_m[1] / 2.0
        turn = np.zeros(self.reduced.size)
        turn[self.reduced.floor_rz[number - 1]] = 1.0
        return {
            "edge_mm": 1e3 * max(self._largest(self.reduced.point_row(number, y)) for y in (-half, half)),
            "rotation_mrad": 1e3 * self._largest(turn),
        }

    def _largest(self, row: Real) -> float:
        """Return the largest magnitude of a combination of coordinates (n,)."""
        moved = turning_points(self.time_s, self.displacement_m @ row, self.velocity_m_s @ row)
        return float(np.abs(moved).max())


@dataclass(frozen=True, eq=False)
class StoreyHistory:
    """A law in a storey through a run, at the integrator's steps.

    Attributes:
        frame: Name of the frame.
        time_s: Times (m,) [s].
        drift_m: Drift on which it acts (m,) [m].
        rate_m_s: The drift's rate (m,) [m/s].
        force_n: Force that opposes the drift (m,) [N].
        middle_n: The same in the middle of each step (m - 1,) [N].
    """

    frame: str
    time_s: Real
    drift_m: Real
    rate_m_s: Real
    force_n: Real
    middle_n: Real

    def __repr__(self) -> str:
        return f"StoreyHistory({self.frame!r}, {len(self.time_s)} times to {self.time_s[-1]:.4g} s)"

    @property
    def work_j(self) -> Real:
        """Work done on the law (m,) [J], stored and lost; Simpson's rule in each step (order four)."""
        step, rate = np.diff(self.time_s), self.rate_m_s
        # Of the drift's cubic: accelerations jump where a contact begins with a force.
        middle = 1.5 * np.diff(self.drift_m) / step - 0.25 * (rate[:-1] + rate[1:])
        power = self.force_n * rate
        parts = step / 6.0 * (power[:-1] + 4.0 * self.middle_n * middle + power[1:])
        return np.concatenate([[0.0], np.cumsum(parts)])


@dataclass(frozen=True, eq=False)
class Motion:
    """A run of the rig.

    Attributes:
        frames: Motion of each frame, from left to right.
        contacts: History of each contact, in the rig's order.
        energy: Its balance.
        wall_s: Wall time of the integration [s].
        processor_s: Its processor time [s], which a busy machine does not lengthen.
        steps: Number of steps that the integrator took.
        solver: `exudyn` or `exact`.
        storeys: History of each law in a storey, in the rig's order; runs of exudyn have those of yielding storeys.
    """

    frames: tuple[FrameMotion, ...]
    contacts: tuple[ContactHistory, ...]
    energy: EnergyBalance
    wall_s: float
    processor_s: float
    steps: int
    solver: str = "exudyn"
    storeys: tuple[StoreyHistory, ...] = ()

    def __repr__(self) -> str:
        names = " beside ".join(repr(frame.name) for frame in self.frames)
        return f"Motion({names}, contacts: {len(self.contacts)}, {self.model_s:.4g} s by {self.solver}, {self.steps} steps)"

    @property
    def time_s(self) -> Real:
        """Times of the integrator's steps (m,) [s]."""
        return self.frames[0].time_s

    @property
    def model_s(self) -> float:
        """Time on the model's clock that the run covers [s]."""
        return float(self.time_s[-1] - self.time_s[0])


def distinct(names: Sequence[str]) -> list[str]:
    """Return names that differ: where one repeats, ``#2`` and so on is added.

    Args:
        names: Names of frames, from left to right.
    """
    counts = [names[: place + 1].count(name) for place, name in enumerate(names)]
    return [name if count == 1 else f"{name}#{count}" for name, count in zip(names, counts, strict=True)]


def floor_coordinate(reduced: ReducedFrame, number: int) -> int:
    """Return the coordinate that is a floor's displacement in x; `ExperimentError` without such a floor."""
    if not (isinstance(number, int | np.integer) and 1 <= number <= reduced.storeys):
        raise ExperimentError(f"{reduced.name} has no floor {number}: its floors are 1 to {reduced.storeys}")
    return int(reduced.floor_x[number - 1])


def turning_points(time_s: Real, value: Real, rate: Real) -> Real:
    """Return the values (k,) of a motion where it turns, in its unit; its largest and smallest are among them.

    Between two steps with rates of opposite sign the motion is Hermite's cubic, and its turning point is found on it.

    Args:
        time_s: Times (m,) [s].
        value: Values (m,) of any unit.
        rate: Their rates (m,), per second.
    """
    turns = np.flatnonzero(rate[:-1] * rate[1:] < 0.0)
    step = np.diff(time_s)[turns]
    before, after = value[turns], value[turns + 1]
    first, last = step * rate[turns], step * rate[turns + 1]
    # The slope is a quadratic in the place from 0 to 1, first at 0 and last at 1: one root lies between.
    a, b = 3.0 * (2.0 * (before - after) + first + last), 2.0 * (3.0 * (after - before) - 2.0 * first - last)
    half = -0.5 * (b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * first, 0.0)), b))
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = half / a, first / half
    place = np.where((one >= 0.0) & (one <= 1.0), one, other)
    at = before + place * (first + place * (b / 2.0 + place * a / 3.0))
    return np.concatenate([value[:1], at[np.isfinite(at)], value[-1:], value[turns], value[turns + 1]])


def unbounded(frame: ReducedFrame, moved_m: Real) -> str:
    """Return why a run cannot go on, if a floor has moved by more than the frame's height; else nothing.

    Args:
        frame: The frame.
        moved_m: How far each of its floors has moved (storeys,) [m].
    """
    height = float(np.max(frame.heights_m))
    if moved_m.max() < height:
        return ""
    return (
        f"floor {int(moved_m.argmax()) + 1} of {frame.name} has moved by more than its height of {height:g} m; "
        "lower the shaking, or check the frame's stiffness and damping"
    )


def stop_if_unbounded(frame: ReducedFrame, time_s: Real, moved_m: Real) -> None:
    """Stop a run in which a floor moves by more than the frame's height.

    Args:
        frame: The frame.
        time_s: Times (m,) [s].
        moved_m: How far each of its floors has moved (m, storeys) [m].

    Raises:
        ExperimentError: One does; says when it first did.
    """
    beyond = np.flatnonzero(~(moved_m.max(axis=1, initial=0.0) < float(np.max(frame.heights_m))))
    if len(beyond):
        reason = unbounded(frame, moved_m[beyond[0]])
        raise ExperimentError(f"the run was stopped at {time_s[beyond[0]]:.4f} s: {reason}")


def end_of_run(shaken_s: float, duration_s: float | None) -> float:
    """Return when a run ends [s].

    Args:
        shaken_s: End of the shaking [s].
        duration_s: What was asked for [s]; None for the end of the shaking.

    Raises:
        ExperimentError: What was asked for is no time after the begin.
    """
    if duration_s is None:
        return shaken_s
    if not (np.isfinite(duration_s) and duration_s > 0.0):
        raise ExperimentError(f"the run would end at {duration_s:g} s; give a duration above 0 s")
    return float(duration_s)


@dataclass(frozen=True, eq=False)
class EnergyBalance:
    """Energies of the motion relative to the table, at the integrator's steps.

    Attributes:
        time_s: Times (m,) [s].
        input_j: Work of the inertia forces that the table's acceleration causes (m,) [J].
        kinetic_j, strain_j: Of all frames (m,) [J].
        damping_j: Lost in the frames' damping (m,) [J].
        contact_j: Work done on the contacts, stored and lost (m,) [J].
        storey_j: Work done on the laws in storeys, stored and lost (m,) [J].
    """

    time_s: Real
    input_j: Real
    kinetic_j: Real
    strain_j: Real
    damping_j: Real
    contact_j: Real
    storey_j: Real

    def __repr__(self) -> str:
        return f"EnergyBalance({len(self.time_s)} times, error {self.error:.2g})"

    @property
    def error(self) -> float:
        """Largest imbalance at any time over the largest energy that was ever put in or held [-]."""
        spent = self.kinetic_j + self.strain_j + self.damping_j + self.contact_j + self.storey_j
        balance = self.input_j - spent
        scale = max(float(np.abs(part).max()) for part in (self.input_j, self.kinetic_j, self.strain_j))
        return float(np.abs(balance).max()) / scale if scale > 0 else 0.0
