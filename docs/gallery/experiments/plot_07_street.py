"""
Three buildings in a row
========================

An office on both sides of a taller block of flats, 60 mm apart. The neighbours at the ends are hit from one side, the
one in the middle from both.
"""

import matplotlib.pyplot as plt

from pounding import frames
from pounding.contact import make_law
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.experiments.records import find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import run_exact

office = {
    "kind": "stick",
    "name": "office",
    "storeys": 4,
    "storey_height_m": 3.4,
    "floor_mass_kg": [300e3] * 4,
    "frequency_hz": [1.1],
    "damping_ratio": 0.04,
}
flats = office | {"name": "flats", "storeys": 6, "floor_mass_kg": [320e3] * 6, "frequency_hz": [0.7]}
row = [frames.build(frames.from_mapping(one)) for one in (office, flats, office)]
law = make_law("linear_viscoelastic", stiffness=3.75e9, restitution=0.6, masses=(300e3, 320e3))
contacts = [Contact(law, 0.06, (4, 4), pair=pair) for pair in (0, 1)]
record = find("elcentro-chopra")
motion = run_exact(row, contacts, record.acceleration_m_s2, record.step_s)
figure, axes = plt.subplots(figsize=(7.0, 3.4), layout="constrained")
for contact, colour, label in zip(motion.contacts, (BLUE, ORANGE), ("left gap", "right gap"), strict=True):
    time_s, force_n = contact.sampled()
    axes.vlines(time_s[force_n > 0], 0.0, force_n[force_n > 0] / 1e6, color=colour, lw=1.4, label=label)
axes.set(xlabel="time [s]", ylabel="contact force [MN]", xlim=(0.0, 20.0), ylim=(0.0, None))
figure.legend(loc="outside upper center", ncols=2)
