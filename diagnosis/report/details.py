"""What a report says beside the keys of docs/diagnosis/case-format.md: worked out only when a report is written."""

from __future__ import annotations

from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.design.detectability import smallest
from pounding.diagnosis.design.distinguishing_tests import apart
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.misfit import channel_misfits, simulate
from pounding.diagnosis.report.origin import origin

EXPLAINABLE = 1.1
"""A gap is explainable when it exceeds the noise floor by this factor; below, a share of it means nothing."""


def completed(case: Case, found: Findings, report: dict[str, Any]) -> dict[str, Any]:
    """Return the report with ``gap.*.closed`` and what is beside the format's keys.

    These are ``channels``, ``smallest_detectable``, ``apart``, ``thresholds`` and ``origin``.

    ``closed`` is the share of the gap above the noise floor that was closed, or None where nothing is explainable.
    """
    misfits = {
        name: gap | {"closed": _closed(gap)} if gap and "noise_floor" in gap else gap
        for name, gap in report["gap"].items()
    }
    return report | {
        "gap": misfits,
        "channels": channels(found, decide(found)),
        "smallest_detectable": smallest(case, found, decide(found)),
        "apart": apart(report, _measured(found)),
        "thresholds": _thresholds(found, False) | {"absorbing": _thresholds(found, True)},
        "origin": origin(case),
    }


def _thresholds(found: Findings, absorbing: bool) -> dict[str, float]:
    ln_bayes, size = found.thresholds(absorbing)
    return {"log_evidence": ln_bayes, "share_of_noise": size}


def channels(found: Findings, decision: Decision) -> list[dict[str, Any]]:
    """Return each channel's gap before and after and its noise floor, on the held-out runs if there are any."""
    which = 1 if found.held_out else 0
    after = found.null.channel_misfit[which]
    if decision.verdict in ("effect_named", "effect_class"):
        runs = (found.training, found.held_out)[which]
        after = channel_misfits(found.model, after_runs(found, decision, runs), runs)
    names, columns = found.model.observed.names, (found.null.channel_misfit[which], after, found.floor[which])
    return [
        {"channel": name, "before": before, "after": left, "noise_floor": noise}
        for name, before, left, noise in zip(names, *columns, strict=True)
    ]


def after_runs(found: Findings, decision: Decision, runs: tuple[int, ...]) -> list[np.ndarray]:
    """Return the channels (samples, channels) [SI] of runs as the engine gave them for the verdict's model."""
    if all(run in found.engine for run in runs):
        return [found.engine[run] for run in runs]
    fit = decision.judged.fit.filtered
    return simulate(found.model, fit.values, fit.effects, runs)


def _closed(gap: dict[str, Any]) -> float | None:
    if not gap["before"] > EXPLAINABLE * gap["noise_floor"]:
        return None
    return float((gap["before"] - gap["after"]) / (gap["before"] - gap["noise_floor"]))


def _measured(found: Findings) -> dict[str, list[int]]:
    """Return the floors with a channel, by frame."""
    structure = found.model.structure
    floors: dict[str, list[int]] = {}
    for index in np.unique(found.model.observed.floor):
        if 0 <= index < structure.floors:
            frame, number = structure.place(int(index))
            floors.setdefault(frame, []).append(number)
    return floors
