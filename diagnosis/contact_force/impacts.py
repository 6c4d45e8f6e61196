"""Single impacts: what a contact law makes of the motion just before one, beside the force that was measured.

A force cell and its logger turn a pulse of a millisecond into a few samples of another shape, by a filter that nobody
states but that is the same for every impact. A pulse is therefore compared by its spectrum well below the sampling rate,
as the logarithm of magnitude and phase, to which an unknown filter adds the same terms in every impact: the magnitude at
zero is the impulse, the slope of the phase the time, the magnitude further up the duration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pounding.constants import STD_PER_MAD
from pounding.contact.damping import hertz_damp_ratio, linear_damping_ratio, nonlinear_damping_ratio
from pounding.contact.laws import BUILT_IN, DAMPED
from pounding.diagnosis.contact_force.striking import STEP_S
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.settings import SETTINGS

LAWS = BUILT_IN


@dataclass(frozen=True)
class Law:
    """A contact law with its numbers in SI; `damping` is NaN where `restitution` says what is lost, and vice versa."""

    name: str
    gap_m: float
    stiffness: float
    damping: float
    restitution: float
    mass: float

    def numbers(self) -> tuple[int, float, float, float, float, float]:
        """Return kind, gap, stiffness, damper, ratio and reduced mass as `strike` wants them."""
        damper, ratio = self.damping, 0.0
        kind = LAWS.index(self.name)
        if self.name not in DAMPED:
            return kind, self.gap_m, self.stiffness, 0.0, 0.0, self.mass
        if np.isnan(damper):
            damper = -1.0
            if self.name == "linear_viscoelastic":
                damper = 2 * linear_damping_ratio(self.restitution) * np.sqrt(self.stiffness * self.mass)
            elif self.name == "nonlinear_viscoelastic":
                ratio = nonlinear_damping_ratio(self.restitution)
            else:
                ratio = hertz_damp_ratio(self.restitution)
        return kind, self.gap_m, self.stiffness, float(damper), float(ratio), self.mass


@dataclass(frozen=True)
class Impact:
    """One impact as measured.

    Attributes:
        free, free_rate: Relative displacement [m] and velocity [m/s] without it, on the fine grid.
        prior: Standard deviations of displacement and velocity.
        turn: exp(-i omega t) times the step on the fine grid, shape (frequencies, steps).
        seen: Logarithmic spectrum: magnitudes, then phases but the first, shape (7,).
        whiten: Inverse Cholesky factor of its covariance; rows of what is too faint are zero, shape (7, 7).
        onset: Index of the first plain sample on the fine grid. impulse: [N s].
    """

    free: np.ndarray
    free_rate: np.ndarray
    prior: tuple[float, float]
    turn: np.ndarray
    seen: np.ndarray
    whiten: np.ndarray
    onset: int
    impulse: float


class Packed(NamedTuple):
    """What is known of all impacts, one array for each, as `striking.differences` takes it, which says what they are."""

    first: np.ndarray
    free: np.ndarray
    free_rate: np.ndarray
    prior: np.ndarray
    turn: np.ndarray
    seen: np.ndarray
    hertz: np.ndarray
    held: np.ndarray
    held_rate: np.ndarray


@dataclass(frozen=True)
class Bodies:
    """The two floors that meet: what a step of force does to their distance, and the impacts between them.

    `sharpness` is the share of the errors expected of the impacts' spectra that they have here, `common_m` the standard
    deviation of the error that all distances before impacts have in common [m].
    """

    held: np.ndarray
    held_rate: np.ndarray
    mass: float
    impacts: tuple[Impact, ...]
    sharpness: float = 1.0
    common_m: float = 0.0

    @cached_property
    def packed(self) -> Packed:
        """What is known of all impacts."""
        each = self.impacts
        return Packed(
            first=np.cumsum([0, *(len(one.free) for one in each)]),
            free=np.concatenate([one.free for one in each]),
            free_rate=np.concatenate([one.free_rate for one in each]),
            prior=np.array([one.prior for one in each]),
            turn=np.ascontiguousarray(np.concatenate([one.turn for one in each], axis=1)),
            seen=np.array([one.seen for one in each]),
            hertz=np.array([-np.angle(one.turn[1:, 1] / one.turn[1:, 0]) / STEP_S for one in each]),
            held=self.held,
            held_rate=self.held_rate,
        )

    @cached_property
    def whiten(self) -> np.ndarray:
        """The inverse Cholesky factors of the impacts' covariances, shape (impacts, 7, 7)."""
        return np.array([one.whiten for one in self.impacts]).reshape(-1, 7, 7)


