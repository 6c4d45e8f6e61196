"""
From a bending beam to a shear beam
===================================

A tall building whose walls bend has its second frequency near six times the first. In a building of frames only the
storeys shear, and the ratio is near three. One number, ``stiffness_ratio``, leads from one to the other.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, ORANGE

tower = {
    "kind": "stick",
    "name": "tower",
    "storeys": 10,
    "storey_height_m": 3.2,
    "floor_mass_kg": [300e3] * 10,
    "frequency_hz": [0.8],
    "damping_ratio": 0.05,
}
ratios = np.concatenate([[0.0], np.geomspace(0.3, 30.0, 12)])
built = [frames.build(frames.from_mapping(tower | {"stiffness_ratio": float(one)})) for one in ratios]
figure, axes = plt.subplots(figsize=(6.0, 3.8), layout="constrained")
for mode, colour in ((1, BLUE), (2, ORANGE)):
    higher = [one.frequencies_hz[mode] / one.frequencies_hz[0] for one in built]
    axes.plot(ratios, higher, "o-", color=colour, ms=4, label=f"mode {mode + 1}")
axes.set(xlabel="stiffness_ratio: 0 bends, 30 shears [-]", ylabel="frequency over the first [-]")
axes.set_xscale("symlog", linthresh=0.3)
axes.legend(frameon=False)
