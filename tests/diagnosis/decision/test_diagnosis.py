"""What is asked of a contact once the frames have been decided on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from pounding.diagnosis.decision import diagnosis as module
from pounding.diagnosis.decision.decision import Decision


def test_a_contact_is_judged_by_the_frames_that_the_verdict_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not by what was likeliest: that may be something outside the catalogue, or two effects of which one is named."""
    likeliest, named = (SimpleNamespace(fit=SimpleNamespace(filtered=name)) for name in ("both", "one"))
    found: Any = SimpleNamespace(pair="pair", judged=[likeliest, named])
    decision: Any = Decision("effect_named", named, (), ())  # type: ignore[arg-type]
    asked: list[object] = []
    nothing: dict[str, Any] = {"claims_of": [], "of_frames": None, "joined": None}
    for name, answer in nothing.items():
        monkeypatch.setattr(module, name, lambda *_, answer=answer: answer)
    monkeypatch.setattr(module, "judge_contact", lambda _case, _found, judged: asked.append(judged))
    monkeypatch.setattr(module, "predicted_impacts", lambda *given: asked.append(given[2]))
    module.conclude(SimpleNamespace(), found, decision)  # type: ignore[arg-type]
    assert asked == [named, "one"]
