"""The laws under test, with parameters of the thesis' order."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from pounding.contact import Law, make_law
from pounding.contact.parameters import FLOOR_MASS

FIVE = ("linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp")
STIFFNESS = {"linear_spring": 20.66e6, "linear_viscoelastic": 20.66e6}
LawMaker = Callable[..., Law]


@pytest.fixture(scope="session")
def law_with() -> LawMaker:
    """Makes a law that is asked for a restitution; the elastic laws have none to ask for."""

    def make(
        name: str, restitution: float = 0.81, masses: tuple[float, float] = (FLOOR_MASS,) * 2, **own: object
    ) -> Law:
        damped = {} if name in ("linear_spring", "hertz") else {"restitution": restitution}
        return make_law(name, stiffness=STIFFNESS.get(name, 9.772e8), masses=masses, **damped, **own)

    return make


@pytest.fixture(params=FIVE)
def law(request: pytest.FixtureRequest, law_with: LawMaker) -> Law:
    return law_with(request.param)


@pytest.fixture(params=FIVE)
def name(request: pytest.FixtureRequest) -> str:
    return request.param
