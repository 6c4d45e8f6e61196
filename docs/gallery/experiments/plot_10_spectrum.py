"""
Spectra: the record and the code
================================

What a single-degree-of-freedom building of each period would feel under El Centro, beside the elastic spectrum of
Eurocode 8 for its peak ground acceleration.
"""

import matplotlib.pyplot as plt
import numpy as np

from pounding.experiments.pictures.palette import BLACK, BLUE, ORANGE
from pounding.experiments.records import find
from pounding.experiments.records.code_spectra import target
from pounding.experiments.records.spectra import response_spectrum

record = find("elcentro-chopra")
periods_s = np.geomspace(0.05, 4.0, 120)
figure, axes = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
for damping, colour in ((0.02, ORANGE), (0.05, BLUE)):
    found = response_spectrum(record, periods_s, damping).pseudo_acceleration_m_s2 / 9.80665
    axes.plot(periods_s, found, color=colour, label=f"El Centro, {100 * damping:.0f} % damping")
code = target(f"ec8-1:{record.pga_g:.3f}:B")
axes.plot(periods_s, code.at(periods_s), "--", color=BLACK, label="Eurocode 8, type 1, ground B, 5 %")
axes.set(xscale="log", xlabel="period [s]", ylabel="pseudo spectral acceleration [g]")
axes.legend(frameon=False)
