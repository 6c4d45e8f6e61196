"""
A diagnosis makes the misfit shrink
===================================

A bench frame of three storeys with friction in the second, measured with 1 % of noise in three runs. The diagnosis
names the effect and its place, puts it into the model, and predicts a run that it did not use: of the misfit hardly
more than the noise remains.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from pounding import frames
from pounding.diagnosis import Case, diagnose
from pounding.diagnosis.case.case import CaseFrame, Channel, Run
from pounding.experiments.pictures.palette import BLUE, GREEN, GREY
from pounding.experiments.records import find
from pounding.experiments.rig.exact import run_exact
from pounding.scale import THESIS

# The frame as built, with friction that its model does not have.
mass_kg, hz = (6.5, 6.5, 6.5), (6.8,)
friction = {"kind": "friction", "storey": 2, "force_n": 1.0, "sticking_stiffness_n_per_m": 60e3}
built = frames.build(
    frames.from_mapping(
        {
            "kind": "stick",
            "name": "bench",
            "storeys": 3,
            "storey_height_m": 0.2,
            "scale": 1 / 30,
            "floor_mass_kg": list(mass_kg),
            "frequency_hz": list(hz),
            "damping_ratio": 0.01,
            "storey_law": [friction],
        }
    )
)
believed = CaseFrame(
    "bench", 3, storey_height_m=0.2, floor_mass_kg=mass_kg, frequency_hz=hz, damping_ratio=(0.01,)
)

# %%
# Three runs, each with another part of the record, as accelerometers on the floors see them.
rng, step_s = np.random.default_rng(3), 0.004
channels = [Channel("table", "table_acceleration", "m/s^2")]
channels += [
    Channel(f"floor {i}", "absolute_acceleration", "m/s^2", frame="bench", floor=i) for i in (1, 2, 3)
]
record = find("elcentro-chopra").scaled(THESIS.time_factor).resampled(step_s)
runs = []
for number, factor in enumerate((0.6, -0.8, 1.0)):
    table = factor * np.roll(record.acceleration_m_s2, 150 * number)[:1000]
    motion = run_exact([built], [], table, step_s).frames[0]
    at = np.arange(len(table)) * step_s
    room = np.column_stack(
        [
            np.interp(at, motion.time_s, motion.acceleration_m_s2[:, motion.floor(i)]) + table
            for i in (1, 2, 3)
        ]
    )
    values = np.column_stack([table, room])
    values[:, 1:] += 0.01 * room.std(axis=0) * rng.standard_normal(room.shape)
    runs.append(Run(f"run{number + 1}", None, at, step_s, values))
report = diagnose(Case("bench", Path("bench"), (believed,), tuple(runs), tuple(channels)))
print(report)

# %%
# The misfit of the run that was held out, over its motion.
judged = report.misfit.judged
figure, axes = plt.subplots(figsize=(5.6, 3.2), layout="constrained")
bars = {"baseline model": judged.before, "with friction": judged.after, "noise": judged.noise_floor}
drawn = axes.bar(list(bars), [100 * value for value in bars.values()], color=[GREEN, BLUE, GREY])
axes.bar_label(drawn, fmt="%.1f")
axes.margins(y=0.12)
axes.set_ylabel("misfit of the held-out run [%]")
