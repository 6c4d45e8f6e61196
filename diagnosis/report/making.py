"""From a diagnosis to the report on it: what the exudyn model with the effects in it leaves of the misfit."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import msgspec
import numpy as np
from msgspec import UNSET

from pounding.diagnosis.decision.claims import finite
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.decision import NAMED, Verdict
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.decision.false_alarms import remains
from pounding.diagnosis.decision.measures import before
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import channel_misfits, median
from pounding.diagnosis.inference.misfit_map import Spot, where
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.twin import simulate_engine
from pounding.diagnosis.report.report import HeldOutMisfit, Misfit, Misfits, ModalRow, Report
from pounding.diagnosis.report.report_text import listed, misread
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.rig.motion import FrameMotion

Outputs = dict[int, np.ndarray]
"""Channels in SI, shape (samples, channels), by the number of the run."""


@dataclass(frozen=True)
class Made:
    """A report, and what the engine gave for the model behind it; nothing for the baseline model.

    Attributes:
        report: The report.
        outputs: The channels of each run.
        motions: The motion of all frames, as one body, of the run that is shown on the frame, by its number.
    """

    report: Report
    outputs: Outputs
    motions: dict[int, FrameMotion] = field(default_factory=dict)


def report_on(diagnosis: Diagnosis) -> Made:
    """Return the report on a diagnosis; the exudyn model with the effects is run here, once for each run.

    Whatever the verdict, `after` is with the likeliest candidate in the model.
    """
    found, conclusion = diagnosis.found, diagnosis.conclusion
    motions: dict[int, FrameMotion] = {}
    outputs = _outputs(diagnosis, motions)
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
        found.baseline.fit.filtered,
        np.nan_to_num(found.floor[0], nan=1.0),
        [*found.training, *found.held_out],
    )
    contact = UNSET if conclusion.contact_misfit is None else conclusion.contact_misfit
    misfits = with_shares(Misfits(training=training, held_out=held_out, contact=contact), conclusion.verdict)
    warnings = lacked(found, diagnosis.decision.judged)
    if found.pair is not None:
        left = training.after if diagnosis.decision.named else training.before
        warnings = poor_forces(found.pair, left, training.noise_floor)
    if diagnosis.decision.named:
        read = (misread(diagnosis.case, effect) for effect in conclusion.effects)
        warnings = [*warnings, *(said for said in read if said)]
    return Made(assembled(conclusion, misfits, spots, warnings), outputs, motions)


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
        warnings=said_once([*conclusion.warnings, *warnings]),
        modal=tuple(modal) or UNSET,
    )


def with_shares(misfits: Misfits, verdict: Verdict) -> Misfits:
    """Return the misfits with the share that the effects explain; None where nothing is missing: there is no effect.

    Args:
        misfits: The misfits before and after.
        verdict: The verdict of the report.
    """
    training, held_out = (
        None if one is None else msgspec.structs.replace(one, explained=_share(one, verdict))
        for one in (misfits.training, misfits.held_out)
    )
    return msgspec.structs.replace(misfits, training=training, held_out=held_out)


def _share(misfit: Misfit, verdict: Verdict) -> float | None:
    # What is simulated after is then the likeliest candidate, which explains nothing and may well make it worse.
    return None if verdict == "nothing_missing" else misfit.share()


def said_once(warnings: Sequence[str]) -> tuple[str, ...]:
    """Return warnings with what holds for several runs said once: `run1.csv and run2.csv: no table acceleration ...`.

    Args:
        warnings: Sentences; one on a run begins with its name and a colon.
    """
    found: dict[str, list[str]] = {}
    for warning in dict.fromkeys(warnings):
        of, mark, said = warning.partition(": ")
        found.setdefault(said if mark else of, []).extend([of] if mark else [])
    return tuple(f"{listed(of)}: {said}" if of else said for said, of in found.items())


def lacked(found: Findings, judged: Judged) -> list[str]:
    """Return a warning where the model lacks something in the reference runs too.

    Args:
        found: What the search found.
        judged: What the verdict rests on.
    """
    left = before(found, judged)
    if not remains(found, left):
        return []
    names = " and ".join(found.model.observed.runs[run].name for run in found.reference)
    return [
        f"{names}: the runs from before leave {left:.2g} noise floors too; what the baseline model lacked then is no change "
        "and is not looked for: diagnose them as a case of their own"
    ]


def poor_forces(pair: Pair, left: float | None, noise: float | None) -> list[str]:
    """Return a warning where forces that no cell measured leave much of the motion unexplained.

    Args:
        pair: The pair.
        left: Misfit over the training runs.
        noise: Its noise floor.
    """
    if not pair.blind or left is None or noise is None or left < SETTINGS.report.poor_forces * noise:
        return []
    return [
        f"the contact forces were found from the motion and leave {left / noise:.1f} times the noise in the runs used: "
        "what is said of the frames is worth less than with a force cell"
    ]


def shown_run(found: Findings) -> int:
    """Return the number of the run that is shown on the frame: the first one that was held out, else the first one used."""
    return (found.held_out or found.training)[0]


def shown_after(diagnosis: Diagnosis) -> Judged | None:
    """Return the candidate with which `after` is run: the verdict's, else the likeliest.

    Where none has evidence it is the null model, if that has errors of the frame in it, else None.
    """
    if diagnosis.decision.named:
        return diagnosis.decision.judged
    found = diagnosis.found
    errors = found.null if found.plain is not None else None
    # What is claimed of a contact changes nothing in frames whose forces are measured.
    return errors if diagnosis.conclusion.verdict in NAMED else _likeliest(found) or errors


def corrected(found: Findings, judged: Judged) -> tuple[Model, Filtered]:
    """Return the model with a candidate in it, and with forces between frames as frames with it put them right."""
    if found.settled is not None and found.settled[0] is judged:
        return found.settled[1:]
    return found.model, judged.fit.filtered


def without(filtered: Filtered, left_out: Collection[Effect]) -> Filtered:
    """Return a fit without some of its effects, everything else as it is.

    Args:
        filtered: The fit.
        left_out: The effects.
    """
    return replace(filtered, effects=tuple(one for one in filtered.effects if one[0] not in left_out))


def _outputs(diagnosis: Diagnosis, motions: dict[int, FrameMotion]) -> Outputs:
    """Return the runs as the engine gives them with the effects in them, empty where no candidate has evidence.

    The motion of the one that is shown on the frame is put beside them; those of all long runs would fill the memory.
    """
    found, judged = diagnosis.found, shown_after(diagnosis)
    if judged is None:
        return {}
    model, filtered = corrected(found, judged)
    runs = (*found.training, *found.held_out)
    shown = shown_run(found)
    seen = {shown: partial(motions.__setitem__, shown)}
    try:
        outputs = simulate_engine(model, filtered.values, filtered.effects, runs, seen)
    except CaseError:
        if diagnosis.decision.named:
            raise
        # Nothing is claimed of it: the report says then what the baseline model leaves.
        motions.clear()
        return {}
    return dict(zip(runs, outputs, strict=True))


def _likeliest(found: Findings) -> Judged | None:
    """Return the likeliest candidate of the catalogue, or None where none has evidence."""
    tried = (one for one in found.claimable() if not any(effect.rival for effect in one.effects))
    best = max(tried, key=lambda one: one.ln_bayes, default=None)
    return best if best is not None and best.ln_bayes > 0 else None


def _misfit(diagnosis: Diagnosis, which: int, outputs: Outputs) -> Misfit:
    found = diagnosis.found
    runs = (found.training, found.held_out)[which]
    plain = after = found.baseline.misfit[which]
    if outputs:
        after = float(median(channel_misfits(found.model, [outputs[run] for run in runs], runs)))
    return Misfit(
        before=finite(plain), after=finite(after), noise_floor=finite(float(median(found.floor[which])))
    )
