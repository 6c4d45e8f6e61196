"""The report's figures, as PNG."""

from __future__ import annotations

import io
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.report.history_figure import history_figure
from pounding.diagnosis.report.loop_figure import loop_figure
from pounding.diagnosis.report.loops import Loops
from pounding.diagnosis.report.making import Outputs
from pounding.diagnosis.report.misfit_maps import misfit_maps
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.residual_force_figure import residual_force_figure
from pounding.diagnosis.report.sheet_figure import sheet_figure
from pounding.diagnosis.report.transmissibility import answers, transmissibility_figure
from pounding.experiments.pictures.palette import BLACK, BLUE, GREY, ORANGE

CANDIDATES = 10
CAPTIONS = {
    "first_page.png": "The picture of the report's first page: measured, before and after, over time and over frequency.",
    "before_after.png": "A measured channel and the model before and after the effect is added to it, and both differences.",
    "transmissibility.png": "How the highest channel answers the table at each frequency: measured, and by the models.",
    "where.png": "The misfit of each channel [%], in all, by band of frequencies and by run.",
    "residual_force.png": "The force [N] that a storey has beyond the calibrated model, against drift, drift rate and time; "
    "drawn towards zero where the measurements say little of it.",
    "evidence.png": "How strongly the measurements speak for each effect that was tried (ln Bayes factor).",
    "force_over_drift.png": "The force [N] of the named storey over its drift [mm], measured and by the law that was found.",
    "on_the_frame.png": "The frame with the effect, in colour, and without it, as lines, at one moment; enlarged.",
}
"""What the report's pictures show, by the name of their file."""


def figures(
    diagnosis: Diagnosis, report: Report, outputs: Outputs, loop: Loops | None, first_page_mm: float
) -> dict[str, bytes]:
    """Return the PNG of each figure by its name.

    Args:
        diagnosis: What was found and decided.
        report: The report with its details.
        outputs: The runs as the engine gave them for the model of the verdict.
        loop: The loops of the named storey, if there is one.
        first_page_mm: Height of the first page's figure on paper [mm].
    """
    answered = answers(diagnosis, outputs)
    shown = {} if loop is None else {"force_over_drift": _png(loop_figure(diagnosis, loop))}
    return shown | {
        "first_page": _png(sheet_figure(diagnosis, outputs, answered, first_page_mm), dpi=200),
        "before_after": _png(history_figure(diagnosis, outputs)),
        "transmissibility": _png(transmissibility_figure(answered)),
        "where": _png(_where(diagnosis, report)),
        "residual_force": _png(residual_force_figure(diagnosis, loop)),
        "evidence": _png(evidence_figure(report)),
    }


def _png(figure: Figure, dpi: int = 100) -> bytes:
    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    store = io.BytesIO()
    # `savefig` would draw a figure that has a layout twice.
    canvas.print_png(store)  # type: ignore[no-untyped-call]
    return store.getvalue()


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), layout="constrained")


