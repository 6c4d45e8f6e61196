"""Plots of a run: histories with published peaks and measured histories, response and Fourier spectra."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import matplotlib.ticker
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.pictures.panels import keep, panels
from pounding.experiments.records.spectra import fourier_spectrum, response_spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pounding.experiments.measurements.history import Channel
    from pounding.experiments.records import Record

Real = NDArray[np.floating[Any]]

OURS, THEIRS, PUBLISHED = "#1f4e79", "#d1711c", "#b3262e"
"""Colours of what is computed, what was measured, and what is published."""

WIDTH = 9.0
"""Width of a figure [inches]."""

STYLE: Any = {
    "font.size": 10,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "lines.linewidth": 1.0,
    "legend.frameon": False,
}


@matplotlib.rc_context(STYLE)
def history(
    data: xr.Dataset,
    path: str | Path | None = None,
    *,
    frame: str,
    floors: Sequence[int] | None = None,
    published_mm: Mapping[int, tuple[float, float]] | None = None,
    measured: Iterable[Channel] = (),
    title: str = "",
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Plot the table's acceleration and a frame's floor displacements relative to it.

    Args:
        data: A run (`pounding.experiments.results.dataset.dataset`).
        path: File to write, its suffix says the format; none when None.
        frame: Label of the frame.
        floors: Floors to show, from the top down; the roof when None.
        published_mm: Published maximum and minimum by floor, both positive [mm].
        measured: Measured histories; those of relative displacement on these floors are laid over.
        title: Title.
        axes: Axes to draw into, one for the table and one for each floor; a new figure when None.

    Returns:
        The axes.

    Raises:
        ExperimentError: Not as many axes were given as there are panels.
        FrameError: The file cannot be written.
    """
    shown = list(floors or [roof(data, frame)])
    axes = panels(axes, 1 + len(shown), (WIDTH, 1.5 + 1.7 * (1 + len(shown))), sharex=True)
    time = data.time.values
    axes[0].plot(time, data.table_acceleration.values / STANDARD_GRAVITY, color="#555555", lw=0.8)
    axes[0].set_ylabel("table [g]")
    axes[0].set_title(title, loc="left")
    channels = list(measured)
    for axis, floor in zip(axes[1:], shown, strict=True):
        moved = 1e3 * data.relative_displacement.sel(frame=frame, floor=floor).values
        axis.plot(time, moved, color=OURS, label="computed")
        for channel in channels:
            if (channel.quantity, channel.floor, channel.frame) == ("relative_displacement", floor, frame):
                axis.plot(channel.time_s, 1e3 * channel.values, color=THEIRS, lw=0.9, label="measured")
        if published_mm and floor in published_mm:
            _mark(axis, published_mm[floor])
        axis.set_ylabel(f"floor {floor} [mm]")
    axes[1].legend(loc="upper right", ncols=4, fontsize=9)
    axes[-1].set_xlabel("time on the model's clock [s]")
    axes[-1].set_xlim(time[0], time[-1])
    keep(axes[0], path)
    return axes


@matplotlib.rc_context(STYLE)
def roof_acceleration(
    data: xr.Dataset,
    path: str | Path | None = None,
    *,
    frame: str,
    title: str = "",
    axes: Axes | None = None,
) -> Axes:
    """Plot the acceleration of a frame's roof in the room.

    Args:
        data: A run (`pounding.experiments.results.dataset.dataset`).
        path: File to write, its suffix says the format; none when None.
        frame: Label of the frame.
        title: Title.
        axes: Axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    floor, time = roof(data, frame), data.time.values
    (axes,) = panels(axes, 1, (WIDTH, 2.8))
    moved = data.absolute_acceleration.sel(frame=frame, floor=floor).values / STANDARD_GRAVITY
    axes.plot(time, moved, color=OURS, lw=0.8)
    axes.set(xlabel="time on the model's clock [s]", ylabel=f"floor {floor} [g]", xlim=(time[0], time[-1]))
    axes.set_title(title, loc="left")
    keep(axes, path)
    return axes


def roof(data: xr.Dataset, frame: str) -> int:
    """Return the top floor of a frame in a dataset."""
    return int(data.floor.values[np.isfinite(data.height.sel(frame=frame).values)][-1])


@matplotlib.rc_context(STYLE)
def overlay(
    data: xr.Dataset,
    measured: Sequence[Channel],
    path: str | Path | None = None,
    *,
    frame: str,
    title: str = "",
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Plot every measured channel that the run has a history for, one panel each.

    Args:
        data: The run's dataset.
        measured: Measured channels on the run's clock.
        path: File to write, its suffix says the format; none when None.
        frame: Name of the frame that was run.
        title: Words above the panels of a new figure.
        axes: Axes to draw into, one for each channel that the run has; a new figure when None.

    Returns:
        The axes, one for each channel that was laid over; with none no file is written.
    """
    found = [(channel, simulated(data, channel, frame)) for channel in measured]
    pairs = [(channel, values) for channel, values in found if values is not None]
    if not pairs:
        return []
    above = title if axes is None else ""
    axes = panels(axes, len(pairs), (WIDTH, 1.0 + 1.7 * len(pairs)), sharex=True, title=above)
    for axis, (channel, values) in zip(axes, pairs, strict=True):
        scale, unit = _shown_unit(channel.quantity)
        axis.plot(channel.time_s, scale * channel.values, color=THEIRS, lw=1.0, label="measured")
        axis.plot(data.time, scale * values, color=OURS, lw=0.8, label="computed")
        axis.set_ylabel(unit)
        axis.set_title(_described(channel), loc="left", fontsize=9)
    axes[0].legend(loc="upper right", ncols=2, fontsize=9)
    axes[-1].set_xlabel("time [s]")
    keep(axes[0], path)
    return axes


