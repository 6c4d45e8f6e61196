"""How the top floors answer the table over frequency: measured, by the baseline model, calibrated, and corrected."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.signal import csd, welch

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.predictor import ACCELERATION
from pounding.diagnosis.report.history_figure import BRIEF
from pounding.diagnosis.report.making import Outputs, shown_after
from pounding.experiments.pictures.palette import BLACK, BLUE, GREEN, ORANGE

SEGMENT = 0.5
"""Length of the segments of a spectrum as a share of the shortest run; they overlap by half."""
BELOW, BEYOND = 0.4, 1.2
"""Shown are frequencies from and to these multiples of a frame's first frequency and of its highest one that is shown."""
MODES = 4
"""The highest frequency shown is at most that of this mode: above it most records hold noise."""
DRIVEN = 1e-4
"""[largest power of the table] Frequencies at which the table moved less are left out: nothing can be divided by it."""


@dataclass(frozen=True)
class Answers:
    """The answer of one channel to the table's acceleration, in all runs of one sampling rate together.

    Attributes:
        runs: Names of the runs. frame: The frame. channel: The channel's name. unit: Unit of the answer.
        hertz: Frequencies [Hz], shape (n,).
        sizes: Size of the answer in that unit, by what gives it, each (n,); NaN where the table hardly moved.
    """

    runs: tuple[str, ...]
    frame: str
    channel: str
    unit: str
    hertz: np.ndarray
    sizes: dict[str, np.ndarray]


def answers(diagnosis: Diagnosis, outputs: Outputs) -> list[Answers]:
    """Return the answer of each frame's highest channel: measured, baseline, calibrated, and corrected where it was run.

    All are the cross spectrum of channel and table over the table's own spectrum, with the same windows, so that what the
    windows smear they smear alike.

    Args:
        diagnosis: What was found and decided.
        outputs: The runs as the engine gave them with the effects in them, by number; may be empty.
    """
    found = diagnosis.found
    model, runs = found.model, _alike(found.model, [*found.training, *found.held_out])
    calibrated = found.baseline.fit.filtered
    series = {
        "measured": [model.observed.runs[run].measured for run in runs],
        "baseline": simulate(model, np.zeros(len(model.std)), (), runs),
        "calibrated": simulate(model, calibrated.values, calibrated.effects, runs),
    }
    if outputs:
        after = shown_after(diagnosis)
        claimed = "corrected" if diagnosis.decision.named else "candidate"
        name = claimed if after is not None and after.effects else "with errors"
        series[name] = [outputs[run] for run in runs]
    shown = (_highest(model, number) for number in range(len(model.structure.frames)))
    drawn = [
        _answers(diagnosis, number, channel, series)
        for number, channel in enumerate(shown)
        if channel is not None
    ]
    # Runs that are too short, or shaken where no mode is, have no spectrum there.
    return [one for one in drawn if np.isfinite(one.sizes["measured"]).sum() > 1]


def _alike(model: Model, runs: Sequence[int]) -> list[int]:
    """Return the runs of the first one's sampling rate: spectra of others have other frequencies."""
    data = model.observed.runs
    return [run for run in runs if np.isclose(data[run].step_s, data[runs[0]].step_s)]


def _highest(model: Model, frame: int) -> int | None:
    """Return the channel on a frame's highest measured floor, an acceleration before others; None without any."""
    observed = model.observed
    ours = np.flatnonzero(model.at_frame(frame))
    if not len(ours):
        return None
    return int(max(ours, key=lambda c: (observed.floor[c], observed.quantity[c] == ACCELERATION)))


