"""Reading a report again: of today's schema, and of the one before it."""

from __future__ import annotations

from pathlib import Path

import msgspec

from pounding.diagnosis.decision.confidence import with_new_names
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.report.report import SCHEMA, Report

FORMER_SCHEMA = 1
WHOLE = "give the report.json of a diagnosis, or diagnose the case again"


def read_report(path: Path | str) -> Report:
    """Read a `report.json` of schema 1 or 2; one of schema 1 is returned in the form of today.

    Raises:
        CaseError: It cannot be read, is not JSON, has another schema, or lacks what a report has.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "report.json"
    try:
        text = path.read_bytes()
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror or error}); {WHOLE}") from error
    return report_from(text, str(path))


def report_from(text: bytes | str, source: str) -> Report:
    """Return the report that is the content of a JSON text.

    Args:
        text: The text.
        source: Where it comes from, for what is said of it.

    Raises:
        CaseError: As `read_report`.
    """
    try:
        raw = msgspec.json.decode(text)
    except (msgspec.DecodeError, UnicodeError, RecursionError) as error:
        raise CaseError(f"{source}: is not JSON ({error}); {WHOLE}") from error
    if not isinstance(raw, dict) or "schema" not in raw:
        raise CaseError(f"{source}: is no report of a diagnosis, it has no `schema`; {WHOLE}")
    schema = raw["schema"]
    if schema not in (FORMER_SCHEMA, SCHEMA) or isinstance(schema, bool):
        raise CaseError(
            f"{source}: has schema {schema!r}, and this version reads {FORMER_SCHEMA} and {SCHEMA}; "
            "diagnose the case again"
        )
    try:
        if schema == FORMER_SCHEMA:
            raw = {"where": []} | with_new_names(raw) | {"schema": SCHEMA}
        return msgspec.convert(raw, Report)
    except (msgspec.ValidationError, TypeError, RecursionError) as error:
        raise CaseError(f"{source}: is not a whole report ({error}); {WHOLE}") from error
