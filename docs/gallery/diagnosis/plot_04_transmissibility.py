"""
Transmissibility: what a softer storey moves
============================================

The motion of the roof over that of the table, frequency by frequency, is what a shaking test measures first. Frame 5A as
built, and with 30 % less stiffness in the columns of its third storey: the third and the fifth peak move most,
because these modes bend that storey most.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.signal import csd, welch

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.experiments.rig.exact import run_exact

step_s = 0.002
table_m_s2 = np.random.default_rng(1).standard_normal(20_000)  # white noise for 40 s
frame = frames.load("5A")
softer = frames.changed(frame, storey_stiffness_factor=[1, 1, 0.7, 1, 1])
figure, axes = plt.subplots(figsize=(7.0, 3.6), layout="constrained")
for definition, colour, label in ((frame, BLUE, "as built"), (softer, ORANGE, "third storey softer")):
    motion = run_exact([frames.build(definition, damping=0.01)], [], table_m_s2, step_s).frames[0]
    at_s = step_s * np.arange(len(table_m_s2))
    roof = np.interp(at_s, motion.time_s, motion.acceleration_m_s2[:, motion.floor(5)]) + table_m_s2
    how = {"fs": 1 / step_s, "nperseg": 4096}
    frequency_hz, power = welch(table_m_s2, **how)
    axes.semilogy(
        frequency_hz, abs(csd(table_m_s2, roof, **how)[1]) / power, color=colour, lw=1.2, label=label
    )
axes.set(xlabel="frequency [Hz]", ylabel="roof over table [-]", xlim=(2.0, 65.0), ylim=(0.02, 100.0))
figure.legend(loc="outside upper center", ncols=2)
