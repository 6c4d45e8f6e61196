"""Exact response of a linear frame to an acceleration that runs straight between its samples.

Every mode is one complex first-order equation ``z' = rate z + load a(t)``, whose solution over a step with a
linear ``a`` is a closed formula (the piecewise exact method: Nigam and Jennings, BSSA 59(2), 1969; Chopra,
*Dynamics of Structures*, section 5.2). The recursion over the samples is a digital filter of first order, so
it costs microseconds a mode. There is no integration error at the samples, whatever the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eig, inv, solve

from pounding.frames.errors import FrameError

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]
Complex = NDArray[np.complexfloating[Any, Any]]

NEGLIGIBLE = 1e-13
"""A pole with less than this share of the largest pole's part in the response is round-off, not motion."""

ROUND_OFF = 1e-9
"""Share of a matrix's largest entry up to which two matrices are the same."""

DEFECTIVE = 1e12
"""Condition number of the eigenvectors above which a critically damped mode makes the poles useless."""


@dataclass(frozen=True)
class Poles:
    """A linear frame as uncoupled complex equations, one for each conjugate pair of poles.

    With the frame's displacement ``u`` and velocity ``v`` relative to the table:
    ``z = from_displacement @ u + from_velocity @ v``, ``u = Re(z @ output)``, ``v = Re(rates z @ output)``.

    Attributes:
        rates: Poles with a non-negative imaginary part (p,) [1/s].
        from_displacement: State of each pole for a unit displacement (p, n).
        from_velocity: State of each pole for a unit velocity (p, n).
        output: Displacement for a unit state of each pole (p, n).
        influence: Displacement under a unit translation of the table (n,) [1].
    """

    rates: Complex
    from_displacement: Complex
    from_velocity: Complex
    output: Complex
    influence: Real

    @property
    def load(self) -> Complex:
        """Load of a unit acceleration of the table on each pole (p,)."""
        return -self.from_velocity @ self.influence


def poles(reduced: ReducedFrame) -> Poles:
    """Return the poles of a reduced frame.

    Modal damping leaves the modes uncoupled, and the poles follow from frequencies and ratios. Any other
    damping matrix is taken as it is, through the eigenvalues of the state matrix; so is a stiffness of which the
    frame's modes are not those, because somebody changed the matrix alone.

    Raises:
        FrameError: A mode is critically damped or free, so that the poles do not span the motion.
    """
    modal = reduced.shapes.T @ reduced.damping @ reduced.shapes
    rate = np.diag(modal) / 2.0
    circular = 2.0 * np.pi * reduced.frequencies_hz
    springs = reduced.shapes.T @ reduced.stiffness @ reduced.shapes
    coupled = _differ(modal, np.diag(np.diag(modal))) or _differ(springs, np.diag(circular**2))
    if coupled or np.any(rate >= circular):
        return state_poles(reduced.mass, reduced.damping, reduced.stiffness, reduced.influence)
    return modal_poles(circular, rate / circular, reduced.shapes, reduced.mass, reduced.influence)


def _differ(one: Real, other: Real) -> bool:
    return bool(np.abs(one - other).max(initial=0.0) > ROUND_OFF * np.abs(one).max(initial=0.0))


def modal_poles(circular: ArrayLike, ratios: ArrayLike, shapes: Real, mass: Real, influence: Real) -> Poles:
    """Return the poles of modes with a damping ratio each.

    Args:
        circular: Circular frequencies (p,) [rad/s].
        ratios: Damping ratios as fractions, below 1; a scalar or (p,).
        shapes: Mass-normalised mode shapes (n, p).
        mass: Mass matrix (n, n) [kg].
        influence: Displacement under a unit translation of the table (n,).
    """
    circular, ratios = np.asarray(circular, float), np.asarray(ratios, float)
    rates, damped = _underdamped(circular, ratios * np.ones_like(circular))
    rows = shapes.T @ mass
    return Poles(
        rates,
        -rates.conj()[:, None] * rows,
        rows.astype(np.complex128),
        -1j / damped[:, None] * shapes.T,
        influence,
    )


def state_poles(mass: Real, damping: Real, stiffness: Real, influence: Real) -> Poles:
    """Return the poles of ``M u'' + C u' + K u = -M r a`` with any damping matrix, all (n, n).

    Args:
        mass: Mass (n, n) [kg].
        damping: Damping (n, n) [N s/m].
        stiffness: Stiffness (n, n) [N/m].
        influence: Coordinates' motion under a unit translation of the table (n,) [-].

    Raises:
        FrameError: Two poles coincide without two motions (critical damping).
    """
    n = len(mass)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-solve(mass, stiffness), -solve(mass, damping)]])
    rates, vectors = eig(state)
    if np.linalg.cond(vectors / np.linalg.norm(vectors, axis=0)) > DEFECTIVE:
        raise FrameError("damping matrix: a mode is critically damped and its poles coincide")
    keep = rates.imag >= 0.0
    pairs = np.where(rates[keep].imag > 0.0, 2.0, 1.0)
    left = inv(vectors)[keep]
    return Poles(rates[keep], left[:, :n], left[:, n:], pairs[:, None] * vectors[:n, keep].T, influence)


