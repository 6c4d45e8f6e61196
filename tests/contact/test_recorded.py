"""Laws recorded for compiled loops give what the laws give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from pounding.contact import ContactError, Law, thesis_law
from pounding.contact.evaluation import force_of
from pounding.contact.laws import LAWS, LinearViscoelastic
from pounding.contact.recorded import recorded

FIVE = ("linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp")


def evaluated(law: Law, deformation: float, rate: float, approach: float) -> float:
    program = recorded(law)
    registers = program.registers.copy()
    found: float = force_of(
        program.instructions,
        0,
        len(program.instructions),
        registers,
        program.result,
        deformation,
        rate,
        approach,
    )
    return found


@pytest.fixture
def forgotten() -> Any:
    """Laws of a test are not known to the others."""
    known = dict(LAWS)
    yield
    LAWS.clear()
    LAWS.update(known)


@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize("name", FIVE)
def test_the_thesis_laws_are_recorded_as_they_are_defined(name: str, tension: bool) -> None:
    law = thesis_law(name, masses=(6.0, 5.0), tension=tension)
    rng = np.random.default_rng(1)
    for deformation, rate, approach in zip(
        rng.uniform(1e-9, 1e-4, 50), rng.normal(0.0, 0.3, 50), rng.uniform(0.0, 0.5, 50), strict=True
    ):
        assert evaluated(law, deformation, rate, approach) == pytest.approx(
            float(law.force(deformation, rate, approach)), rel=1e-12, abs=1e-12
        )


def test_a_law_with_every_operation_is_recorded(forgotten: None) -> None:
    @dataclass(frozen=True)
    class Everything(Law):
        name: ClassVar[str] = "everything"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            curved = 2.0**rate + deformation**1.5 / (1.0 + approach) - (-rate) + abs(rate)
            branch = xp.where(rate > 0.1, xp.sqrt(deformation), 3.0 - xp.power(deformation, 2.0))
            other = xp.where(rate <= 0.2, 1.0, xp.maximum(rate, approach)) + xp.where(
                approach >= rate, 5.0, rate
            )
            return self.stiffness * (1.0 / (1.0 + deformation)) * (+curved + branch * other)

    law = Everything(7.0, tension=True)
    for deformation, rate, approach in [
        (0.3, 0.05, 0.4),
        (0.3, 0.15, 0.4),
        (0.3, 0.5, 0.4),
        (0.3, -0.5, 0.0),
    ]:
        assert evaluated(law, deformation, rate, approach) == pytest.approx(
            float(law.force(deformation, rate, approach)), rel=1e-12
        )


@pytest.mark.parametrize("kind", ["branch", "numpy", "method", "equal", "unequal"])
def test_a_law_that_cannot_be_recorded_is_refused_in_a_sentence(kind: str, forgotten: None) -> None:
    @dataclass(frozen=True)
    class Wayward(Law):
        name: ClassVar[str] = "wayward"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            if "equal" in kind:
                asked = approach == 0.0 if kind == "equal" else approach != 0.0
                return xp.where(asked, 2.0, 1.0) * deformation
            if kind == "branch":
                return self.stiffness * deformation if rate > 0 else 0.0
            return np.sin(deformation) if kind == "numpy" else deformation.clip(0.0)

    with pytest.raises(ContactError, match=r"wayward: the formula cannot be recorded .*--solver exudyn"):
        recorded(Wayward(1.0))


def test_a_constant_force_is_a_law_too(forgotten: None) -> None:
    @dataclass(frozen=True)
    class Constant(Law):
        name: ClassVar[str] = "constant"

        def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
            return 12.5

    assert evaluated(Constant(1.0), 1e-3, 0.0, 0.0) == 12.5


def test_a_dashpot_does_not_pull_unless_asked() -> None:
    law = LinearViscoelastic(1e6, damping=1e4)
    assert evaluated(law, 1e-6, -1.0, 0.1) == 0.0
    assert evaluated(LinearViscoelastic(1e6, True, 1e4), 1e-6, -1.0, 0.1) == pytest.approx(1.0 - 1e4)
