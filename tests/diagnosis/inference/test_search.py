"""The search for effects: from where refinements start."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.findings import Findings, judge
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.search import softer
from pounding.diagnosis.inference.starting import calibrated
from tests.diagnosis.models import measured


def test_a_soft_base_is_found_from_a_stiff_one() -> None:
    base = next(one for one in candidates(measured()) if one.name == "base_rocking")
    truth = np.array([8000.0])
    model = measured([(base, truth)])
    null = refine(model, calibrated(model, [0]), (), (), ())
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, [base], sizes)
    found = Findings(model, judge(model, null, null, (0,), (1,)), scores, sizes, (0,), (1,))
    stiff = 6.0 * truth
    stuck = refine(model, null.filtered, (base,), (stiff,), (stiff,), iterations=0, thorough=False)
    fit = softer(found, stuck)
    assert fit.log_posterior > stuck.log_posterior + 1000.0
    assert fit.values[0] == pytest.approx(truth, rel=0.02)
