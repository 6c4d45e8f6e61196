"""The search for effects: from where refinements start."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.baseline import calibrated
from diagnosis.catalogue import candidates
from diagnosis.evidence import scales, score
from diagnosis.findings import Findings, judge
from diagnosis.refine import refine
from diagnosis.search import softer
from tests.diagnosis.models import measured


def test_a_soft_base_is_found_from_a_stiff_one() -> None:
    base = next(one for one in candidates(measured()) if one.name == "base_rocking")
    truth = np.array([8000.0])
    believed = measured([(base, truth)])
    null = refine(believed, calibrated(believed, [0]), (), (), ())
    sizes = scales(believed, null.baseline)
    scores = score(believed, null.baseline, [base], sizes)
    found = Findings(believed, judge(believed, null, null, (0,), (1,)), scores, sizes, (0,), (1,))
    stiff = 6.0 * truth
    stuck = refine(believed, null.baseline, (base,), (stiff,), (stiff,), iterations=0, thorough=False)
    fit = softer(found, stuck)
    assert fit.log_posterior > stuck.log_posterior + 1000.0
    assert fit.values[0] == pytest.approx(truth, rel=0.02)
