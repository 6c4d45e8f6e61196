"""A hidden case on disk, and its truth in a file apart."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.hide import Hidden
from pounding.frames.files import write_whole


def check_free(out: Path) -> None:
    """Refuse a folder that holds a case already.

    Raises:
        CaseError: It does.
    """
    if (out / "case.toml").exists():
        raise CaseError(f"{out} holds a case already; name another folder or remove it")


def write_hidden(hidden: Hidden, out: Path, truth: Path | None = None) -> Path:
    """Write the case, and the truth only where it is asked for.

    Args:
        hidden: What was hidden.
        out: Folder of the case; it must not hold another case.
        truth: File for the truth; none when None.

    Returns:
        The path of `case.toml`.

    Raises:
        CaseError: There is a case already.
    """
    check_free(out)
    written = write_case(replace(hidden.case, folder=out), out)
    if truth is not None:
        write_truth(hidden.truth, truth)
    return written


def write_truth(truth: dict[str, Any], path: Path) -> None:
    """Write a truth as JSON, the whole file or nothing."""
    write_whole(path, (json.dumps(truth, indent=2) + "\n").encode())
