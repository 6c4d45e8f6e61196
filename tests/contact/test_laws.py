"""The five laws as functions: signs, continuity, monotonicity, the same numbers by every road."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pounding.contact import ContactError, HertzDamp, Law, LinearSpring, collide, law_class, make_law, names
from pounding.contact.laws import LAWS, FloatOperations

FIVE = ("linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp")
DEFORMATION = st.floats(1e-9, 5e-3)
RATE = st.floats(-2.0, 2.0)
APPROACH = st.floats(0.02, 2.0)
NAME = st.sampled_from(FIVE)
quickly = settings(max_examples=60, deadline=None, derandomize=True)


def test_the_five_laws_are_known_by_their_names() -> None:
    assert tuple(names()[:5]) == FIVE
    with pytest.raises(ContactError, match="known are linear_spring"):
        law_class("xyz")
    with pytest.raises(ContactError, match="did you mean hertz"):
        law_class("hertzian")


@quickly
@given(NAME, st.floats(-1e-2, 0.0), RATE, APPROACH)
def test_no_force_while_apart(
    law_with: Any, name: str, deformation: float, rate: float, approach: float
) -> None:
    assert law_with(name, tension=True).force(deformation, rate, approach) == 0.0


@quickly
@given(NAME, DEFORMATION, RATE, APPROACH)
def test_a_contact_never_pulls_unless_told(
    law_with: Any, name: str, deformation: float, rate: float, approach: float
) -> None:
    assert law_with(name).force(deformation, rate, approach) >= 0.0


@quickly
@given(NAME, DEFORMATION, st.floats(-1.0, 1.0), APPROACH)
def test_damping_opposes_the_rate(
    law_with: Any, name: str, deformation: float, share: float, approach: float
) -> None:
    """Approaching floors are pushed harder, parting ones less, than the spring alone would push."""
    law = law_with(name, tension=True)
    rate = share * approach
    beyond = law.force(deformation, rate, approach) - law.force(deformation, 0.0, approach)
    assert beyond * rate >= 0.0


@quickly
@given(NAME, DEFORMATION, st.floats(1.0, 1.5), st.floats(0.0, 1.0), APPROACH)
def test_force_grows_with_deformation_while_approaching(
    law_with: Any, name: str, deformation: float, factor: float, share: float, approach: float
) -> None:
    law = law_with(name)
    rate = share * approach
    assert law.force(factor * deformation, rate, approach) >= law.force(deformation, rate, approach)


@quickly
@given(NAME, DEFORMATION, RATE, APPROACH)
def test_force_is_continuous_while_in_touch(
    law_with: Any, name: str, deformation: float, rate: float, approach: float
) -> None:
    law = law_with(name)
    here = law.force(deformation, rate, approach)
    nearby = law.force(deformation * (1 + 1e-9), rate + 1e-9, approach)
    assert nearby == pytest.approx(here, rel=1e-6, abs=1e-3)


def test_only_the_linear_dashpot_jumps_at_first_touch(law: Law) -> None:
    jump = float(law.force(1e-24, 0.3, 0.3))
    assert jump == pytest.approx(getattr(law, "damping", 0.0) * 0.3, abs=0.1)


@quickly
@given(NAME, st.lists(st.tuples(st.floats(-5e-3, 5e-3), RATE, APPROACH), min_size=1, max_size=8))
def test_arrays_and_floats_give_the_same(law_with: Any, name: str, states: list[tuple[float, ...]]) -> None:
    law = law_with(name)
    columns = np.array(states).T
    together = law.force(*columns)
    one_by_one = [law.force(*state, FloatOperations) for state in states]
    np.testing.assert_allclose(together, one_by_one, rtol=1e-12)


def test_stored_energy_is_the_springs(law: Law) -> None:
    deep = 1e-4
    power = 2.0 if law.unit == "N/m" else 2.5
    assert law.stored_energy(deep) == pytest.approx(law.stiffness * deep**power / power, rel=1e-6)
    assert law.stored_energy(-deep) == 0.0


def test_tension_off_and_on() -> None:
    """At the end of an impact the printed formula pulls; with the switch off it lets go."""
    off = make_law("linear_viscoelastic", stiffness=20.66e6, damping=1255.0)
    on = replace(off, tension=True)
    assert off.force(1e-6, -0.2) == 0.0
    assert on.force(1e-6, -0.2) == pytest.approx(20.66 - 251.0)
    assert collide(on, 6.2, 6.2, 0.3).force_n.min() < -100.0
    assert collide(off, 6.2, 6.2, 0.3).force_n.min() >= 0.0


@pytest.mark.parametrize("restitution", [0.0, 1.2, -0.5])
@pytest.mark.parametrize("name", ["linear_viscoelastic", "nonlinear_viscoelastic", "hertz_damp"])
def test_impossible_restitution_is_refused(name: str, restitution: float) -> None:
    with pytest.raises(ContactError, match="coefficient of restitution"):
        make_law(name, stiffness=1e7, restitution=restitution)


@pytest.mark.parametrize("name", ["linear_viscoelastic", "nonlinear_viscoelastic", "hertz_damp"])
def test_restitution_of_one_is_the_elastic_law(name: str) -> None:
    law = make_law(name, stiffness=1e7, restitution=1.0)
    assert law.force(1e-4, 0.3, 0.3) == law.force(1e-4, -0.3, 0.3)


@pytest.mark.parametrize("stiffness", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_stiffness_is_refused(name: str, stiffness: float) -> None:
    with pytest.raises(ContactError, match="stiffness"):
        make_law(name, stiffness=stiffness)


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("linear_viscoelastic", {"damping": -1.0}, "create energy"),
        ("linear_viscoelastic", {"damping": 1.0, "restitution": 0.8}, "give one of them"),
        ("linear_viscoelastic", {"restitution": 0.8, "masses": (0.0, 1.0)}, "must be positive"),
        ("nonlinear_viscoelastic", {"damping_ratio": -0.1}, "create energy"),
        ("nonlinear_viscoelastic", {"damping": 3.0}, "no use"),
        ("hertz", {"restitution": 0.8}, "no use"),
        ("hertz_damp", {"formula": "hunt"}, "known are ye, muthukumar"),
        ("hertz_damp", {"slowest_approach": 0.0}, "slowest_approach"),
    ],
)
def test_other_nonsense_is_refused(name: str, values: dict[str, Any], words: str) -> None:
    with pytest.raises(ContactError, match=words):
        make_law(name, stiffness=1e7, **values)


def test_a_users_law_is_known_everywhere() -> None:
    @dataclass(frozen=True)
    class Progressive(Law):
        name: ClassVar[str] = "progressive_for_test"
        unit: ClassVar[str] = "N/m^2"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            return self.stiffness * xp.power(deformation, 2.0)

    try:
        law = make_law("progressive_for_test", stiffness=1e11)
        assert law.force(1e-4, 0.0) == pytest.approx(1e3)
        assert collide(law, 1.0, 2.0, 0.5).restitution == pytest.approx(1.0, abs=1e-8)
    finally:
        del LAWS["progressive_for_test"]


def test_slow_approach_does_not_blow_up_hertz_damp() -> None:
    """Two floors lying against each other have no approach velocity to divide by."""
    law = HertzDamp(9.772e8, restitution=0.81)
    assert law.force(1e-5, 1e-3, 0.0) <= 2.0 * law.force(1e-5, 0.0, 0.0)


def test_a_law_is_hashable_and_comparable() -> None:
    assert LinearSpring(1.0) == LinearSpring(1.0)
    assert len({LinearSpring(1.0), LinearSpring(1.0), LinearSpring(2.0)}) == 2
