"""
The gap that two frames need
============================

Without a contact the floors may pass through each other. The largest closing motion of two floors is the gap that they
need. Codes combine the two peaks by a rule instead: their sum, the root of the sum of squares, or the double-difference
rule, which knows from the periods how much two frames move in step.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.experiments.pictures.palette import BLACK, BLUE, GREY, ORANGE, VERMILION
from pounding.experiments.records import find
from pounding.experiments.rig.required_gap import gaps_by_floor, motions
from pounding.experiments.separation.rules.rules import (
    absolute_sum,
    correlation,
    double_difference,
    square_root_of_squares,
)
from pounding.scale import THESIS

tall, low = (frames.build(frames.load(name)) for name in ("15B", "5B"))
record = find("elcentro-chopra").scaled(THESIS.time_factor)

# %%
# The closing motion of the fifth floors over time; its largest value is the gap that the low frame's roof needs.
moved_mm = [1e3 * motions(frame, record, [5])[:, 0] for frame in (tall, low)]
time_s = np.linspace(0.0, record.duration_s, len(moved_mm[0]))
closing_mm = moved_mm[0] - moved_mm[1]
figure, axes = plt.subplots(figsize=(7.0, 3.2), layout="constrained")
axes.plot(time_s, closing_mm, color=BLACK, lw=0.9, label="15B towards 5B, floor 5")
axes.axhline(closing_mm.max(), color=VERMILION, ls="--", label=f"required gap {closing_mm.max():.1f} mm")
axes.set(xlabel="time [s]", ylabel="closing motion [mm]", xlim=(0.0, 5.0))
figure.legend(loc="outside upper center", ncols=2)

# %%
# Each floor's need beside the three rules, which take the peaks of both floors. The periods of these two frames lie so far
# apart that the double-difference rule says nearly the same as the root of the sum of squares.
by_floor = gaps_by_floor(tall, low, record)
floors = [floor for floor, _ in by_floor]
peaks_mm = [(1e3 * gap.left_peak_m, 1e3 * gap.right_peak_m) for _, gap in by_floor]
in_step = correlation(1 / tall.frequencies_hz[0], 1 / low.frequencies_hz[0], 0.005, 0.005)
rules = {
    "root of the sum of squares": (square_root_of_squares, "o", ORANGE),
    "double difference": (lambda a, b: double_difference(a, b, in_step), "D", VERMILION),
    "sum of the peaks": (absolute_sum, "s", BLUE),
}
figure, axes = plt.subplots(figsize=(7.0, 3.8), layout="constrained")
axes.barh(floors, [1e3 * gap.closing_m for _, gap in by_floor], color=GREY, label="closing motion of the run")
for label, (rule, marker, colour) in rules.items():
    size = 11 if marker == "o" else 5  # a large dot shows behind a small diamond
    axes.plot([rule(*pair) for pair in peaks_mm], floors, marker, ms=size, color=colour, label=label)
axes.set(xlabel="gap [mm]", ylabel="floor", yticks=floors)
figure.legend(loc="outside lower center", ncols=2)