def linear_response(
    reduced: ReducedFrame, acceleration: ArrayLike, dt_s: float, *, outputs: ArrayLike | None = None
) -> tuple[Real, Real]:
    """Return the response of a frame at rest to an acceleration of its table, exact at every sample.

    Args:
        reduced: The frame.
        acceleration: Acceleration of the table (m,) [m/s^2], linear between samples.
        dt_s: Sample step [s].
        outputs: Coordinates wanted, as indices (k,), or as rows (k, n) that combine coordinates, such as
            ``reduced.point_row(floor, y_m)``; all coordinates when None.

    Returns:
        Displacement (m, k) [m] and velocity (m, k) [m/s] relative to the table; k is n when outputs is None.

    Raises:
        FrameError: Fewer than two samples, a sample that is not finite, or a step that is not positive.
    """
    return forced(poles(reduced), acceleration, dt_s, outputs=outputs)


def forced(
    frame: Poles, acceleration: ArrayLike, dt_s: float, *, outputs: ArrayLike | None = None
) -> tuple[Real, Real]:
    """Return displacement [m] and velocity [m/s] as `linear_response` does, of poles that are at hand already.

    Args:
        frame: Poles of the frame.
        acceleration: Acceleration of the table (m,) [m/s^2], linear between samples.
        dt_s: Sample step [s].
        outputs: Coordinates wanted (k,), or rows (k, n) that combine coordinates; all coordinates when None.
    """
    acceleration = checked(acceleration, dt_s)
    weights = frame.load[:, None] * select(frame.output, outputs)
    part = np.abs(weights).max(axis=1, initial=0.0)
    moving = part > NEGLIGIBLE * part.max(initial=0.0)
    rates, weights = frame.rates[moving], weights[moving]
    states = run(rates, acceleration, dt_s)
    return _real_product(states, weights), _real_product(states, rates[:, None] * weights)


def free_response(
    reduced: ReducedFrame,
    displacement: ArrayLike,
    velocity: ArrayLike,
    times_s: ArrayLike,
    *,
    outputs: ArrayLike | None = None,
) -> tuple[Real, Real]:
    """Return the free vibration of a frame let go at time zero on a table at rest.

    Args:
        reduced: The frame.
        displacement: Displacement at time zero (n,) [m], relative to the table.
        velocity: Velocity at time zero (n,) [m/s].
        times_s: Times wanted (m,) [s].
        outputs: Coordinates wanted (k,) or rows (k, n), as in `linear_response`.

    Returns:
        Displacement (m, k) [m] and velocity (m, k) [m/s] relative to the table.
    """
    frame = poles(reduced)
    start = frame.from_displacement @ np.asarray(displacement) + frame.from_velocity @ np.asarray(velocity)
    states = np.exp(np.multiply.outer(np.asarray(times_s, float), frame.rates)).T
    weights = start[:, None] * select(frame.output, outputs)
    return _real_product(states, weights), _real_product(states, frame.rates[:, None] * weights)


def absolute_acceleration(reduced: ReducedFrame, displacement: Real, velocity: Real) -> Real:
    """Return the accelerations in the room (m, n) [m/s^2] that go with a linear response.

    Args:
        reduced: The frame.
        displacement: All coordinates (m, n) [m], relative to the table.
        velocity: All coordinates (m, n) [m/s].
    """
    force = displacement @ reduced.stiffness + velocity @ reduced.damping
    return np.asarray(-solve(reduced.mass, force.T, assume_a="pos").T)


class Peaks(NamedTuple):
    """Largest and smallest values of a response, one pair a case."""

    maximum: Real
    minimum: Real

    @property
    def absolute(self) -> Real:
        """The larger of the two magnitudes, one a case, of their shape."""
        return np.maximum(self.maximum, -self.minimum)


