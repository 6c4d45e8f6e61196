"""What fits that no data made are asked."""

from __future__ import annotations

import pytest

from pounding.diagnosis.decision import verdict


@pytest.fixture
def own_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no other frame move like that of a made-up fit."""
    monkeypatch.setattr(verdict, "nearest_frame", lambda _, judged: judged.fit.filtered.values)
