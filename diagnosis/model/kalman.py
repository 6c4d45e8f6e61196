"""The baseline predictor: modes, latent storey forces and table noise as one linear system, and its steady Kalman gain.

Latent forces are Ornstein-Uhlenbeck processes, one in each storey; they stand for whatever the model lacks, so that
predictions do not run out of phase with a lightly damped frame and a later linearisation about them holds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.predictor import (
    ABSOLUTE_DISPLACEMENT,
    ACCELERATION,
    LEAK,
    TABLE_DISPLACEMENT,
    VELOCITY,
)
from pounding.diagnosis.model.storeys import Modes

LATENT_RATE = 2 * np.pi * 15.0
TABLE_NOISE_RATE = 2 * np.pi * 80.0
"""[1/s] corner of the latent forces and of the table channel's noise."""


DISCREPANCY = 0.0032
"""Scale of the model discrepancy where nothing is known of it yet (see `Noise`)."""


@dataclass(frozen=True)
class Noise:
    """What is not known, as standard deviations.

    Attributes:
        latent: Standard deviation of each storey's latent force [N], shape (storeys,).
        table: Standard deviation of the table channel's noise [m/s^2].
        channel: Standard deviation of each channel's noise in SI, shape (channels,); infinite where not measured.
        discrepancy: Standard deviation of what no storey parameter explains in the stiffness between the frame's modes,
            relative to these modes' own [-]. It is that of the frame, the same in all runs.
    """

    latent: np.ndarray
    table: float
    channel: np.ndarray
    discrepancy: float = DISCREPANCY


