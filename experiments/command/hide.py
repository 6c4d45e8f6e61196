"""`pounding hide`: a case with effects hidden in it, made by a simulator that is not that of the diagnosis."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from pounding.diagnosis.hidden.hide import LONGEST_S
from pounding.diagnosis.hidden.hide import hide as hide_effects
from pounding.diagnosis.hidden.writing import check_free, write_hidden
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp

USUAL_S = 8.0
"""Longest run that is drawn where no length is asked for [s]."""


def hide(
    *effects: str,
    out: Annotated[
        Path, Parameter(help="Folder of the case; created if missing.", validator=options.writable_folder)
    ],
    frame: Annotated[
        list[str] | None,
        Parameter(negative=(), help="Frame of the thesis on the table, repeatable for a pair; default: 5A."),
    ] = None,
    visibility: Annotated[
        float | None,
        Parameter(help="Signal-to-noise ratio of each effect after calibration; default: drawn, 0.1 to 10."),
    ] = None,
    motions: Annotated[
        Literal["records", "artificial", "mixed"],
        Parameter(
            help="Shake with the four records if they can be found, with artificial motions, or with both."
        ),
    ] = "mixed",
    engine: Annotated[
        Literal["own", "opensees"],
        Parameter(
            help="Simulator: our own, or OpenSees with other frames and laws, which is for development and has to be "
            "installed apart (docs/diagnosis/hidden-cases.md)."
        ),
    ] = "own",
    noise: Annotated[
        float | None,
        Parameter(help="Noise of every response channel [% of its rms]; default: drawn, 0.7 to 5.6."),
    ] = None,
    model_error: Annotated[
        float | None,
        Parameter(
            help="With --engine opensees: what the model error leaves after calibration [% of the motion]; "
            "default: drawn, 0.5 to 5."
        ),
    ] = None,
    duration: Annotated[
        float | None, Parameter(help="Length of each run [s]; default: drawn, 6 to 8, 4 to 5.5 for pairs.")
    ] = None,
    reference: Annotated[
        int, Parameter(help="How many runs there are of the frame before an effect was put in, 0 to 3.")
    ] = 0,
    seed: options.Seed = 0,
    truth: Annotated[
        Path | None,
        Parameter(
            help="File for the truth; default: the truth is not written.", validator=options.writable_file
        ),
    ] = None,
    json: options.Json = False,
) -> None:
    """Write a case in which effects are hidden, to try the diagnosis on.

    Args:
        effects: Names of effects in or outside the catalogue, each optionally with its place, such as
            coulomb_friction:3 (storey or floor) or sensor_gain:5A_a5 (channel); the word nothing for a case without
            an effect. All names: docs/diagnosis/catalogue.md and docs/diagnosis/hidden-cases.md.
    """
    check_free(out)
    if duration is None or duration <= LONGEST_S:
        frames = min(len(frame or ["5A"]), 2)
        estimates.announce(estimates.of_hiding(frames, len(effects), duration or USUAL_S))
    hidden = hide_effects(
        effects,
        tuple(frame or ["5A"]),
        seed=seed,
        visibility=visibility,
        source=motions,
        duration_s=duration,
        engine=engine,
        noise=None if noise is None else noise / 100,
        model_error=None if model_error is None else model_error / 100,
        reference=reference,
    )
    written = write_hidden(hidden, out, truth)
    asked = {
        "effects": list(effects),
        "frames": list(frame or ["5A"]),
        "visibility": visibility,
        "seed": seed,
        "engine": engine,
        "noise_percent": noise,
        "model_error_percent": model_error,
        "reference": reference,
    }
    result: dict[str, Any] = {
        **stamp({**asked, "motions": motions, "duration_s": duration}),
        "case": str(written),
        "truth": None if truth is None else str(truth),
        "runs": len(hidden.case.runs),
        "channels": len(hidden.case.channels),
        "motions": hidden.truth["motions"],
    }
    emit(result, as_json=json, show=lambda: [_shakings(result), f"{written} is ready for pounding diagnose"])


def _shakings(result: dict[str, Any]) -> Any:
    rows = [
        (f"run{number}.csv", motion["source"], f"{motion['peak_m_s2']:.2f}")
        for number, motion in enumerate(result["motions"], 1)
    ]
    return table("Runs", ["file", "motion", "peak [m/s^2]"], rows)
