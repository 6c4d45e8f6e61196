"""
Modes of a plate-and-column frame
=================================

A frame with 15 storeys of 100 mm: steel plates on four thin columns. The model is reduced to a few dozen coordinates;
its first modes are those of a building that sways.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, GREEN, ORANGE

frame = frames.build(frames.load("15B"))
height_m = np.concatenate([[0.0], frame.heights_m])
figure, axes = plt.subplots(figsize=(6.4, 4.8), layout="constrained")
for mode, colour in enumerate((BLUE, ORANGE, GREEN)):
    moved = np.concatenate([[0.0], frame.shapes[frame.floor_x, mode]])
    axes.plot(
        moved / np.abs(moved).max(),
        height_m,
        "o-",
        ms=4,
        color=colour,
        label=f"mode {mode + 1}, {frame.frequencies_hz[mode]:.2f} Hz",
    )
axes.axvline(0.0, color="black", lw=0.8)
axes.set(xlabel="displacement over the largest [-]", ylabel="height [m]")
figure.legend(loc="outside right upper")
