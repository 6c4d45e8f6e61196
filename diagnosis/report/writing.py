"""The report as files: `report.json`, a self-contained `report.html`, its figures, and a table for the terminal."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.report.details import completed
from pounding.diagnosis.report.figures import figures
from pounding.diagnosis.report.report_text import advice, assumptions, kind_and_place, percent, sentence
from pounding.frames.errors import FrameError
from pounding.frames.files import write_whole

TEMPLATE = Path(__file__).with_name("report.html.jinja")


def write_report(case: Case, found: Findings, report: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Write a report's files, `report.json` last; each appears whole or not at all.

    Returns:
        The report as written: with what `pounding.diagnosis.report.details.completed` adds.

    Raises:
        CaseError: The folder cannot be made or written.
    """
    if folder.exists() and not folder.is_dir():
        raise CaseError(f"{folder}: is a file, not a folder; give --out another name")
    report = clean(completed(case, found, report))
    pictures = figures(case, found, report)
    files = {f"{name}.png": picture for name, picture in pictures.items()}
    files["report.html"] = page(case, found, report, pictures).encode()
    files["report.json"] = (json.dumps(report, indent=2, allow_nan=False) + "\n").encode()
    try:
        for name, content in files.items():
            write_whole(folder / name, content)
    except FrameError as error:
        raise CaseError(str(error)) from error
    return report


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
    environment.filters |= {
        "number": number,
        "place": place,
        "percent": percent,
        "what": kind_and_place,
        "sizes": sizes,
    }
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        case=case,
        report=report,
        sentence=sentence(report),
        advice=advice(case, found, report),
        assumptions=[*assumptions(case, found), f"Confidence: {report['confidence_basis']['calibration']}."],
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


def sizes(entry: dict[str, Any] | None) -> str:
    """Return an effect's parameters in one line, such as `gap 0.3 mm, stiffness 400 N/m`."""
    if entry is None:
        return "–"
    units = {"1": "", "-": ""}
    return ", ".join(
        f"{p['name'].replace('_', ' ')} {_short(p['value'])} {units.get(p['unit'], p['unit'])}".rstrip()
        for p in entry["parameters"]
    )


def _short(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.2g}"


def tables(report: dict[str, Any]) -> Iterable[RenderableType | str]:
    """Return the findings for the terminal."""
    yield Text(sentence(report))
    yield _gaps(report)
    if contact := report["gap"].get("contact"):
        left = f"{number(contact['before'])} with the contact as believed"
        if contact["after"] != contact["before"]:
            left += f", {number(contact['after'])} as found"
        yield Text(
            f"{contact['impacts']} held-out impacts, standard deviations left of their forces (1 is as known): {left}"
        )
    if report["effects"]:
        effects = Table("effect", "where", "parameter", "value", "std", "unit", title="What is missing")
        for effect in report["effects"]:
            for one in effect["parameters"]:
                size = (number(one["value"]), number(one["std"]), one["unit"])
                effects.add_row(effect["effect"], place(effect), one["name"], *size)
        yield effects
    if report["where"]:
        spots = Table(
            "channel",
            "run",
            "window [s]",
            "band [Hz]",
            "gap",
            title="Where the model disagrees most",
        )
        for one in report["where"][:4]:
            window, band = (f"{number(a)} to {number(b)}" for a, b in (one["window_s"], one["band_hz"]))
            spots.add_row(one["channel"], one["run"], window, band, percent(one["gap"]))
        yield spots
    ranked = Table("candidate", "where", "log evidence [nats]", title="Evidence against 'nothing missing'")
    for candidate in report["candidates"][:8]:
        ranked.add_row(candidate["effect"], place(candidate), f"{candidate['log_evidence']:.1f}")
    yield ranked
    for pair in report.get("apart", ()):
        first, other = (kind_and_place(entry) for entry in pair["between"])
        yield Text(f"to tell {first} from {other}: {' '.join(pair['tests'])}")
    for warning in report["warnings"]:
        yield Text(f"warning: {warning}")


def _gaps(report: dict[str, Any]) -> Table:
    title = "Gap: rms(simulated - measured) / rms(measured)"
    misfits = Table("gap", "before", "after", "noise floor", "closed", title=title)
    held_out = report["gap"]["held_out"]
    for label, gap in (
        ("training", report["gap"]["training"]),
        (f"held out ({held_out['run']})" if held_out else "held out: none, there is a single run", held_out),
    ):
        shares = [percent((gap or {}).get(key)) for key in ("before", "after", "noise_floor", "closed")]
        misfits.add_row(label, *shares)
    return misfits
