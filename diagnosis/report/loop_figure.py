"""The picture of the named storey's force over its drift, as measured and by the law."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.inference.residual_force import ResidualForce
from pounding.diagnosis.report.loops import Loops
from pounding.experiments.pictures.palette import BLACK, BLUE, GREY, ORANGE

CYCLES = 3.0
"""Cycles of the frame's first frequency that are drawn as loops, about the largest drift."""
FINER = 4
"""Points a sample at which loops are drawn: fast frames have few samples a cycle."""
BINS = 20
LEAST = 8
"""Bins of drift for the means of each branch, and the least number of samples in one."""


def loop_figure(diagnosis: Diagnosis, loop: Loops) -> Figure:
    """Return the picture of the loops about the largest drift, and of the mean force on both branches over all runs.

    Args:
        diagnosis: What was found and decided.
        loop: The loops.
    """
    model = diagnosis.found.model
    frame, number = model.structure.place(loop.storey)
    first = model.structure.first(model.structure.index(frame))
    omega = float(diagnosis.found.null.fit.filtered.modes.omega[first])
    measured, law = loop.measured[0], loop.law[0]
    part = _about_the_largest(measured, loop.storey, CYCLES * 2 * np.pi / omega)
    figure = Figure(figsize=(9, 3.9), layout="constrained")
    beyond, branches = figure.subplots(1, 2, sharey=True)
    _loop(beyond, measured, law, loop.storey, part)
    beyond.set_xlabel("drift [mm]")
    beyond.set_ylabel("force beyond the model [N]")
    beyond.set_title(f"{measured.run}, {part.sum()} samples about its largest drift", fontsize=9)
    _branches(branches, loop)
    branches.set_xlabel("drift [mm]")
    branches.set_title(f"means over {', '.join(one.run for one in loop.measured)}", fontsize=9)
    figure.suptitle(f"Storey {number} of {frame}: force over drift", fontsize=10)
    handles = dict(zip(*reversed(beyond.get_legend_handles_labels()), strict=True))
    handles |= dict(zip(*reversed(branches.get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=5, fontsize=8)
    return figure


def _about_the_largest(motion: ResidualForce, storey: int, length_s: float) -> np.ndarray:
    """Return which samples are shown, (samples,): so long a time about the largest drift."""
    middle = motion.time_s[int(np.argmax(np.abs(motion.drift[:, storey])))]
    first = np.clip(
        middle - length_s / 2, motion.time_s[0], max(motion.time_s[0], motion.time_s[-1] - length_s)
    )
    return np.asarray((motion.time_s >= first) & (motion.time_s <= first + length_s))


def _loop(axes: Axes, measured: ResidualForce, law: ResidualForce, storey: int, part: np.ndarray) -> None:
    drift, force = 1e3 * measured.drift[part, storey], measured.force[part, storey]
    axes.plot(*_between(law, storey, part), color=ORANGE, lw=2.6, label="by the law")
    axes.errorbar(
        drift, force, 2 * measured.std[storey], fmt="none", ecolor=GREY, alpha=0.25, elinewidth=1.5,
        label="± 2 standard errors",
    )  # fmt: skip
    axes.plot(*_between(measured, storey, part), color=BLACK, lw=1.0, label="measured")
    axes.axhline(0, color=GREY, lw=0.6)
    axes.grid(alpha=0.25)


def _between(one: ResidualForce, storey: int, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return drift [mm] and force [N] at the samples of a part and smoothly between them, (points,) each."""
    times = one.time_s[part]
    finer = np.linspace(times[0], times[-1], FINER * (len(times) - 1) + 1)
    drift, force = (CubicSpline(times, series[part, storey])(finer) for series in (one.drift, one.force))
    return 1e3 * drift, force


def _branches(axes: Axes, loop: Loops) -> None:
    """Draw the mean force over the drift, going and coming, with its standard error over the samples' scatter."""
    for each, colour, width in ((loop.law, ORANGE, 2.6), (loop.measured, None, 1.0)):
        drift, rate, force = (
            np.concatenate([getattr(one, key)[:, loop.storey] for one in each])
            for key in ("drift", "drift_rate", "force")
        )
        largest = np.quantile(np.abs(drift), 0.998)
        edges = np.linspace(-largest, largest, BINS + 1)
        for sign, own, dashes in ((1, BLACK, "-"), (-1, BLUE, "--")):
            branch = sign * rate > 0
            centre, mean, spread = _means(drift[branch], force[branch], edges)
            axes.plot(1e3 * centre, mean, color=colour or own, lw=width, ls=dashes if colour else "-")
            if colour is None:
                axes.fill_between(
                    1e3 * centre, mean - 2 * spread, mean + 2 * spread, color=own, alpha=0.15, lw=0
                )
                way = "drift grows" if sign > 0 else "drift falls"
                axes.plot([], [], color=own, lw=width, label=f"measured, {way}")
    axes.axhline(0, color=GREY, lw=0.6)
    axes.grid(alpha=0.25)


def _means(
    drift: np.ndarray, force: np.ndarray, edges: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return centres, means and the standard errors of these, (bins,) each, of the bins with enough samples."""
    inside = np.digitize(drift, edges) - 1
    full = [i for i in range(BINS) if np.sum(inside == i) >= LEAST]
    centre = 0.5 * (edges[:-1] + edges[1:])[full]
    parts = [force[inside == i] for i in full]
    mean = np.array([part.mean() for part in parts])
    return centre, mean, np.array([part.std(ddof=1) / np.sqrt(len(part)) for part in parts])
