"""What a verdict is: its name, the candidate behind it, and what speaks against it."""

from __future__ import annotations

from dataclasses import dataclass

from pounding.diagnosis.inference.findings import Judged


@dataclass(frozen=True)
class Decision:
    """A verdict: its name, the candidate behind it, candidates that cannot be told from it, and what speaks against it."""

    verdict: str
    judged: Judged
    alike: tuple[Judged, ...]
    model_checks: tuple[str, ...] = ()
