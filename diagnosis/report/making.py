"""From a diagnosis to the report on it: what the exudyn model with the effects in it leaves of the misfit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from msgspec import UNSET

from pounding.diagnosis.decision.claims import finite
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.inference.findings import Judged
from pounding.diagnosis.inference.misfit import median, misfit
from pounding.diagnosis.inference.misfit_map import Spot, where
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.twin import simulate_engine
from pounding.diagnosis.report.report import HeldOutMisfit, Misfit, Misfits, ModalRow, Report
from pounding.diagnosis.settings import SETTINGS

Outputs = dict[int, np.ndarray]
"""Channels in SI, shape (samples, channels), by the number of the run."""


@dataclass(frozen=True)
class Made:
    """A report, and the channels as the engine gave them for the model behind it; empty for the baseline model."""

    report: Report
    outputs: Outputs


def report_on(diagnosis: Diagnosis) -> Made:
    """Return the report on a diagnosis; the exudyn model with the effects is run here, once for each run."""
    found, conclusion = diagnosis.found, diagnosis.conclusion
    judged = found.null if diagnosis.decision.verdict == "unknown_effect" else diagnosis.decision.judged
    outputs = {} if judged is found.null else _outputs(diagnosis, judged)
    training = _misfit(diagnosis, 0, outputs)
    held_out = None
    if found.held_out:
        names = ", ".join(found.model.observed.runs[run].name for run in found.held_out)
        values = _misfit(diagnosis, 1, outputs)
        held_out = HeldOutMisfit(
            run=names, before=values.before, after=values.after, noise_floor=values.noise_floor
        )
    spots = where(
        found.model,
        found.null.fit.filtered,
        np.nan_to_num(found.floor[0], nan=1.0),
        [*found.training, *found.held_out],
    )
    contact = UNSET if conclusion.contact_misfit is None else conclusion.contact_misfit
    misfits = Misfits(training=training, held_out=held_out, contact=contact)
    warnings = [] if found.pair is None else poor_forces(found.pair, training)
    return Made(assembled(conclusion, misfits, spots, warnings), outputs)


def assembled(
    conclusion: Conclusion,
    misfits: Misfits,
    spots: Sequence[Spot] = (),
    warnings: Sequence[str] = (),
    modal: Sequence[ModalRow] = (),
) -> Report:
    """Return the report that states a conclusion.

    Args:
        conclusion: The conclusion.
        misfits: How far the model is from the measurements before and after.
        spots: Where the baseline model disagrees most.
        warnings: Sentences beside those of the conclusion.
        modal: The modal data, of a case with these alone.
    """
    return Report(
        verdict=conclusion.verdict,
        confidence=conclusion.confidence,
        confidence_basis=conclusion.basis,
        effects=conclusion.effects,
        misfit=misfits,
        where=tuple(spots),
        candidates=conclusion.candidates,
        warnings=(*conclusion.warnings, *warnings),
        modal=tuple(modal) or UNSET,
    )


def poor_forces(pair: Pair, training: Misfit) -> list[str]:
    """Return a warning where forces that no cell measured leave much of the motion unexplained."""
    after, noise = training.after, training.noise_floor
    if not pair.blind or after is None or noise is None or after < SETTINGS.report.poor_forces * noise:
        return []
    return [
        f"the contact forces were found from the motion and leave {after / noise:.1f} times the noise in the runs used: "
        "what is said of the frames is worth less than with a force cell"
    ]


def _outputs(diagnosis: Diagnosis, judged: Judged) -> Outputs:
    found = diagnosis.found
    model, filtered = found.model, judged.fit.filtered
    if found.settled is not None and found.settled[0] is judged:
        _, model, filtered = found.settled
    runs = (*found.training, *found.held_out)
    return dict(zip(runs, simulate_engine(model, filtered.values, filtered.effects, runs), strict=True))


def _misfit(diagnosis: Diagnosis, which: int, outputs: Outputs) -> Misfit:
    found = diagnosis.found
    runs = (found.training, found.held_out)[which]
    before = found.null.misfit[which]
    after = misfit(found.model, [outputs[run] for run in runs], runs) if outputs else before
    return Misfit(
        before=finite(before), after=finite(after), noise_floor=finite(float(median(found.floor[which])))
    )
