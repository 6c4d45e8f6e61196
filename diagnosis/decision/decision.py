"""What a verdict is: its name, the candidate behind it, and what speaks against it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pounding.diagnosis.inference.findings import Judged

Verdict = Literal["nothing_missing", "effect_named", "effect_class", "unknown_effect"]
NAMED: tuple[Verdict, ...] = ("effect_named", "effect_class")
"""Verdicts that say what is missing."""


@dataclass(frozen=True)
class Decision:
    """What is decided of one set of findings.

    Attributes:
        verdict: Its name.
        judged: The candidate behind it: the best that was tried for an unknown effect, the null model for nothing missing.
        alike: Candidates that these data cannot tell from it.
        model_checks: Sentences on what speaks against the model, and on tones that are within its error.
        objections: Whether some of them do speak against an effect that is unknown.
    """

    verdict: Verdict
    judged: Judged
    alike: tuple[Judged, ...] = ()
    model_checks: tuple[str, ...] = ()
    objections: bool = False

    def __repr__(self) -> str:
        return f"Decision({self.verdict!r}, {self.judged!r}, {len(self.alike)} alike)"

    @property
    def named(self) -> bool:
        """Whether it says what is missing, alone or as one of a class."""
        return self.verdict in NAMED
