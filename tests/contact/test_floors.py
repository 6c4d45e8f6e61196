"""Contacts estimated from floors: each formula by hand, its basis in words, and what it is for two colliding bodies."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from pounding.contact import ContactError, collide
from pounding.contact.floors import (
    RESTITUTION,
    Estimate,
    Floor,
    floor_law,
    hertz_spheres,
    is_hertz,
    restitution_of,
    slab_strip,
)
from pounding.contact.laws import BUILT_IN, DAMPED

OFFICE = Floor("office", 250e3, 0.2, 15.0, 24.0, 30e9, 0.2, 2500.0)
FLATS = Floor("flats", 320e3, 0.22, 18.0, 20.0, 30e9, 0.2, 2500.0)


def test_the_softer_strip_of_the_narrower_width_counts() -> None:
    found = slab_strip((FLATS, OFFICE))
    assert found.value == pytest.approx(30e9 * 0.2 * 15.0 / 24.0)
    assert "slab strip of office, 30 GPa x 0.2 m x 15 m / 24 m" in found.basis
    assert slab_strip((OFFICE, FLATS)).value == found.value
    assert slab_strip((OFFICE, OFFICE)).value == found.value


def test_spheres_have_the_floors_masses_and_hertz_stiffness() -> None:
    assert 4 / 3 * math.pi * OFFICE.radius_m**3 * 2500.0 == pytest.approx(250e3)
    radius = OFFICE.radius_m * FLATS.radius_m / (OFFICE.radius_m + FLATS.radius_m)
    plane_strain = 30e9 / (1.0 - 0.2**2)
    assert hertz_spheres((FLATS, OFFICE)).value == pytest.approx(4 / 3 * math.sqrt(radius) * plane_strain / 2)
    assert hertz_spheres((FLATS, OFFICE), 4.0 * radius).value == pytest.approx(
        2 * hertz_spheres((FLATS, OFFICE)).value
    )


@pytest.mark.parametrize("name", BUILT_IN)
def test_two_floors_part_with_the_restitution_that_is_stated(name: str) -> None:
    estimate = (hertz_spheres if is_hertz(name) else slab_strip)((FLATS, OFFICE))
    law, said = floor_law(name, estimate, restitution_of(None), (320e3, 250e3), tension=True)
    parted = collide(law, 320e3, 250e3, 0.5).restitution
    assert parted == pytest.approx(RESTITUTION if name in DAMPED else 1.0, abs=0.025)
    assert ("Jankowski" in said) == (name in DAMPED)


def test_a_value_beyond_the_literature_is_used_and_said() -> None:
    assert "outside the 0.5 to 0.85" in restitution_of(0.95).basis
    assert "outside" not in restitution_of(0.7).basis
    assert "outside" in slab_strip((replace(OFFICE, thickness_m=2.0),) * 2).basis


def test_a_restitution_that_cannot_be_is_refused() -> None:
    with pytest.raises(ContactError, match="restitution of 2"):
        floor_law("linear_viscoelastic", Estimate(1e9, ""), restitution_of(2.0), (1.0, 1.0))
