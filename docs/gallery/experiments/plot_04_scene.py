"""
The hardest impact, off-screen
==============================

The frames as bodies at the moment of the largest contact force, drawn without a window. Displacements are enlarged;
the arrow is the force. ``pounding pound ... --out DIR`` writes the same picture, a film on request, and a series for
ParaView.
"""

import matplotlib.pyplot as plt

from pounding import frames
from pounding.contact import thesis_law
from pounding.experiments.pictures.scenes import picture
from pounding.experiments.records import find
from pounding.experiments.rig.pounding import pound
from pounding.scale import THESIS

tall, low = (frames.build(frames.load(name)) for name in ("15B", "5B"))
record = find("elcentro-chopra").scaled(THESIS.time_factor)
run = pound(tall, low, record, thesis_law("linear_viscoelastic"), gap_m=0.008, solver="exact")
scene = picture(run.motion)
figure, axes = plt.subplots(figsize=(8.0, 6.6), layout="constrained")
axes.imshow(scene.screenshot(return_img=True))
axes.axis("off")
