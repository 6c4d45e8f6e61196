"""
A rubber bumper
===============

A block of rubber is soft at first and stiffer the flatter it is pressed. From 80 % of its thickness the floors
themselves would begin to press.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding.contact.rubber import FLAT, RubberBlock
from pounding.experiments.pictures.palette import BLUE, GREEN, ORANGE

figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
for thickness_m, colour in ((0.03, ORANGE), (0.05, BLUE), (0.08, GREEN)):
    block = RubberBlock.of(area_m2=0.25, thickness_m=thickness_m)
    pressed_m = np.linspace(0.0, 0.85 * thickness_m, 200)
    axes.plot(
        1e3 * pressed_m,
        block.force(pressed_m, 0.0, 0.1) / 1e6,
        color=colour,
        label=f"{1e3 * thickness_m:.0f} mm thick",
    )
    flat_m = FLAT * thickness_m
    axes.plot(1e3 * flat_m, block.force(flat_m, 0.0, 0.1) / 1e6, "o", color=colour)
axes.set(xlabel="compression [mm]", ylabel="elastic force of 0.25 m² of rubber [MN]")
axes.legend(frameon=False, title="the dot: 80 % pressed")
