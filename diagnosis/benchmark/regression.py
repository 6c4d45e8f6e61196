"""A storey-wise sparse regression with BIC: the residual force of each storey against a library of terms.

What most people would write first (Brunton, Proctor and Kutz 2016, PNAS 113(15), applied storey by storey):
drift and rate from the measured motion, inertia forces from the accelerations, sequentially thresholded least
squares over a library, and the model with the best Bayesian information criterion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt

from pounding import frames
from pounding.diagnosis.benchmark.methods import report_of_method
from pounding.diagnosis.case.case import Case, CaseFrame, Run
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.decision.claims import Claim, Place, claim, parameter
from pounding.diagnosis.report.report import Report
from pounding.extras import extra_module

LOWEST = 0.4
"""Of the first frequency: below, twice integrated accelerometers show their noise and little else."""

HIGHEST_HZ = 60.0
THRESHOLDS = np.geomspace(0.01, 0.5, 12)
"""Of the sequentially thresholded least squares; columns and force have unit root mean square."""

SURE = 10.0
"""Gain in BIC from which a term counts as very strong evidence (Kass and Raftery 1995)."""

FAR_OFF = 0.1
"""Relative change of a storey's stiffness that no calibration is trusted to explain."""

ALWAYS = 2
"""Terms that every model has, so that it is calibrated: the storey's drift and its rate."""

LIBRARY = {
    "stiffness_change": "relative_change",
    "damping_change": "damping",
    "coulomb_friction": "friction_force",
    "cubic_stiffness": "cubic_stiffness",
    "air_drag": "coefficient",
    "loosening": "final_relative_change",
    "bumper": "stiffness",
}
"""The effects that a term of the library can stand for, each with the parameter that the term's factor is."""


Optimiser = Callable[[np.ndarray, np.ndarray, float, int], np.ndarray]


@dataclass(frozen=True)
class Storey:
    """The library of one storey: columns (samples, terms), residual force (samples,), columns' effects."""

    frame: str
    number: int
    columns: np.ndarray
    force: np.ndarray
    effects: tuple[str, ...]


def sparse_regression(folder: Path, optimiser: Optimiser | None = None) -> Report:
    """Report on a case by sparse regression, without a confidence and misfits.

    Args:
        folder: The case.
        optimiser: `thresholded`, our own, when None; or `thresholded_by_pysindy`.

    Raises:
        CaseError: The case cannot be read.
    """
    case = read_case(folder)
    storeys = [storey for frame in case.frames for storey in _storeys(case, frame)]
    claims = sorted(
        (claim for storey in storeys for claim in _claims(storey, optimiser or thresholded)),
        key=lambda one: -one.log_evidence,
    )
    return report_of_method(claims[:1], claims)


def best_model(
    columns: np.ndarray, force: np.ndarray, always: int = 0, optimiser: Optimiser | None = None
) -> tuple[float, np.ndarray]:
    """Return the gain in BIC of the best sparse model over the terms that are always in, and its factors, (terms,).

    Args:
        columns: Terms, shape (samples, terms).
        force: What they shall explain, shape (samples,).
        always: So many terms, the first, are in every model.
        optimiser: Finds the factors at a threshold; `thresholded` when None.
    """
    optimiser = optimiser or thresholded
    scale = columns.std(axis=0)
    scale[scale == 0] = 1.0
    unit, size = columns / scale, float(force.std()) or 1.0
    plain = thresholded(unit, force / size, np.inf, always)
    least = best_bic = _bic(unit, force / size, plain)
    best = plain
    for threshold in THRESHOLDS:
        factors = optimiser(unit, force / size, threshold, always)
        bic = _bic(unit, force / size, factors)
        if bic < best_bic:
            best_bic, best = bic, factors
    return least - best_bic, best * size / scale


def _bic(columns: np.ndarray, target: np.ndarray, factors: np.ndarray) -> float:
    left = target - columns @ factors
    samples = len(target)
    return float(samples * np.log(left @ left / samples) + np.count_nonzero(factors) * np.log(samples))


def thresholded(columns: np.ndarray, target: np.ndarray, threshold: float, always: int = 0) -> np.ndarray:
    """Return factors of sequentially thresholded least squares, shape (terms,): fit, drop what is small, fit again.

    Args:
        columns: Terms of the model at each sample, shape (samples, terms).
        target: What they are fitted to, shape (samples,).
        threshold: Factors below it are dropped.
        always: Number of first terms that are never dropped.
    """
    kept = np.ones(columns.shape[1], bool)
    held = np.arange(columns.shape[1]) < always
    factors = np.zeros(columns.shape[1])
    while kept.any():
        factors[:] = 0.0
        factors[kept] = np.linalg.lstsq(columns[:, kept], target, rcond=None)[0]
        small = kept & ~held & (np.abs(factors) < threshold)
        if not small.any():
            break
        kept &= ~small
    return factors


