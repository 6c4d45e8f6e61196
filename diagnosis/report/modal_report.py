"""The report on modal data as files and tables: `report.json`, a self-contained `report.html` with one picture."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from matplotlib.figure import Figure
from rich.console import RenderableType
from rich.table import Table

from pounding.diagnosis.report.writing import clean, number
from pounding.experiments.console.output import table
from pounding.frames.files import write_whole

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Diagnosis: {{ title }}</title>
<style>body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; } th, td { padding: .25rem .8rem; border-bottom: 1px solid #d5dbe1; text-align: left; }
.verdict { border-left: 5px solid #2b6cb0; padding: .6rem 1rem; background: #eef4fb; } img { max-width: 100%; }</style>
</head><body><h1>{{ title }}</h1><p class="verdict">{{ sentence }}</p>
<p>Confidence: {{ report.confidence_basis.calibration }}.</p>
<img alt="Measured, believed and explained numbers" src="data:image/png;base64,{{ picture }}">
{% for one in tables %}<h2>{{ one.title }}</h2><table><tr>{% for head in one.heads %}<th>{{ head }}</th>{% endfor %}</tr>
{% for row in one.rows %}<tr>{% for cell in row %}<td>{{ cell }}</td>{% endfor %}</tr>{% endfor %}</table>{% endfor %}
</body></html>
"""
COLOURS = {"believed": "#c0392b", "fitted": "#2e86c1", "foretold": "#27ae60"}


def write_modal_report(title: str, report: dict[str, Any], folder: Path) -> None:
    """Write `report.json` and `report.html` into a folder, made if it is not there; each appears whole or not at all."""
    picture = drawing(report)
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    page = environment.from_string(PAGE).render(
        title=title,
        sentence=modal_sentence(report),
        report=report,
        picture=base64.b64encode(picture).decode(),
        tables=[{"title": name, "heads": heads, "rows": rows} for name, heads, rows in contents(report)],
    )
    text = json.dumps(clean(report), indent=2, allow_nan=False) + "\n"
    write_whole(folder / "report.json", text.encode())
    write_whole(folder / "report.html", page.encode())


def modal_sentence(report: dict[str, Any]) -> str:
    """Return the verdict in one sentence."""
    gap = report["gap"]["held_out"]
    change = (
        f"a number foretold from the others is off by {gap['after']:.1%} in the median instead of "
        f"{gap['before']:.1%} ({report['confidence']:.0%} sure)"
    )
    named = " and ".join(_words(effect) for effect in report["effects"])
    return {
        "nothing_missing": f"Nothing is missing that these numbers could show ({report['confidence']:.0%} sure).",
        "unknown_effect": f"Something is missing that nothing tried explains; nearest is {named}; {change}.",
        "effect_class": f"Missing is {named}, or another that these numbers cannot tell from it; {change}.",
        "effect_named": f"Missing is {named}; {change}.",
    }[report["verdict"]]


def _words(effect: dict[str, Any]) -> str:
    parameter = effect["parameters"][0]
    place = "".join(f" of {key} {effect[key]}" for key in ("storey", "floor") if effect[key] is not None)
    test = f", only in the {effect['test'].replace('_', ' ')}," if "test" in effect else ""
    size = f"{parameter['value']:.4g} {parameter['unit']}"
    return f"{effect['effect'].replace('_', ' ')}{place} of {effect['frame']}{test} ({size})"


def contents(report: dict[str, Any]) -> list[tuple[str, list[str], list[list[str]]]]:
    """Return title, heads and rows of the report's tables."""
    effects = [
        [
            effect["effect"],
            effect["frame"],
            effect.get("test", "all"),
            parameter["name"],
            number(parameter["value"]),
            number(parameter["std"]),
            parameter["unit"],
            "; ".join(_member(other) for other in effect["class"][1:]) or "–",
        ]
        for effect in report["effects"]
        for parameter in effect["parameters"]
    ]
    rows = [
        [row["frame"], _datum(row)]
        + [number(row[key]) for key in ("measured", "std", "believed", "fitted", "foretold", "surprise")]
        for row in report["modal"]
    ]
    ranked = [
        [_member(entry), entry["frame"], entry.get("test", "all"), f"{entry['log_evidence']:.1f}"]
        for entry in report["candidates"][:12]
    ]
    heads = ["effect", "frame", "tests", "parameter", "value", "std", "unit", "cannot be told from"]
    return [
        ("What is missing", heads, effects),
        (
            "Numbers in SI; 'foretold' is from the others, 'surprise' in standard deviations",
            ["frame", "number", "measured", "std", "believed", "fitted", "foretold", "surprise"],
            rows,
        ),
        ("Evidence of single effects (nats)", ["effect", "frame", "tests", "log evidence"], ranked),
    ]


def _member(entry: dict[str, Any]) -> str:
    where = "".join(f" {key} {entry[key]}" for key in ("storey", "floor") if entry[key] is not None)
    test = f" only in {entry['test'].replace('_', ' ')}" if "test" in entry else ""
    return f"{entry['effect']}{where}{test}"


def _datum(row: dict[str, Any]) -> str:
    what = f"f{row['mode']}" if row["mode"] else row["quantity"].replace("_", " ")
    return f"{what}, {row['test'].replace('_', ' ')}"


def modal_tables(report: dict[str, Any]) -> Iterable[RenderableType | str]:
    """Return the findings for the terminal."""
    yield modal_sentence(report)
    for title, heads, rows in contents(report):
        if rows:
            shown: Table = table(title, heads, rows)
            yield shown
    for warning in report["warnings"]:
        yield f"warning: {warning}"


def drawing(report: dict[str, Any]) -> bytes:
    """Return a PNG of every number's relative error: believed, fitted, foretold from the others."""
    rows = report["modal"]
    figure = Figure(figsize=(8.0, 0.6 + 0.32 * len(rows)), layout="constrained")
    axis = figure.subplots()
    y = np.arange(len(rows))[::-1]
    spread = np.array([100 * row["std"] / row["measured"] for row in rows])
    axis.barh(y, 2 * spread, left=-spread, color="#d5d8dc", height=0.8, label="measured, one std")
    marks = {"believed": "s", "fitted": "o", "foretold": "D"}
    for key, colour in COLOURS.items():
        error = [100 * (row[key] / row["measured"] - 1) for row in rows]
        axis.plot(error, y, marks[key], color=colour, ms=5, label=key)
    axis.set_yticks(y, [f"{row['frame']}: {_datum(row)}" for row in rows], fontsize=8)
    axis.axvline(0, color="#222222", lw=0.6)
    axis.set_xlabel("model less measured [%]", fontsize=9)
    axis.legend(fontsize=8, frameon=False)
    axis.spines[["top", "right"]].set_visible(False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()
