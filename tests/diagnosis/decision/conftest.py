"""What fits that no data made are asked."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.diagnosis.decision import measures, objections
from pounding.diagnosis.inference.findings import Findings, Judged


@pytest.fixture
def made_up_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no other frame move like that of a made-up fit, and let its effects do what they take out of the misfit."""
    monkeypatch.setattr(objections, "nearest_frame", lambda _, judged: judged.fit.filtered.values)
    monkeypatch.setattr(measures, "what_is_done", taken)


def taken(found: Findings, judged: Judged) -> np.ndarray:
    """Return what effects take out of each channel, in powers of its noise, (2, channels)."""
    before, after = (measures.over_noise(found, one) ** 2 for one in (found.null, judged))
    return np.abs(before - after)
