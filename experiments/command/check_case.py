"""`pounding check-case`: everything that keeps a measured case from being read, at once."""

from __future__ import annotations

from pathlib import Path

from pounding.diagnosis.case.all_faults import all_faults
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.errors import CaseError
from pounding.experiments.console.output import printer


def check_case(case: Path, /) -> None:
    """List everything that keeps a measured case from being diagnosed, with what would be allowed, and what is odd in it.

    The exit status is 2 if there is anything.

    Args:
        case: Folder with case.toml and the CSV files.
    """
    faults = all_faults(case)
    if not faults:
        for warning in _odd(case):
            printer().print(f"note: {warning}", markup=False, soft_wrap=True)
        printer().print(
            f"{case} can be read; next: pounding diagnose {case} --out DIR", markup=False, soft_wrap=True
        )
        return
    for number, fault in enumerate(faults, 1):
        printer().print(f"{number}. {fault}", markup=False, soft_wrap=True)
    count = f"{len(faults)} things have" if len(faults) > 1 else "one thing has"
    raise CaseError(f"{case}: {count} to be corrected before it can be diagnosed")


def _odd(folder: Path) -> list[str]:
    """Return what is odd in a case that can be read.

    Raises:
        CaseError: Nothing could be diagnosed with these frames and runs.
    """
    # Only here: this loads the engine, which what is wrong with the files does not need.
    from pounding.diagnosis.report.making import said_once
    from pounding.diagnosis.workflow import prepared

    case = read_case(folder)
    odd = prepared(case).observed.warnings if case.runs else []
    return list(said_once([*case.warnings, *odd]))
