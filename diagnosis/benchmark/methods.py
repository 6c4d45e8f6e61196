"""The report of a method that states no confidence and no misfits."""

from __future__ import annotations

from collections.abc import Sequence

from pounding.diagnosis.decision.claims import Claim, candidate
from pounding.diagnosis.report.report import Misfits, Report


def report_of_method(missing: Sequence[Claim], tried: Sequence[Claim]) -> Report:
    """Return what a method says of a case, for the benchmark to judge.

    Args:
        missing: What it says is missing; nothing when empty.
        tried: Everything that it tried, the likeliest first.
    """
    return Report(
        verdict="effect_named" if missing else "nothing_missing",
        confidence=None,
        effects=tuple(missing),
        candidates=tuple(candidate(one.place, one.log_evidence) for one in tried),
        misfit=Misfits(training=None, held_out=None),
        where=(),
        warnings=(),
    )
