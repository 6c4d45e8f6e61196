"""`diagnose_case`: from a folder of measurements to the report on them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from diagnosis.believe import believed_frames
from diagnosis.believed import Believed
from diagnosis.case import Case, read_case
from diagnosis.catalogue import candidates
from diagnosis.observations import observe
from diagnosis.search import Findings, search
from diagnosis.sensors import screened, usable
from diagnosis.storeys import Structure
from diagnosis.verdict import report_of

Progress = Callable[[str, float], None]


def diagnose_case(
    case_folder: Path | str, out: Path | str | None = None, progress: Progress | None = None
) -> dict[str, Any]:
    """Diagnose a case: where it disagrees with the believed model, what is missing, and what that closes.

    Args:
        case_folder: Folder with `case.toml` and its runs.
        out: Folder for `report.json`, `report.html` and figures; nothing is written when None.
        progress: Called with what is being done and the share that is done (0 to 1).

    Returns:
        The report, as docs/diagnosis/case-format.md describes it.

    Raises:
        CaseError: The case cannot be read or says too little.
    """
    told = progress or (lambda what, share: None)
    told("reading the case", 0.0)
    case = read_case(case_folder)
    found = find(case, told)
    report = report_of(case, found)
    if out is not None:
        from diagnosis.report import write_report

        told("writing the report", 0.95)
        write_report(case, found, report, Path(out))
    told("done", 1.0)
    return report


def find(case: Case, progress: Progress) -> Findings:
    """Return what the search finds in a case."""
    structure = Structure(believed_frames(case))
    observed = screened(observe(case, structure))
    believed = Believed(structure, observed, case.prior)
    training, held_out = case.split()
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    effects = [
        effect
        for effect in candidates(believed)
        if effect.name != "joint_flexibility" or structure.frames[effect.index].joint_derivative is not None
    ]
    used = usable(observed, [numbers[run.file] for run in training])
    unseen = usable(observed, [numbers[run.file] for run in held_out])
    if not used:
        used, unseen = unseen, []
    return search(believed, effects, used, unseen, progress)
