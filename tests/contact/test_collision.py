"""Two free bodies that collide: what physics and the laws' own formulas say about it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pounding.contact import BUILT_IN, ContactError, Law, collide, make_law, thesis_law
from pounding.contact.collision import contact_time_hertz, contact_time_linear
from pounding.contact.damping import linear_damping_ratio, linear_restitution, reduced_mass
from pounding.contact.laws import DAMPED
from pounding.contact.stereo import after_impact, after_impact_as_printed, restitution_of

RATIOS = (1.0, 3.0, 10.0, 30.0, 100.0)
SPEEDS = (0.02, 0.2, 2.0)
RESTITUTIONS = (0.3, 0.5, 0.65, 0.81, 0.95)

# Reached where RESTITUTIONS was asked for; docs/theory/contact.md shows the same table.
REACHED = {
    ("linear_viscoelastic", ()): (0.3971, 0.5503, 0.6748, 0.8173, 0.9505),
    ("linear_viscoelastic", (("tension", True),)): RESTITUTIONS,
    ("nonlinear_viscoelastic", ()): (0.2917, 0.4946, 0.6470, 0.8090, 0.9499),
    ("hertz_damp", ()): (0.2562, 0.4704, 0.6303, 0.7991, 0.9468),
    ("hertz_damp", (("formula", "muthukumar"),)): (0.6842, 0.7252, 0.7748, 0.8530, 0.9535),
}


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_law_is_called_damped_that_loses_energy(name: str) -> None:
    found = collide(thesis_law(name), 6.2, 6.2, 0.3)
    assert (found.restitution < 0.99) == (name in DAMPED)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("speed", SPEEDS)
def test_momentum_is_kept_and_no_energy_made(law: Law, ratio: float, speed: float) -> None:
    found = collide(law, 6.2, 6.2 / ratio, speed, -0.3 * speed)
    assert found.momentum_error < 1e-9
    assert found.energy_ratio <= 1.0 + 1e-9


@pytest.mark.parametrize(("case", "reached"), REACHED.items(), ids=str)
def test_restitution_reached_against_asked(law_with: Any, case: Any, reached: tuple[float, ...]) -> None:
    name, own = case
    found = [collide(law_with(name, asked, **dict(own)), 6.2, 6.2, 0.3).restitution for asked in RESTITUTIONS]
    assert found == pytest.approx(reached, abs=1e-4)


@pytest.mark.parametrize("name", DAMPED)
@pytest.mark.parametrize("ratio", [1.0, 100.0])
@pytest.mark.parametrize("speed", SPEEDS)
def test_restitution_depends_neither_on_speed_nor_on_masses(
    law_with: Any, name: str, ratio: float, speed: float
) -> None:
    masses = (6.2, 6.2 / ratio)
    one = collide(law_with(name, 0.65), 6.2, 6.2, 0.3).restitution
    assert collide(law_with(name, 0.65, masses), *masses, speed).restitution == pytest.approx(one, abs=1e-6)


@pytest.mark.parametrize("restitution", RESTITUTIONS)
@pytest.mark.parametrize("tension", [True, False])
def test_linear_viscoelastic_reaches_its_closed_form(
    law_with: Any, restitution: float, tension: bool
) -> None:
    law = law_with("linear_viscoelastic", restitution, tension=tension)
    exact = linear_restitution(linear_damping_ratio(restitution), tension=tension)
    assert collide(law, 6.2, 6.2, 0.3).restitution == pytest.approx(exact, abs=1e-7)
    if tension:
        assert exact == pytest.approx(restitution, abs=1e-12)


def test_muthukumars_formula_is_the_worse_one(law_with: Any) -> None:
    """At half the velocity lost, eq. 2.17 damps far too little; eq. 2.18 is the one to trust."""
    asked = 0.5
    miss = {
        formula: abs(
            collide(law_with("hertz_damp", asked, formula=formula), 6.2, 6.2, 0.3).restitution - asked
        )
        for formula in ("ye", "muthukumar")
    }
    assert miss["ye"] < 0.04
    assert miss["muthukumar"] > 4.0 * miss["ye"]


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("restitution", [1.0, 0.81, 0.5])
def test_contact_time_of_the_linear_laws(ratio: float, restitution: float) -> None:
    masses = (6.2, 6.2 / ratio)
    law = make_law(
        "linear_viscoelastic", stiffness=20.66e6, restitution=restitution, masses=masses, tension=True
    )
    exact = contact_time_linear(20.66e6, reduced_mass(*masses), linear_damping_ratio(restitution))
    assert collide(law, *masses, 0.3).duration_s == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("speed", SPEEDS)
def test_contact_time_of_hertz(law_with: Any, ratio: float, speed: float) -> None:
    masses = (6.2, 6.2 / ratio)
    exact = contact_time_hertz(9.772e8, reduced_mass(*masses), speed)
    assert collide(law_with("hertz"), *masses, speed).duration_s == pytest.approx(exact, rel=1e-5)


def test_histories_obey_the_law(law: Law) -> None:
    found = collide(law, 6.2, 3.1, 0.3)
    np.testing.assert_allclose(found.force_n, law.force(found.deformation_m, found.rate_m_s, 0.3), rtol=1e-12)
    impulse = np.trapezoid(found.force_n, found.time_s)
    # The trapezoid rule loses half an interval of the dashpot's jump at first touch: 400 points, so 1e-3.
    assert impulse == pytest.approx(6.2 * (found.before_m_s[0] - found.after_m_s[0]), rel=1e-3)


@pytest.mark.parametrize("restitution", [0.0, *RESTITUTIONS, 1.0])
def test_stereo_mechanics_keeps_momentum(restitution: float) -> None:
    before, masses = (0.4, -0.1), (6.2, 2.0)
    after = after_impact(*masses, *before, restitution)
    assert np.dot(masses, after) == pytest.approx(np.dot(masses, before), rel=1e-12)
    assert restitution_of(*before, *after) == pytest.approx(restitution, abs=1e-12)


@pytest.mark.parametrize("restitution", [-0.1, 2.0])
def test_stereo_mechanics_refuses_a_restitution_that_cannot_be(restitution: float) -> None:
    with pytest.raises(ContactError, match="restitution"):
        after_impact(1.0, 2.0, 1.0, 0.0, restitution)


def test_the_printed_relations_lose_momentum() -> None:
    """Eq. 2.1 and 2.2 as printed give both bodies a change of the same sign."""
    before, masses = (0.4, -0.1), (6.2, 2.0)
    after = after_impact_as_printed(*masses, *before, 0.81)
    assert abs(np.dot(masses, after) - np.dot(masses, before)) > 1.0


def test_bodies_that_part_do_not_collide(law: Law) -> None:
    with pytest.raises(ContactError, match="must be faster"):
        collide(law, 1.0, 1.0, 0.1, 0.2)
