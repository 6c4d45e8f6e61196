"""Plots of the laboratory's preliminary tests: load and deflection, decay with its spectrum, amplification of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import matplotlib.ticker

from pounding.experiments.pictures.panels import keep, panels
from pounding.experiments.pictures.plots import OURS, PUBLISHED, STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from pounding.frames.response.laboratory import FreeVibration, PushTest, SineSweep

DECAY_S = 40.0
"""So much of a decay is shown [s]."""


@matplotlib.rc_context(STYLE)
def free_vibration_and_sweep(
    name: str,
    decay: FreeVibration,
    sweep: SineSweep,
    path: str | Path | None = None,
    *,
    axes: Sequence[Axes] | None = None,
) -> list[Axes]:
    """Plot the decay, its spectrum with the half-power band, and the sweep's amplification of a frame.

    Args:
        name: Name of the frame.
        decay: Its free vibration.
        sweep: Its sweep.
        path: File to write, its suffix says the format; none when None.
        axes: Three axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    axes = panels(axes, 3, (9.0, 6.6))
    _decay(axes[0], name, decay)
    _spectrum(axes[1], decay)
    _amplification(axes[2], sweep)
    keep(axes[0], path)
    return axes


@matplotlib.rc_context(STYLE)
def free_vibration(
    name: str, decay: FreeVibration, path: str | Path | None = None, *, axes: Sequence[Axes] | None = None
) -> list[Axes]:
    """Plot a decay and its spectrum with the half-power band.

    Args:
        name: Name of the frame.
        decay: Its free vibration.
        path: File to write, its suffix says the format; none when None.
        axes: Two axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    axes = panels(axes, 2, (9.0, 4.6))
    _decay(axes[0], name, decay)
    _spectrum(axes[1], decay)
    keep(axes[0], path)
    return axes


@matplotlib.rc_context(STYLE)
def sine_sweep(
    name: str, sweep: SineSweep, path: str | Path | None = None, *, axes: Sequence[Axes] | None = None
) -> list[Axes]:
    """Plot the roof's acceleration in a sweep and its amplification over frequency.

    Args:
        name: Name of the frame.
        sweep: Its sweep.
        path: File to write, its suffix says the format; none when None.
        axes: Two axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    axes = panels(axes, 2, (9.0, 4.6))
    axes[0].plot(sweep.time_s, sweep.roof_m_s2, color=OURS, lw=0.6)
    axes[0].set(xlabel="time [s]", ylabel="roof [m/s²]", xlim=(0.0, sweep.time_s[-1]))
    axes[0].set_title(f"Frame {name}: sweep of the table", loc="left")
    _amplification(axes[1], sweep)
    keep(axes[0], path)
    return axes


@matplotlib.rc_context(STYLE)
def push(name: str, test: PushTest, path: str | Path | None = None, *, axes: Axes | None = None) -> Axes:
    """Plot load over deflection of the roof.

    Args:
        name: Name of the frame.
        test: Its push test.
        path: File to write, its suffix says the format; none when None.
        axes: Axes to draw into; a new figure when None.

    Returns:
        The axes.
    """
    (axes,) = panels(axes, 1, (5.4, 3.8))
    axes.plot(1e3 * test.deflection_m, test.force_n, "o-", color=OURS)
    axes.set(xlabel="deflection of the roof [mm]", ylabel="load at the roof [N]")
    axes.set_title(f"Frame {name}: {test.stiffness_n_per_m / 1e3:.2f} N/mm", loc="left")
    keep(axes, path)
    return axes


def _decay(axes: Axes, name: str, decay: FreeVibration) -> None:
    shown = decay.time_s < DECAY_S
    axes.plot(decay.time_s[shown], decay.acceleration_m_s2[shown], color=OURS, lw=0.6)
    axes.set(xlabel="time [s]", ylabel="roof [m/s²]", xlim=(0.0, DECAY_S))
    axes.set_title(f"Frame {name}: roof displaced by 5 mm and released", loc="left")


def _spectrum(axes: Axes, decay: FreeVibration) -> None:
    height = decay.amplitude_m_s / decay.amplitude_m_s.max()
    frequency, ratio = decay.reading
    axes.plot(decay.frequency_hz, height, color=OURS)
    axes.hlines(0.5**0.5, frequency * (1 - ratio), frequency * (1 + ratio), color=PUBLISHED, lw=2.0)
    words = f"half-power bandwidth:\n{frequency:.3f} Hz, damping ratio {ratio:.5f}"
    axes.annotate(words, (frequency * (1 + 1.5 * ratio), 0.5**0.5), va="center", color=PUBLISHED)
    axes.set(xlabel="frequency [Hz]", ylabel="amplitude / peak", ylim=(0.0, 1.05))
    axes.set_xlim(decay.frequency_hz[0], decay.frequency_hz[-1])


def _amplification(axes: Axes, sweep: SineSweep) -> None:
    axes.loglog(sweep.frequency_hz, sweep.ratio, color=OURS)
    for reading in sweep.readings:
        axes.axvline(reading.frequency_hz, color=PUBLISHED, lw=0.8, ls="--")
        place = (reading.frequency_hz * 1.03, 0.02)
        axes.annotate(f"{reading.frequency_hz:.2f} Hz", place, color=PUBLISHED, fontsize=9)
    axes.set(xlabel="frequency [Hz]", ylabel="roof / table", xlim=(0.2, 50.0), ylim=(1e-2, 3e2))
    axes.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
