"""The force that each storey has beyond a model: a smoother with a latent force in every storey.

The latent forces' sizes are found from the data by expectation and maximisation (Shumway and Stoffer 1982), so that a
storey in which nothing is left over gives its share to the one where something is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.kalman import (
    LinearSystem,
    Noise,
    SteadyFilter,
    discretise,
    noise_density,
)
from pounding.diagnosis.model.model import Model

FIRST_LEVEL = 0.1
ROUNDS = 16
LEAST_LEVEL = 1e-4
"""Latent forces to start from as a share of each storey's shear, rounds of estimating their size, and the least."""


@dataclass(frozen=True)
class ResidualForce:
    """The force that a storey has beyond the calibrated model's, in one run.

    Attributes:
        run: Name of the run. time_s: Times (samples,). force: (samples, storeys) [N]. std: (storeys,) [N].
        drift, drift_rate: (samples, storeys) [m], [m/s].
        noise: The noise and the latent forces' sizes that the smoother used.
    """

    run: str
    time_s: np.ndarray
    force: np.ndarray
    std: np.ndarray
    drift: np.ndarray
    drift_rate: np.ndarray
    noise: Noise


def residual_force(model: Model, filtered: Filtered, run: int, noise: Noise | None = None) -> ResidualForce:
    """Return the residual force of every storey in a run, from all of the run's measurements.

    Args:
        model: The baseline model.
        filtered: The model: its nuisance parameters and effects.
        run: Number of the run.
        noise: Noise and the latent forces' sizes where they are known; else these sizes are found from the run.
    """
    data = model.observed.runs[run]
    if noise is None:
        noise = _found(model, filtered, run)
    found, states, spread, latent = _smoothed_run(model, filtered, run, noise)
    modes = len(found.modes.omega)
    rows = model.structure.drift @ found.modes.floors
    return ResidualForce(
        run=data.name,
        time_s=data.time_s,
        # A latent force pushes along the drift; what a storey has beyond the model opposes it.
        force=-states[:, latent],
        std=spread[latent],
        drift=states[:, :modes] @ rows.T,
        drift_rate=states[:, modes : 2 * modes] @ rows.T,
        noise=noise,
    )


def _found(model: Model, filtered: Filtered, run: int) -> Noise:
    """Return the noise of a run with the latent forces' sizes as its measurements ask for them."""
    (noise,) = starting_noise(model, [run], FIRST_LEVEL)
    # Noise that the fit has found in this run is better than that of the spectrum alone.
    if run in filtered.runs:
        known = filtered.noise[filtered.runs.index(run)]
        noise = replace(noise, table=known.table)
    least = LEAST_LEVEL / FIRST_LEVEL * noise.latent
    for _ in range(ROUNDS - 1):
        _, states, spread, latent = _smoothed_run(model, filtered, run, noise)
        size = np.sqrt(np.mean(states[:, latent] ** 2, axis=0) + spread[latent] ** 2)
        noise = replace(noise, latent=np.maximum(size, least))
    return noise


def _smoothed_run(
    model: Model, filtered: Filtered, run: int, noise: Noise
) -> tuple[Filtered, np.ndarray, np.ndarray, slice]:
    """Return a run as filtered, its smoothed states and their standard deviations, and where the latent forces are."""
    found = run_filter(model, filtered.values, [noise], [run], filtered.effects)
    step_s = model.observed.runs[run].step_s
    states, spread = smoothed(model.linear_system(found.modes), found, noise, step_s)
    first = 2 * len(found.modes.omega)
    return found, states, spread, slice(first, first + len(noise.latent))


def smoothed(
    system: LinearSystem, filtered: Filtered, noise: Noise, step_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the states of a run given all its samples (samples, states), and their standard deviations (states,).

    The backward pass of Rauch, Tung and Striebel (1965) with the filter's steady covariance.

    Args:
        system: The linear system of the model.
        filtered: The filtered model of one run.
        noise: Noise of the run.
        step_s: Sampling step [s].
    """
    steady, prediction = filtered.filters[0], filtered.prediction
    before, after = prediction.before[0], prediction.after[0]
    predicted, updated = _covariances(system, steady, noise, step_s)
    size = np.sqrt(np.maximum(np.diag(predicted), 1e-30))
    scaled = predicted / np.outer(size, size)
    # C = P_filtered A' P_predicted^-1, each state scaled to about one: metres and newtons stand side by side.
    gain = np.linalg.solve(scaled, (steady.step @ updated / size[:, None]) / size[None, :]).T
    gain = gain * size[:, None] / size[None, :]
    states = after.copy()
    for k in range(len(states) - 2, -1, -1):
        states[k] += gain @ (states[k + 1] - before[k + 1])
    covariance = solve_discrete_lyapunov(gain, updated - gain @ predicted @ gain.T)
    return states, np.sqrt(np.maximum(np.diag(covariance), 0.0))


def _covariances(
    system: LinearSystem, steady: SteadyFilter, noise: Noise, step_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the steady covariance of the states before and after a sample, from the filter's own gain.

    Joseph's form, a Lyapunov equation: it stays positive where the Riccati solution is a small difference.
    """
    measured = np.isfinite(noise.channel)
    gain, output = steady.gain[:, measured], steady.output[measured]
    left = np.eye(len(steady.step)) - gain @ output
    step, driven = discretise(system.rate, noise_density(len(steady.step), noise), step_s)
    seen = gain @ np.diag(noise.channel[measured] ** 2) @ gain.T
    predicted = solve_discrete_lyapunov(step @ left, step @ seen @ step.T + driven)
    return predicted, left @ predicted @ left.T + seen
