"""A pair's twin: by the exact solver where the frames are linear, by exudyn where a law acts between floors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.contact import make_law
from pounding.diagnosis.model import twin
from pounding.diagnosis.model.model import Model
from tests.diagnosis.pair_models import CONTACT, FLOORS, MASS, STEP_S, colliding, model_of


def test_the_exact_twin_of_a_pair_is_the_engines(monkeypatch: pytest.MonkeyPatch) -> None:
    model = model_of(colliding(CONTACT, measured=False))
    alone = Model(model.structure, replace(model.observed, runs=model.observed.runs[:1]), model.prior)
    law = make_law(
        CONTACT.law, stiffness=CONTACT.stiffness, restitution=CONTACT.restitution, masses=(MASS, MASS)
    )
    between = twin.Between(FLOORS - 1, 2 * FLOORS - 1, law, CONTACT.gap_m)
    values = np.zeros(len(alone.std))
    exact = twin.simulate_pair(alone, values, (), 0, between)
    monkeypatch.setattr(twin, "_linear", lambda *_: False)
    engine = twin.simulate_pair(alone, values, (), 0, between)
    for mine, other in zip(exact[0].T, engine[0].T, strict=True):
        assert np.sqrt(np.mean((mine - other) ** 2)) < 2e-3 * np.sqrt(np.mean(other**2))
    assert exact[1].sum() * STEP_S == pytest.approx(engine[1].sum() * STEP_S, rel=2e-3)
    assert exact[1].max() == pytest.approx(engine[1].max(), rel=1e-2)
