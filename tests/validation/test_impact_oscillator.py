"""A building of real size against a wall under steady harmonic shaking: closed form of one impact a cycle.

Between impacts the building follows a linear equation, and an impact turns its velocity by the coefficient of restitution.
A motion that repeats itself after one cycle with one impact in it follows from two linear equations (Shaw and Holmes 1983,
Journal of Sound and Vibration 90(1); Davis 1992 computes the same problem with Hertz' contact for buildings). The derivation
here is our own.
"""

from __future__ import annotations

import numpy as np
import pytest

from pounding.contact.damping import linear_damping, linear_damping_ratio
from pounding.contact.laws import LinearViscoelastic
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import run_exact
from tests.validation.oscillators import HEAVIEST_KG, oscillator, wall

MASS_KG, FREQUENCY_HZ, DAMPING = 300e3, 1.0, 0.05
GAP_M, RESTITUTION = 0.05, 0.65
SHAKING_M_S2 = 3.0


def approach_velocities(ratio: float) -> list[float]:
    """Return the velocities before impact of motions with one impact a cycle of the shaking [m/s]; both roots.

    Args:
        ratio: Frequency of the shaking over that of the building [-].
    """
    own, omega = 2.0 * np.pi * FREQUENCY_HZ, 2.0 * np.pi * FREQUENCY_HZ * ratio
    damped = own * np.sqrt(1.0 - DAMPING**2)
    cycle = 2.0 * np.pi / omega
    size = SHAKING_M_S2 / abs(own**2 - omega**2 + 2j * DAMPING * own * omega)
    decay, cosine, sine = np.exp(-DAMPING * own * cycle), np.cos(damped * cycle), np.sin(damped * cycle)
    # Free motion over a cycle: (displacement, velocity) after it from those before it.
    kept = decay * (cosine + DAMPING * own / damped * sine)
    from_rate = decay * sine / damped
    to_rate = -decay * own**2 / damped * sine
    rate_kept = decay * (cosine - DAMPING * own / damped * sine)
    # The free part p = gap - size sin(phase) repeats itself: its rate after the impact is p * turn.
    turn = (1.0 - kept) / from_rate
    after_cycle = to_rate + rate_kept * turn
    # Restitution: omega size cos(phase) (1 + e) + p (turn + e after_cycle) = 0.
    along, across = omega * size * (1.0 + RESTITUTION), size * (turn + RESTITUTION * after_cycle)
    cosine_of = -GAP_M * (turn + RESTITUTION * after_cycle) / np.hypot(along, across)
    found = []
    for sign in (-1.0, 1.0) if abs(cosine_of) <= 1.0 else ():
        phase = sign * np.arccos(cosine_of) - np.arctan2(across, along)
        free = GAP_M - size * np.sin(phase)
        found.append(float(omega * size * np.cos(phase) + free * after_cycle))
    return found


def simulated(ratio: float, stiffness: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the approach velocities (k,) [m/s] of the last ten impacts and the times between them, in cycles."""
    cycle_s = 1.0 / (FREQUENCY_HZ * ratio)
    step_s = cycle_s / 200.0
    time_s = np.arange(0.0, 45.0, step_s)
    shaking = SHAKING_M_S2 * np.sin(2.0 * np.pi * time_s / cycle_s) * np.minimum(1.0, time_s / 5.0)
    reduced = MASS_KG * HEAVIEST_KG / (MASS_KG + HEAVIEST_KG)
    damping = linear_damping(stiffness, linear_damping_ratio(RESTITUTION), reduced)
    # With tension the law's restitution is that of the formula.
    law = LinearViscoelastic(stiffness, damping=damping, tension=True)
    building = oscillator("building", MASS_KG, FREQUENCY_HZ, DAMPING)
    motion = run_exact([building, wall()], [Contact(law, GAP_M, 1)], shaking, step_s)
    times, rates = motion.contacts[0].touches
    return rates[-10:], np.diff(times[-10:]) / cycle_s


@pytest.mark.parametrize("ratio", [0.8, 1.0, 1.3])
def test_one_impact_a_cycle_is_that_of_the_closed_form(ratio: float) -> None:
    expected = max(approach_velocities(ratio))
    # The closed form has no contact time. It grows with the root of 1 / stiffness, and so does what it changes.
    softer, _ = simulated(ratio, 2.5e11)
    stiffer, between = simulated(ratio, 1e12)
    np.testing.assert_allclose(between, 1.0, rtol=1e-4)
    np.testing.assert_allclose(stiffer, expected, rtol=6e-3)
    np.testing.assert_allclose(2.0 * stiffer - softer, expected, rtol=1e-3)
