"""Reading a measured case from its folder."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.csv import read_run
from pounding.diagnosis.case.toml import read_description


def read_case(folder: Path | str) -> Case:
    """Read a case.

    Args:
        folder: The folder that holds `case.toml`.

    Raises:
        CaseError: The case cannot be read; one sentence with file, line, channel, what is wrong, what to do.
    """
    case, files = read_description(Path(folder))
    runs, warnings = [], []
    for file, role in files:
        run, odd = read_run(case.folder / file, case.channels, role=role)
        runs.append(replace(run, file=file))
        warnings += odd
    return replace(case, runs=tuple(runs), warnings=(*case.warnings, *warnings))
