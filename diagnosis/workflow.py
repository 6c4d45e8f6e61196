"""`diagnose`: from a folder of measurements to the report on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import msgspec
import numpy as np
from threadpoolctl import threadpool_limits

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.contact_force.force_errors import put_right, put_right_with
from pounding.diagnosis.contact_force.pair import cell_at_its_word, found_again, prepare
from pounding.diagnosis.decision.beyond_errors import beyond_errors, first_decides, search_beyond_errors
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.diagnosis import Diagnosis, conclude
from pounding.diagnosis.decision.false_alarms import stored
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings, judged_on
from pounding.diagnosis.inference.search import Progress, search, silent
from pounding.diagnosis.model.first_frequencies import check_resolved, frequency_warnings
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.free_memory import give_back
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData, observe
from pounding.diagnosis.model.sensors import screened, usable
from pounding.diagnosis.model.slowing import slowed_if_long
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.report.making import Made, report_on
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.report_text import sentence
from pounding.diagnosis.settings import SETTINGS
from pounding.frames.files import tried_file, tried_folder


def diagnose(
    case: Case | Path | str,
    out: Path | str | None = None,
    progress: Progress | None = None,
    *,
    candidates_file: Path | str | None = None,
    calibrate: bool = False,
    film: bool = False,
    false_alarms: float = SETTINGS.decision.false_alarms,
    export_model: Path | str | None = None,
) -> Report:
    """Diagnose a case: where it disagrees with the baseline model, what is missing, and how much that explains.

    Args:
        case: Folder with `case.toml` and its runs, or what `read_case` has read from it.
        out: Folder for `report.json`, `report.html` and figures; nothing is written when None.
        progress: Called with what is being done and the share that is done (0 to 1).
        candidates_file: Python file with effects of the user's that compete with the catalogue. It is executed, once the
            case has been read: pass a file that you trust.
        calibrate: Simulate null and rivals on this rig for a confidence of its own (up to 15 minutes, resumed), and on a
            single frame for what an effect needs.
        film: Film the run before and after over each other, `before_after.mp4`; only with `out`.
        false_alarms: Share of the cases of a single frame without an effect in which one may be named or something may
            be said to remain.
        export_model: Frame file for the corrected model; the report's `model` says what was written, or why nothing was.

    Returns:
        The report; with `out` also what `pounding.diagnosis.report.details` adds.

    Raises:
        CaseError: The case cannot be read or says too little, or the user's candidates cannot be used.
        FrameError: The report cannot be written.
    """
    told = progress or silent
    told("reading the case", 0.0)
    if not isinstance(case, Case):
        case = read_case(case)
    if out is not None:
        tried_folder(out)
    if export_model is not None:
        tried_file(export_model)
    own = _own(candidates_file) if candidates_file is not None else []
    if calibrate and not case.runs:
        raise CaseError(
            f"{case.folder / 'case.toml'}: --calibrate simulates runs, and this case has no run; leave --calibrate out"
        )
    if export_model is not None and not case.runs:
        raise CaseError(
            f"{case.folder / 'case.toml'}: the corrected model is made of runs, and this case has none; leave "
            "--export-model out"
        )
    if case.modal and not case.runs:
        return _modal(case, out, told)
    found, decision = find(case, told, own, false_alarms)
    if found.pair is not None:
        told("looking at the impacts", 0.9)
    diagnosis = conclude(case, found, decision)
    if calibrate:
        diagnosis = _calibrated(diagnosis, own, told)
    give_back()
    made = report_on(diagnosis)
    if export_model is not None:
        made = _exported(diagnosis, made, Path(export_model))
    report = made.report
    if out is not None:
        from pounding.diagnosis.report.writing import write_report

        told("writing the report", 0.92)
        report = write_report(diagnosis, made, Path(out), film=film)
    told("done", 1.0)
    return report


def _exported(diagnosis: Diagnosis, made: Made, file: Path) -> Made:
    from pounding.diagnosis.report.corrected_model import export_model

    model = export_model(diagnosis, file, sentence(made.report))
    return replace(made, report=msgspec.structs.replace(made.report, model=model))


def _calibrated(diagnosis: Diagnosis, own: Sequence[type[Effect]], told: Progress) -> Diagnosis:
    """Return the diagnosis with what cases simulated on this very rig say: the confidence, and what an effect needs."""
    from pounding.diagnosis.decision import pair_calibration, rig_calibration
    from pounding.frames.cache import folder

    case, found = diagnosis.case, diagnosis.found
    if diagnosis.contact is None:
        names = [one.label() for one in rig_calibration.hypotheses(found)]
        simulate = partial(rig_calibration.simulate_and_judge, found)
    else:
        names = [one.label for one in pair_calibration.truths(found, diagnosis.contact)]
        names.append(repr(case.contacts))
        judge = partial(_concluded, own)
        simulate = partial(pair_calibration.simulate_and_judge, case, found, diagnosis.contact, judge)
    outcomes = rig_calibration.calibrated(found, folder() / "diagnosis", simulate, names, told)
    alarms = rig_calibration.false_alarms(found, outcomes)
    if alarms is not None:
        found = replace(found, false_alarms=alarms)
        diagnosis = conclude(case, found, decide(found))
    return replace(diagnosis, conclusion=rig_calibration.stated(diagnosis.conclusion, outcomes))


def _concluded(own: Sequence[type[Effect]], case: Case) -> Conclusion:
    """Return what is concluded of a simulated case."""
    return conclude(case, *find(case, silent, own)).conclusion


def _modal(case: Case, out: Path | str | None, told: Progress) -> Report:
    from pounding.diagnosis.inference.modal import search_modal
    from pounding.diagnosis.report.modal import report_on_modal_data

    report = report_on_modal_data(case, search_modal(case, told))
    if out is not None:
        from pounding.diagnosis.report.writing import write_modal_report

        write_modal_report(case, report, Path(out))
    told("done", 1.0)
    return report


def _own(file: Path | str) -> list[type[Effect]]:
    from pounding.diagnosis.effects.candidate_file import read_candidates
    from pounding.diagnosis.effects.candidate_trial import try_out
    from pounding.diagnosis.effects.user import user_kinds

    try_out(file)
    return user_kinds(read_candidates(file))


def find(
    case: Case,
    progress: Progress,
    own: Sequence[type[Effect]] = (),
    false_alarms: float = SETTINGS.decision.false_alarms,
) -> tuple[Findings, Decision]:
    """Return what the search finds in a case, and what is decided of the frames.

    A force cell whose gain or delay was put right by sensors of which one is wrong itself is taken at its word instead.

    Args:
        case: The case.
        progress: Called with what is being done and the share that is done.
        own: Kinds of effects of the user's, beside the catalogue.
        false_alarms: Share of the cases without an effect in which one may be named.
    """
    # Thousands of small matrices: threads inside the BLAS only get in the way of our own. Trials that blow up cost
    # infinitely much, and are not taken; nobody needs to be warned of them.
    with threadpool_limits(1, user_api="blas"), np.errstate(over="ignore", invalid="ignore"):
        found, decision = _find(case, progress, own, false_alarms)
        cell = None if found.pair is None else found.pair.cell
        if cell is not None and cell.corrected and _wrong_sensor(decision):
            found, decision = _find(case, progress, own, false_alarms, against_motion=False)
        return found, decision


def _wrong_sensor(decision: Decision) -> bool:
    return decision.named and any(effect.channel is not None for effect in decision.judged.effects)


def _settled(found: Findings, decision: Decision, measured: tuple[RunData, ...]) -> tuple[Findings, Decision]:
    """Keep the forces of `measured` runs as frames with what is found put them right, unless channels were exchanged.

    What is found has the sizes that it has with these forces, and is decided again: those that frames without it had put
    right may be all that left it unexplained, or all that spoke for it.
    """
    model, chosen = found.model, decision.judged
    known = bool(chosen.effects) and not any(effect.rival for effect in chosen.effects)
    if found.pair is None or model is not found.pair.slow or not known:
        return found, decision
    as_measured = model.seeing(replace(model.observed, runs=measured))
    corrected, fit = put_right_with(as_measured, model, chosen.fit)
    again = judged_on(replace(chosen, fit=fit), corrected, fit.filtered, found.training, found.held_out)
    retried = replace(found, judged=[again if one is chosen else one for one in found.judged])
    decided = decide(retried)
    if decided.named and decided.judged is again:
        return replace(retried, settled=(again, corrected, fit.filtered)), decided
    return (retried, decided) if decision.named else (found, decision)


def _as_before(model: Model, effects: Sequence[Effect], runs: Sequence[int], progress: Progress) -> Model:
    """Return the model with what it lacks in the reference runs already, which is no change; itself without any.

    Args:
        model: The baseline model.
        effects: The candidates.
        runs: Numbers of the runs that are fitted.
        progress: Called with what is being done and the share that is done.
    """
    observed = model.observed
    known = [number for number in runs if not model.acts(number)]
    if not known:
        return model
    progress("looking for what was missing before", 0.03)
    plain = tuple(replace(run, reference=False) for run in observed.runs)
    alone = model.seeing(replace(observed, runs=plain, warnings=[]))
    decision = decide(search_beyond_errors(alone, effects, known, ()))
    fit = decision.judged.fit
    if decision.verdict == "unknown_effect" or not fit.effects:
        return model
    names = ", ".join(observed.runs[number].name for number in known)
    lacked = " and ".join(effect.label() for effect in fit.effects)
    observed.warnings.append(
        f"{names}: {lacked} is missing in the baseline model before the change already; it is part of the "
        "model here, and what is said is what changed since"
    )
    return Model(model.structure, observed, model.prior, tuple(zip(fit.effects, fit.values, strict=True)))


def prepared(case: Case) -> Model:
    """Return the baseline model of a case with its measurements, screened for what sensors did not measure.

    Args:
        case: The case.

    Raises:
        CaseError: The frames cannot be modelled, or the runs show nothing that a diagnosis could start from.
    """
    structure = Structure(baseline_frames(case))
    observed = screened(observe(case, structure))
    if not case.contacts:
        observed = slowed_if_long(observed, structure)
    model = Model(structure, observed, case.prior)
    check_resolved(model)
    if not case.contacts:
        # Impacts fill the spectrum and change its first peak.
        observed.warnings.extend(frequency_warnings(model))
    return model


def _find(
    case: Case,
    progress: Progress,
    own: Sequence[type[Effect]],
    false_alarms: float,
    against_motion: bool = True,
) -> tuple[Findings, Decision]:
    model = prepared(case)
    structure, observed = model.structure, model.observed
    pair = prepare(case, model, against_motion) if case.contacts else None
    training, held_out = case.split()
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    used = usable(observed, [numbers[run.file] for run in training])
    unseen = usable(observed, [numbers[run.file] for run in held_out])
    if not model.since(used):
        used, unseen = [*used, *unseen], []
    if not model.since(used):
        raise CaseError(
            f"{case.folder / 'case.toml'}: nothing moves in any run but the references; "
            "check that the files hold the measurements"
        )
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
    model = _as_before(model, effects, used, progress)
    alarms = stored(false_alarms, len(effects))

    def enough(singles: Findings) -> bool:
        return first_decides(replace(singles, pair=pair, false_alarms=alarms))

    found = search(model, effects, used, unseen, progress, start, enough)
    found.pair, found.false_alarms = pair, alarms
    found = beyond_errors(found, effects, progress)
    decision = decide(found)
    if start is None:
        return found, decision
    progress("putting contact forces right with what is found", 0.97)
    return _settled(found, decision, measured)
