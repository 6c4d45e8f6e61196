"""
Five frequencies, many suspects
===============================

A modal test of frame 5A, whose third storey lost 30 % of its columns' stiffness. The evidence says how much likelier
the five frequencies are with an effect than with nothing missing. A softer storey and a heavier floor above it cannot
be told apart by frequencies; the place can.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

from pounding import frames
from pounding.diagnosis import diagnose
from pounding.experiments.pictures.palette import BLUE, GREY

ENTRY = (
    '[[modal]]\nquantity = "frequency"\nmode = {}\nvalue = {:.2f}\nunit = "Hz"\nstd = 0.1\ntest = "sweep"\n'
)
damaged = frames.build(frames.changed(frames.load("5A"), storey_stiffness_factor=[1, 1, 0.7, 1, 1]))
entries = [ENTRY.format(mode, hz) for mode, hz in enumerate(damaged.frequencies_hz[:5], 1)]
with tempfile.TemporaryDirectory() as folder:
    Path(folder, "case.toml").write_text('[[frame]]\nname = "5A"\n' + "".join(entries))
    report = diagnose(folder)
best = report.candidates[:8]
names = {member.words() for member in report.effects[0].members}
figure, axes = plt.subplots(figsize=(7.0, 3.4), layout="constrained")
axes.barh(
    [one.words() for one in best],
    [one.log_evidence for one in best],
    color=[BLUE if one.words() in names else GREY for one in best],
)
axes.invert_yaxis()
axes.set_xlabel("ln Bayes factor against nothing missing [-]; blue: the verdict")
