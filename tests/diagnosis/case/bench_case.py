"""A small case as text, which tests change before they read it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

CASE = """title = "bench"

[[frame]]
name = "5B"

[[frame]]
name = "bench"
storeys = 2
storey_height_m = 0.1
floor_mass_kg = [6.5, 6.5]
frequency_hz = [2.1, 6.0]
damping_ratio = [0.005, 0.004]

[[run]]
file = "run1.csv"

[[run]]
file = "run2.csv"

[[channel]]
name = "table"
quantity = "table_acceleration"
unit = "g"

[[channel]]
name = "d2"
frame = "5B"
floor = 2
quantity = "relative_displacement"
unit = "mm"

[[channel]]
name = "force"
contact = 1
quantity = "contact_force"
unit = "kN"

[[contact]]
left = "5B"
right = "bench"
floor = 2
gap_mm = 9.5
law = "linear_viscoelastic"
stiffness_n_per_m = 20.66e6
damping_n_s_per_m = 1255.0

[prior]
table_gain = 0.05
"""


def samples(step: float, count: int = 50, digits: int = 9) -> str:
    time = 3.0 + step * np.arange(count)
    rows = [f"{t:.{digits}f},{np.sin(t):.6g},{np.cos(t):.6g},{max(np.sin(3 * t), 0):.6g}" for t in time]
    return "\n".join(["time_s,table,d2,force", *rows]) + "\n"


def edit(path: Path, old: str, new: str, count: int = 1) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, count))
