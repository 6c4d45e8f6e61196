"""What the mesh, rigid floors and the reduction cost: bare plates on rigid joints, and the baseline model.

The OpenSees figures are an independent shell code's (ShellDKGQ, mesh-converged) for the same bare plates. Run
it with ``python -m pounding.experiments.studies.frame_mesh``.
"""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
from rich.progress import track
from scipy.sparse.linalg import spsolve

from pounding import frames
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import printer, progress_console, table
from pounding.experiments.studies.table_3_1 import thesis_frame
from pounding.frames.definition import PlateFrame
from pounding.frames.fe.assembly import Options, assemble
from pounding.frames.fe.mesh import DEFAULT, Density
from pounding.frames.response.modal import analyse, rigid_motions

OPENSEES = {"5A": (8.44, 44.5), "10": (4.37, 21.9), "15A": (2.95, 14.4)}
"""First frequency [Hz] and roof stiffness [N/mm] of bare plates on rigid joints, without P-Delta."""

DENSITIES = (Density(0.02, 2, 5), DEFAULT, Density(0.02, 2, 10), Density(0.01, 4, 12), Density(0.005, 8, 24))


def bare(frame: PlateFrame, density: Density = DEFAULT) -> dict[str, float]:
    """Return frequencies and roof stiffness of a frame on rigid joints without P-Delta."""
    reduced = frames.build(frame, joints="rigid", p_delta=False, density=density)
    names = ("f1_hz", "f2_hz", "f3_hz")
    found = dict(zip(names, reduced.frequencies_hz[:3].tolist(), strict=True))
    return found | {"roof_stiffness_n_per_mm": reduced.roof_stiffness_n_per_m / 1e3}


def meshes() -> list[dict[str, Any]]:
    """Return the bare frames on coarser and finer meshes; the finest for five storeys alone."""
    rows: list[dict[str, Any]] = []
    cases = [
        (name, density) for name in OPENSEES for density in (DENSITIES if name == "5A" else DENSITIES[:-1])
    ]
    for name, density in track(cases, "meshes", console=progress_console(), transient=True):
        first, roof = OPENSEES[name]
        found = bare(thesis_frame(name), density)
        label = f"{1e3 * density.floor_m:g} mm, {density.across} x {density.along}"
        against = {
            "f1_against_opensees": found["f1_hz"] / first - 1.0,
            "roof_against_opensees": found["roof_stiffness_n_per_mm"] / roof - 1.0,
        }
        rows.append({"frame": name, "mesh": label, **found, **against})
    return rows


def insets() -> list[dict[str, Any]]:
    """Return the bare five-storey frame with its columns moved inwards, along y or along x."""
    frame, rows = thesis_frame("5A"), []
    for along, inset in (("y", 0.0), ("y", 0.04), ("y", 0.08), ("x", 0.04), ("x", 0.08)):
        columns = msgspec.structs.replace(frame.columns, **{f"inset_{along}_m": inset})
        found = bare(frames.changed(frame, columns=columns))
        rows.append({"along": along, "inset_mm": 1e3 * inset, **found})
    return rows


def floors(name: str = "5A") -> dict[str, float]:
    """Return what floors that are rigid in their plane change below 60 Hz and under a push on the roof."""
    models = [assemble(thesis_frame(name), Options(rigid_floors=rigid)) for rigid in (True, False)]
    rigid, flexible = (
        analyse(thesis_frame(name), Options(rigid_floors=rigid)).frequencies_hz for rigid in (True, False)
    )
    push = [_push(model) for model in models]
    return {
        "modes": len(rigid),
        "largest_change_of_frequency": float(np.abs(rigid / flexible - 1.0).max()),
        "change_of_roof_stiffness": push[0] / push[1] - 1.0,
    }


def reductions(name: str = "15B") -> list[dict[str, Any]]:
    """Return how well reduced frames of several sizes keep the motions along x below 60 Hz."""
    frame = thesis_frame(name)
    modes = analyse(frame)
    along = modes.effective_mass_ratio[:, 0] > 1e-4
    full, gamma = modes.frequencies_hz[along], np.abs(modes.participation[along, 0])
    rows = []
    for keep_hz in (100.0, 300.0, 600.0):
        reduced = frames.build(frame, keep_hz=keep_hz)
        small = np.abs(reduced.shapes.T @ reduced.mass @ reduced.influence)[: len(full)]
        rows.append(
            {
                "keep_hz": keep_hz,
                "coordinates": reduced.size,
                "frequency": float(np.abs(reduced.frequencies_hz[: len(full)] / full - 1.0).max()),
                "participation": float(np.abs(small / gamma - 1.0).max()),
            }
        )
    return rows


def _push(model: Any) -> float:
    """Return the roof's stiffness [N/m] against a force spread over the roof."""
    on_roof = (model.mesh.node_part == model.frame.storeys).repeat(6)
    load = rigid_motions(model.mesh)[:, 0] * on_roof
    load /= load.sum()
    load = model.coordinates.to_nodes.T @ load
    return float(1.0 / (load @ spsolve(model.stiffness.tocsc(), load)))


def main() -> dict[str, Any]:
    """Compare meshes, insets, rigid floors and reductions with an independent shell code on bare plates."""
    result: dict[str, Any] = {
        "meshes": meshes(),
        "insets": insets(),
        "floors": floors(),
        "reductions": reductions(),
    }
    console = printer()
    heads = ["frame", "floor, column", "f1 Hz", "f2 Hz", "f3 Hz", "roof N/mm", "f1 %", "roof %"]
    rows = [
        [row["frame"], row["mesh"], *(f"{row[key]:.3f}" for key in list(row)[2:6]),
         *(f"{100.0 * row[key]:+.2f}" for key in list(row)[6:])]
        for row in result["meshes"]
    ]  # fmt: skip
    console.print(table("Bare plates on rigid joints; % against OpenSees", heads, rows))
    heads = ["along", "inset mm", "f1 Hz", "f2 Hz", "f3 Hz", "roof N/mm"]
    rows = [[along, *(f"{v:.2f}" for v in values)] for along, *values in map(dict.values, result["insets"])]
    console.print(table("5A, columns moved inwards", heads, rows))
    console.print("5A, floors rigid in their plane against flexible:", result["floors"])
    heads = ["keep Hz", "coordinates", "error of f", "error of participation"]
    rows = [[f"{value:.3g}" for value in row.values()] for row in result["reductions"]]
    console.print(table("15B, motions along x below 60 Hz, reduced against full", heads, rows))
    return result


if __name__ == "__main__":
    run_script(main)
