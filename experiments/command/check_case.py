"""`pounding check-case`: everything that keeps a measured case from being read, at once."""

from __future__ import annotations

from pathlib import Path

from pounding.diagnosis.case.all_faults import all_faults
from pounding.diagnosis.errors import CaseError
from pounding.experiments.console.output import printer


def check_case(case: Path, /) -> None:
    """List everything that keeps a measured case from being read, with what would be allowed.

    The exit status is 2 if there is anything.

    Args:
        case: Folder with case.toml and the CSV files.
    """
    faults = all_faults(case)
    if not faults:
        printer().print(
            f"{case} can be read; next: pounding diagnose {case} --out DIR", markup=False, soft_wrap=True
        )
        return
    for number, fault in enumerate(faults, 1):
        printer().print(f"{number}. {fault}", markup=False, soft_wrap=True)
    count = f"{len(faults)} things have" if len(faults) > 1 else "one thing has"
    raise CaseError(f"{case}: {count} to be corrected before it can be diagnosed")