def _where(diagnosis: Diagnosis, report: Report) -> Figure:
    found = diagnosis.found
    model, names = found.model, found.model.observed.names
    which = 1 if found.held_out else 0
    floor = found.floor[which]
    figure = _figure(9, 1.2 + 0.36 * len(names))
    bars, bands, each = figure.subplots(1, 3, width_ratios=(3, 3, 1.5))
    at = np.arange(len(names))
    bars.barh(at - 0.2, 100 * found.baseline.channel_misfit[which], 0.36, color=BLUE, label="before")
    after = np.array([])
    if any(one.after is not None for one in report.channels or ()):
        after = np.array([np.nan if one.after is None else one.after for one in report.channels or ()])
        bars.barh(at + 0.2, 100 * after, 0.36, color=ORANGE, label="after")
    for row in at:
        noise = 100 * floor[row]
        bars.plot(
            [noise, noise], [row - 0.42, row + 0.42], color=BLACK, lw=2, label="" if row else "noise floor"
        )
    bars.set_yticks(at, names)
    bars.set_xscale("log")
    lengths = 100 * np.concatenate([found.baseline.channel_misfit[which], floor, after])
    bars.set_xlim(0.6 * np.nanmin(lengths), max(1.3 * np.nanmax(lengths), 4 * np.nanmin(lengths)))
    bars.xaxis.set_major_locator(LogLocator(10, (1, 2, 5)))
    bars.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    bars.xaxis.set_minor_formatter(NullFormatter())
    bars.set_xlabel("misfit [%]")
    bars.set_title("held-out run" if which else "runs used", fontsize=10)
    # Names of channels reach to the edge of the picture.
    figure.set_layout_engine("constrained", w_pad=0.1)
    figure.legend(*bars.get_legend_handles_labels(), loc="outside upper left", ncols=3, fontsize=8)
    maps = misfit_maps(
        model,
        found.baseline.fit.filtered,
        np.nan_to_num(found.floor[0], nan=1.0),
        [*found.training, *found.held_out],
    )
    edges = maps.edges_hz
    labels = [f"{low:.0f}–{high:.0f}" for low, high in pairwise(edges)]
    _map(bands, maps.by_band, maps.band_noise, labels, "before, by band [Hz]")
    image = _map(
        each, maps.by_run, maps.run_noise, [name.removesuffix(".csv") for name in maps.runs], "by run"
    )
    figure.colorbar(image, ax=each, label="misfit / noise", ticks=[1, 3, 10, 30], format="%g")
    for axes in (bars, bands, each):
        axes.set_ylim(len(names) - 0.5, -0.5)
    return figure


def _map(axes: Axes, misfits: np.ndarray, noise: np.ndarray, labels: list[str], title: str) -> AxesImage:
    """Draw misfits [%] as numbers on colours that say how far above the noise they are."""
    ratio = np.clip(np.nan_to_num(misfits / noise, nan=1.0), 1.0, 30.0)
    image = axes.imshow(ratio, norm=LogNorm(1, 30), cmap="YlOrRd", aspect="auto")
    for (row, column), value in np.ndenumerate(misfits):
        if np.isfinite(value):
            colour = "white" if ratio[row, column] > 10 else "black"
            text = f"{100 * value:.0f}" if value >= 0.0995 else f"{100 * value:.1f}"
            axes.text(column, row, text, ha="center", va="center", fontsize=7.5, color=colour)
    axes.set_xticks(range(len(labels)), labels, rotation=40, ha="right", fontsize=8)
    axes.set_yticks([])
    axes.set_title(f"{title}, misfit in %" if "band" in title else title, fontsize=10)
    return image


def evidence_figure(report: Report) -> Figure:
    """Return the ln Bayes factors of the best candidates, beside what a verdict needs."""
    shown = report.candidates[:CANDIDATES][::-1]
    figure = _figure(9, 0.9 + 0.3 * len(shown))
    axes = figure.subplots()
    named = {effect.place for effect in report.effects}
    values = [one.log_evidence for one in shown]
    bars = axes.barh(
        range(len(shown)), values, color=[ORANGE if one.place in named else BLUE for one in shown]
    )
    # On white, so that neither a line of what is needed nor the next bar runs through a number.
    axes.bar_label(
        bars,
        [f"{value:.1f}" if abs(value) < 100 else f"{value:.0f}" for value in values],
        padding=4,
        fontsize=9,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
    )
    axes.set_yticks(range(len(shown)), [one.words() for one in shown])
    axes.set_ylim(-0.6, len(shown) + 0.1)
    most = 100.0
    if thresholds := report.thresholds:
        needed, absorbing = thresholds.log_evidence, thresholds.absorbing.log_evidence
        of_frames = absorbing != needed
        label = "needed for a verdict" + (" on the frames" if of_frames else "")
        axes.axvline(needed, color=GREY, ls="--", lw=1, label=label)
        if of_frames:
            label = "by P-Delta, joints, rocking, torsion, hysteresis"
            axes.axvline(absorbing, color=GREY, ls=":", lw=1, label=label)
        most = max(most, 3.0 * absorbing)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower right", ncols=2, fontsize=8)
    axes.set_xscale("symlog", linthresh=10)
    axes.set_xlim(min(0.0, 1.6 * min(values, default=0.0)), max(5.0 * max(values, default=0.0), most))
    axes.set_xlabel("ln Bayes factor against 'nothing missing' (logarithmic beyond 10)")
    return figure