def spectrum(force: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return logarithmic magnitudes and phases (but at zero) of a force on a grid, shape (7,)."""
    values = turn @ force
    size = np.log(np.maximum(np.abs(values), 1e-12))
    return np.concatenate([size, np.angle(values[1:])])


def response(modes: Modes, row: np.ndarray, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative displacement and velocity after a unit force over one step, each of shape (steps + 1,).

    Args:
        modes: Modes of the frames.
        row: Relative displacement of the two floors for a unit of each mode, shape (modes,).
        steps: For how many steps of `STEP_S`.
    """
    stayed, rate, *_ = modes.swing(np.arange(steps + 1) * STEP_S)
    moved, weight = (1 - stayed) / modes.omega**2, row**2
    return np.diff(moved @ weight, prepend=0.0), np.diff(rate @ weight, prepend=0.0)


def groups(force: np.ndarray, noise: float, step: float) -> list[tuple[int, int]]:
    """Return first and last plain sample of each impact.

    Args:
        force: Contact force of a run [N], shape (samples,).
        noise: Standard deviation of its noise [N].
        step: Sampling step [s].
    """
    least = SETTINGS.impacts.plain_share * float(force.max(initial=0.0))
    return above(force, max(SETTINGS.impacts.plain * noise, least), step)


def above(force: np.ndarray, least: float, step: float) -> list[tuple[int, int]]:
    """Return first and last sample of each contact event with more than a force.

    Args:
        force: Contact force of a run [N], shape (samples,).
        least: The force that counts [N].
        step: Sampling step [s].
    """
    plain = np.flatnonzero(force > least)
    if not len(plain):
        return []
    cuts = np.flatnonzero(np.diff(plain) * step > SETTINGS.impacts.apart_s) + 1
    return [(int(part[0]), int(part[-1])) for part in np.split(plain, cuts)]


def force_noise(force: np.ndarray) -> float:
    """Return the standard deviation of a force channel while nothing touches [N]."""
    middle = np.median(force)
    return max(STD_PER_MAD * float(np.median(np.abs(force - middle))), 1e-6)


def found_noise(force: np.ndarray) -> float:
    """Return the standard deviation of a force that was found from the motion [N]."""
    return force_noise(force[force != 0]) if np.any(force) else 1.0


def bodies(
    model: Model, filtered: Filtered, column: int, noise: Sequence[float], known_mass: float
) -> Bodies:
    """Return the impacts of a measured or found contact force.

    Args:
        model: The baseline model at the rate of the logger.
        filtered: The filter with all forces as known inputs.
        column: Which of the contact forces.
        noise: Standard deviation of the force in each run of the baseline [N].
        known_mass: Reduced mass of the two floors [kg].
    """
    left, right = model.observed.contact_floors[column]
    modes = filtered.modes
    row = modes.floors[left] - modes.floors[right]
    found: list[Impact] = []
    longest = 1
    for number, run in enumerate(filtered.runs):
        data = model.observed.runs[run]
        n, covariance = len(modes.omega), filtered.filters[number].updated
        spread = (
            float(np.sqrt(max(row @ covariance[:n, :n] @ row, 0.0))),
            float(np.sqrt(max(row @ covariance[n : 2 * n, n : 2 * n] @ row, 0.0))),
        )
        series = data.contact[:, column]
        spans = groups(series, noise[number], data.step_s)
        for index, (first, last) in enumerate(spans):
            following = spans[index + 1][0] if index + 1 < len(spans) else len(series)
            lead = max(2, int(np.ceil(SETTINGS.impacts.lead_s / data.step_s)))
            begin = first - lead
            tail = int(np.ceil(SETTINGS.impacts.tail_s / data.step_s))
            end = min(last + tail, following - lead, len(series) - 1)
            if begin < 1 or end <= last or (end - begin) * data.step_s > SETTINGS.impacts.longest_s:
                continue
            one = _impact(
                model, filtered, number, data, row, spread, series, (begin, first, end), noise[number]
            )
            if one is not None:
                found.append(one)
                longest = max(longest, len(one.free))
    found.sort(key=lambda one: -one.impulse)
    held, held_rate = response(modes, row, longest)
    return Bodies(held, held_rate, known_mass, tuple(found[: SETTINGS.impacts.used]))


def common_error(model: Model, filtered: Filtered, column: int, errors: np.ndarray) -> float:
    """Return the standard deviation of the error that all distances before the impacts of a contact have in common [m].

    Where a floor is when it is hit follows from the motion of its frame, of which the model is wrong by the same share
    every time: impacts that repeat say nothing of it.

    Args:
        model: The baseline model at the rate of the logger.
        filtered: The filtered model.
        column: Which of the contact forces.
        errors: Share of its motion by which the model of each frame is wrong, shape (frames,).
    """
    floors, structure = list(model.observed.contact_floors[column]), model.structure
    shapes, modes = filtered.modes.floors[floors], len(filtered.modes.omega)
    force = np.concatenate([model.observed.runs[run].contact[:, column] for run in filtered.runs])
    moved = np.concatenate([states[:, :modes] @ shapes.T for states in filtered.prediction.after])
    pushed = float(force.sum())
    if pushed <= 0.0:
        return 0.0
    there = force @ moved / pushed  # The noise of a cell that reads on between impacts cancels.
    own = errors[[structure.index(structure.place(floor)[0]) for floor in floors]]
    return float(np.hypot(*(own * there)))


def sharper(met: Bodies, share: float) -> Bodies:
    """Return impacts with a share of the errors of their spectra; the states before them are known as before."""
    found = tuple(replace(one, whiten=one.whiten / share) for one in met.impacts)
    return replace(met, impacts=found, sharpness=met.sharpness * share)


def _impact(
    model: Model,
    filtered: Filtered,
    number: int,
    data: RunData,
    row: np.ndarray,
    spread: tuple[float, float],
    series: np.ndarray,
    span: tuple[int, int, int],
    noise: float,
) -> Impact | None:
    begin, first, end = span
    step = data.step_s
    steps = round((end - begin) * step / STEP_S)
    free, rate = _free(model, filtered, number, data, row, begin, end, steps)
    force = series[begin : end + 1]
    ours = SETTINGS.impacts
    shares = np.array(ours.frequencies)
    hertz = np.minimum(shares / step, shares / shares[-1] * ours.highest_hz)
    coarse = step * np.exp(-2j * np.pi * np.outer(hertz, np.arange(len(force)) * step))
    fine = STEP_S * np.exp(-2j * np.pi * np.outer(hertz, (np.arange(steps) + 0.5) * STEP_S))
    values = coarse @ force
    if values[0].real <= 0:
        return None
    slope = coarse / values[:, None]
    spreads = np.concatenate([slope.real, slope[1:].imag]) * noise
    covariance = spreads @ spreads.T + np.diag(np.square(ours.model_error))
    strong = np.abs(values) > ours.faint * np.abs(values[0])
    good = np.concatenate([strong, strong[1:]])
    whiten = np.zeros((7, 7))
    whiten[np.ix_(good, good)] = np.linalg.inv(np.linalg.cholesky(covariance[np.ix_(good, good)]))
    onset = round((first - begin) * step / STEP_S)
    speed = abs(float(rate[min(onset, steps - 1)]))
    prior = (
        float(np.hypot(ours.inflated * spread[0], ours.least_state[0])),
        float(np.hypot(ours.inflated * spread[1], ours.least_state[1] * speed)),
    )
    return Impact(
        free=free,
        free_rate=rate,
        prior=prior,
        turn=fine,
        seen=spectrum(force, coarse),
        whiten=whiten,
        onset=onset,
        impulse=float(values[0].real),
    )


def _free(
    model: Model,
    filtered: Filtered,
    number: int,
    data: RunData,
    row: np.ndarray,
    begin: int,
    end: int,
    steps: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return relative displacement and velocity from the filtered state at `begin` on, without contact."""
    modes = filtered.modes
    n, storeys = len(modes.omega), model.structure.floors
    state = filtered.prediction.after[number][begin]
    table = float(data.table[begin : end + 1].mean()) - state[-3]
    push = state[2 * n : 2 * n + storeys] @ (model.structure.drift @ modes.floors)
    push = push - modes.participation * table
    a11, a12, a21, a22 = modes.swing(np.arange(steps) * STEP_S)
    still = push / modes.omega**2
    eta, rate = state[:n] - still, state[n : 2 * n]
    moved, moving = a11 * eta + a12 * rate + still, a21 * eta + a22 * rate
    return np.ascontiguousarray(moved @ row), np.ascontiguousarray(moving @ row)
