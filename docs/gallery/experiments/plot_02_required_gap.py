"""
The gap that two frames need
============================

Without a contact the floors may pass through each other. The largest closing motion of two floors is the gap that
they need. Codes combine the two peaks by a rule instead: their sum, or the root of the sum of squares.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, GREY, ORANGE
from pounding.experiments.records import find
from pounding.experiments.rig.required_gap import gaps_by_floor
from pounding.experiments.separation.rules.rules import absolute_sum, square_root_of_squares
from pounding.scale import THESIS

tall, low = (frames.build(frames.load(name)) for name in ("15B", "5B"))
record = find("elcentro-chopra").scaled(THESIS.time_factor)
by_floor = gaps_by_floor(tall, low, record)
floors = np.array([floor for floor, _ in by_floor])
closing = np.array([gap.closing_m for _, gap in by_floor])
peaks = [(gap.left_peak_m, gap.right_peak_m) for _, gap in by_floor]
figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
axes.barh(floors, 1e3 * closing, color=GREY, label="closing motion of the run")
axes.plot(
    [1e3 * square_root_of_squares(*one) for one in peaks],
    floors,
    "o",
    color=ORANGE,
    label="root of the sum of squares",
)
axes.plot([1e3 * absolute_sum(*one) for one in peaks], floors, "s", color=BLUE, label="sum of the peaks")
axes.set(xlabel="gap [mm]", ylabel="floor", yticks=floors)
figure.legend(loc="outside lower center", ncols=2)
