"""The report's figures, as PNG."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from diagnosis.gap import levelled, simulate
from diagnosis.search import Findings
from diagnosis.verdict import decide
from diagnosis.where import Leftover, leftover_forces

BLUE, ORANGE, GREY = "#2b6cb0", "#dd6b20", "#4a5568"


def figures(found: Findings, report: dict[str, Any]) -> dict[str, bytes]:
    """Return each figure's name and PNG."""
    return {
        "before_after": _png(_before_after(found)),
        "where": _png(_where(found)),
        "leftover": _png(_leftover(found, report)),
        "evidence": _png(_evidence(report)),
    }


def _png(figure: Figure) -> bytes:
    FigureCanvasAgg(figure)
    store = io.BytesIO()
    figure.savefig(store, format="png", dpi=100)
    return store.getvalue()


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), layout="constrained")


def _before_after(found: Findings) -> Figure:
    believed, judged = found.believed, decide(found).judged
    run = (found.held_out or found.training)[0]
    data = believed.observed.runs[run]
    before = simulate(believed, found.null.fit.baseline.values, (), [run])[0]
    after = simulate(believed, judged.fit.baseline.values, judged.fit.baseline.effects, [run])[0]
    gaps = found.null.channel_gap[1 if found.held_out else 0]
    channel = int(np.nanargmax(gaps))
    scale = believed.observed.to_si[channel]
    measured = data.measured[:, channel] / scale
    figure = _figure(9, 5)
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(data.time_s, measured, color=GREY, lw=1.2, label="measured")
    for name, output, colour in (("before", before, BLUE), ("after", after, ORANGE)):
        simulated = output[:, channel] / scale
        upper.plot(data.time_s, simulated, color=colour, lw=0.8, label=f"simulated, {name}")
        difference = levelled(believed, output - data.measured)[:, channel] / scale
        lower.plot(data.time_s, difference, color=colour, lw=0.8, label=f"{name}: simulated − measured")
    upper.set_title(
        f"{believed.observed.names[channel]}, {data.name}: the channel with the largest gap before"
    )
    middle = data.time_s[int(np.argmax(np.abs(np.nan_to_num(measured))))]
    upper.set_xlim(max(data.time_s[0], middle - 1.5), min(data.time_s[-1], middle + 1.5))
    for axes in (upper, lower):
        axes.legend(loc="upper right", fontsize=8)
        axes.set_ylabel("channel's unit")
    lower.set_xlabel("time [s]")
    return figure


def _where(found: Findings) -> Figure:
    judged = decide(found).judged
    names = found.believed.observed.names
    figure = _figure(9, 0.6 + 0.32 * len(names))
    axes = figure.subplots()
    at = np.arange(len(names))
    which = 1 if found.held_out else 0
    axes.barh(at + 0.2, found.null.channel_gap[which], 0.4, color=BLUE, label="before")
    axes.barh(at - 0.2, judged.channel_gap[which], 0.4, color=ORANGE, label="after")
    axes.plot(found.floor[which], at, "k|", ms=14, label="noise floor")
    axes.set_yticks(at, names)
    axes.set_xscale("log")
    axes.set_xlabel("gap, " + ("held-out runs" if which else "training runs"))
    axes.legend(fontsize=8)
    return figure


def _leftover(found: Findings, report: dict[str, Any]) -> Figure:
    runs = found.training[:1]
    force = leftover_forces(found.believed, found.null.fit.baseline, runs)[0]
    storey = _storey(found, report, force)
    frame, number = found.believed.structure.place(storey)
    series, std = force.force[:, storey], float(force.std[storey])
    figure = _figure(9, 3.2)
    axes = figure.subplots(1, 3, sharey=True)
    pairs = (
        (force.drift[:, storey] * 1000, "drift [mm]"),
        (force.drift_rate[:, storey] * 1000, "drift rate [mm/s]"),
    )
    for one, (abscissa, label) in zip(axes, pairs, strict=False):
        one.plot(abscissa, series, ".", ms=1.5, color=BLUE)
        one.axhspan(-2 * std, 2 * std, color=ORANGE, alpha=0.2, lw=0)
        one.set_xlabel(label)
    axes[2].fill_between(force.time_s, series - 2 * std, series + 2 * std, color=ORANGE, alpha=0.3, lw=0)
    axes[2].plot(force.time_s, series, color=BLUE, lw=0.6)
    axes[2].set_xlabel("time [s]")
    axes[0].set_ylabel("leftover force [N]")
    figure.suptitle(f"storey {number} of {frame}, {force.run}", fontsize=10)
    return figure


def _storey(found: Findings, report: dict[str, Any], force: Leftover) -> int:
    for effect in report["effects"]:
        if effect["storey"] is not None:
            structure = found.believed.structure
            return structure.first(structure.index(effect["frame"])) + int(effect["storey"]) - 1
    return int(np.argmax(np.sqrt(np.mean(force.force**2, axis=0)) / force.std))


def _evidence(report: dict[str, Any]) -> Figure:
    shown = report["candidates"][:10][::-1]
    figure = _figure(9, 0.6 + 0.3 * len(shown))
    axes = figure.subplots()
    labels = []
    for one in shown:
        where = [str(one[key]) for key in ("frame", "storey", "floor", "channel") if one[key] is not None]
        labels.append(" ".join([one["effect"].replace("_", " "), *where]))
    axes.barh(labels, [max(one["log_evidence"], 0.0) for one in shown], color=BLUE)
    axes.set_xscale("symlog", linthresh=10)
    axes.set_xlabel("log evidence against 'nothing missing' [nats]")
    return figure
