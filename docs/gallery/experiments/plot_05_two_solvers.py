"""
Two solvers, one collision
==========================

The multibody engine exudyn steps through time and iterates; the exact solver goes from touch to touch in closed form.
Both compute the same run, each with its own error.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.contact import thesis_law
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.experiments.records import find
from pounding.experiments.rig.pounding import pound
from pounding.scale import THESIS

pair = [frames.build(frames.load(name)) for name in ("5A", "5B")]
record = find("elcentro-chopra").scaled(THESIS.time_factor)
law = thesis_law("linear_viscoelastic")
figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
for solver, colour, style in (("exudyn", ORANGE, "-"), ("exact", BLUE, "--")):
    motion = pound(*pair, record, law, gap_m=0.004, duration_s=2.0, solver=solver).motion
    time_s, force_n = motion.contacts[0].sampled(200_000.0)
    axes.plot(time_s, force_n / 1e3, style, color=colour, lw=1.6, label=solver)
first = time_s[np.argmax(force_n > 0.0)]
axes.set(xlabel="time [s]", ylabel="contact force [kN]", xlim=(first - 0.001, first + 0.003))
axes.legend(frameon=False, title="the first contact event")
