"""The report on modal data alone: its rows, its tables and its one picture."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.figure import Figure

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import finite
from pounding.diagnosis.decision.modal_decision import of_modal_data
from pounding.diagnosis.inference.modal import ModalFindings
from pounding.diagnosis.report.making import assembled
from pounding.diagnosis.report.report import HeldOutMisfit, Misfit, Misfits, ModalRow, Report
from pounding.diagnosis.report.report_text import number

SHOWN = 12
"""Candidates in the table."""
MARKS = {"baseline": ("s", "#c0392b"), "fitted": ("o", "#2e86c1"), "predicted": ("D", "#27ae60")}
"""Marker and colour of what is drawn of each number."""
Rows = list[list[str]]


def report_on_modal_data(case: Case, found: Sequence[ModalFindings]) -> Report:
    """Return the report on what was found of each frame."""
    rows = [row for one in found for row in _rows(one)]
    return assembled(of_modal_data(case, found), _misfits(found), modal=rows)


def _misfits(found: Sequence[ModalFindings]) -> Misfits:
    """Return relative errors: of the fit, and of each number predicted from the others."""

    def median(rows: list[np.ndarray]) -> float | None:
        return finite(float(np.median(np.concatenate(rows))))

    value = [np.array([datum.value for datum in one.data]) for one in found]
    noise = median([np.array([datum.std / datum.value for datum in one.data]) for one in found])

    def errors(of: Callable[[ModalFindings], np.ndarray]) -> float | None:
        return median([np.abs(of(one) / v - 1) for one, v in zip(found, value, strict=True)])

    return Misfits(
        training=Misfit(
            before=errors(lambda one: one.null.fitted),
            after=errors(lambda one: one.best.fitted),
            noise_floor=noise,
        ),
        held_out=HeldOutMisfit(
            run="each number predicted from the others",
            before=errors(lambda one: one.foretold["null"][0]),
            after=errors(lambda one: one.foretold["best"][0]),
            noise_floor=noise,
        ),
    )


def _rows(found: ModalFindings) -> list[ModalRow]:
    return [
        ModalRow(
            frame=found.frame,
            quantity=datum.quantity,
            mode=datum.mode,
            test=datum.test,
            measured=datum.value,
            std=datum.std,
            baseline=finite(found.null.fitted[i]),
            fitted=finite(found.best.fitted[i]),
            predicted=finite(found.foretold["best"][0][i]),
            surprise=finite(found.foretold["best"][1][i]),
        )
        for i, datum in enumerate(found.data)
    ]


def contents(report: Report) -> list[tuple[str, list[str], Rows]]:
    """Return title, heads and rows of the tables of a report on modal data."""
    effects = [
        [
            effect.effect,
            effect.where(),
            parameter.name,
            number(parameter.value),
            number(parameter.std),
            parameter.unit,
            "; ".join(other.words() for other in effect.members[1:]) or "–",
        ]
        for effect in report.effects
        for parameter in effect.parameters
    ]
    keys = ("measured", "std", "baseline", "fitted", "predicted", "surprise")
    rows = [
        [row.frame, _datum(row), *(number(getattr(row, key)) for key in keys)] for row in report.modal or ()
    ]
    ranked = [[one.effect, one.where(), f"{one.log_evidence:.1f}"] for one in report.candidates[:SHOWN]]
    return [
        (
            "What is missing",
            ["effect", "where", "parameter", "value", "standard error", "unit", "cannot be told from"],
            effects,
        ),
        (
            "Numbers in SI; 'predicted' is from the others, 'surprise' in standard deviations",
            ["frame", "number", *keys],
            rows,
        ),
        ("Evidence of single effects", ["effect", "where", "ln Bayes factor"], ranked),
    ]


def _datum(row: ModalRow) -> str:
    what = f"f{row.mode}" if row.mode else row.quantity.replace("_", " ")
    return f"{what}, {row.test.replace('_', ' ')}"


def drawing(rows: Sequence[ModalRow]) -> bytes:
    """Return a PNG of every number's relative error: by the baseline model, fitted, predicted from the others."""
    figure = Figure(figsize=(8.0, 0.6 + 0.32 * len(rows)), layout="constrained")
    axis = figure.subplots()
    y = np.arange(len(rows))[::-1]
    spread = np.array([100 * row.std / row.measured for row in rows])
    axis.barh(y, 2 * spread, left=-spread, color="#d5d8dc", height=0.8, label="measured ± 1 std. error")
    for key, (mark, colour) in MARKS.items():
        values = [getattr(row, key) for row in rows]
        error = [
            np.nan if value is None else 100 * (value / row.measured - 1)
            for value, row in zip(values, rows, strict=True)
        ]
        axis.plot(error, y, mark, color=colour, ms=5, label=key)
    axis.set_yticks(y, [f"{row.frame}: {_datum(row)}" for row in rows], fontsize=8)
    axis.axvline(0, color="#222222", lw=0.6)
    axis.set_xlabel("model − measured [%]", fontsize=9)
    axis.legend(fontsize=8, frameon=False)
    axis.spines[["top", "right"]].set_visible(False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()
