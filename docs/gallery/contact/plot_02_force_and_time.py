"""
How hard and how long
=====================

Twice the velocity is twice the force for a spring, and more for Hertz's law, which stiffens as it is pressed: there
the touch also becomes shorter. The numbers of the five laws are the thesis', for floors of 6.2 kg.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding.contact import BUILT_IN, collide, thesis_law
from pounding.experiments.pictures.palette import BLACK, BLUE, GREEN, ORANGE, VERMILION

velocities_m_s = np.geomspace(0.05, 1.0, 10)
figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
styles = ("-", "--", "-", "-.", "--")
for name, colour, style in zip(BUILT_IN, (BLACK, BLUE, ORANGE, GREEN, VERMILION), styles, strict=True):
    impacts = [collide(thesis_law(name), 6.2, 6.2, velocity) for velocity in velocities_m_s]
    label = name.replace("_", " ")
    left.plot(velocities_m_s, [one.force_n.max() / 1e3 for one in impacts], style, color=colour, label=label)
    right.plot(velocities_m_s, [1e3 * one.duration_s for one in impacts], style, color=colour)
left.set(xlabel="approach velocity [m/s]", ylabel="largest force [kN]")
right.set(xlabel="approach velocity [m/s]", ylabel="time in contact [ms]", ylim=(0.0, None))
figure.legend(loc="outside lower center", ncols=3)