@dataclass(frozen=True)
class LinearSystem:
    """Continuous system x' = A x + B force, y = C x + D force over modes, latent forces, table noise, table motion.

    `rate` (states, states), `force` (states, modes + 1: the table's acceleration last), `output` (channels, states),
    `direct` (channels, modes).
    """

    rate: np.ndarray
    force: np.ndarray
    output: np.ndarray
    direct: np.ndarray

    @cached_property
    def estimated(self) -> np.ndarray:
        """Which states a filter estimates, shape (states,): those of the table's motion only where a channel sees it.

        They drift for minutes, which takes twice as many doublings as all that the frames do.
        """
        found = np.ones(len(self.rate), bool)
        found[-2:] = self.output[:, -2:].any()
        return found

    def held(self, step_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what a step makes of the states, (states, states), and forces held over it, (states, modes + 1).

        Args:
            step_s: The step [s].
        """
        states, forces = self.force.shape
        block = np.zeros((states + forces, states + forces))
        block[:states, :states], block[:states, states:] = self.rate * step_s, self.force * step_s
        exponential = expm(block)
        return exponential[:states, :states], exponential[:states, states:]

    def part(self, states: np.ndarray) -> LinearSystem:
        """Return the system of some states, which no others act on; `states` says which, shape (states,)."""
        rate = self.rate[np.ix_(states, states)]
        return LinearSystem(rate, self.force[states], self.output[:, states], self.direct)


@dataclass(frozen=True)
class Gain:
    """A filter's gain that corrects the floors alike whatever the modes are: those of other parameters have other shapes.

    Attributes:
        modal: The gain for the states that `modes` have, shape (states, channels).
        modes: The modes for which it was worked out.
    """

    modal: np.ndarray
    modes: Modes

    def at(self, modes: Modes) -> np.ndarray:
        """Return the gain for the states that other modes have, shape (states, channels)."""
        if modes is self.modes:
            return self.modal
        n = len(modes.omega)
        turned = np.linalg.solve(modes.shapes, self.modes.shapes)
        return np.vstack([turned @ self.modal[:n], turned @ self.modal[n : 2 * n], self.modal[2 * n :]])


@dataclass(frozen=True)
class SteadyFilter:
    """Filter gain (states, channels), innovation covariance (channels, channels), one-step matrices, and the
    covariance of the states after a sample (states, states); zero for states that are not estimated.
    """

    gain: np.ndarray
    covariance: np.ndarray
    step: np.ndarray
    force_start: np.ndarray
    force_end: np.ndarray
    output: np.ndarray
    direct: np.ndarray
    updated: np.ndarray

    @cached_property
    def factor(self) -> np.ndarray:
        """Lower Cholesky factor of the innovation covariance, shape (channels, channels)."""
        return np.asarray(np.linalg.cholesky(self.covariance))

    @cached_property
    def whitening(self) -> np.ndarray:
        """Matrix that divides the innovation covariance out, shape (channels, channels)."""
        return np.linalg.inv(self.factor)


def linear_system(
    modes: Modes, latent_rows: np.ndarray, quantities: np.ndarray, floor: np.ndarray
) -> LinearSystem:
    """Return the linear system of a model with latent forces in its storeys.

    Args:
        modes: Modes of the frames.
        latent_rows: Drift of each storey for a unit of each mode, shape (storeys, modes); a latent force acts along each.
        quantities: Kind of each channel (see `pounding.diagnosis.model.predictor`), shape (channels,).
        floor: Floor of each channel among all floors, shape (channels,).
    """
    n, storeys = len(modes.omega), len(latent_rows)
    states = 2 * n + storeys + 3
    latent, noise, displacement, velocity = slice(2 * n, 2 * n + storeys), states - 3, states - 2, states - 1
    rate = np.zeros((states, states))
    rate[:n, n : 2 * n] = np.eye(n)
    rate[n : 2 * n, :n] = -np.diag(modes.omega**2)
    rate[n : 2 * n, n : 2 * n] = -np.diag(2 * modes.ratio * modes.omega) - modes.coupling.matrix(n)
    rate[n : 2 * n, latent] = latent_rows.T
    rate[n : 2 * n, noise] = modes.participation
    rate[latent, latent] = -LATENT_RATE * np.eye(storeys)
    rate[noise, noise] = -TABLE_NOISE_RATE
    rate[displacement, velocity] = 1.0
    rate[velocity, [noise, displacement, velocity]] = -1.0, -(LEAK**2), -1.4 * LEAK
    force = np.zeros((states, n + 1))
    force[n : 2 * n, :n] = np.eye(n)
    force[velocity, n] = 1.0
    output = np.zeros((len(quantities), states))
    direct = np.zeros((len(quantities), n))
    for c, (quantity, f) in enumerate(zip(quantities, floor, strict=True)):
        if quantity == ACCELERATION:
            output[c] = modes.floors[f] @ rate[n : 2 * n]
            output[c, noise] = 0.0
            direct[c] = modes.floors[f]
        elif quantity == VELOCITY:
            output[c, n : 2 * n] = modes.floors[f]
        elif quantity == TABLE_DISPLACEMENT:
            output[c, displacement] = 1.0
        else:
            output[c, :n] = modes.floors[f]
            output[c, displacement] = float(quantity == ABSOLUTE_DISPLACEMENT)
    return LinearSystem(rate, force, output, direct)


def steady_filter(system: LinearSystem, noise: Noise, step_s: float) -> SteadyFilter:
    """Return the steady Kalman filter of a sampled system.

    Args:
        system: The system.
        noise: Latent forces and noise of table and channels.
        step_s: Sampling step [s].

    Raises:
        CaseError: Noise and motion are of too different sizes for a filter.
    """
    states, estimated, measured = len(system.rate), system.estimated, np.isfinite(noise.channel)
    part = system.part(estimated)
    step, covariance = discretise(part.rate, noise_density(states, noise)[estimated], step_s)
    output = part.output[measured]
    scale = 1.0 / noise.channel[measured]
    predicted = _riccati(step, output * scale[:, None], covariance)
    scaled = output * scale[:, None]
    innovation = scaled @ predicted @ scaled.T + np.eye(len(scaled))
    corrected = np.linalg.solve(innovation, scaled @ predicted).T * scale
    full = np.eye(len(measured))
    full[np.ix_(measured, measured)] = innovation / np.outer(scale, scale)
    found = SteadyFilter(
        gain=np.zeros((states, len(measured))),
        covariance=full,
        step=np.zeros((states, states)),
        force_start=np.zeros(system.force.shape),
        force_end=np.zeros(system.force.shape),
        output=system.output,
        direct=system.direct,
        updated=np.zeros((states, states)),
    )
    square = np.ix_(estimated, estimated)
    found.gain[np.ix_(estimated, measured)] = corrected
    found.step[square], found.updated[square] = step, predicted - corrected @ output @ predicted
    found.force_start[estimated], found.force_end[estimated] = _first_order_hold(
        part.rate, part.force, step_s
    )
    return found


@dataclass(frozen=True)
class FilterSlopes:
    """Derivatives of a steady filter by the logarithms of its noise: that of the latent forces, of the table, of each
    measured channel.

    Attributes:
        gain: Of the gain, shape (numbers, states, channels).
        covariance: Of the innovation covariance, shape (numbers, channels, channels).
    """

    gain: np.ndarray
    covariance: np.ndarray


def filter_slopes(system: LinearSystem, noise: Noise, step_s: float, steady: SteadyFilter) -> FilterSlopes:
    """Return how the steady filter of a sampled system changes with its noise.

    A covariance that changes by what drives the states does so as a stable system's does: each a Lyapunov equation.

    Args:
        system: The system.
        noise: Latent forces and noise of table and channels.
        step_s: Sampling step [s].
        steady: Its filter.
    """
    states, estimated, measured = len(system.rate), system.estimated, np.isfinite(noise.channel)
    part, inner = system.part(estimated), np.ix_(measured, measured)
    output, gain = part.output[measured], steady.gain[np.ix_(estimated, measured)]
    step = steady.step[np.ix_(estimated, estimated)]
    driven = [
        discretise(part.rate, noise_density(states, one)[estimated], step_s)[1]
        for one in (replace(noise, table=0.0), replace(noise, latent=0.0 * noise.latent))
    ]
    shares = np.zeros((2 + len(output), len(output), len(output)))
    for c, sigma in enumerate(noise.channel[measured]):
        shares[2 + c, c, c] = 2.0 * sigma**2
    through = step @ gain
    pushed = through @ shares @ through.T
    pushed[:2] += 2.0 * np.array(driven)
    kept = np.eye(estimated.sum()) - gain @ output
    predicted = _lyapunov(step @ kept, pushed)
    slopes = output @ predicted @ output.T + shares
    found = FilterSlopes(
        np.zeros((len(shares), states, len(measured))), np.zeros((len(shares), len(measured), len(measured)))
    )
    inverse = np.linalg.inv(steady.covariance[inner])
    by_gain = (kept @ predicted @ output.T - gain @ shares) @ inverse
    for number, (one, slope) in enumerate(zip(by_gain, slopes, strict=True)):
        found.gain[number][np.ix_(estimated, measured)] = one
        found.covariance[number][inner] = slope
    return found


def _lyapunov(step: np.ndarray, pushed: np.ndarray) -> np.ndarray:
    """Return the steady covariances of a stable system under pushes, each (pushes, states, states); NaN where not stable."""
    whole = pushed
    for _ in range(DOUBLINGS):
        more = step @ whole @ step.T
        whole, step = whole + more, step @ step
        if np.abs(more).max() <= 1e-12 * np.abs(whole).max():
            return np.asarray(whole)
    return np.full_like(pushed, np.nan)


def noise_density(states: int, noise: Noise) -> np.ndarray:
    """Return the spectral density of the white noise that drives each state, shape (states,)."""
    storeys = len(noise.latent)
    density = np.zeros(states)
    density[states - 3 - storeys : states - 3] = 2 * LATENT_RATE * noise.latent**2
    density[states - 3] = 2 * TABLE_NOISE_RATE * noise.table**2
    # A table channel that is a little off its zero drifts away when integrated twice.
    density[states - 1] = 1e-12 + 1e-4 * noise.table**2
    return density


def discretise(rate: np.ndarray, density: np.ndarray, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return transition and noise covariance over a step, each (states, states) (Van Loan 1978).

    Args:
        rate: Rate matrix A of the states [1/s], shape (states, states).
        density: Spectral density of the white noise that drives each state, shape (states,).
        step_s: The step [s].
    """
    n = len(rate)
    # Halved until the matrix is small, then doubled: exp of a stiff, lightly damped system stays accurate.
    block = np.zeros((2 * n, 2 * n))
    block[:n, :n], block[:n, n:], block[n:, n:] = -rate, np.diag(density), rate.T
    halvings = 4
    exponential = expm(block * step_s / 2**halvings)
    step = exponential[n:, n:].T
    covariance = step @ exponential[:n, n:]
    for _ in range(halvings):
        covariance = covariance + step @ covariance @ step.T
        step = step @ step
    return step, (covariance + covariance.T) / 2


def _first_order_hold(rate: np.ndarray, force: np.ndarray, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the responses to a force at the start and at the end of a step, linear in between."""
    n, m = force.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n], block[:n, n : n + m] = rate * step_s, force * step_s
    block[n : n + m, n + m :] = np.eye(m)
    exponential = expm(block)
    held, ramp = exponential[:n, n : n + m], exponential[:n, n + m :]
    return held - ramp, ramp


DOUBLINGS = 60
"""Doublings after which what has not become steady never will."""
LEAST = (1e-12, 1e-9, 1e-6)
"""Covariances that every state has at least, over what drives the driven ones, tried in turn: what nothing drives, and noisy
channels hardly see, has no steady covariance to many digits."""


def _riccati(step: np.ndarray, output: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Return the steady predicted covariance for unit measurement noise, shape (states, states).

    Raises:
        CaseError: There is none.
    """
    # States of very different size (metres, newtons) spoil the solver, so each is scaled to about one.
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-30))
    n = len(step)
    scaled_step = step * size[None, :] / size[:, None]
    scaled_covariance = covariance / np.outer(size, size)
    scaled_output = output * size
    for least in LEAST:
        solution = _doubling(scaled_step, scaled_output, scaled_covariance + least * np.eye(n))
        if solution is not None:
            return np.asarray(solution * np.outer(size, size))
    raise CaseError(
        "no filter follows from the noise of the channels, which is far too large or too small beside their motion; "
        "check the channels' units in case.toml"
    )


def _doubling(step: np.ndarray, output: np.ndarray, covariance: np.ndarray) -> np.ndarray | None:
    """Solve the Riccati equation by structure-preserving doubling (Chu, Fan, Lin and Wang 2004).

    It costs a third of an ordered QZ decomposition, less for many states. None is returned where it does not converge.
    """
    a, g, h = step.T.copy(), output.T @ output, covariance.copy()
    n = len(step)
    identity = np.eye(n)
    for _ in range(DOUBLINGS):
        solved = np.linalg.solve(identity + g @ h, np.hstack([a, g @ a.T]))
        by_a, by_g = solved[:, :n], solved[:, n:]
        new_h = h + a.T @ (h @ by_a)
        g = g + a @ by_g
        a = a @ by_a
        change, h = np.abs(new_h - h).max(), new_h
        if not np.isfinite(change):
            return None
        if change <= 1e-12 * np.abs(h).max():
            return np.asarray((h + h.T) / 2)
    return None
