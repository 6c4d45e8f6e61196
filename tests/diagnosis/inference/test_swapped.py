"""Channels that were swapped, told by the model as calibrated to them, or by the baseline model."""

from __future__ import annotations

import pytest

from pounding.diagnosis.inference import null_model
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.null_model import unswapped
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.inference.swapped import exchange, exchanged
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured


@pytest.mark.parametrize("calibrated_tells", [True, False])
def test_the_baseline_model_tells_what_was_swapped_where_the_calibrated_one_is_bent_too_far(
    calibrated_tells: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = measured([], samples=1000)
    model = right.seeing(exchanged(right.observed, 0, 2))
    null = refine(model, calibrated(model, [0]))

    def asked(model: Model, filtered: Filtered) -> tuple[int, int] | None:
        bent = filtered is null.filtered
        return exchange(model, filtered) if calibrated_tells or not bent else None

    monkeypatch.setattr(null_model, "exchange", asked)
    again, fit = unswapped(model, null, [0])
    assert (again.observed.runs[0].measured == right.observed.runs[0].measured).all()
    assert fit.log_posterior > null.log_posterior + 1000.0
    assert any("a1 and a3 are swapped" in warning for warning in model.observed.warnings)


def test_nothing_is_swapped_where_nothing_was() -> None:
    model = measured([], samples=1000)
    null = refine(model, calibrated(model, [0]))
    assert unswapped(model, null, [0]) == (model, null)
