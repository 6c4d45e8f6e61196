"""The force that a storey has beyond the model, against drift, its rate and time, with what was found laid over it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.residual_force import ResidualForce, residual_force
from pounding.diagnosis.inference.storey_force import storey_force
from pounding.diagnosis.report.loops import Loops, without_forces
from pounding.diagnosis.report.making import without
from pounding.experiments.pictures.palette import BLUE, GREY, ORANGE

SHOWN_S = 1.5
BINS = 24
LEAST = 8
"""Seconds shown against time, and bins of the means with the least number of samples in one."""


def residual_force_figure(diagnosis: Diagnosis, loop: Loops | None = None) -> Figure:
    """Return the picture of the storey in question in the strongest run that was used.

    The model is that of the verdict without its effects, so that their force is the residual.

    Args:
        diagnosis: What was found and decided.
        loop: The loops of the named storey, whose estimate is taken where it is of this model.
    """
    found, decision = diagnosis.found, diagnosis.decision
    model, named = found.model, decision.named
    judged = decision.judged if named else found.baseline
    fit = judged.fit.filtered
    run = max(found.training, key=lambda number: float(np.ptp(model.observed.runs[number].table)))
    if named and loop is not None and found.settled is None:
        left = loop.measured[0]
    else:
        left = residual_force(model, without_forces(fit, judged.effects), run)
    storey = _storey(diagnosis, left)
    frame, number = model.structure.place(storey)
    force, std = left.force[:, storey], float(left.std[storey])
    step = model.observed.runs[run].step_s
    claimed = without(fit, found.null.fit.effects)
    law = storey_force(model, claimed, storey, left.drift, left.drift_rate, step) if named else None
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    *axes, storeys = figure.subplots(1, 4, width_ratios=(3, 3, 3, 1.3))
    for one in axes[1:]:
        one.sharey(axes[0])
        one.tick_params(labelleft=False)
    for one, series, label in zip(
        axes, (left.drift * 1e3, left.drift_rate * 1e3), ("drift [mm]", "drift rate [mm/s]"), strict=False
    ):
        _against(one, series[:, storey], force, std, law)
        one.set_xlabel(label)
    _in_time(axes[2], left, force, std, law)
    axes[0].set_ylabel("force beyond the model [N]")
    _by_storey(storeys, found, left, storey)
    figure.suptitle(f"Storey {number} of {frame} in {left.run}: residual force", fontsize=10)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _storey(diagnosis: Diagnosis, left: ResidualForce) -> int:
    """Return the storey of what is claimed; without any the one whose residual force is largest."""
    structure = diagnosis.found.model.structure
    for claim in diagnosis.conclusion.effects:
        if claim.frame is not None and (claim.storey is not None or claim.floor is not None):
            return structure.first(structure.index(claim.frame)) + int(claim.storey or claim.floor or 0) - 1
    return int(np.argmax(np.sqrt(np.mean(left.force**2, axis=0)) / left.std))


def _against(axes: Axes, abscissa: np.ndarray, force: np.ndarray, std: float, law: np.ndarray | None) -> None:
    axes.plot(abscissa, force, ".", ms=1.2, color=BLUE, alpha=0.35, rasterized=True)
    if law is not None:
        axes.plot(abscissa, law, ".", ms=1.2, color=ORANGE, alpha=0.6, rasterized=True)
        axes.plot([], [], "-", color=ORANGE, label="the effect as found")
    edges = np.linspace(abscissa.min(), abscissa.max(), BINS + 1)
    inside = np.clip(np.digitize(abscissa, edges) - 1, 0, BINS - 1)
    full = [i for i in range(BINS) if np.sum(inside == i) >= LEAST]
    centre = 0.5 * (edges[:-1] + edges[1:])[full]
    mean = np.array([force[inside == i].mean() for i in full])
    axes.plot([], [], "-", color=BLUE, label="residual force, each sample")
    axes.fill_between(
        centre, mean - 2 * std, mean + 2 * std, color=GREY, alpha=0.25, lw=0, label="± 2 std. errors"
    )
    axes.plot(centre, mean, color="black", lw=1.2, label="its mean")
    axes.axhline(0, color=GREY, lw=0.6)


def _in_time(axes: Axes, left: ResidualForce, force: np.ndarray, std: float, law: np.ndarray | None) -> None:
    axes.fill_between(left.time_s, force - 2 * std, force + 2 * std, color=GREY, alpha=0.3, lw=0)
    axes.plot(left.time_s, force, color=BLUE, lw=0.8)
    if law is not None:
        axes.plot(left.time_s, law, color=ORANGE, lw=0.9)
    middle = float(left.time_s[int(np.argmax(np.abs(law if law is not None else force)))])
    first = max(float(left.time_s[0]), middle - 0.5 * SHOWN_S)
    axes.set_xlim(first, first + SHOWN_S)
    axes.axhline(0, color=GREY, lw=0.6)
    axes.set_xlabel("time [s]")


def _by_storey(axes: Axes, found: Findings, left: ResidualForce, storey: int) -> None:
    """Draw the residual force of each storey, beside its standard error."""
    rms = np.sqrt(np.mean(left.force**2, axis=0))
    at = np.arange(len(rms))
    axes.barh(at, rms, 0.6, color=[BLUE if i == storey else "#a0bfe0" for i in at])
    axes.plot(left.std, at, "|", ms=12, mew=2, color=GREY)
    structure = found.model.structure
    places = [structure.place(int(i)) for i in at]
    single = len(structure.frames) == 1
    axes.set_yticks(at, [str(number) if single else f"{frame} {number}" for frame, number in places])
    axes.set_ylabel("storey")
    axes.yaxis.set_label_position("right")
    axes.yaxis.tick_right()
    axes.set_xlabel("rms [N]")
