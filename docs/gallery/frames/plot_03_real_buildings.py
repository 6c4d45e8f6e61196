"""
Two real buildings
==================

An office of four storeys and flats of six, known by the masses of their floors and two frequencies. Their floors move
out of step under El Centro, at full scale: this is what brings neighbours together.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.experiments.records import find
from pounding.experiments.rig.required_gap import motions

office = {
    "kind": "stick",
    "name": "office",
    "storeys": 4,
    "storey_height_m": [4.0, 3.2, 3.2, 3.2],
    "floor_mass_kg": [310e3, 290e3, 290e3, 250e3],
    "frequency_hz": [1.1, 3.2],
    "damping_ratio": [0.03, 0.04],
}
flats = {
    "kind": "stick",
    "name": "flats",
    "storeys": 6,
    "storey_height_m": [4.0, 3.2, 3.2, 3.2, 3.2, 3.2],
    "floor_mass_kg": [340e3, 320e3, 320e3, 320e3, 320e3, 270e3],
    "frequency_hz": [0.7, 2.0],
    "damping_ratio": 0.05,
}
record = find("elcentro-chopra")
figure, axes = plt.subplots(figsize=(7.0, 3.4), layout="constrained")
for building, colour in ((flats, BLUE), (office, ORANGE)):
    moved = motions(frames.build(frames.from_mapping(building)), record, [4])[:, 0]
    time_s = np.linspace(0.0, record.duration_s, len(moved))
    axes.plot(time_s, 1e3 * moved, color=colour, lw=1, label=f"fourth floor of the {building['name']}")
axes.set(xlabel="time [s]", ylabel="displacement [mm]", xlim=(0.0, 15.0))
figure.legend(loc="outside upper center", ncols=2)
