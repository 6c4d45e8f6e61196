"""Single changes of shaken storeys against closed forms and an adaptive integrator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.records import Record, find
from pounding.experiments.studies import added_forces, change_catalogue, single_changes
from pounding.experiments.studies.single_changes import Storeys
from pounding.experiments.studies.table_4_1 import floor_peaks
from pounding.frames import build, load
from pounding.scale import THESIS

STEP = 5e-4
SHARE = 0.2


@pytest.fixture(scope="module")
def body():
    stiffness = 2.6e5 * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    return Storeys(6.5 * np.eye(3), stiffness, 0.005, 0.1 * np.arange(1, 4))


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(2)
    samples = 4.0 * np.hanning(120) * rng.normal(size=120)
    return Record("burst", samples - samples.mean(), 4e-3)


def adaptive(body, record, force):
    """Integrate by DOP853 with a force (n,) of displacement and velocities (n,)."""
    basis = single_changes.modes(body)
    inverse = np.linalg.inv(body.mass)
    damping = body.mass @ basis.shapes @ np.diag(2 * body.ratio * basis.omega) @ basis.shapes.T @ body.mass
    time, a = record.time_s, record.acceleration_m_s2
    ground = np.append(0, np.cumsum((a[1:] + a[:-1]) / 2) * record.step_s)
    tilt = ground[-1] / time[-1]

    def right(t, y):
        u, v = y[:3], y[3:]
        shake = np.interp(t, time, a)
        # the velocity of the table is a parabola between samples
        index = min(int(t / record.step_s), len(a) - 2)
        part = t - time[index]
        w = (
            ground[index]
            + a[index] * part
            + (a[index + 1] - a[index]) / record.step_s * part**2 / 2
            - tilt * t
        )
        push = force(u, v, v + w)
        return np.concatenate([v, inverse @ (push - damping @ v - body.stiffness @ u) - shake])

    times = np.linspace(0, time[-1], 2001)
    y = solve_ivp(right, (0, time[-1]), np.zeros(6), "DOP853", times, rtol=1e-8, atol=1e-10, max_step=1e-3).y[
        :3
    ]
    return np.stack([y.max(axis=1), -y.min(axis=1)], axis=-1)


@pytest.mark.parametrize(
    ("make", "value"),
    [
        (added_forces.coulomb_friction, 3.0),
        (added_forces.air_drag, 30.0),
        (added_forces.quadratic_damping, 3000.0),
        (added_forces.damping_by_drift, 0.05),
        (added_forces.cubic_stiffness, -0.1),
        (added_forces.cubic_stiffness, 0.2),
    ],
)
def test_added_forces_against_an_adaptive_integrator(make, value, body, record):
    values = np.array([value])
    once = make(body, values)
    fine = record.resampled(STEP)
    found = single_changes.respond(body, single_changes.modes(body), fine, once, 1)[0]
    truth = adaptive(body, record, lambda u, v, w: once(u[None], v[None], w[None])[0])
    without = single_changes.respond(body, single_changes.modes(body), fine, None, 1)[0]
    # second order in a step of 0.5 ms: 0.3 % is left; the forces themselves change the peaks by far more
    np.testing.assert_allclose(found, truth, rtol=3e-3)
    assert np.abs(without / truth - 1).max() > 0.02


def test_hysteresis_lies_between_its_two_elastic_limits(body, record):
    fine, basis = record.resampled(STEP), single_changes.modes(body)
    values = np.array([1e3, 1e-6])
    found = single_changes.respond(body, basis, fine, added_forces.hysteresis(body, values, share=SHARE), 2)
    never = single_changes.respond(body, basis, fine, None, 1)[0]
    # what always slips carries nothing: the stiffness without the yielding fifth (this body is a pure chain)
    softer = single_changes.with_stiffness(body, -SHARE)
    softer_basis = replace(single_changes.modes(softer), ratio=basis.ratio * (1 - SHARE) ** -0.5)
    always = single_changes.respond(softer, softer_basis, fine, None, 1)[0]
    np.testing.assert_allclose(found[0], never, rtol=1e-12)
    np.testing.assert_allclose(found[1], always, rtol=5e-3)


def test_hysteresis_dissipates(body):
    slip = added_forces.hysteresis(body, np.array([0.2]), share=SHARE)
    cycle = np.sin(np.linspace(0, 4 * np.pi, 2001))[:, None] * np.array([[1e-3, 1e-3, 1e-3]])
    forces = np.array([slip(u[None], 0 * u[None], 0 * u[None])[0, 0] for u in cycle])
    work = np.trapezoid(forces[1000:], cycle[1000:, 0])
    # the storey gives k d - f_y: a closed loop takes 4 f_y (d - d_y) out of the motion
    stiffness = SHARE * body.storey_stiffness[0]
    expected = 4 * stiffness * 0.2e-3 * (1e-3 - 0.2e-3)
    assert -work == pytest.approx(expected, rel=0.01)


def test_softening_storeys_follow_their_backbone_and_close_their_loops(body):
    x = 2.0
    soft = added_forces.softening(body, np.array([x]))
    drift = 1e-3 * np.concatenate([np.linspace(0, 3, 301), np.linspace(3, -3, 601), np.linspace(-3, 3, 601)])
    # only the lowest storey drifts, because all floors move alike
    lost = np.array([soft(np.full((1, 3), d), 0.0, 0.0)[0, 0] for d in drift])
    stiffness = body.storey_stiffness[0]
    backbone = stiffness * drift[:301] / (1 + drift[:301] * 1e3 / x)
    # six springs are polygons of the backbone: 5 % of the stiffness that all of them have at the start
    np.testing.assert_allclose(stiffness * drift[:301] - lost[:301], backbone, atol=0.05 * stiffness * 3e-3)
    # Masing: after a whole cycle the force is that of the first loading again
    assert lost[-1] == pytest.approx(lost[300])
    assert lost[901] == pytest.approx(-lost[300])


def test_yielding_columns_hold_their_plastic_shear_and_no_more(body):
    push = added_forces.column_yielding(body, np.array([280.0]))
    drift = np.linspace(0, 12e-3, 601)
    # only the lowest storey drifts: it gives k d and the force takes away what is beyond the plastic shear
    carried = [body.storey_stiffness[0] * d - push(np.full((1, 3), d), 0.0, 0.0)[0, 0] for d in drift]
    # four columns of 40 mm by 2 mm, plastic moments of 11.2 N m at both ends, 100 mm apart
    assert max(carried) == pytest.approx(8 * 11.2 / 0.1)
    assert carried[100] == pytest.approx(body.storey_stiffness[0] * drift[100])


def test_damping_by_drift_takes_the_energy_of_its_ratio(body):
    omega, amplitude, ratio = single_changes.modes(body).omega[0], 3e-3, 0.01
    drag = added_forces.damping_by_drift(body, np.array([ratio]))
    phase = np.linspace(0, 2 * np.pi, 4001)
    u, v = amplitude * np.sin(phase), amplitude * omega * np.cos(phase)
    # all floors move alike, so that only the lowest storey drifts
    forces = [drag(np.full((1, 3), a), np.full((1, 3), b), 0.0)[0, 0] for a, b in zip(u, v, strict=True)]
    # a viscous damper of ratio z takes 2 pi z k d^2 in a cycle; z is 0.01 for each of 3 mm
    expected = 2 * np.pi * 3 * ratio * body.storey_stiffness[0] * amplitude**2
    assert -np.trapezoid(forces, u) == pytest.approx(expected, rel=1e-4)


def test_what_softens_lowers_the_frequencies(body):
    first = single_changes.modes(body).omega
    np.testing.assert_allclose(
        single_changes.modes(single_changes.with_stiffness(body, 0.21)).omega, 1.1 * first
    )
    assert (single_changes.modes(single_changes.with_p_delta(body, 1.0)).omega < first).all()
    rocking = single_changes.modes(single_changes.with_rocking(body, 0.1)).omega
    assert rocking[0] < first[0]
    # a base as soft as the lowest storey of a chain halves that storey's stiffness
    stiffness = body.storey_stiffness[0]
    in_series = single_changes.modes(single_changes.with_yielding_base(body, 1e6 / stiffness)).omega
    halved = body.stiffness - np.diag([stiffness / 2, 0, 0])
    np.testing.assert_allclose(in_series, single_changes.modes(replace(body, stiffness=halved)).omega)
    # P-Delta of one floor on a storey: k - m g / h
    one = Storeys(np.array([[6.5]]), np.array([[1e4]]), 0.0, np.array([0.1]))
    expected = 1e4 - 6.5 * STANDARD_GRAVITY / 0.1
    assert single_changes.with_p_delta(one, 1.0).stiffness[0, 0] == pytest.approx(expected)


def test_storeys_are_the_frame():
    reduced = build(load("5B"))
    fine = find("elcentro-chopra").scaled(THESIS.time_factor).trimmed(lower=0.0, upper=0.9).resampled(STEP)
    body = single_changes.storeys(reduced)
    histories = single_changes.linear_histories(body, single_changes.modes(body), fine)
    whole = floor_peaks(reduced, fine, range(1, 6)) * 1e-3
    # Guyan's masses against the whole reduction: what is lost are modes above 60 Hz
    np.testing.assert_allclose(single_changes.extremes(histories), whole, rtol=1e-3)


@pytest.mark.parametrize("name", change_catalogue.CHANGES)
def test_the_first_value_of_every_change_is_no_change(name, body, record):
    chosen = change_catalogue.CHANGES[name]
    basis = single_changes.modes(body)
    none = single_changes.extremes(single_changes.linear_histories(body, basis, record.resampled(STEP)))
    first = chosen.peaks(body, record, np.array(chosen.values[:1]))[0]
    # looked at every 0.65 instead of 0.5 ms where a force is added
    np.testing.assert_allclose(first, none, rtol=5e-3)


def test_a_frame_that_runs_away_is_told_by_what_is_not_finite(body, record):
    loud = replace(record, acceleration_m_s2=30 * record.acceleration_m_s2)
    peaks = change_catalogue.CHANGES["cubic stiffness"].peaks(body, loud, np.array([0.0, -0.2]))
    assert np.isfinite(peaks[0]).all()
    assert not np.isfinite(peaks[1]).all()
