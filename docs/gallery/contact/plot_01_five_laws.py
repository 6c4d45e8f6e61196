"""
Five impact laws
================

Two floors of 6.2 kg meet at 0.3 m/s. Each law, with its numbers from the thesis, gives another loop of force over
overlap. The area of a loop is the energy that the impact takes.
"""

import matplotlib.pyplot as plt

from pounding.contact import BUILT_IN, collide, thesis_law
from pounding.experiments.pictures.palette import BLACK, BLUE, GREEN, ORANGE, VERMILION

figure, axes = plt.subplots(figsize=(6.5, 4.4), layout="constrained")
for name, colour in zip(BUILT_IN, (BLACK, BLUE, ORANGE, GREEN, VERMILION), strict=True):
    impact = collide(thesis_law(name), 6.2, 6.2, 0.3)
    label = f"{name.replace('_', ' ')}, restitution {impact.restitution:.2f}"
    axes.plot(1e3 * impact.deformation_m, impact.force_n / 1e3, color=colour, label=label)
axes.set(xlabel="overlap of the floors [mm]", ylabel="contact force [kN]")
figure.legend(loc="outside lower center", ncols=2)
