"""An effect behind a larger error of the frame: a part that sways on the roof, and friction in a storey below."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.decision.measures import model_error
from pounding.diagnosis.decision.verdict import decide, error_of_frame
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.null_with_error import with_error
from pounding.diagnosis.inference.search import search
from tests.diagnosis.models import measured

SWAYING, RUBBING = np.array([0.1, 11.0, 0.02]), np.array([0.15, 10.0, 0.0])


def silent(what: str, share: float) -> None:
    """Tell nobody."""


def test_an_effect_that_alone_has_no_evidence_is_named_beside_the_error_that_hides_it() -> None:
    every = candidates(measured())

    def one(name: str, place: int) -> Effect:
        return next(
            effect for effect in every if effect.name == name and place in (effect.storey, effect.floor)
        )

    sway, rub = one("appendage", 3), one("coulomb_friction", 2)
    model = measured([(sway, SWAYING), (rub, RUBBING)], noise=0.005)
    effects = [sway, rub, one("coulomb_friction", 1), one("coulomb_friction", 3), one("cubic_stiffness", 2)]
    found = search(model, effects, [0], [1], silent)
    alone = [judged for judged in found.judged if judged.effects == (rub,)]
    assert all(judged.ln_bayes < 0.0 for judged in alone)
    error = error_of_frame(found)
    assert error is not None
    assert error.effects == (sway,)
    about = with_error(found, error, effects, silent)
    assert about.null.effects == ()
    assert about.null.fit.effects == (sway,)
    assert model_error(about) < model_error(found)
    decision = decide(about)
    assert decision.verdict == "effect_named"
    assert decision.judged.effects == (rub,)
    assert decision.judged.fit.values[1][0] == pytest.approx(RUBBING[0], rel=0.03)
    assert decision.judged.ln_bayes == pytest.approx(
        decision.judged.fit.log_posterior - error.fit.log_posterior
    )
    (said,) = decision.model_checks
    assert said.startswith("the model also has a little appendage, floor 3 of bench")
