"""`diagnose_case`: from a folder of measurements to the report on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.contact_force.force_errors import put_right, put_right_by
from pounding.diagnosis.contact_force.pair import (
    ContactFindings,
    cell_at_its_word,
    foretold,
    found_again,
    judge_contact,
    prepare,
)
from pounding.diagnosis.decision.pair_decision import NAMED, claims_of, joined
from pounding.diagnosis.decision.verdict import decide, report_of
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings, judged_on
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.model.first_frequencies import frequency_warnings
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData, observe
from pounding.diagnosis.model.sensors import screened, usable
from pounding.diagnosis.model.storeys import Structure

Progress = Callable[[str, float], None]


def diagnose_case(
    case_folder: Path | str,
    out: Path | str | None = None,
    progress: Progress | None = None,
    *,
    candidates_file: Path | str | None = None,
    calibrate: bool = False,
) -> dict[str, Any]:
    """Diagnose a case: where it disagrees with the baseline model, what is missing, and what that closes.

    Args:
        case_folder: Folder with `case.toml` and its runs.
        out: Folder for `report.json`, `report.html` and figures; nothing is written when None.
        progress: Called with what is being done and the share that is done (0 to 1).
        candidates_file: Python file with effects of the user's that compete with the catalogue.
        calibrate: Simulate null and rivals on this rig for a confidence of its own (up to 15 minutes, resumed).

    Returns:
        The report, as docs/diagnosis/case-format.md describes it; with `out` also what `diagnosis.report.details` adds.

    Raises:
        CaseError: The case cannot be read or says too little, or the user's candidates cannot be used.
    """
    told = progress or (lambda what, share: None)
    told("reading the case", 0.0)
    own = _own(candidates_file) if candidates_file is not None else []
    case = read_case(case_folder)
    if calibrate and not case.runs:
        raise CaseError(
            f"{case.folder / 'case.toml'}: --calibrate simulates runs, and this case has no run; leave --calibrate out"
        )
    if case.modal and not case.runs:
        return _modal(case, out, told)
    found = find(case, told, own)
    report = report_of(case, found)
    contact_findings = None
    if found.pair is not None:
        told("looking at the impacts", 0.9)
        report, contact_findings = report_on_pair(case, found, report)
    if calibrate:
        report |= _calibrated(case, found, contact_findings, report, own, told)
    if out is not None:
        from pounding.diagnosis.decision.pair_decision import CLAIM_NATS
        from pounding.diagnosis.design import contact_advice
        from pounding.diagnosis.design.advice import advice
        from pounding.diagnosis.report.writing import write_report

        told("trying further measurements", 0.92)
        report["advice"] = (
            advice(found) if contact_findings is None else contact_advice.advice(contact_findings, CLAIM_NATS)
        )
        told("writing the report", 0.95)
        report = write_report(case, found, report, Path(out))
    told("done", 1.0)
    return report


def report_on_pair(
    case: Case, found: Findings, report: dict[str, Any]
) -> tuple[dict[str, Any], ContactFindings]:
    """Return the report on a pair, and what its impacts say, from the report on its frames.

    Where something between the frames is missing, effects of the frames are judged again as second ones.
    """
    assert found.pair is not None
    contact_findings = judge_contact(case, found, report)
    held_out = foretold(case, found, report, contact_findings)
    if report["verdict"] in NAMED and claims_of(case, found.pair, contact_findings, report, held_out):
        found.pair = replace(found.pair, contact_claimed=True)
        again = report_of(case, found)
        if again["verdict"] != report["verdict"]:
            contact_findings = judge_contact(case, found, again)
            held_out = foretold(case, found, again, contact_findings)
        report = again
    objections = bool(decide(found).model_checks)
    return joined(case, found.pair, contact_findings, report, held_out, objections), contact_findings


def _calibrated(
    case: Case,
    found: Findings,
    contact_findings: ContactFindings | None,
    report: dict[str, Any],
    own: Sequence[type[Effect]],
    told: Progress,
) -> dict[str, Any]:
    from pounding.diagnosis.decision import pair_calibration, rig_calibration
    from pounding.frames.cache import folder

    if contact_findings is None:
        names = [rig_calibration.name_of(one) for one in rig_calibration.hypotheses(found)]
        simulate = partial(rig_calibration.simulate_and_judge, found)
    else:
        names = [one.label for one in pair_calibration.truths(found, contact_findings)] + [
            repr(case.contacts)
        ]
        judge = partial(_report_on_simulated, own)
        simulate = partial(pair_calibration.simulate_and_judge, case, found, contact_findings, judge)
    outcomes = rig_calibration.calibrated(found, folder() / "diagnosis", simulate, names, told)
    return rig_calibration.stated(report, outcomes)


def _report_on_simulated(own: Sequence[type[Effect]], case: Case) -> dict[str, Any]:
    found = find(case, lambda what, share: None, own)
    return report_on_pair(case, found, report_of(case, found))[0]


def _modal(case: Case, out: Path | str | None, told: Progress) -> dict[str, Any]:
    from pounding.diagnosis.inference.modal import diagnose_modal
    from pounding.diagnosis.report.modal_report import write_modal_report

    report = diagnose_modal(case, told)
    if out is not None:
        write_modal_report(case.title, report, Path(out))
    told("done", 1.0)
    return report


def _own(file: Path | str) -> list[type[Effect]]:
    from pounding.diagnosis.effects.candidate_file import read_candidates
    from pounding.diagnosis.effects.user import user_kinds

    return user_kinds(read_candidates(file))


def find(case: Case, progress: Progress, own: Sequence[type[Effect]] = ()) -> Findings:
    """Return what the search finds in a case, with kinds of effects of the user's `own` beside the catalogue.

    A force cell whose gain or delay was put right by sensors of which one is wrong itself is taken at its word instead.
    """
    found = _find(case, progress, own)
    cell = None if found.pair is None else found.pair.cell
    if cell is not None and cell.corrected and _wrong_sensor(found):
        found = _find(case, progress, own, against_motion=False)
    return found


def _wrong_sensor(found: Findings) -> bool:
    decision = decide(found)
    wrong = any(effect.channel is not None for effect in decision.judged.effects)
    return decision.verdict in NAMED and wrong


def _settle(found: Findings, measured: tuple[RunData, ...]) -> None:
    """Keep the forces of `measured` runs as frames with what is found put them right, unless channels were exchanged.

    Where the forces that frames without it had put right were all that left it unexplained, it is judged by these.
    """
    model, decision = found.model, decide(found)
    chosen = decision.judged
    known = bool(chosen.effects) and not any(effect.rival for effect in chosen.effects)
    if found.pair is None or model is not found.pair.slow or not known:
        return
    as_measured = Model(model.structure, replace(model.observed, runs=measured), model.prior)
    corrected, filtered = put_right_by(as_measured, model, chosen.fit.filtered)
    if decision.verdict not in NAMED:
        before = found.judged
        again = judged_on(chosen, corrected, filtered, found.training, found.held_out)
        found.judged = [again if one is chosen else one for one in before]
        decision, chosen = decide(found), again
        if decision.verdict not in NAMED or decision.judged is not again:
            found.judged = before
            return
    found.settled = (chosen, corrected, filtered)


def _find(
    case: Case, progress: Progress, own: Sequence[type[Effect]], against_motion: bool = True
) -> Findings:
    structure = Structure(baseline_frames(case))
    observed = screened(observe(case, structure))
    model = Model(structure, observed, case.prior)
    if not case.contacts:
        # Impacts fill the spectrum and change its first peak.
        observed.warnings.extend(frequency_warnings(model))
    pair = prepare(case, model, against_motion) if case.contacts else None
    training, held_out = case.split()
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    used = usable(observed, [numbers[run.file] for run in training])
    unseen = usable(observed, [numbers[run.file] for run in held_out])
    if not used:
        used, unseen = unseen, []
    start, measured = None, observed.runs
    if pair is not None:
        progress("putting contact forces right", 0.02)
        pair = found_again(cell_at_its_word(case, model, pair, used), used)
        measured = pair.slow.observed.runs
        model, start = put_right(pair.slow, used, not pair.blind)
        pair = replace(pair, slow=model)
    effects = [
        effect
        for effect in candidates(model)
        if effect.name != "joint_flexibility" or structure.frames[effect.index].joint_derivative is not None
    ]
    effects += [effect for kind in own for effect in places(kind, model)]
    found = search(model, effects, used, unseen, progress, start)
    found.pair = pair
    if start is not None:
        _settle(found, measured)
    return found
