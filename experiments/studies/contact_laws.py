"""Pictures of the laws by themselves: two free floors of 6.2 kg that collide at 0.3 m/s.

Run it with ``python -m pounding.experiments.studies.contact_laws --out DIR``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from pounding.contact.collision import collide
from pounding.contact.laws import DAMPED
from pounding.contact.parameters import FLOOR_MASS, RESTITUTION, thesis_law
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, table
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.experiments.pictures.plots import STYLE
from pounding.experiments.results.provenance import stamp
from pounding.frames.files import replacing

SPEED = 0.3


def main(*, out: options.Out = None, json: options.Json = False) -> None:
    """Tension off and on for each damped law with the thesis' printed parameters.

    Args:
        out: Folder for the picture; none is drawn without it.
    """
    rows = tension_rows()
    if out is not None:
        tension_picture(out / "contact-tension.png")
    result = stamp({"floor_mass_kg": FLOOR_MASS, "speed_m_s": SPEED}) | {"laws": rows}
    emit(result, as_json=json, show=lambda: [_table(rows)])


def tension_rows() -> list[dict[str, Any]]:
    """Return restitution, contact time, peak and pull of each damped law, tension off and on."""
    rows = []
    for name in DAMPED:
        for tension in (False, True):
            found = collide(thesis_law(name, tension=tension), FLOOR_MASS, FLOOR_MASS, SPEED)
            rows.append(
                {
                    "law": name,
                    "tension": tension,
                    "restitution": found.restitution,
                    "restitution_measured": RESTITUTION,
                    "duration_ms": 1e3 * found.duration_s,
                    "peak_force_n": float(found.force_n.max()),
                    "pull_n": max(0.0, -float(found.force_n.min())),
                }
            )
    return rows


@matplotlib.rc_context(STYLE)
def tension_picture(path: Path) -> None:
    """Draw the linear viscoelastic law's force over time and over deformation, tension off and on."""
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    over_time, over_depth = figure.subplots(1, 2)
    # The wide line stays seen on both sides of the thin one where the two coincide.
    for tension, colour, width in ((True, ORANGE, 6.0), (False, BLUE, 1.6)):
        law = thesis_law("linear_viscoelastic", tension=tension)
        found = collide(law, FLOOR_MASS, FLOOR_MASS, SPEED)
        name = "tension on" if tension else "tension off"
        over_time.plot(1e3 * found.time_s, found.force_n, color=colour, linewidth=width, label=name)
        over_depth.plot(1e3 * found.deformation_m, found.force_n, color=colour, linewidth=width)
    over_time.set(xlabel="time after contact begins [ms]", ylabel="contact force [N]")
    figure.legend(loc="outside upper center", ncols=2)
    over_depth.set(xlabel="deformation [mm]", ylabel="contact force [N]")
    for axes in (over_time, over_depth):
        axes.axhline(0.0, color="black", lw=0.8)
    with replacing(path) as whole:
        figure.savefig(whole, dpi=150)


def _table(rows: list[dict[str, Any]]) -> Any:
    columns = ["law", "tension", "restitution", "lasts ms", "peak N", "pull N"]
    shown = [
        [
            row["law"],
            "on" if row["tension"] else "off",
            f"{row['restitution']:.4f}",
            f"{row['duration_ms']:.3f}",
            f"{row['peak_force_n']:.0f}",
            f"{row['pull_n']:.0f}",
        ]
        for row in rows
    ]
    return table(f"Two floors of {FLOOR_MASS} kg at {SPEED} m/s, printed parameters", columns, shown)


if __name__ == "__main__":
    run_script(main)
