"""A pair's twin: by the exact solver, with laws in storeys and known forces or without; by exudyn if that finds no step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pounding.contact import make_law
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.model import twin
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.laws import Law
from pounding.experiments.rig.rig import Accuracy
from pounding.experiments.rig.storey_forces import friction, growing_spring
from tests.diagnosis.pair_models import CONTACT, FLOORS, MASS, STEP_S, STIFFNESS, colliding, model_of

STOREY = STIFFNESS["tall"]
EFFECTS: dict[str, tuple[float, ...]] = {
    "damping_change": (20.0, 0.0),
    "coulomb_friction": (8.0, 15.0, 0.0, 0.3),
    "cubic_stiffness": (0.2 * STOREY / 0.005**2,),
    "hysteresis": (20.0, 0.4 * STOREY, 8.0, 0.0),
    "loosening": (-0.3, 0.5),
    "bumper": (0.003, STOREY, 0.0, 0.0, 0.0),
    "dahl_friction": (8.0, 3e-4),
    "air_drag": (6.0, 0.0, 0.0),
    "table_tilt": (5e-4,),
}
"""Effects that are laws in the tall frame, and one whose forces are known; in SI."""
FINE = Accuracy(1e-9, 1e-11, longest_step_s=1e-4)
"""Steps short enough for what a law remembers, whose error the engine does not measure, and as close as it repeats itself on
other processors: with its usual tolerances floors that are struck may be 4e-3 of their motion apart, with these 4e-4."""


@pytest.fixture(scope="module")
def alone() -> Model:
    model = model_of(colliding(CONTACT, measured=False))
    return Model(model.structure, replace(model.observed, runs=model.observed.runs[:1]), model.prior)


def refused(*_: Any) -> Any:
    raise ExperimentError("not by the exact solver")


def simulated(model: Model, effects: Sequence[tuple[Any, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    law = make_law(
        CONTACT.law, stiffness=CONTACT.stiffness, restitution=CONTACT.restitution, masses=(MASS, MASS)
    )
    between = twin.Between(FLOORS - 1, 2 * FLOORS - 1, law, CONTACT.gap_m)
    return twin.simulate_pair(model, np.zeros(len(model.std)), effects, 0, between)


def agree(exact: tuple[np.ndarray, np.ndarray], engine: tuple[np.ndarray, np.ndarray]) -> None:
    """Hold that they agree: 1.98e-3 at floors that touch, 1e-4 elsewhere, without an effect."""
    for mine, other in zip(exact[0].T, engine[0].T, strict=True):
        assert np.sqrt(np.mean((mine - other) ** 2)) < 2.5e-3 * np.sqrt(np.mean(other**2))
    assert exact[1].sum() * STEP_S == pytest.approx(engine[1].sum() * STEP_S, rel=2e-3)
    assert exact[1].max() == pytest.approx(engine[1].max(), rel=1e-2)


@pytest.fixture(autouse=True)
def finely_integrated(monkeypatch: pytest.MonkeyPatch) -> None:
    """As closely as exudyn repeats itself: by default a table that is off by 1e-14 moves its struck floors by 1.5e-3."""
    monkeypatch.setattr(twin, "COLLIDING", FINE._replace(longest_step_s=Accuracy().longest_step_s))


def without(method: str, monkeypatch: pytest.MonkeyPatch, run: Callable[[], Any]) -> Any:
    with monkeypatch.context() as patched:
        patched.setattr(twin, method, refused)
        return run()


def test_the_exact_twin_of_a_pair_is_the_engines(alone: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = without("Rig", monkeypatch, lambda: simulated(alone, ()))
    agree(exact, without("_exact", monkeypatch, lambda: simulated(alone, ())))


@pytest.mark.parametrize("name", EFFECTS)
def test_it_is_with_a_law_in_a_storey_or_a_table_that_pitches_too(
    name: str, alone: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    effect: Effect = next(place for kind in kinds() if kind.name == name for place in places(kind, alone))
    acting = [(effect, np.array(EFFECTS[name]))]
    assembly = alone.assemble(np.zeros(len(alone.std)), acting)
    assert assembly.laws or assembly.table_tilt
    monkeypatch.setattr(twin, "COLLIDING", FINE)
    exact = without("Rig", monkeypatch, lambda: simulated(alone, acting))
    agree(exact, without("_exact", monkeypatch, lambda: simulated(alone, acting)))
    plain = simulated(alone, ())[0]
    assert np.sqrt(np.mean((exact[0] - plain) ** 2)) > 0.01 * np.sqrt(np.mean(plain**2))


@pytest.mark.parametrize("law", [friction, growing_spring])
def test_it_is_with_a_law_that_acts_on_several_floors_in_any_shares(
    law: Law, alone: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What its own storey's columns bend by where joints turn; one law remembers, one does not."""
    numbers = {friction: (8.0, 15.0 * STOREY, 0.0, np.inf), growing_spring: (-0.3 * STOREY, np.nan)}[law]

    class Bending:
        def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
            drift = model.structure.drift
            assembly.laws.append(PlacedLaw(law, drift[1] - 0.3 * drift[0] - 0.2 * drift[2], numbers))

    acting: Any = [(Bending(), np.zeros(1))]
    monkeypatch.setattr(twin, "COLLIDING", FINE)
    exact = without("Rig", monkeypatch, lambda: simulated(alone, acting))
    agree(exact, without("_exact", monkeypatch, lambda: simulated(alone, acting)))
    plain = simulated(alone, ())[0]
    assert np.sqrt(np.mean((exact[0] - plain) ** 2)) > 0.01 * np.sqrt(np.mean(plain**2))


class Jumping:
    """Friction that jumps with the rate."""

    def __init__(self) -> None:
        def force(p, state, d, v, t, new):  # type: ignore[no-untyped-def]
            return p[0] if v > 0.0 else -p[0]

        self.law = Law(force, cache=False)

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        assembly.laws.append(PlacedLaw(self.law, np.asarray(model.structure.drift[0]), (float(values[0]),)))


def test_a_law_that_the_exact_solver_cannot_follow_is_left_to_the_engine(
    alone: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran = []
    monkeypatch.setattr(twin, "Rig", lambda *_, **__: ran.append(True) or refused())
    with pytest.raises(Exception, match="with the contact in it did not finish"):
        simulated(alone, [(Jumping(), np.array([2.0]))])  # type: ignore[list-item]
    assert ran
