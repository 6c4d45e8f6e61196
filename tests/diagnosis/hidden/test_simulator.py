"""The simulator of hidden cases: its frames, its laws, its contacts and its integration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from pounding import frames
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden import laws, stepping
from pounding.diagnosis.hidden.baseline import baseline
from pounding.diagnosis.hidden.beams import Appendage
from pounding.diagnosis.hidden.contacts import STIFFNESS, Contact, Touch
from pounding.diagnosis.hidden.modes import frequencies_hz, lone_storey_stiffness, modes, storey_stiffness
from pounding.diagnosis.hidden.motions import Motion, draw
from pounding.diagnosis.hidden.rigging import draw_rig
from pounding.diagnosis.hidden.scenario import Scenario, Spring, at_rate, happen
from pounding.diagnosis.hidden.worlds import OWN


@pytest.mark.parametrize("name", ["5A", "5B", "10", "15B"])
def test_rings_as_believed(name: str) -> None:
    """The first modes of an independent beam-column model, two stiffnesses fitted, against the shells'."""
    expected = frames.build(frames.load(name)).frequencies_hz[:3]
    assert frequencies_hz(baseline(name), 3) == pytest.approx(expected, rel=5e-3)
    # Rigid floors take part with nearly all the mass: what is missing hangs on the base.
    assert np.sum(modes(baseline(name)).gamma ** 2) == pytest.approx(
        frames.load(name).moving_mass_kg, rel=0.01
    )


def test_beam_theory() -> None:
    """One storey with clamped ends: 12 EI / h^3, and Euler's load in the geometric stiffness (within 1 %)."""
    frame = baseline("5A")
    one = replace(
        frame,
        bending=frame.bending[:1],
        joint=np.full(2, 1e9),
        floor_mass=frame.floor_mass[:1],
        gyration=frame.gyration[:1],
        axial=np.zeros(1),
    )
    stiffness = 12 * one.bending[0] / one.height_m**3
    assert storey_stiffness(one)[0] == pytest.approx(stiffness, rel=1e-5)
    euler = np.pi**2 * one.bending[0] / one.height_m**2
    assert storey_stiffness(replace(one, axial=np.array([0.5 * euler])))[0] < 0.6 * stiffness
    assert frequencies_hz(replace(one, axial=np.array([0.99 * euler])), 1)[0] > 0
    with pytest.raises(CaseError, match="buckles"):
        modes(replace(one, axial=np.array([1.02 * euler])))


def test_an_appendage_is_damped_where_it_hangs_and_not_against_the_table() -> None:
    """Without a damper of its own nothing damps it, however much the frame is damped."""
    frame = baseline("5A")
    first = frequencies_hz(frame, 1)[0]
    hung = replace(frame, appendage=Appendage(3, 0.05, 1.02 * first, 0.0))
    matrices, moved = hung.matrices(), modes(hung)
    swings = eigh(matrices.stiffness, matrices.mass)[1][:, : len(moved.omega)].T @ matrices.mass[:, -1]
    swings /= np.sqrt(matrices.mass[-1, -1])
    assert swings @ swings == pytest.approx(1.0, rel=1e-3)
    assert swings @ moved.damping @ swings < 1e-6 * np.diag(moved.damping)[:2].min()


def test_rocking_softens_and_a_stiff_base_does_not() -> None:
    frame = baseline("5A")
    fixed = frequencies_hz(frame, 3)
    assert frequencies_hz(replace(frame, base=1e12), 3) == pytest.approx(fixed, rel=1e-4)
    soft = frequencies_hz(replace(frame, base=3e4), 3)
    assert soft[0] < 0.95 * fixed[0]


def test_eccentricity_couples_and_an_appendage_splits() -> None:
    frame = baseline("5A")
    first = frequencies_hz(frame, 1)[0]
    twisted = frequencies_hz(replace(frame, eccentricity_m=0.05, torsion_ratio=1.3), 2)
    assert twisted[0] < first < 1.3 * first < twisted[1]
    split = frequencies_hz(replace(frame, appendage=Appendage(5, 0.5, first, 0.01)), 2)
    assert split[0] < first < split[1]


@pytest.fixture(scope="module")
def shaking() -> Motion:
    return draw(np.random.default_rng(5), 1, 0.8, 1 / 4000, "artificial")[0]


def test_integration_against_a_runge_kutta_of_high_order(shaking: Motion) -> None:
    """Linear frame and a cubic spring in storey 2, against DOP853 at a tight tolerance."""
    frame = replace(baseline("5A"), ratios=np.full(5, 0.01))
    coefficient = 0.5 * storey_stiffness(frame)[1] / 1e-3**2
    spring = Spring("5A", 2, 1, lambda _: laws.cubic(coefficient))
    whole = modes(frame)
    count = len(whole.omega)
    row = whole.floors[1] - whole.floors[0]
    time = shaking.step_s * np.arange(len(shaking.acceleration))

    def slope(t: float, x: np.ndarray, k3: float) -> np.ndarray:
        table = np.interp(t, time, shaking.acceleration)
        q, v = x[:count], x[count:]
        force = k3 * (row @ q) ** 3
        return np.concatenate(
            [v, -whole.gamma * table - whole.damping @ v - whole.omega**2 * q - row * force]
        )

    for springs, k3, tolerance in (((), 0.0, 1e-5), ((spring,), coefficient, 2e-4)):
        got = happen(Scenario({"5A": frame}, springs), shaking, 0).displacement[-1]
        exact = solve_ivp(
            slope,
            (0, time[-1]),
            np.zeros(2 * count),
            "DOP853",
            time[::40],
            args=(k3,),
            rtol=1e-8,
            atol=1e-11,
            max_step=1e-3,
        )
        truth = whole.floors[-1] @ exact.y[:count]
        assert np.abs(got[::40] - truth).max() < tolerance * np.abs(truth).max()


