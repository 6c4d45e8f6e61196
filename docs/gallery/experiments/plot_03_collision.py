"""
A collision
===========

A tall frame and a low one stand 8 mm apart and need more. The floors of the low one's roof height meet, part, and
meet again; each impact is a force of about a millisecond.
"""

import matplotlib.pyplot as plt

from pounding import frames
from pounding.contact import thesis_law
from pounding.experiments.pictures.palette import BLUE, ORANGE, VERMILION
from pounding.experiments.records import find
from pounding.experiments.results.dataset import dataset
from pounding.experiments.rig.pounding import pound
from pounding.scale import THESIS

tall, low = (frames.build(frames.load(name)) for name in ("15B", "5B"))
record = find("elcentro-chopra").scaled(THESIS.time_factor)
run = pound(tall, low, record, thesis_law("linear_viscoelastic"), gap_m=0.008, solver="exact")
data = dataset(run.motion, record)
moved = 1e3 * data.relative_displacement.sel(floor=5)
figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.0, 4.6), sharex=True, layout="constrained")
top.plot(data.contact_time, data.contact_force[0] / 1e3, color=VERMILION, lw=0.9)
top.set_ylabel("contact force [kN]")
bottom.plot(data.time, moved.sel(frame="15B"), color=BLUE, label="15B, floor 5")
bottom.plot(data.time, moved.sel(frame="5B") + 8.0, color=ORANGE, label="5B, floor 5, and the gap of 8 mm")
bottom.set(xlabel="time [s]", ylabel="displacement [mm]", xlim=(0.0, 3.0))
figure.legend(loc="outside lower center", ncols=2)
