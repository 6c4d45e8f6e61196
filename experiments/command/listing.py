"""`pounding list`: the available frames, records, impact laws and studies."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from pounding import contact, frames
from pounding.experiments import records as ground_motions
from pounding.experiments.command.app import STUDIES
from pounding.experiments.console import options
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp


def listing(*, records: options.Records = None, json: options.Json = False) -> None:
    """List the shipped frames, the records and where they were found, the impact laws and the studies."""
    result = stamp({"records": None if records is None else str(records)}) | inventory(records)
    emit(result, as_json=json, show=lambda: _tables(result))


def inventory(folder: options.Records = None) -> dict[str, Any]:
    """Return the shipped frames, the records that were found or how to get them, the laws and the studies."""
    return {
        "frames": [_frame(name) for name in frames.names()],
        "ground_motions": [asdict(entry) for entry in ground_motions.available(folder)],
        "laws": [
            {"name": name, "description": (contact.law_class(name).__doc__ or "").partition("\n")[0]}
            for name in contact.names()
        ],
        "studies": list(STUDIES),
    }


def _frame(name: str) -> dict[str, Any]:
    frame = frames.load(name)
    return {"name": name, "storeys": frame.storeys, "title": getattr(frame, "title", "")}


def _tables(result: dict[str, Any]) -> list[Any]:
    return [
        table("Frames", ["name", "storeys", "title"], [list(f.values()) for f in result["frames"]]),
        table(
            "Ground motions",
            ["name", "title", "found in", "how to get it, or what is wrong"],
            [[r["name"], r["title"], r["found"], r["note"]] for r in result["ground_motions"]],
        ),
        table("Impact laws", ["name", "description"], [list(law.values()) for law in result["laws"]]),
        table("Studies (pounding study NAME)", ["name"], [[name] for name in result["studies"]]),
    ]
