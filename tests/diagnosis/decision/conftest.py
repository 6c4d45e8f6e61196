"""What fits that no data made are asked."""

from __future__ import annotations

import pytest

from pounding.diagnosis.decision import objections


@pytest.fixture
def own_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no other frame move like that of a made-up fit."""
    monkeypatch.setattr(objections, "nearest_frame", lambda _, judged: judged.fit.filtered.values)
