"""How far the yield force of another law may be from that of ours, by how far a storey drifts beyond yielding.

A part of a storey yields by the law of Menegotto and Pinto (1973) with the constants of Filippou, Popov and Bertero (1983;
R0 = 20, cR1 = 0.925, cR2 = 0.15), and with R0 = 10, the other end of what OpenSees recommends for Steel02. It follows drifts
of narrow bands that grow for three seconds and go on for five. Our law is fitted to what that force lacks of an elastic one,
without noise and without what is slower than 1 Hz, which accelerometers do not see: yield force, stiffness, sharpness of
the knee and how it unloads. The last column is the error of the yield force over the standard error that is stated for the
law (`pounding.diagnosis.effects.storey`).

    python -m tests.benchmarks.yield_forces
"""

from __future__ import annotations

from itertools import product

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.optimize import differential_evolution
from scipy.signal import butter, sosfilt, sosfiltfilt

from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.storey_forces import yielding
from tests.planar_world.laws import STATES, yielding_force

FORCE_N, STIFFNESS_N_PER_M, HARDENING = 150.0, 1e5, 0.015
ROUNDNESS = {"20": (20.0, 18.5, 0.15), "10": (10.0, 9.25, 0.15)}
"""R0, R0 cR1 and cR2 by R0."""
STEP_S, SAMPLES, FINER = 0.002, 4000, 2
DUCTILITIES, SEEDS = (1.0, 1.5, 2.2, 4.0, 8.0), range(4)
BOUNDS = [(-2.0, 1.0), (-2.0, 1.0), (-2.0, 1.3), (0.0, 1.0)]
"""Of the logarithms of force, stiffness and sharpness (8 at zero), and of how it unloads."""


def drifts(ductility: float, rng: np.random.Generator) -> np.ndarray:
    """Return a drift that grows and then goes on, its largest being so many yield drifts, (samples x FINER,) [m]."""
    centre = rng.uniform(2.0, 6.0)
    band = butter(2, [0.8 * centre, 1.25 * centre], "bandpass", fs=1 / STEP_S, output="sos")
    swings = sosfilt(band, rng.standard_normal(SAMPLES)) * np.minimum(np.arange(SAMPLES) * STEP_S / 3.0, 1.0)
    swings *= ductility * FORCE_N / STIFFNESS_N_PER_M / np.abs(swings).max()
    return np.interp(np.arange(SAMPLES * FINER) / FINER, np.arange(SAMPLES), swings)


def found(drift: np.ndarray, roundness: tuple[float, float, float]) -> tuple[float, float]:
    """Return yield force and stiffness of our law nearest to the other one's force, each over the other one's.

    Args:
        drift: As of `drifts` (samples x FINER,) [m].
        roundness: R0, R0 cR1 and cR2 of the other law [-].
    """
    step = STEP_S / FINER
    slow = butter(2, 1.0, "highpass", fs=1 / STEP_S, output="sos")
    memory, values = np.zeros(STATES), np.array([FORCE_N, STIFFNESS_N_PER_M, HARDENING, *roundness])
    theirs = np.array([yielding_force(one, values, memory) for one in drift])
    seen = sosfiltfilt(slow, theirs[::FINER])
    rate, time = np.gradient(drift, step), np.arange(len(drift)) * step

    def left(theta: np.ndarray) -> float:
        force, stiffness, sharpness = np.exp(theta[:3]) * [FORCE_N, STIFFNESS_N_PER_M, 8.0]
        ours = np.asarray(yielding.along((force, stiffness, sharpness, theta[3]), drift, rate, time))
        return float(np.mean((sosfiltfilt(slow, ours[::FINER]) - seen) ** 2))

    best = differential_evolution(left, BOUNDS, maxiter=30, popsize=10, seed=1, tol=1e-6).x
    return float(np.exp(best[0])), float(np.exp(best[1]))


def main() -> None:
    """Print what is found of the yield force, and the error over the standard error that is stated for the law."""
    ours = SETTINGS.refinement
    table = Table(
        "R0", "ductility", "as found", "yield force / true", "yield drift / true", "error / law error"
    )
    for (name, roundness), ductility in product(ROUNDNESS.items(), DUCTILITIES):
        moved = [drifts(ductility, np.random.default_rng(seed)) for seed in SEEDS]
        force, stiffness = np.array([found(drift, roundness) for drift in moved]).T
        as_found = ductility * stiffness / force
        stated = np.hypot(ours.law_error_of_yielding, ours.law_error_of_knee / as_found)
        shown = (as_found, force, force / stiffness, (1.0 / force - 1.0) / stated)
        table.add_row(name, f"{ductility:g}", *(f"{one.min():.2f} to {one.max():.2f}" for one in shown))
    Console().print(table)


if __name__ == "__main__":
    main()
