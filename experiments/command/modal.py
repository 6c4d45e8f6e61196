"""`pounding modal`: natural modes of a frame beside the measured values."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import msgspec
from cyclopts import Parameter

from pounding import bounds, frames
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, table
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.states import in_words, states_of
from pounding.frames.fe.assembly import Options
from pounding.frames.response import modal as modal_analysis
from pounding.frames.response.modal import DIRECTIONS
from pounding.frames.stick import notes

LARGE_KG = 1e4
"""Heavier frames are buildings, shown in tonnes and kN/mm."""


def modal(
    frame: options.FrameName,
    *,
    state: options.State = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    up_to_hz: Annotated[
        float,
        Parameter(
            help="Show the modes up to this frequency [Hz].", validator=options.bounded(bounds.FREQUENCY)
        ),
    ] = 60.0,
    json: options.Json = False,
) -> None:
    """Show the natural modes of a frame, its mass and its roof stiffness, beside the published ones.

    Args:
        frame: Name of a shipped frame (see `pounding list`) or path of a frame file.
    """
    result = modes(frame, state=state, joints=joints, p_delta=p_delta, damping=damping, up_to_hz=up_to_hz)
    emit(result, as_json=json, show=lambda: _show(result))


def modes(
    name: str,
    *,
    state: options.State = None,
    joints: options.Joints = "calibrated",
    p_delta: bool = True,
    damping: float | None = None,
    up_to_hz: float = modal_analysis.UP_TO_HZ,
) -> dict[str, Any]:
    """Return the modes of a frame as `pounding modal --json` prints them.

    Args:
        name: Name of a shipped frame, or path of a frame file.
        state: State of a frame of the laboratory, see `states_of`; in strong motion as it stands alone.
        joints: See `pounding modal`.
        p_delta: Geometric stiffness of gravity.
        damping: Damping ratio of every mode [-]; the frame's own when None.
        up_to_hz: Highest frequency that is shown [Hz].
    """
    definition = frames.load(name)
    (chosen,) = states_of([name], state, joints=joints, damping=damping)
    estimates.announce(estimates.of_frame(definition, up_to_hz))
    calibration, ratio = chosen.calibration, chosen.damping_ratio
    reduced = frames.build(definition, joints=joints, p_delta=p_delta, damping=ratio, calibration=calibration)
    found = modal_analysis.analyse(
        definition, Options(joints, p_delta, calibration), up_to_hz=up_to_hz, damping=ratio
    )
    ratios = found.effective_mass_ratio
    entries = [
        {
            "frequency_hz": frequency,
            **{f"effective_mass_ratio_{axis}": ratio for axis, ratio in zip(DIRECTIONS, row, strict=True)},
            "damping_ratio": zeta,
            "description": description,
        }
        for frequency, row, zeta, description in zip(
            found.frequencies_hz, ratios, found.damping_ratios, found.descriptions, strict=True
        )
    ]
    asked = {"frame": name, "up_to_hz": up_to_hz, "states": [chosen.as_dict()]}
    return stamp(asked | reduced.options) | {
        "frame": definition.name,
        "mass_kg": reduced.moving_mass_kg,
        "roof_stiffness_n_per_mm": reduced.roof_stiffness_n_per_m / 1e3,
        "modes": entries,
        "notes": notes(definition) if isinstance(definition, frames.StickFrame) else [],
        "published": msgspec.structs.asdict(definition.published),
    }


def _show(result: dict[str, Any]) -> Iterable[Any]:
    rows = [
        [
            number,
            f"{mode['frequency_hz']:.3f}",
            f"{mode['effective_mass_ratio_x']:.4f}",
            f"{mode['effective_mass_ratio_y']:.4f}",
            f"{mode['damping_ratio']:.5f}",
            mode["description"],
        ]
        for number, mode in enumerate(result["modes"], 1)
    ]
    heads = ["mode", "f [Hz]", "mass x", "mass y", "damping", "description"]
    if rows:
        yield table(f"Frame {result['frame']}", heads, rows)
        yield "mass x, mass y: effective modal mass along x and y as a fraction of the moving mass"
    else:
        yield f"Frame {result['frame']}: no mode up to {result['parameters']['up_to_hz']:g} Hz; --up-to-hz asks for more"
    yield from map(in_words, result["parameters"]["states"])
    yield from result["notes"]
    mass, stiffness = result["mass_kg"], result["roof_stiffness_n_per_mm"]
    large = mass > LARGE_KG
    yield f"moving mass {mass / 1e3:.1f} t" if large else f"moving mass {mass:.2f} kg"
    yield f"roof stiffness {stiffness / 1e3:.4g} kN/mm" if large else f"roof stiffness {stiffness:.2f} N/mm"
    known = result["published"]
    if known["source"]:
        yield table(f"Published ({known['source']})", ["quantity", "value"], list(_published(known)))


def _published(known: dict[str, Any]) -> Iterable[list[str]]:
    labels = {
        "mass_kg": "mass, base plate included [kg]",
        "free_vibration_hz": "free vibration f1 [Hz]",
        "free_vibration_damping_ratio": "free vibration damping ratio",
        "sweep_hz": "sine sweep f1, f2, f3 [Hz]",
        "roof_stiffness_n_per_mm": "roof stiffness [N/mm]",
        "numerical_hz": "SAP2000 f1, f2, f3 [Hz]",
        "numerical_roof_stiffness_n_per_mm": "SAP2000 roof stiffness [N/mm]",
    }
    for key, label in labels.items():
        value = known[key]
        if value:
            yield [label, ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else f"{value:g}"]
