"""The laboratory's preliminary tests of the five frames, simulated, beside Table 3.1.

Roof push, free vibration and sine sweep run on the baseline model, and frequency and damping are read from
the simulated records alone by the half-power bandwidth. What is read must be what was put in; further tables
show how far a short record or a tapering window leads astray, and how far a fast sweep does when it is read
at its loudest instant. Run it with ``pounding study laboratory``.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter
from rich.progress import Progress

from pounding import frames
from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.pictures import laboratory_plots
from pounding.experiments.results.provenance import stamp
from pounding.frames.files import write_whole
from pounding.frames.response import laboratory

FRAMES = ("5A", "5B", "10", "15A", "15B")

RECORD_LENGTHS = (1.0, 2.0, 4.0, 7.0)
"""Record lengths of the free vibration, in time constants of the first mode."""

SWEEP_RATES = (0.5, 2.0, 8.0)
"""Rates of the sweep in octaves a minute; the thesis does not state the laboratory's."""


def tested(name: str) -> dict[str, Any]:
    """Return the three tests of a frame: what was put in, what was read, what the laboratory read."""
    reduced = frames.build(frames.load(name))
    known = reduced.definition.published
    push = laboratory.push_test(reduced)
    decay = laboratory.free_vibration_test(reduced)
    sweep = laboratory.sine_sweep_test(reduced)
    return {
        "frame": reduced.name,
        "model_hz": reduced.frequencies_hz[:3].tolist(),
        "model_damping_ratio": reduced.damping_ratio,
        "model_roof_stiffness_n_per_mm": reduced.roof_stiffness_n_per_m / 1e3,
        "push_n_per_mm": push.stiffness_n_per_m / 1e3,
        "free_vibration_hz": decay.reading.frequency_hz,
        "free_vibration_damping_ratio": decay.reading.damping_ratio,
        "free_vibration_record_s": float(decay.time_s[-1]),
        "sweep_hz": [reading.frequency_hz for reading in sweep.readings],
        "sweep_damping_ratio": [reading.damping_ratio for reading in sweep.readings],
        "sweep_roof_mm_per_g": 1e3
        * float(np.abs(sweep.roof_displacement_m).max())
        / (float(np.abs(sweep.table_m_s2).max()) / STANDARD_GRAVITY),
        "published": {
            "free_vibration_hz": known.free_vibration_hz,
            "free_vibration_damping_ratio": known.free_vibration_damping_ratio,
            "sweep_hz": list(known.sweep_hz),
            "roof_stiffness_n_per_mm": known.roof_stiffness_n_per_mm,
        },
    }


def record_lengths(name: str) -> list[dict[str, Any]]:
    """Return the error of the damping that short and tapered records give."""
    reduced = frames.build(frames.load(name))
    constant = 1.0 / (2.0 * np.pi * reduced.damping_ratio * reduced.frequencies_hz[0])
    rows = []
    for length in RECORD_LENGTHS:
        for window in ("boxcar", "hann"):
            reading = laboratory.free_vibration_test(
                reduced, record_s=length * constant, window=window
            ).reading
            error = reading.damping_ratio / reduced.damping_ratio - 1.0
            rows.append(
                {"frame": name, "time_constants": length, "record_s": length * constant, "window": window}
                | {"damping_error": error}
            )
    return rows


def sweep_rates(name: str) -> list[dict[str, Any]]:
    """Return the error of the first frequency at several rates, by spectra and by the loudest instant."""
    reduced = frames.build(frames.load(name))
    rows = []
    for rate in SWEEP_RATES:
        sweep = laboratory.sine_sweep_test(reduced, octaves_per_minute=rate, modes=1)
        first = reduced.frequencies_hz[0]
        rows.append(
            {
                "frame": name,
                "octaves_per_minute": rate,
                "ratio_of_spectra_error": sweep.readings[0].frequency_hz / first - 1.0,
                "loudest_instant_error": sweep.instant_hz[0] / first - 1.0,
            }
        )
    return rows


