"""
How likely do they touch?
=========================

Until the first touch linear buildings move in proportion to the shaking, so one run for each record says at which
intensity floors meet. A lognormal curve through these intensities is the fragility; the band comes from drawing the
records anew.

The records are the 44 of the far-field set of FEMA P695, which the extra ``records`` installs.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.contact import make_law
from pounding.experiments.fragility.capacity import closings, touching_intensity
from pounding.experiments.fragility.intensity import Intensity
from pounding.experiments.fragility.lognormal import band, fit_capacities
from pounding.experiments.pictures.palette import BLUE, GREY
from pounding.experiments.records.sets import record_set
from pounding.experiments.rig.contacts import Contact

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
pair = [frames.build(frames.from_mapping(one)) for one in (flats, office)]
contacts = [Contact(make_law("linear_spring", stiffness=3.75e9), 0.06, (4, 4))]
records = record_set("fema-p695-farfield")
intensity = Intensity(1.43)
touching_g = np.array(
    [
        touching_intensity(closings(pair, contacts, one), contacts, one.name, intensity.of(one))
        for one in records
    ]
)
axis_g = np.linspace(0.005, 0.2, 150)
low, high = band(lambda drawn: fit_capacities(touching_g[drawn]), len(records), axis_g)
figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
axes.fill_between(axis_g, low, high, color=BLUE, alpha=0.2, lw=0, label="90 % band")
axes.plot(axis_g, fit_capacities(touching_g).at(axis_g), color=BLUE, label="lognormal")
shares = np.arange(1, len(records) + 1) / len(records)
axes.step(np.sort(touching_g), shares, where="post", color=GREY, label="the records")
axes.set(xlabel=intensity.words, ylabel="probability that the floors touch [-]")
axes.legend(frameon=False)
