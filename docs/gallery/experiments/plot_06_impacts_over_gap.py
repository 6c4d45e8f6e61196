"""
Impacts over the gap
====================

Is a narrow gap the worst one? Forty runs of the exact solver, side by side on all cores, say how hard and how often
two frames meet. The largest force belongs to a gap in between, where the floors meet at their largest velocity.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.contact import thesis_law
from pounding.experiments.pictures.palette import BLUE, VERMILION
from pounding.experiments.records import find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.many import Case, many
from pounding.scale import THESIS

pair = [frames.build(frames.load(name)) for name in ("15B", "5B")]
record = find("elcentro-chopra").scaled(THESIS.time_factor)
gaps_m = np.linspace(0.0005, 0.0125, 40)
law = thesis_law("linear_viscoelastic")
cases = [
    Case(pair, [Contact(law, float(gap_m), (5, 5))], record.acceleration_m_s2, record.step_s)
    for gap_m in gaps_m
]
outcomes = list(many(cases))
figure, (top, bottom) = plt.subplots(2, 1, figsize=(6.4, 4.6), sharex=True, layout="constrained")
top.plot(1e3 * gaps_m, [one.peak_force_n[0] / 1e3 for one in outcomes], "o-", ms=3, color=VERMILION)
top.set_ylabel("largest force [kN]")
bottom.step(1e3 * gaps_m, [one.touches[0] for one in outcomes], where="mid", color=BLUE)
bottom.set(xlabel="gap [mm]", ylabel="touches")
