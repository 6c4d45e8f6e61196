"""Figure 4.11 and Table 7.1 of the thesis: the four scaled motions beside the frames' fundamental periods.

Dominant periods by four definitions beside the printed ones, and a picture of the Fourier and the response
spectra. Run it with ``pounding study figure-4-11``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pounding.experiments import published
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.pictures.plots import OURS, PUBLISHED, STYLE, THEIRS
from pounding.experiments.records import RECORDS, Record, find
from pounding.experiments.records.spectra import (
    dominant_period,
    fourier_spectrum,
    mean_period,
    response_spectrum,
)
from pounding.experiments.results.provenance import stamp
from pounding.experiments.studies.table_4_1 import FRAMES
from pounding.frames.files import replacing
from pounding.scale import THESIS

SMOOTHING_HZ = 1.0
"""Standard deviation of the Gaussian over the squared Fourier amplitude [Hz]."""
RATHJE_BAND_HZ = (0.25 / THESIS.time_factor, 20.0 / THESIS.time_factor)
"""Band of the mean period, 0.25 to 20 Hz at full scale."""
SHOWN_S = (0.03, 1.0)
"""Periods shown, model time [s]."""
DAMPING = {0.005: OURS, 0.05: THEIRS}
"""Damping ratios of the response spectra with their colours: the frames' own, and the usual one."""


def periods(record: Record) -> dict[str, float]:
    """Return the dominant period of a scaled motion by each definition [s], the printed one first."""
    return {
        "table_7_1_s": float(published.table("7.1")["tg_s"][record.name]),
        "fourier_s": dominant_period(record),
        "fourier_smoothed_s": dominant_period(record, smoothing_hz=SMOOTHING_HZ),
        "response_s": dominant_period(record, "response"),
        "mean_s": mean_period(record, RATHJE_BAND_HZ),
    }


def fundamental_periods() -> dict[str, float]:
    """Return the frames' fundamental periods [s] by the free-vibration tests of Table 3.1."""
    measured = published.table("3.1")["experiment"]["free_vibration_hz"]
    return {name: float(1.0 / measured[name]) for name in FRAMES}


@matplotlib.rc_context(STYLE | {"font.size": 9})
def picture(records: list[Record], path: Path) -> None:
    """Draw a row for each motion: Fourier amplitude to the left, response spectra to the right.

    Raises:
        FrameError: The file cannot be written.
    """
    figure = Figure(figsize=(9.6, 1.0 + 2.0 * len(records)), layout="constrained")
    rows = figure.subplots(len(records), 2, sharex=True, squeeze=False)
    for record, (left, right) in zip(records, rows, strict=True):
        _fourier(left, record)
        _response(right, record)
        for axis in (left, right):
            for period in fundamental_periods().values():
                axis.axvline(period, color="#555555", lw=0.9, ls=":")
        left.set_title(f"{record.name}, {record.pga_g:.3f} g", loc="left")
    for axis in rows[0]:
        _name_frames(axis)
    for axis in rows[-1]:
        axis.set_xlabel("period on the model's clock [s]")
        axis.set_xticks([0.03, 0.05, 0.1, 0.2, 0.5, 1.0], labels=["0.03", "0.05", "0.1", "0.2", "0.5", "1"])
        axis.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    for axis in rows[-1]:
        axis.legend(loc="upper right" if axis is rows[-1, 0] else "lower right", fontsize=8)
    with replacing(path) as part:
        figure.savefig(part, dpi=75)


def _fourier(axis: Axes, record: Record) -> None:
    for smoothing, colour, width in ((0.0, "#9db3cc", 0.6), (SMOOTHING_HZ, OURS, 1.3)):
        spectrum = fourier_spectrum(record, smoothing)
        period = 1.0 / spectrum.frequency_hz
        shown = (period >= SHOWN_S[0]) & (period <= SHOWN_S[1])
        label = f"smoothed over {smoothing:g} Hz" if smoothing else "Fourier amplitude"
        axis.semilogx(period[shown], spectrum.amplitude_m_s[shown], color=colour, lw=width, label=label)
    known = periods(record)
    axis.axvline(known["table_7_1_s"], color=PUBLISHED, lw=1.2, ls="--", label="dominant, Table 7.1")
    axis.axvline(known["fourier_s"], color=THEIRS, lw=1.2, label="largest amplitude")
    axis.set_ylabel("amplitude [m/s]")
    axis.set_ylim(bottom=0.0)
    axis.set_xlim(*SHOWN_S)


def _response(axis: Axes, record: Record) -> None:
    period = np.geomspace(*SHOWN_S, 240)
    for ratio, colour in DAMPING.items():
        spectrum = response_spectrum(record, period, ratio)
        axis.loglog(period, 1e3 * spectrum.displacement_m, color=colour, label=f"damping {100 * ratio:g} %")
    axis.set_ylabel("displacement [mm]")


def _name_frames(axis: Axes) -> None:
    """Write the frames' names above the panel, those of one height together."""
    heights: dict[str, list[str]] = {}
    for name in FRAMES:
        heights.setdefault(name.rstrip("AB"), []).append(name)
    known = fundamental_periods()
    for names in heights.values():
        place = (float(np.mean([known[name] for name in names])), 1.0)
        axis.annotate(
            ", ".join(names), place, (0, 2), xycoords=("data", "axes fraction"), textcoords="offset points",
            ha="center", fontsize=8, color="#555555",
        )  # fmt: skip


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the table of dominant periods and a sentence on the frames for a reader."""
    heads = ["record", "Table 7.1", "largest Fourier", "smoothed 1 Hz", "largest response", "mean period"]
    rows = [[row["record"], *(f"{row[key]:.3f}" for key in list(row)[1:])] for row in result["periods"]]
    yield table("Dominant periods at model time [s]", heads, rows)
    frames = ", ".join(f"{name} {value:.3f} s" for name, value in result["fundamental_periods_s"].items())
    yield f"fundamental periods (free vibration, Table 3.1): {frames}"


def main(
    *, records: options.Records = None, json: options.Json = False, out: options.Out = None
) -> dict[str, Any]:
    """Show spectra and dominant periods of the four scaled motions beside the frames' periods."""
    motions = [find(name, records).scaled(THESIS.time_factor) for name in RECORDS]
    result = stamp({"smoothing_hz": SMOOTHING_HZ, "mean_period_band_hz": RATHJE_BAND_HZ}, motions)
    result["periods"] = [{"record": motion.name, **periods(motion)} for motion in motions]
    result["fundamental_periods_s"] = fundamental_periods()
    if out is not None:
        with progress_console().status("drawing spectra"):
            picture(motions, out / "figure-4-11.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


if __name__ == "__main__":
    run_script(main)
