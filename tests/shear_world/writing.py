"""A case as a stranger writes it: a frame file, `case.toml`, and a CSV of each run, by docs/diagnosis/case-format.md."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from tests.shear_world.building import Building, Real

FRAME = "shear"


def write_frame(file: Path, believed: Building) -> None:
    """Write a frame file of a stick: the baseline as masses and stiffnesses."""
    lines = [
        'kind = "stick"',
        f'name = "{FRAME}"',
        f"storeys = {believed.storeys}",
        f"storey_height_m = {believed.storey_height}",
        f"floor_mass_kg = {believed.masses.tolist()}",
        f"storey_stiffness_n_per_m = {believed.stiffnesses.tolist()}",
        f"damping_ratio = {believed.ratios.tolist()}",
        "plan_m = [0.4, 0.3]",
    ]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_case(
    folder: Path, believed: Building, floors: tuple[int, ...], runs: list[tuple[Real, Real]]
) -> None:
    """Write a case.

    Args:
        folder: An empty folder.
        believed: The frame as stated.
        floors: Floors with an accelerometer, the last of which also has its displacement measured.
        runs: Times [s] (times,) and readings (times, channels) of each: the table's acceleration [m/s^2], the floors'
            accelerations in the room [m/s^2], the last floor's displacement relative to the table [mm].
    """
    write_frame(folder / "frame.toml", believed)
    channels = [("table", "table_acceleration", "m/s^2", 0)]
    channels += [(f"a{floor}", "absolute_acceleration", "m/s^2", floor) for floor in floors]
    channels += [(f"d{floors[-1]}", "relative_displacement", "mm", floors[-1])]
    lines = ["[[frame]]", 'file = "frame.toml"', ""]
    for number, (times, readings) in enumerate(runs, 1):
        name = f"run{number}.csv"
        lines += ["[[run]]", f'file = "{name}"', ""]
        with (folder / name).open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow(["time_s", *(channel[0] for channel in channels)])
            for row in np.column_stack([times, readings]):
                rows.writerow([f"{value:.7g}" for value in row])
    for name, quantity, unit, floor in channels:
        lines += ["[[channel]]", f'name = "{name}"', f'quantity = "{quantity}"', f'unit = "{unit}"']
        lines += [f"floor = {floor}"] if floor else []
        lines += [""]
    (folder / "case.toml").write_text("\n".join(lines), encoding="utf-8")
