"""Slip and friction on the lattice of Table 4.1: a gain of the table needs no run, and which models there are."""

from dataclasses import replace

import numpy as np
import pytest

from pounding.experiments.studies import added_forces, added_lattice
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.added_lattice import AddedLattice
from pounding.experiments.studies.change_catalogue import STEP_S
from pounding.experiments.studies.frame_states import baseline
from pounding.experiments.studies.missing_in_the_thesis import freedoms, with_effect
from pounding.experiments.studies.peak_lattice import GAINS, motion_of

GAIN = 0.85


def strongest_half(name, folder, step_s):
    return motion_of(name, folder, step_s).trimmed(lower=0.0, upper=0.5)


@pytest.fixture(params=["slip", "friction"])
def lattice(request, monkeypatch, test_records):
    """One frame under one record in one state."""
    monkeypatch.setattr(added_lattice, "FRAMES", ("5A",))
    monkeypatch.setattr(added_lattice, "RECORDS", ("northridge",))
    monkeypatch.setattr(added_lattice, "PLACES", ("sweep",))
    monkeypatch.setattr(added_lattice, "RATIOS", (None,))
    monkeypatch.setattr(added_lattice, "motion_of", strongest_half)
    return AddedLattice(request.param)


def louder(lattice, value):
    """Return the peaks [mm] (floors, sides) of a frame whose table moves by the gain, by a run of its own."""
    motion = strongest_half("northridge", None, STEP_S)
    body = baseline("5A")
    body = replace(body, stiffness=(6.90 / 6.93) ** 2 * body.stiffness)
    if lattice.effect == "slip":
        force = added_forces.hysteresis(body, np.array([value[1]]), share=value[0])
    else:
        force = added_forces.coulomb_friction(body, np.array([value]))
    shaken = replace(motion, acceleration_m_s2=GAIN * motion.acceleration_m_s2)
    peaks = 1e3 * change.respond(body, change.modes(body), shaken, force, 1)[0]
    return peaks[np.array(lattice.floors["5A"]) - 1]


def test_a_gain_is_a_slip_or_a_friction_of_another_size(lattice):
    gain = int(np.argmin(abs(GAINS - GAIN)))
    assert GAINS[gain] == pytest.approx(GAIN)
    values = lattice.axes[lattice.effect]
    weak = lattice.predictions["5A"][0, 0, 0, gain, :, 0]
    moved = []
    for number in (None, 10, 20, -20):
        value = (
            values[number] if number else ((0.0, added_lattice.NEVER_MM) if lattice.effect == "slip" else 0.0)
        )
        found = lattice.predictions["5A"][0, number or 0, 0, gain, :, 0]
        # Peaks are straight between values that are 16 to 19 % apart.
        np.testing.assert_allclose(found, louder(lattice, value), rtol=0.015)
        moved.append(abs(found / weak - 1.0).max())
    assert moved[0] == 0.0
    assert max(moved) > 0.05  # the effect is there at all


def test_slip_and_friction_stand_alone_and_beside_one_number():
    models = with_effect("slip")
    assert len(models) == 9
    assert {one.numbers for one in models.values()} == {("slip",), ("slip", "damping"), ("slip", "gain")}
    assert not set(models) & set(freedoms())
    assert models["slip in the storeys"].fitted == 2
    assert with_effect("friction")["a state for each frame + friction in the storeys"].fitted == 6
