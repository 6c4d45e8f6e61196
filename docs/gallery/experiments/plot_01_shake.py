"""
A frame on the shaking table
============================

Frame 5A under El Centro, whose time is shortened by the root of the scale 1:30. All floors sway in the first mode;
the roof moves most.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.records import find
from pounding.experiments.rig.shaking import shake
from pounding.scale import THESIS

record = find("elcentro-chopra").scaled(THESIS.time_factor)
motion = shake(frames.build(frames.load("5A")), record).motion
floors = motion.frames[0]
figure, (top, bottom) = plt.subplots(
    2, 1, figsize=(7.0, 4.6), sharex=True, layout="constrained", height_ratios=(1, 2)
)
top.plot(record.time_s, record.acceleration_m_s2 / 9.80665, color="black", lw=0.8)
top.set_ylabel("table [g]")
shades = plt.cm.viridis(np.linspace(0.1, 0.85, 5))
for floor, shade in enumerate(shades, 1):
    bottom.plot(
        floors.time_s,
        1e3 * floors.displacement_m[:, floors.floor(floor)],
        color=shade,
        lw=1,
        label=f"floor {floor}",
    )
bottom.set(xlabel="time [s]", ylabel="displacement relative\nto the table [mm]", xlim=(0.0, 5.0))
figure.legend(loc="outside right center")
