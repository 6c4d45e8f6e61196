"""
What a softer storey does to the frequencies
============================================

The columns of one storey lose 30 % of their stiffness. Each mode says something else about where that was, which is
how a diagnosis finds the place.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames

frame = frames.load("5A")
intact = frames.build(frame).frequencies_hz[:5]
change = np.empty((5, 5))
for storey in range(5):
    factors = np.where(np.arange(5) == storey, 0.7, 1.0).tolist()
    softer = frames.build(frames.changed(frame, storey_stiffness_factor=factors))
    change[:, storey] = 100 * (softer.frequencies_hz[:5] / intact - 1)

figure, axes = plt.subplots(figsize=(5.6, 4.2), layout="constrained")
image = axes.imshow(change, cmap="cividis")
axes.set(xlabel="softer storey", ylabel="mode", xticks=range(5), yticks=range(5))
axes.set_xticklabels(range(1, 6))
axes.set_yticklabels(range(1, 6))
for (mode, storey), value in np.ndenumerate(change):
    axes.text(
        storey,
        mode,
        f"{value:.1f}",
        ha="center",
        va="center",
        color="white" if value < change.mean() else "black",
    )
figure.colorbar(image, label="change of the frequency [%]")