def simulated(data: xr.Dataset, channel: Channel, frame: str) -> Real | None:
    """Return the run's history (time,) of what a channel measured, or None where the run has none.

    Args:
        data: The run's dataset.
        channel: The measured channel.
        frame: Name of the frame that was run.
    """
    if channel.floor == 0 or channel.frame is None:
        name = f"table_{channel.quantity.rpartition('_')[2]}"
        # What is relative to the table does not move on the table, and a force has no place there.
        known = name in data and not channel.quantity.startswith(("relative", "contact"))
        return data[name].values if known else None
    if channel.frame != frame or channel.quantity not in data or channel.floor not in data.floor.values:
        return None
    return data[channel.quantity].sel(frame=frame, floor=channel.floor).values


LOWEST_HZ = 0.8
"""Where spectra begin, below the thesis' frames; further down for a building that sways slower [Hz]."""

TICKS_HZ = (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)


@matplotlib.rc_context(STYLE)
def spectra(
    record: Record,
    path: str | Path | None = None,
    *,
    damping_ratio: float,
    marks_hz: Mapping[str, float] | None = None,
    title: str = "",
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Plot displacement and acceleration response spectra and the Fourier spectrum of a motion.

    Args:
        record: The motion, at the scale of the frame.
        path: File to write, its suffix says the format; none when None.
        damping_ratio: Of the oscillators, a fraction.
        marks_hz: Frequencies to mark by name, such as a frame's modes [Hz].
        title: Title.
        axes: Three axes to draw into; a new figure when None.

    Returns:
        The axes: displacement, acceleration, Fourier spectrum.
    """
    lowest = min([LOWEST_HZ, *(0.5 * frequency for frequency in (marks_hz or {}).values())])
    frequencies = np.geomspace(lowest, 60.0, 400)
    response = response_spectrum(record, 1.0 / frequencies, damping_ratio)
    fourier = fourier_spectrum(record)
    axes = panels(axes, 3, (WIDTH, 6.4), sharex=True)
    axes[0].loglog(frequencies, 1e3 * response.displacement_m, color=OURS)
    axes[0].set_ylabel("displacement [mm]")
    axes[1].semilogx(frequencies, response.acceleration_m_s2 / STANDARD_GRAVITY, color=OURS)
    axes[1].set_ylabel("acceleration [g]")
    axes[2].semilogx(fourier.frequency_hz, fourier.amplitude_m_s, color=OURS, lw=0.6)
    axes[2].set_ylabel("Fourier amplitude [m/s]")
    axes[2].set_xlabel("frequency [Hz]")
    axes[2].set_xlim(frequencies[0], frequencies[-1])
    axes[2].xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axes[2].set_xticks([tick for tick in TICKS_HZ if tick >= lowest])
    for name, frequency in (marks_hz or {}).items():
        for axis in axes:
            axis.axvline(frequency, color=PUBLISHED, lw=0.8, ls="--")
        place: Any = {"xy": (frequency, 1.02), "xycoords": ("data", "axes fraction"), "ha": "center"}
        axes[0].annotate(name, **place, fontsize=8, color=PUBLISHED)
    axes[0].set_title(title, loc="left", pad=18)
    axes[1].annotate(f"damping ratio {damping_ratio:g}", (0.01, 0.9), xycoords="axes fraction", fontsize=9)
    keep(axes[0], path)
    return axes


def end_of_motion(times_s: Real, motions: Iterable[Real], *, rest: float = 0.05) -> float:
    """Return when all motions have fallen below a share of their peaks for good [s], so that rest is not drawn.

    Args:
        times_s: Instants (m,) [s].
        motions: Motions at these instants (m,).
        rest: The share.
    """
    last = max(int(np.flatnonzero(np.abs(m) >= rest * np.abs(m).max()).max(initial=1)) for m in motions)
    return float(times_s[min(int(1.05 * last) + 1, len(times_s) - 1)])


def _mark(axis: Axes, peaks_mm: tuple[float, float]) -> None:
    for sign, value in zip((1.0, -1.0), peaks_mm, strict=True):
        label = "published peaks" if sign > 0 else None
        axis.axhline(sign * value, color=PUBLISHED, lw=1.0, ls="--", label=label)


def _described(channel: Channel) -> str:
    on_table = channel.floor == 0 or channel.frame is None
    place = "table" if on_table else f"{channel.frame}, floor {channel.floor}"
    return f"{place}: {channel.quantity.replace('_', ' ')} ({channel.name})"


def _shown_unit(quantity: str) -> tuple[float, str]:
    if quantity.endswith("displacement"):
        return 1e3, "mm"
    if quantity.endswith("acceleration"):
        return 1.0 / STANDARD_GRAVITY, "g"
    return 1.0, "m/s" if quantity.endswith("velocity") else "N"
