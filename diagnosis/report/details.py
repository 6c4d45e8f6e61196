"""What a report says beside its main findings: worked out only when it is written to a folder."""

from __future__ import annotations

import msgspec
import numpy as np
from msgspec import UNSET

from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.decision.claims import finite
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.decision.false_alarms import alarms_of, thresholds
from pounding.diagnosis.design.advice import advice
from pounding.diagnosis.design.detectability import smallest
from pounding.diagnosis.design.distinguishing_tests import distinctions
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.misfit import channel_misfits
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.report.calibration import calibration, remainder
from pounding.diagnosis.report.loops import Loops
from pounding.diagnosis.report.making import Made, Outputs
from pounding.diagnosis.report.origin import origin
from pounding.diagnosis.report.report import ChannelMisfit, Report, Threshold, Thresholds
from pounding.diagnosis.report.shape import shape


def detailed(diagnosis: Diagnosis, made: Made, loop: Loops | None = None) -> Report:
    """Return a report with what docs/diagnosis/reports.md lists beside the keys of the format.

    Args:
        diagnosis: What was found and decided.
        made: The report and what was simulated for it.
        loop: The loops of the named storey, if there is one.
    """
    case, found, report = diagnosis.case, diagnosis.found, made.report
    judged = diagnosis.decision.judged
    sight = Sight.of(found, judged.fit.filtered)
    further = advice(diagnosis)
    return msgspec.structs.replace(
        report,
        remainder=remainder(found, judged, sight),
        calibration=calibration(found, judged, _contact(diagnosis)),
        advice=tuple(one.sentence for one in further),
        advice_evidence=tuple(one.ln_bayes for one in further),
        shape=shape(diagnosis, loop) or UNSET,
        channels=channels(diagnosis, made.outputs),
        smallest_detectable=tuple(smallest(case, found, diagnosis.decision, sight)),
        apart=tuple(distinctions(report.effects, _measured(found))),
        thresholds=_thresholds(found),
        origin=origin(case),
    )


def _contact(diagnosis: Diagnosis) -> Fitted | None:
    """Return the contact of the baseline model as its impacts have it, None without any or where another one is named."""
    named = any(one.contact is not None for one in diagnosis.conclusion.effects)
    return None if diagnosis.contact is None or named else diagnosis.contact.null


def _thresholds(found: Findings) -> Thresholds:
    evidence, size = thresholds(found, False)
    absorbing = thresholds(found, True)
    known = None if found.pair is not None else alarms_of(found)
    return Thresholds(
        false_alarms=UNSET if known is None else known.rate,
        nulls=UNSET if known is None else known.source,
        log_evidence=evidence,
        share_of_noise=size,
        absorbing=Threshold(log_evidence=absorbing[0], share_of_noise=absorbing[1]),
        standard_errors=alarms_of(found).from_none,
    )


def channels(diagnosis: Diagnosis, outputs: Outputs) -> tuple[ChannelMisfit, ...]:
    """Return each channel's misfit before and after and its noise floor, on the held-out runs if there are any."""
    found = diagnosis.found
    which = 1 if found.held_out else 0
    before = after = found.baseline.channel_misfit[which]
    if outputs:
        runs = (found.training, found.held_out)[which]
        after = channel_misfits(found.model, [outputs[run] for run in runs], runs)
    rows = zip(found.model.observed.names, before, after, found.floor[which], strict=True)
    return tuple(
        ChannelMisfit(channel=name, before=finite(b), after=finite(a), noise_floor=finite(noise))
        for name, b, a, noise in rows
    )


def _measured(found: Findings) -> dict[str, list[int]]:
    """Return the floors with a channel, by frame."""
    structure = found.model.structure
    floors: dict[str, list[int]] = {}
    for index in np.unique(found.model.observed.floor):
        if 0 <= index < structure.floors:
            frame, number = structure.place(int(index))
            floors.setdefault(frame, []).append(number)
    return floors