def oscillator_peaks(
    frequencies_hz: ArrayLike,
    ratios: ArrayLike,
    acceleration: ArrayLike,
    dt_s: float,
    *,
    points_per_period: int = 40,
) -> Peaks:
    """Return the peak displacements [m] of single oscillators, for response spectra and many cases.

    Args:
        frequencies_hz: Undamped natural frequencies [Hz], of any shape.
        ratios: Damping ratios [-], below 1; broadcast against the frequencies.
        acceleration: Acceleration of the base (m,) [m/s^2].
        dt_s: Sample step [s].
        points_per_period: The response is evaluated at so many instants a natural period at least. A peak
            that falls between two of N instants is missed by at most ``1 - cos(pi / N)``: 0.3 % for 40.

    Returns:
        Maximum and minimum relative displacement, of the broadcast shape.

    Raises:
        FrameError: As `linear_response`, and for a frequency or ratio out of range.
    """
    acceleration = checked(acceleration, dt_s)
    frequencies, ratios = np.broadcast_arrays(np.asarray(frequencies_hz, float), np.asarray(ratios, float))
    rates, damped = _underdamped(2.0 * np.pi * frequencies.ravel(), ratios.ravel())
    maximum, minimum = np.empty(rates.shape), np.empty(rates.shape)
    factors = np.ceil(points_per_period * frequencies.ravel() * dt_s).astype(int).clip(1)
    for factor in np.unique(factors):
        finer = refine(acceleration, factor)
        for index in np.flatnonzero(factors == factor):
            # The load on z is -a and the displacement is Im(z) / damped.
            motion = run(rates[index : index + 1], finer, dt_s / factor)[0].imag / -damped[index]
            maximum[index], minimum[index] = motion.max(), motion.min()
    return Peaks(maximum.reshape(frequencies.shape), minimum.reshape(frequencies.shape))


def refine(acceleration: Real, factor: int) -> Real:
    """Return a piecewise linear history at ``factor`` times as many steps [m/s^2]; the history is the same.

    Args:
        acceleration: Samples (m,) [m/s^2].
        factor: Number of parts of a step.
    """
    if factor == 1:
        return acceleration
    samples = len(acceleration)
    return np.interp(np.arange((samples - 1) * factor + 1) / factor, np.arange(samples), acceleration)


def run(rates: Complex, history: Real, dt_s: float) -> Complex:
    """Return the states (p, m) of ``z' = rate z + history(t)``, ``z(0) = 0``, linear between samples.

    Args:
        rates: Poles (p,) [1/s].
        history: Samples (m,) of the right side.
        dt_s: Sample step [s].
    """
    from scipy.signal import lfilter  # only here: importing it takes longer than a frame's modes

    step = rates * dt_s
    growth = np.exp(step)
    mean = np.expm1(step) / step
    late = (mean - 1.0) / step
    states = np.empty((len(rates), len(history)), complex)
    for index in range(len(rates)):
        now, before = dt_s * late[index], dt_s * (mean[index] - late[index])
        # The filter's own start would count the first sample as a step already done: take it out.
        start = np.array([-now * history[0]])
        states[index], _ = lfilter([now, before], [1.0, -growth[index]], history, zi=start)
    return states


def checked(acceleration: ArrayLike, dt_s: float) -> Real:
    """Return an acceleration history as an array (m,) [m/s^2].

    Args:
        acceleration: Acceleration (m,) [m/s^2].
        dt_s: Sample step [s].

    Raises:
        FrameError: It has fewer than two samples or one that is not finite, or its step is not positive.
    """
    history = np.asarray(acceleration, float)
    if history.ndim != 1 or history.size < 2:
        raise FrameError(f"acceleration: shape {history.shape}, needs at least two samples in one row")
    if not np.isfinite(history).all():
        first = int(np.flatnonzero(~np.isfinite(history))[0])
        raise FrameError(f"acceleration: sample {first} is {history[first]}; remove or interpolate it first")
    if not (np.isfinite(dt_s) and dt_s > 0.0):
        raise FrameError(f"acceleration: step {dt_s} s, must be positive")
    return history


def select(output: Complex, outputs: ArrayLike | None) -> Complex:
    """Return the columns of (p, n) for indices (k,), or their combinations for rows (k, n)."""
    if outputs is None:
        return output
    wanted = np.asarray(outputs)
    return output @ wanted.T if wanted.ndim == 2 else output[:, wanted]


def _underdamped(circular: Real, ratios: Real) -> tuple[Complex, Real]:
    if not (np.all(circular > 0.0) and np.all((ratios >= 0.0) & (ratios < 1.0))):
        raise FrameError("oscillator: frequencies must be positive and damping ratios at least 0 and below 1")
    damped = circular * np.sqrt(1.0 - ratios**2)
    return -ratios * circular + 1j * damped, damped


def _real_product(states: Complex, weights: Complex) -> Real:
    """Return Re(states^T weights) without the products that do not count."""
    return states.real.T @ weights.real - states.imag.T @ weights.imag
