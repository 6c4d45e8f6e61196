"""
What can be done
================

A pair of real buildings that is too close. Each dot is one setting of a measure, found by a bounded search: wider
gaps, bumpers of rubber, links, dampers, damping, walls. Left and low is better.
"""

import matplotlib.pyplot as plt

from pounding import frames
from pounding.contact import make_law
from pounding.experiments.mitigation.search import compare
from pounding.experiments.mitigation.standing import Standing
from pounding.experiments.pictures import palette
from pounding.experiments.records import find
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
pair = tuple(frames.build(frames.from_mapping(one)) for one in (flats, office))
law = make_law("linear_viscoelastic", stiffness=3.75e9, restitution=0.6, masses=(300e3, 320e3))
record = find("elcentro-chopra")
answers = compare(Standing(pair, (Contact(law, 0.06, (4, 4)),)), [record], evaluations=10)
colours = (
    palette.BLACK,
    palette.BLUE,
    palette.ORANGE,
    palette.GREEN,
    palette.VERMILION,
    palette.PURPLE,
    palette.SKY,
    palette.GREY,
)
figure, axes = plt.subplots(figsize=(7.0, 4.4), layout="constrained")
for answer, colour in zip(answers, colours, strict=False):
    tried = [one.response for one in answer.tried] or [answer.best.response]
    axes.plot(
        [100 * one.drift for one in tried],
        [one.acceleration_g for one in tried],
        "o",
        ms=3,
        color=colour,
        alpha=0.4,
    )
    best = answer.best.response
    axes.plot(100 * best.drift, best.acceleration_g, "D", color=colour, label=answer.measure.name)
axes.set(xlabel="largest storey drift [%]", ylabel="largest floor acceleration [g]", yscale="log")
axes.set_yticks([0.3, 0.5, 1.0, 2.0, 5.0], ["0.3", "0.5", "1", "2", "5"])
axes.minorticks_off()
figure.legend(loc="outside right center", title="diamond: the best")