def thresholded_by_pysindy(
    columns: np.ndarray, target: np.ndarray, threshold: float, always: int = 0
) -> np.ndarray:
    """Return the same factors, shape (terms,), by the STLSQ of pysindy; what is never dropped is taken out first.

    Args:
        columns: Terms of the model at each sample, shape (samples, terms).
        target: What they are fitted to, shape (samples,).
        threshold: Factors below it are dropped.
        always: Number of first terms that are never dropped.

    Raises:
        MissingExtraError: pysindy is not installed.
    """
    stlsq = extra_module("pysindy.optimizers").STLSQ
    base = columns[:, :always]
    known = np.linalg.lstsq(base, np.column_stack([columns[:, always:], target]), rcond=None)[0]
    left = np.column_stack([columns[:, always:], target]) - base @ known
    optimiser = stlsq(threshold=threshold, alpha=0.0)
    found = np.ravel(optimiser.fit(left[:, :-1], left[:, -1:]).coef_)
    return np.concatenate([known[:, -1] - known[:, :-1] @ found, found])


def _claims(storey: Storey, optimiser: Optimiser) -> list[Claim]:
    """Return what a storey's best model says: its strongest term, or its stiffness where that is far off."""
    gain, factors = best_model(storey.columns, storey.force, ALWAYS, optimiser)
    if gain > SURE:
        strength = np.abs(factors) * storey.columns.std(axis=0)
        term = ALWAYS + int(np.argmax(strength[ALWAYS:]))
        return [_claim(storey, term, float(factors[term]), gain)]
    return [_claim(storey, 0, float(factors[0]), 0.0)] if abs(factors[0]) > FAR_OFF else []


def _claim(storey: Storey, term: int, factor: float, gain: float) -> Claim:
    effect = storey.effects[term]
    number = None if effect == "air_drag" else storey.number
    place = Place(effect=effect, frame=storey.frame, storey=number)
    return claim(place, [parameter(LIBRARY[effect], factor, None, "")], gain / 2)


def _storeys(case: Case, frame: CaseFrame) -> list[Storey]:
    """Return the library of every storey of a frame, over the training runs."""
    reduced = frames.build(frames.load(frame.file or frame.name))
    masses, stiffness, dampers = reduced.storey_model()
    band_hz = LOWEST * float(reduced.frequencies_hz[0]), HIGHEST_HZ
    parts = [_motion(case, frame, run, band_hz) for run in case.split()[0]]
    storeys = []
    for index in range(frame.storeys):
        blocks, forces = [], []
        for displacement, velocity, acceleration, absolute in parts:
            left = masses @ acceleration + stiffness @ displacement + dampers @ velocity
            # The residual forces of the floors above are what the storey did not carry.
            forces.append(-left[index:].sum(axis=0))
            below = np.zeros_like(displacement[0])
            drift = displacement[index] - (displacement[index - 1] if index else below)
            rate = velocity[index] - (velocity[index - 1] if index else below)
            blocks.append(_terms(drift, rate, absolute[index]))
        columns = np.concatenate(blocks)
        columns[:, 0] *= -stiffness[index, index - 1] if index else stiffness[0, :2].sum()
        columns[:, 5] *= -stiffness[index, index - 1] if index else stiffness[0, :2].sum()
        storeys.append(Storey(frame.name, index + 1, columns, np.concatenate(forces), _NAMES))
    return storeys


_NAMES = (
    "stiffness_change",
    "damping_change",
    "coulomb_friction",
    "cubic_stiffness",
    "air_drag",
    "loosening",
    "bumper",
    "bumper",
)


def _terms(drift: np.ndarray, rate: np.ndarray, absolute: np.ndarray) -> np.ndarray:
    time = np.linspace(0.0, 1.0, len(drift))
    half = 0.5 * np.abs(drift).max()
    return np.column_stack(
        [
            drift,
            rate,
            np.sign(rate),
            drift**3,
            absolute * np.abs(absolute),
            time * drift,
            np.maximum(drift - half, 0.0),
            np.minimum(drift + half, 0.0),
        ]
    )


def _motion(
    case: Case, frame: CaseFrame, run: Run, band_hz: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return all floors' displacement, velocity, room acceleration and room velocity, (storeys, samples)."""
    table = next(c for c, channel in enumerate(case.channels) if channel.quantity == "table_acceleration")
    ground = _filled(run.values[:, table])
    floors, rows = [0], [np.zeros_like(ground)]
    for column, channel in enumerate(case.channels):
        if channel.frame == frame.name and channel.quantity == "absolute_acceleration" and channel.floor:
            floors.append(channel.floor)
            rows.append(_filled(run.values[:, column]) - ground)
    # Floors without an accelerometer lie on a smooth line through the others.
    relative = (
        CubicSpline(np.array(floors), np.array(rows))(np.arange(1, frame.storeys + 1))
        if len(floors) > 2
        else np.outer(np.arange(1, frame.storeys + 1) / floors[-1], rows[-1])
    )
    sections = butter(4, [2 * run.step_s * hz for hz in band_hz], "bandpass", output="sos")
    velocity = _integrated(sections, relative, run.step_s)
    displacement = _integrated(sections, velocity, run.step_s)
    acceleration = sosfiltfilt(sections, relative + ground)
    absolute = velocity + _integrated(sections, ground[None, :], run.step_s)
    return displacement, velocity, acceleration, absolute


def _integrated(sections: np.ndarray, values: np.ndarray, step_s: float) -> np.ndarray:
    return np.asarray(sosfiltfilt(sections, cumulative_trapezoid(values, dx=step_s, axis=1, initial=0.0)))


def _filled(values: np.ndarray) -> np.ndarray:
    good = ~np.isnan(values)
    return np.interp(np.arange(len(values)), np.flatnonzero(good), values[good]) if good.any() else 0 * values
