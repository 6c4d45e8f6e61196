"""The single changes that table_4_1_missing tries, each with the values of its one parameter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import bilinear, butter, lfilter, sosfilt

from pounding.experiments.records import Record
from pounding.experiments.studies import added_forces
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.single_changes import Storeys

Real = NDArray[np.float64]
LINEAR_STEP_S = 5e-4
"""The exact linear response is looked at this often [s]."""
STEP_S = 6.5e-4
"""Step of the nonlinear runs [s]; a twentieth of the period of the highest mode that matters, 76 Hz."""


@dataclass(frozen=True)
class Change:
    """One candidate for what is missing.

    Attributes:
        unit: Of the parameter.
        values: Tried values, the neutral one first.
        peaks: Largest and size of smallest displacement (values, floors, 2) [m] of a frame under a record.
        what: In words.
    """

    unit: str
    values: tuple[float, ...]
    peaks: Callable[[Storeys, Record, Real], Real]
    what: str


def _bodies(make: Callable[[Storeys, float], Storeys]) -> Callable[[Storeys, Record, Real], Real]:
    def peaks(body: Storeys, record: Record, values: Real) -> Real:
        made = [make(body, float(value)) for value in values]
        return np.stack([_linear(each, record) for each in made])

    return peaks


def _linear(body: Storeys, record: Record, ratio: Real | None = None) -> Real:
    basis = change.modes(body)
    basis = basis if ratio is None else replace(basis, ratio=np.minimum(ratio, 0.99))
    return change.extremes(change.linear_histories(body, basis, _at(record, LINEAR_STEP_S)))


def _at(record: Record, step_s: float) -> Record:
    """Return the same motion at a step that divides its own and is no longer than asked."""
    return record.resampled(record.step_s / np.ceil(record.step_s / step_s))


def _damping(ratio: Callable[[Storeys, float], Real]) -> Callable[[Storeys, Record, Real], Real]:
    def peaks(body: Storeys, record: Record, values: Real) -> Real:
        return np.stack([_linear(body, record, ratio(body, float(value))) for value in values])

    return peaks


def _motions(make: Callable[[Record, float], Record]) -> Callable[[Storeys, Record, Real], Real]:
    def peaks(body: Storeys, record: Record, values: Real) -> Real:
        return np.stack([_linear(body, make(record, float(value))) for value in values])

    return peaks


def _forces(
    make: Callable[[Storeys, Real], change.Force], step_s: float = STEP_S
) -> Callable[[Storeys, Record, Real], Real]:
    def peaks(body: Storeys, record: Record, values: Real) -> Real:
        force = make(body, values)
        return change.respond(body, change.modes(body), _at(record, step_s), force, len(values))

    return peaks


def _stiffness_proportional(body: Storeys, slope: float) -> Real:
    omega = change.modes(body).omega
    return np.asarray(body.ratio + slope * (omega / omega[0] - 1))


def _mass_proportional(body: Storeys, first: float) -> Real:
    omega = change.modes(body).omega
    return first * omega[0] / omega if first else np.full(len(omega), body.ratio)


def _slow_table(record: Record, lag_ms: float) -> Record:
    if lag_ms == 0:
        return record
    record = _at(record, LINEAR_STEP_S)
    numerator, denominator = bilinear([1.0], [1e-3 * lag_ms, 1.0], 1 / record.step_s)
    return replace(record, acceleration_m_s2=lfilter(numerator, denominator, record.acceleration_m_s2))


def _louder_table(record: Record, gain: float) -> Record:
    return replace(record, acceleration_m_s2=(1 + gain) * record.acceleration_m_s2)


def _short_stroke(record: Record, corner_hz: float) -> Record:
    if corner_hz == 0:
        return record
    record = _at(record, LINEAR_STEP_S)
    section = butter(2, corner_hz, "highpass", fs=1 / record.step_s, output="sos")
    return replace(record, acceleration_m_s2=sosfilt(section, record.acceleration_m_s2))


def _slow_clock(record: Record, change: float) -> Record:
    return replace(record, step_s=(1 + change) * record.step_s)


def _averaged(body: Storeys, record: Record, values: Real) -> Real:
    record = _at(record, LINEAR_STEP_S)
    histories = change.linear_histories(body, change.modes(body), record)
    windows = [max(1, round(1e-3 * value / record.step_s)) for value in values]
    return np.stack([change.extremes(uniform_filter1d(histories, window, axis=0)) for window in windows])


def _steps(first: float, last: float, count: int) -> tuple[float, ...]:
    return (0.0, *np.linspace(first, last, count).tolist())


def _decades(first: float, last: float, count: int = 21) -> tuple[float, ...]:
    return (0.0, *np.geomspace(first, last, count).tolist())


def _same_damping(body: Storeys, ratio: float) -> Real:
    return np.full(len(body.mass), ratio or body.ratio)


def _more_damping(body: Storeys, change_of_ratio: float) -> Real:
    return np.full(len(body.mass), body.ratio * (1 + change_of_ratio))


DRAG = "N s^2/m^2"
CHANGES: dict[str, Change] = {
    "one damping ratio": Change("-", _decades(0.002, 0.06, 31), _damping(_same_damping), "x in all frames"),
    "damping factor": Change(
        "-", _steps(-0.5, 7.0, 31), _damping(_more_damping), "each frame's times (1 + x)"
    ),
    "damping rising with frequency": Change(
        "-", _decades(1e-4, 0.05), _damping(_stiffness_proportional), "x more for each multiple of f1"
    ),
    "damping falling with frequency": Change(
        "-", _decades(0.002, 0.06, 31), _damping(_mass_proportional), "x f1 / f, in proportion to the mass"
    ),
    "damping rising with drift": Change(
        # The drag grows with frequency: 0.02 asks the highest modes for more than the longer step can follow.
        "1/mm",
        _decades(1e-4, 0.02),
        _forces(added_forces.damping_by_drift, 2e-4),
        "x more for each mm of storey drift",
    ),
    "stiffness": Change(
        "-", _steps(-0.25, 0.25, 51), _bodies(change.with_stiffness), "times (1 + x), or mass divided by it"
    ),
    "P-Delta": Change("-", _steps(-1.0, 4.0, 26), _bodies(change.with_p_delta), "x times the weight more"),
    "yielding base": Change(
        "mm/kN",
        _decades(0.1, 100.0),
        _bodies(change.with_yielding_base),
        "base or lowest storey gives way by x",
    ),
    "base rocking": Change(
        "rad/(kN m)", _decades(0.001, 1.0), _bodies(change.with_rocking), "the base turns by x under a moment"
    ),
    "table gain": Change(
        "-", _steps(-0.4, 0.4, 41), _motions(_louder_table), "table did (1 + x) x the record"
    ),
    "slow table": Change("ms", _decades(0.5, 100.0), _motions(_slow_table), "first-order lag x of the table"),
    "short stroke": Change(
        "Hz", _decades(0.05, 3.0), _motions(_short_stroke), "the table leaves out what is slower than x"
    ),
    "slow clock": Change(
        "-", _steps(-0.15, 0.15, 31), _motions(_slow_clock), "the record takes (1 + x) times its time"
    ),
    "averaging laser": Change("ms", _decades(1.0, 200.0), _averaged, "displacement is the mean over x"),
    "Coulomb friction": Change(
        "N", _decades(0.05, 60.0, 25), _forces(added_forces.coulomb_friction), "x in every storey"
    ),
    "air drag": Change(DRAG, _decades(0.05, 50.0), _forces(added_forces.air_drag), "x w|w| on every floor"),
    "quadratic damping": Change(
        DRAG, _decades(10.0, 2e4), _forces(added_forces.quadratic_damping), "x v|v| in every storey"
    ),
    "cubic stiffness": Change(
        # Softer than -0.008 a storey would have no stiffness left at the drifts of 6 mm that Kobe asks for.
        "-",
        _steps(-0.008, 0.016, 25),
        _forces(added_forces.cubic_stiffness),
        "storeys harden by x at 1 mm",
    ),
    "softening": Change(
        "mm",
        (1e6, *np.geomspace(0.5, 200.0, 21).tolist()),
        _forces(added_forces.softening),
        "storeys soften as k / (1 + drift / x)",
    ),
    "column yielding": Change(
        "MPa",
        (1e6, *np.geomspace(30.0, 800.0, 25).tolist()),
        _forces(added_forces.column_yielding),
        "columns yield at x",
    ),
}
CHANGES |= {
    f"slip of {100 * share:.0f} %": Change(
        "mm",
        (1e3, *np.geomspace(0.02, 8.0, 21).tolist()),
        _forces(partial(added_forces.hysteresis, share=share)),
        f"{share} of each storey's stiffness slips at a drift of x",
    )
    for share in (0.1, 0.2, 0.3, 0.4)
}
