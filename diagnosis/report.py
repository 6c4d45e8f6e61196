"""The report as files: `report.json`, a self-contained `report.html`, its figures, and a table for the terminal."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from rich.console import RenderableType
from rich.table import Table

from diagnosis.case import Case
from diagnosis.errors import CaseError
from diagnosis.figures import figures
from diagnosis.search import Findings
from diagnosis.words import advice, assumptions, sentence

TEMPLATE = Path(__file__).with_name("report.html.jinja")


def write_report(case: Case, found: Findings, report: dict[str, Any], folder: Path) -> None:
    """Write a report's files; each appears whole or not at all.

    Raises:
        CaseError: The folder cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise CaseError(f"{folder}: is a file, not a folder; give --out another name") from error
    pictures = figures(found, report)
    for name, picture in pictures.items():
        _write(folder / f"{name}.png", picture)
    _write(folder / "report.json", (json.dumps(clean(report), indent=2, allow_nan=False) + "\n").encode())
    _write(folder / "report.html", page(case, found, report, pictures).encode())


def _write(path: Path, content: bytes) -> None:
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    beside.write_bytes(content)
    os.replace(beside, path)


def clean(value: Any) -> Any:
    """Return a value in the types of JSON; what is not finite becomes null."""
    if isinstance(value, dict):
        return {key: clean(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [clean(item) for item in value]
    if isinstance(value, np.generic):
        return clean(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def page(case: Case, found: Findings, report: dict[str, Any], pictures: dict[str, bytes]) -> str:
    """Return the report as one HTML page that needs no other file."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["number"] = number
    environment.filters["place"] = place
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        case=case,
        report=report,
        sentence=sentence(report),
        advice=advice(found, report),
        assumptions=assumptions(case, found),
        pictures={name: base64.b64encode(picture).decode() for name, picture in pictures.items()},
    )


def number(value: float | str | None) -> str:
    """Return a number with four significant digits, a dash for none."""
    if value is None or (isinstance(value, float) and not np.isfinite(value)):
        return "–"
    return value if isinstance(value, str) else f"{value:.4g}"


def place(entry: dict[str, Any]) -> str:
    """Return where an effect is, in words."""
    words = [str(entry["frame"])] if entry["frame"] else []
    words += [
        f"{key} {entry[key]}" for key in ("storey", "floor", "channel", "contact") if entry[key] is not None
    ]
    if entry["left"]:
        words.insert(0, f"{entry['left']}–{entry['right']}")
    return ", ".join(words) or "the table"


def tables(report: dict[str, Any]) -> Iterable[RenderableType | str]:
    """Return the findings for the terminal."""
    yield sentence(report)
    gaps = Table(
        "gap", "before", "after", "noise floor", title="Gap: rms(simulated - measured) / rms(measured)"
    )
    gaps.add_row(
        "training", *(number(report["gap"]["training"][k]) for k in ("before", "after", "noise_floor"))
    )
    held_out = report["gap"]["held_out"]
    if held_out:
        label = f"held out ({held_out['run']})"
        gaps.add_row(label, *(number(held_out[k]) for k in ("before", "after", "noise_floor")))
    yield gaps
    if report["effects"]:
        effects = Table("effect", "where", "parameter", "value", "std", "unit", title="What is missing")
        for effect in report["effects"]:
            for parameter in effect["parameters"]:
                effects.add_row(
                    effect["effect"],
                    place(effect),
                    parameter["name"],
                    number(parameter["value"]),
                    number(parameter["std"]),
                    parameter["unit"],
                )
        yield effects
    ranked = Table("candidate", "where", "log evidence (nats)", title="Evidence against 'nothing missing'")
    for candidate in report["candidates"][:8]:
        ranked.add_row(candidate["effect"], place(candidate), number(candidate["log_evidence"]))
    yield ranked
    for warning in report["warnings"]:
        yield f"warning: {warning}"
