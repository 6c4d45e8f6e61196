"""Reading a report again: of today's schema, and of the one before it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

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
        return msgspec.convert(raw if schema == SCHEMA else _upgraded(raw), Report)
    except (msgspec.ValidationError, AttributeError, TypeError, RecursionError) as error:
        raise CaseError(f"{source}: is not a whole report ({error}); {WHOLE}") from error


def _upgraded(raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return a report of schema 1 with the keys of schema 2."""
    new = _renamed(raw, {"gap": "misfit"}) | {"schema": SCHEMA}
    new["where"] = [_renamed(one, {"gap": "misfit"}) for one in raw.get("where", ())]
    for key, change in _CHANGED.items():
        if key in new:
            new[key] = change(new[key])
    return new


def _renamed(entry: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    return {names.get(key, key): value for key, value in entry.items()}


def _misfits(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value and _renamed(value, {"closed": "explained"}) for key, value in entry.items()}


def _basis(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: with_new_names(value) if key in ("features", "contact") else value
        for key, value in entry.items()
    }


def _modal(rows: list[Mapping[str, Any]]) -> list[dict[str, Any]]:
    return [_renamed(row, {"believed": "baseline", "foretold": "predicted"}) for row in rows]


_CHANGED: dict[str, Callable[[Any], Any]] = {"misfit": _misfits, "confidence_basis": _basis, "modal": _modal}
