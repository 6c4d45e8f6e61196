"""The engine's own flexible body beside ours: the same finite elements on two kinds of coordinates.

Ours is a body on Craig-Bampton coordinates that scipy reduced (`frames.response.body`); the engine's is
``ObjectFFRFreducedOrder``, whose modes and coupling terms exudyn computes from the same mesh with its rotations
condensed (`frames.response.floating_body`). Both are shaken alone. Run it with ``pounding study engine-body``.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter

from pounding import frames
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.records import Record, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.table_scale import table_scale
from pounding.frames.definition import PlateFrame
from pounding.frames.fe.assembly import Options, assemble
from pounding.frames.fe.mesh import DEFAULT, Density
from pounding.frames.files import write_whole
from pounding.frames.reduction.translations import without_rotations
from pounding.frames.response.body import longest_step, run_alone
from pounding.frames.response.floating_body import run_floating

WANTED = 0.005
"""Largest relative difference of a frequency or peak that was asked for."""

MODES = 14
"""Modes of the engine's body; the five sways of a five-storey frame are among its lowest nine."""


def compare(frame: PlateFrame, record: Record, density: Density) -> dict[str, Any]:
    """Return frequencies, peaks and cost of both bodies of a frame.

    Args:
        frame: The frame, with at most five storeys, so that `MODES` hold its sways.
        record: Table motion at the frame's scale.
        density: The mesh of both.

    Raises:
        FrameError: The mesh is too fine to be condensed, or the frame too tall or its base not fixed.
    """
    if frame.storeys > 5:
        raise frames.FrameError(f"frame {frame.name}: {frame.storeys} storeys; this study takes up to five")
    # First, for it refuses a mesh that is too fine.
    condensed = without_rotations(assemble(frame, Options(rigid_floors=False, density=density)))
    ours = frames.build(frame, density=density)
    longest_s = longest_step([ours])
    alone = run_alone(ours, record.acceleration_m_s2, record.step_s, longest_step_s=longest_s)
    theirs = run_floating(
        condensed,
        record.acceleration_m_s2,
        record.step_s,
        damping_ratio=ours.damping_ratio,
        modes=MODES,
        longest_step_s=longest_s,
    )
    sways = ours.frequencies_hz[: frame.storeys]
    # The engine's body has also the modes that a shaking along x cannot excite.
    nearest = np.abs(theirs.frequencies_hz[:, None] - sways).argmin(axis=0)
    moved = alone.history.displacement[:, ours.floor_x]
    return {
        "displacements": len(condensed.nodes) * 3,
        "frequencies": _rows("mode", sways, theirs.frequencies_hz[nearest]),
        "peaks_mm": _rows(
            "floor", 1e3 * np.abs(moved).max(axis=0), 1e3 * np.abs(theirs.displacement).max(axis=0)
        ),
        "history_difference": float(
            (np.abs(theirs.displacement - moved).max(axis=0) / np.abs(moved).max(axis=0)).max()
        ),
        "steps": theirs.steps,
        "ours_us_a_step": 1e6 * alone.wall_s / alone.steps,
        "engine_us_a_step": 1e6 * theirs.wall_s / theirs.steps,
        "engine_modes_s": theirs.modes_s,
    }


def main(
    *,
    name: Annotated[str, Parameter(name="--frame", help="Frame of up to five storeys.")] = "5B",
    record: Annotated[str, Parameter(help="Ground motion by name or file.")] = "elcentro-peer180",
    floor_mm: Annotated[
        float, Parameter(help="Longest side of a floor's elements [mm]; the default mesh has 20.")
    ] = 1e3 * DEFAULT.floor_m,
    records: options.Records = None,
    out: options.Out = None,
    json: options.Json = False,
) -> dict[str, Any]:
    """Compare exudyn's own flexible body of a frame with ours: frequencies, peaks, cost of a step."""
    frame = frames.load(name)
    if not isinstance(frame, PlateFrame):
        raise frames.FrameError(f"frame {name}: a stick has no finite elements to compare")
    shaking = find(record, records).scaled(table_scale([frame]).time_factor)
    result = stamp({"frame": name, "record": record, "floor_mm": floor_mm, "wanted": WANTED}, [shaking])
    result |= compare(frame, shaking, Density(floor_m=1e-3 * floor_mm))
    if out is not None:
        rows = pd.DataFrame(result["frequencies"] + result["peaks_mm"])
        write_whole(out / "engine_body.csv", rows.to_csv(index=False).encode())
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the tables of a result of `main` for a reader."""
    heads = ["", "ours", "engine's own", "difference"]
    for key, title in (("frequencies", "frequency [Hz]"), ("peaks_mm", "peak displacement [mm]")):
        rows = [
            [row["what"], f"{row['ours']:.4f}", f"{row['engine']:.4f}", f"{100 * row['difference']:+.3f} %"]
            for row in result[key]
        ]
        yield table(f"{result['parameters']['frame']}: {title}", heads, rows)
    yield (
        f"largest difference at any sample: {100 * result['history_difference']:.2f} % of the floor's peak; "
        f"asked for: {100 * WANTED:g} % of each frequency and peak"
    )
    yield (
        f"a step costs {result['ours_us_a_step']:.1f} us on our coordinates and {result['engine_us_a_step']:.1f} "
        f"us on the engine's; its modes took {result['engine_modes_s']:.1f} s on {result['displacements']} "
        "displacements"
    )


def _rows(what: str, ours: Any, engine: Any) -> list[dict[str, Any]]:
    return [
        {
            "what": f"{what} {number}",
            "ours": float(one),
            "engine": float(other),
            "difference": float(other / one - 1),
        }
        for number, (one, other) in enumerate(zip(ours, engine, strict=True), start=1)
    ]


if __name__ == "__main__":
    run_script(main)