def main(
    *,
    names: Annotated[list[str] | None, Parameter(name="--frame", help="Frame, repeatable.")] = None,
    out: options.Out = None,
    json: options.Json = False,
) -> dict[str, Any]:
    """Simulate roof push, free vibration and sine sweep of the frames and read them as the laboratory did."""
    names = list(names or FRAMES)
    tests = []
    with Progress(console=progress_console(), transient=True) as progress:
        task = progress.add_task("testing", total=len(names) + 2)
        for name in names:
            tests.append(tested(name))
            progress.advance(task)
        lengths = record_lengths(names[-1])
        progress.advance(task)
        rates = sweep_rates(names[-1])
    result = stamp({"frames": names, "sample_hz": laboratory.SAMPLE_HZ}) | {
        "tests": tests,
        "record_lengths": lengths,
        "sweep_rates": rates,
    }
    if out is not None:
        write_whole(out / "laboratory.csv", pd.DataFrame(tests).to_csv(index=False).encode())
        picture(names[-1], out / "laboratory.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the tables of a result of `main` for a reader."""
    yield table(
        "Roof push and free vibration: put in, read, and (Table 3.1)",
        ["frame", "roof N/mm", "f1 Hz", "damping %"],
        [_first_row(test) for test in result["tests"]],
    )
    yield table(
        "Sine sweep: put in, read, and (Table 3.1)",
        ["frame", "f1 Hz", "f2 Hz", "f3 Hz", "damping % of modes 1, 2, 3 read"],
        [_sweep_row(test) for test in result["tests"]],
    )
    name = result["record_lengths"][0]["frame"]
    yield table(
        f"{name}: error of the damping from a record that is cut or tapered",
        ["time constants", "record s", "window", "error %"],
        [
            [
                f"{r['time_constants']:g}",
                f"{r['record_s']:.0f}",
                r["window"],
                f"{100 * r['damping_error']:+.1f}",
            ]
            for r in result["record_lengths"]
        ],
    )
    yield table(
        f"{name}: error of the first frequency from a sweep upwards [%]",
        ["octaves a minute", "ratio of spectra", "loudest instant"],
        [
            [
                f"{r['octaves_per_minute']:g}",
                f"{100 * r['ratio_of_spectra_error']:+.2f}",
                f"{100 * r['loudest_instant_error']:+.1f}",
            ]
            for r in result["sweep_rates"]
        ],
    )


def picture(name: str, path: Path) -> None:
    """Plot the decay, its spectrum with the half-power band, and the sweep's amplification of a frame."""
    reduced = frames.build(frames.load(name))
    decay, sweep = laboratory.free_vibration_test(reduced), laboratory.sine_sweep_test(reduced)
    laboratory_plots.free_vibration_and_sweep(reduced.name, decay, sweep, path)


def _first_row(test: dict[str, Any]) -> list[str]:
    known = test["published"]
    return [
        test["frame"],
        _three(
            test["model_roof_stiffness_n_per_mm"], test["push_n_per_mm"], known["roof_stiffness_n_per_mm"]
        ),
        _three(test["model_hz"][0], test["free_vibration_hz"], known["free_vibration_hz"], 3),
        _three(
            100 * test["model_damping_ratio"],
            100 * test["free_vibration_damping_ratio"],
            100 * known["free_vibration_damping_ratio"],
            3,
        ),
    ]


def _sweep_row(test: dict[str, Any]) -> list[str]:
    columns = zip(test["model_hz"], test["sweep_hz"], test["published"]["sweep_hz"], strict=True)
    damping = " ".join(f"{100 * ratio:.3f}" for ratio in test["sweep_damping_ratio"])
    return [test["frame"], *(_three(*column) for column in columns), damping]


def _three(model: float, read: float, known: float | None, digits: int = 2) -> str:
    printed = "" if known is None else f" ({known:g})"
    return f"{model:.{digits}f} {read:.{digits}f}{printed}"


if __name__ == "__main__":
    run_script(main)