def _answers(diagnosis: Diagnosis, frame: int, channel: int, series: dict[str, list[np.ndarray]]) -> Answers:
    found, case = diagnosis.found, diagnosis.case
    model, observed = found.model, found.model.observed
    data = [observed.runs[run] for run in _alike(model, [*found.training, *found.held_out])]
    samples = max(16, int(SEGMENT * min(len(one.table) for one in data)))
    step_s = data[0].step_s
    tables = [one.table for one in data]
    power = sum(welch(table, 1 / step_s, nperseg=samples)[1] for table in tables)
    hertz = np.fft.rfftfreq(samples, step_s)
    stated = case.channels[case.channel_index(observed.names[channel])].unit
    acceleration = observed.quantity[channel] == ACCELERATION
    # An acceleration over the table's has no unit; others stay in that of the channel.
    scale, unit = (1.0, "-") if acceleration else (observed.to_si[channel], f"{stated} / (m/s²)")
    modes = found.baseline.fit.filtered.modes
    first = model.structure.first(frame)
    last = min(first + model.structure.frames[frame].floors, first + MODES) - 1
    own = modes.omega / (2 * np.pi)
    inside = (hertz > BELOW * own[first]) & (hertz < min(BEYOND * own[last], 0.4 / step_s))
    driven = power[inside] > DRIVEN * power.max()
    sizes = {}
    for name, given in series.items():
        crossed = sum(
            csd(table, _filled(one[:, channel]), 1 / step_s, nperseg=samples)[1]
            for table, one in zip(tables, given, strict=True)
        )
        sizes[name] = np.where(driven, np.abs(crossed[inside]) / power[inside] / scale, np.nan)
    names = tuple(one.name for one in data)
    return Answers(
        names, model.structure.frames[frame].name, observed.names[channel], unit, hertz[inside], sizes
    )


def _filled(series: np.ndarray) -> np.ndarray:
    """Return a series with its missing samples on straight lines between those that were measured."""
    good = np.isfinite(series)
    if good.all() or not good.any():
        return np.asarray(np.nan_to_num(series))
    index = np.arange(len(series))
    return np.asarray(np.interp(index, index[good], series[good]))


STYLES: dict[str, dict[str, Any]] = {
    "baseline": {"color": GREEN, "lw": 1.6, "ls": (0, (5, 2))},
    "calibrated": {"color": BLUE, "lw": 2.2},
    "corrected": {"color": ORANGE, "lw": 2.6},
    "candidate": {"color": ORANGE, "lw": 2.6},
    "with errors": {"color": ORANGE, "lw": 2.6},
    "measured": {"color": BLACK, "lw": 1.0},
}
"""How each line is drawn, the measured one last: it lies over what was simulated."""


def transmissibility_figure(shown: Sequence[Answers]) -> Figure:
    """Return the picture of the frames' answers to the table, a panel for each frame.

    Args:
        shown: See `answers`.
    """
    figure = Figure(figsize=(9, 0.6 + 3.2 * max(1, len(shown))), layout="constrained")
    panels = figure.subplots(max(1, len(shown)), 1, squeeze=False)[:, 0]
    draw_answers(panels, shown)
    if shown:
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    return figure


def draw_answers(panels: Iterable[Axes], shown: Sequence[Answers], *, brief: bool = False) -> None:
    """Draw the answer of each frame into a panel of its own.

    Args:
        panels: As many as answers, from the top.
        shown: See `answers`.
        brief: Whether the titles have little room.
    """
    for axes, one in zip(panels, shown, strict=False):
        for name, style in STYLES.items():
            if name in one.sizes:
                wide = (BRIEF if brief else 1.0) * style["lw"]
                axes.plot(one.hertz, one.sizes[name], label=name, **(style | {"lw": wide}))
        axes.set_yscale("log")
        # Anti-resonances of a simulation without noise go down without end.
        axes.set_ylim(0.5 * np.nanmin(one.sizes["measured"]), 2 * np.nanmax([*one.sizes.values()]))
        axes.set_xlim(one.hertz[0], one.hertz[-1])
        axes.set_ylabel(f"|{one.channel} / table| [{one.unit}]")
        runs = "all runs" if brief else ", ".join(one.runs)
        what = "top over table" if brief else "the highest channel over the table's acceleration"
        axes.set_title(f"{one.frame}: {what} in {runs}", fontsize="medium")
        axes.grid(alpha=0.25, which="both")
        axes.set_xlabel("frequency [Hz]")