def test_lugre_slides_at_its_level_and_sticks_below() -> None:
    law = laws.LuGre(10.0, 1e6)
    for _ in range(1000):
        law.accept(0, 0, 0.1, 1e-3)
    assert law.force(0, 0, 0.1, 1e-3) == pytest.approx(10.0)
    # Turned round, it first lets go elastically.
    assert law.force(0, 0, -1e-6, 1e-3) == pytest.approx(10.0, abs=0.01)
    law = laws.LuGre(10.0, 1e6)
    law.accept(0, 0, 1e-6, 1.0)
    assert law.force(0, 0, 0.0, 1e-3) == pytest.approx(1e6 * 1e-6, rel=0.06)


def test_bouc_wen_is_elastic_when_small_and_yields_when_large() -> None:
    small = laws.BoucWen(100.0, 1e5, 4.0)
    assert small.force(0, 1e-4, 0, 1e-3) == pytest.approx(0.0, abs=0.02)
    large = laws.BoucWen(100.0, 1e5, 4.0)
    for d in np.linspace(0, 0.01, 2000):
        large.accept(0, float(d), 0, 1e-3)
    assert large.pull == pytest.approx(100.0, rel=0.01)
    assert large.force(0, 0.01, 0, 1e-3) == pytest.approx(100.0 - 1000.0, rel=0.01)


def test_a_stop_pushes_back_on_its_side_only() -> None:
    stop = laws.stop(-1e-3, 1e5, 1e-5, 0.0)
    assert stop.force(0, -2e-3, 0, 0) == pytest.approx(-100.0, rel=1e-3)
    assert stop.force(0, 2e-3, 0, 0) == 0.0


def restitution(event: Touch, speed: float, mass: float) -> float:
    """Let a mass [kg] hit with a speed [m/s]; return the ratio of the speeds after and before."""
    law = Contact(event, mass)
    x, v, dt = 0.0, speed, 1e-7
    while x >= 0.0:
        force = law.force(0.0, x, v, dt)
        law.accept(0.0, x, v, dt)
        v -= force / mass * dt
        x += v * dt
    return -v / speed


@pytest.mark.parametrize(
    ("law", "tolerance"),
    [("linear_viscoelastic", 0.03), ("nonlinear_viscoelastic", 0.03), ("hertz_damp", 0.05)],
)
def test_a_contact_gives_back_what_its_restitution_says(law: str, tolerance: float) -> None:
    """Within what published damping ratios reach; the linear law is cut where it would pull."""
    event = Touch("a", "b", 1, 0.0, law, STIFFNESS[law], restitution=0.7)
    assert restitution(event, 0.3, 3.2) == pytest.approx(0.7, abs=tolerance)


@pytest.mark.parametrize("law", ["linear_spring", "hertz"])
def test_an_undamped_contact_gives_everything_back(law: str) -> None:
    assert restitution(Touch("a", "b", 1, 0.0, law, STIFFNESS[law]), 0.3, 3.2) == pytest.approx(1.0, abs=1e-3)


def test_the_first_impact_of_a_pair_is_resolved(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = draw_rig(np.random.default_rng(5), ["10", "5B"], "artificial", 1.5, world=OWN)
    peaks = []
    for parts in (8, 32):
        monkeypatch.setattr(stepping, "FINER", parts)
        force = happen(rig.bare, rig.shakings[0], 0).contact_force[0]
        start = int(np.flatnonzero(force > 0)[0])
        peaks.append(force[start : start + 40].max())
    assert peaks[0] > 50.0
    assert peaks[0] == pytest.approx(peaks[1], rel=0.01)


def test_storey_stiffness_by_two_definitions_agrees_where_joints_do_not_turn() -> None:
    frame = baseline("5A")
    rigid = replace(frame, joint=np.full(6, 1e9), axial=np.zeros(5))
    assert lone_storey_stiffness(rigid) == pytest.approx(storey_stiffness(rigid), rel=1e-4)
    assert (lone_storey_stiffness(frame) > storey_stiffness(frame)).all()


def test_a_signal_at_another_rate_keeps_its_start_and_holds_its_end() -> None:
    time = np.arange(4000) / 1000
    np.testing.assert_allclose(at_rate(np.sin(time), 0.99), np.sin(0.99 * time), atol=1e-6)
    fast = at_rate(np.sin(time), 1.01)
    np.testing.assert_allclose(fast[:3900], np.sin(1.01 * time[:3900]), atol=1e-6)
    assert (fast[-30:] == np.sin(time[-1])).all()
