"""A run as it was measured and as it is simulated before and after, with the differences below."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.inference.misfit import levelled, simulate
from pounding.diagnosis.report.making import Outputs, shown_after, shown_run
from pounding.experiments.pictures.palette import BLACK, BLUE, ORANGE

SHOWN_S = 3.0
"""Length of what is shown of a run [s], about its largest value."""
BRIEF = 0.6
"""Width of lines in a small picture, as a share of that in a large one."""


def history_figure(diagnosis: Diagnosis, outputs: Outputs) -> Figure:
    """Return the picture of `draw_history`.

    Args:
        diagnosis: What was found and decided.
        outputs: The runs as the engine gave them for the model of the verdict, by number; may be empty.
    """
    figure = Figure(figsize=(9, 5.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    draw_history(upper, lower, diagnosis, outputs)
    return figure


def _not_claimed(diagnosis: Diagnosis, brief: bool) -> str:
    """Return in words what is in the model after, where that is not the verdict's effect."""
    shown = shown_after(diagnosis)
    if diagnosis.decision.named or shown is None:
        return ""
    if not shown.effects:
        return " (errors)" if brief else " (with the errors that this frame has)"
    return " (candidate)" if brief else " (with the likeliest candidate, which is not claimed)"


def draw_history(
    upper: Axes, lower: Axes, diagnosis: Diagnosis, outputs: Outputs, *, brief: bool = False
) -> None:
    """Draw the channel with the largest misfit in the held-out run, or in the first one that was used.

    Args:
        upper: Takes what was measured and simulated.
        lower: Takes the differences; its time is that of `upper`.
        diagnosis: What was found and decided.
        outputs: The runs as the engine gave them for the model of the verdict, by number; may be empty.
        brief: Whether the titles have little room.
    """
    case, found = diagnosis.case, diagnosis.found
    model, observed = found.model, found.model.observed
    run = shown_run(found)
    data = observed.runs[run]
    channel = int(np.nanargmax(found.baseline.channel_misfit[1 if found.held_out else 0]))
    scale, unit = observed.to_si[channel], case.channels[case.channel_index(observed.names[channel])].unit
    fitted = found.baseline.fit.filtered
    simulated = {"before": (simulate(model, fitted.values, fitted.effects, [run])[0], BLUE)}
    if outputs:
        simulated["after"] = (outputs[run], ORANGE)
    told = {"after": _not_claimed(diagnosis, brief)}
    before, wide = ("", BRIEF) if brief else ("simulated, ", 1.0)
    measured = data.measured[:, channel] / scale
    for (name, (output, colour)), width in zip(simulated.items(), (1.8, 2.8), strict=False):
        difference = levelled(model, output - data.measured, data.step_s)[:, channel] / scale
        rms = float(np.sqrt(np.nanmean(difference**2)))
        # What lies nearer to the measurement is drawn wider, so that both stand out behind it.
        upper.plot(
            data.time_s,
            output[:, channel] / scale,
            color=colour,
            lw=wide * width,
            label=f"{before}{name}{told.get(name, '')}",
        )
        label = f"{name}: {'' if brief else 'simulated − measured, '}rms {rms:.3g} {unit}"
        lower.plot(data.time_s, difference, color=colour, lw=wide, label=label)
    upper.plot(data.time_s, measured, color=BLACK, lw=0.9 * wide, label="measured")
    used = "held out" if found.held_out else "the run that was used; none could be held out"
    largest = "" if brief else ": the channel with the largest misfit before"
    upper.set_title(
        f"{observed.names[channel]} in {data.name} ({used}){largest}",
        fontsize="medium",
        pad=17 if brief else 26,
    )
    middle = data.time_s[int(np.argmax(np.abs(np.nan_to_num(measured))))]
    first = min(max(data.time_s[0], middle - 0.4 * SHOWN_S), max(data.time_s[0], data.time_s[-1] - SHOWN_S))
    upper.set_xlim(first, min(data.time_s[-1], first + SHOWN_S))
    for axes in (upper, lower):
        axes.set_ylabel(f"{observed.names[channel]} [{unit}]" if axes is upper else f"difference [{unit}]")
        axes.grid(alpha=0.25)
    lower.set_xlabel("time [s]")
    upper.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=3, fontsize="small", borderaxespad=0)
    lower.legend(loc="lower left", bbox_to_anchor=(0, 1.02), ncols=2, fontsize="small", borderaxespad=0)
