"""The picture of a report's first page: the run over time beside the frames' answer over frequency, at its printed size."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.figure import Figure

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.report.history_figure import draw_history
from pounding.diagnosis.report.making import Outputs
from pounding.diagnosis.report.transmissibility import Answers, draw_answers

WIDTH_MM, INCH_MM = 182.0, 25.4
FONT_PT = 7.0
"""Size of the letters, on paper too."""


def sheet_figure(
    diagnosis: Diagnosis, outputs: Outputs, answers: Sequence[Answers], height_mm: float
) -> Figure:
    """Return the picture of the first page.

    Args:
        diagnosis: What was found and decided.
        outputs: The runs as the engine gave them for the model of the verdict, by number; may be empty.
        answers: The frames' answers to the table.
        height_mm: How high it may be on paper [mm].
    """
    with rc_context({"font.size": FONT_PT, "lines.linewidth": 1.0}):
        figure = Figure(figsize=(WIDTH_MM / INCH_MM, height_mm / INCH_MM), layout="constrained")
        over_time, over_frequency = figure.subfigures(1, 2, squeeze=False, width_ratios=(3, 2), wspace=0.03)[
            0
        ]
        upper, lower = over_time.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        draw_history(upper, lower, diagnosis, outputs, brief=True)
        panels = over_frequency.subplots(max(1, len(answers)), 1, squeeze=False)[:, 0]
        draw_answers(panels, answers, brief=True)
        if answers:
            handles = panels[0].get_legend_handles_labels()
            over_frequency.legend(*handles, loc="outside lower center", ncols=2, fontsize="small")
    return figure
