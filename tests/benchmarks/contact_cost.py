"""What a colliding run costs over storeys, contacts, frames in a row, modes kept and laws.

CPU s per simulated s and microseconds per step, so that what else runs on the machine does not count;
the best of three runs. One thing varies at a time, the rest stays as it is in the base case: 15B beside 5B
under El Centro, one contact, the linear viscoelastic law, the default accuracy.

    python tests/benchmarks/contact_cost.py --out docs/validation/contact-cost.json --picture cost.png
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from rich.console import Console
from rich.table import Table

from pounding import frames
from pounding.contact import thesis_law
from pounding.contact.parameters import PRINTED
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.rig.rig import Rig

mpl.use("Agg")
from matplotlib import pyplot as plt

RECORD = "elcentro"
DURATION_S = 2.0
GAP_M = 6e-3
REPEATS = 3
LAW = "linear_viscoelastic"


class Row(NamedTuple):
    """One case: what varies, its value, size of the system and cost."""

    axis: str
    value: str
    coordinates: int
    highest_hz: float
    steps: int
    contact_events: int
    cost_s_per_model_s: float
    us_per_step: float


def built(name: str, keep_hz: float | None = None) -> frames.ReducedFrame:
    """Return a frame of the thesis."""
    return frames.build(frames.load(name), keep_hz=keep_hz)


def stick(storeys: int) -> frames.ReducedFrame:
    """Return a shear building of 6.5 kg floors whose first frequency falls with its height, as the frames' do."""
    unit = 2.0 * np.sin(np.pi / (2.0 * (2 * storeys + 1)))
    return frames.build(
        frames.StickFrame(
            name=f"{storeys} storeys",
            storeys=storeys,
            storey_height_m=0.1,
            floor_mass_kg=[6.5] * storeys,
            storey_stiffness_n_per_m=[6.5 * (2.0 * np.pi * 34.0 / storeys / unit) ** 2] * storeys,
            damping_ratio=0.005,
        )
    )


def measured(axis: str, value: str, row: list[frames.ReducedFrame], contacts: list[Contact]) -> Row:
    """Run a case and return its cost."""
    record, rig = shaking(RECORD), Rig(row, contacts)
    runs = [rig.run(record, duration_s=DURATION_S) for _ in range(REPEATS)]
    best = min(runs, key=lambda run: run.processor_s)
    return Row(
        axis,
        value,
        sum(frame.size for frame in row),
        max(float(frame.frequencies_hz.max()) for frame in row),
        best.steps,
        sum(len(contact.pulses) for contact in best.contacts),
        best.processor_s / best.model_s,
        1e6 * best.processor_s / best.steps,
    )


def storeys() -> Iterator[Row]:
    """Sticks, which have a coordinate a storey, beside one of half the storeys."""
    for count in (4, 8, 16, 32, 64):
        pair = [stick(count), stick(count // 2)]
        yield measured("storeys", f"{count}", pair, [Contact(thesis_law(LAW), GAP_M, count // 2)])


def contacts() -> Iterator[Row]:
    """15B beside 10, contacts from the lower roof downwards."""
    for count in (1, 2, 5, 10):
        floors = [Contact(thesis_law(LAW), GAP_M, 10 - down) for down in range(count)]
        yield measured("contacts", f"{count}", [built("15B"), built("10")], floors)


def row_of_frames() -> Iterator[Row]:
    """5B beside 5A beside 5B and so on, each pair with a contact at the roof."""
    for count in (2, 3, 4, 6):
        row = [built("5A" if place % 2 else "5B") for place in range(count)]
        pairs = [Contact(thesis_law(LAW), 1e-3, 5, pair=pair) for pair in range(count - 1)]
        yield measured("frames", f"{count}", row, pairs)


def modes() -> Iterator[Row]:
    """The base case with modes kept up to higher frequencies."""
    for keep_hz in (100.0, 300.0, 600.0, 1200.0):
        pair = [built("15B", keep_hz), built("5B", keep_hz)]
        yield measured("modes to Hz", f"{keep_hz:g}", pair, [Contact(thesis_law(LAW), GAP_M, 5)])


def laws() -> Iterator[Row]:
    """The base case with each law."""
    for name in PRINTED:
        yield measured("law", name, [built("15B"), built("5B")], [Contact(thesis_law(name), GAP_M, 5)])


AXES: tuple[Callable[[], Iterator[Row]], ...] = (storeys, contacts, row_of_frames, modes, laws)


def show(rows: list[Row], console: Console) -> None:
    """Print the rows."""
    table = Table(
        "varies", "value", "coordinates", "highest Hz", "steps", "touches", "s / model s", "us / step"
    )
    for row in rows:
        table.add_row(
            row.axis, row.value, f"{row.coordinates}", f"{row.highest_hz:.0f}", f"{row.steps}",
            f"{row.touches}", f"{row.cost_s_per_model_s:.3f}", f"{row.us_per_step:.1f}",
        )  # fmt: skip
    console.print(table)


def picture(rows: list[Row], path: Path) -> None:
    """Draw cost over each number that varies."""
    axes_names = [name for name in dict.fromkeys(row.axis for row in rows) if name != "law"]
    figure, axes = plt.subplots(1, len(axes_names), figsize=(9.0, 2.6), sharey=True, layout="constrained")
    for name, place in zip(axes_names, axes, strict=True):
        chosen = [row for row in rows if row.axis == name]
        place.loglog([float(row.value) for row in chosen], [row.cost_s_per_model_s for row in chosen], "o-")
        place.set_xticks([float(row.value) for row in chosen], [row.value for row in chosen])
        place.minorticks_off()
        place.set_xlabel(name)
        place.grid(alpha=0.3)
    axes[0].set_ylabel("CPU s per simulated s")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Measure all cases and print them; write table and picture where asked."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, help="JSON file")
    parser.add_argument("--picture", type=Path, help="PNG file")
    chosen = parser.parse_args()
    rows = [row for axis in AXES for row in axis()]
    show(rows, Console(width=110))
    if chosen.out:
        chosen.out.write_text(json.dumps([row._asdict() for row in rows], indent=1) + "\n")
    if chosen.picture:
        picture(rows, chosen.picture)


if __name__ == "__main__":
    main()
