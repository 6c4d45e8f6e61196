"""Where a result comes from: schema, software, parameters and records, stamped on everything we write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pounding.experiments.records import Record

SCHEMA = 1
"""Version of the JSON results' layout; raised when a key changes its meaning or goes."""

SOFTWARE = "pounding"


def software_version() -> str:
    """Return the installed version of this software."""
    return version(SOFTWARE)


def stamp(parameters: Mapping[str, Any], records: Iterable[Record] = ()) -> dict[str, Any]:
    """Return the keys that every result carries beside its own.

    Args:
        parameters: All that the result was asked with, defaults included.
        records: The ground motions that went in.

    Returns:
        ``schema``, ``software``, ``version``, ``parameters`` and ``records``, each record with its
        ``name``, ``sha256``, ``samples``, ``step_s`` [s] and ``pga_g`` [g].
    """
    return {
        "schema": SCHEMA,
        "software": SOFTWARE,
        "version": software_version(),
        "parameters": dict(parameters),
        "records": [describe(record) for record in records],
    }


def describe(record: Record) -> dict[str, Any]:
    """Return what identifies a record: its name, hash, number of samples, step [s] and peak [g]."""
    return {
        "name": record.name,
        "sha256": record.sha256,
        "samples": len(record.acceleration_m_s2),
        "step_s": record.step_s,
        "pga_g": record.pga_g,
    }
