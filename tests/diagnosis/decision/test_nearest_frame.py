"""The nearest frame that moves alike: what the error that a model may have leaves of a frame that seems another one."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec import structs

from pounding.diagnosis.decision.nearest_frame import nearest_frame
from pounding.diagnosis.inference.misfit import own_error, simulate
from pounding.diagnosis.inference.model_checks import strain
from pounding.diagnosis.model.observations import root_mean_square
from tests.diagnosis.report.test_calibration import softer


def test_it_moves_alike_within_the_error_that_a_model_may_have(monkeypatch: pytest.MonkeyPatch) -> None:
    found = softer()
    model, fit = found.model, found.null.fit.filtered
    own, output = strain(model, fit.values)[0], simulate(model, fit.values, fit.effects, [0])[0]
    strains = []
    for allowed in (1e-7, 1e-3, 0.05, 1.0, 100.0):
        monkeypatch.setattr(model, "prior", structs.replace(model.prior, model_error=allowed))
        found.nearest.clear()
        nearest = nearest_frame(found, found.null)
        moved = root_mean_square(simulate(model, nearest, fit.effects, [0])[0] - output)
        assert np.all(moved < 5 * own_error(model, fit, 0) + fit.noise[0].channel)
        strains.append(strain(model, nearest)[0])
    found.nearest.clear()
    assert strains == sorted(strains, reverse=True)
    assert strains[0] == pytest.approx(own, rel=0.3)
    assert strains[-1] < 0.01 * own


def test_it_is_worked_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    found = softer()
    first = nearest_frame(found, found.null)
    monkeypatch.setattr("pounding.diagnosis.decision.nearest_frame.run_filter", None)
    assert nearest_frame(found, found.null) is first
