"""What chapters 5 and 6 could see: laws evaluated on one motion, and a stiffness read with laser sensors.

The thesis computed the forces of its laws in a spreadsheet from one deformation, at the 10,000 samples a second of
the measurement (sections 5.4 and 6.6.1). No law then acts back on the frames. The two functions here say what such a
comparison can show and how finely its deformation was known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from pounding.contact.laws import Law
from pounding.experiments import published
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.impacts import impacts

LASER = "ZX1-LD300A81"
"""Sensor that stood at the floors that collide (section 3.8 for 15B beside 10, then 'repeated')."""


def on_one_motion(history: ContactHistory, laws: Mapping[str, Law]) -> pd.DataFrame:
    """Return what laws say of one and the same motion of two floors.

    Args:
        history: A contact of a run, whose motion is kept.
        laws: Laws by what they are called.

    Returns:
        One row a law: `impacts`, `touches`, `first_touch_s` [s], `first_peak_n` of the first touch and
        `largest_peak_n` [N].
    """
    rows = {}
    for name, law in laws.items():
        found = impacts(replace(history, law=law))
        first = replace(history, law=law).pulse(*history.pulses[0])
        rows[name] = {
            "impacts": len(found),
            "touches": sum(one.touches for one in found),
            "first_touch_s": float(first[0][0]),
            "first_peak_n": float(first[3].max()),
            "largest_peak_n": max(one.peak_force_n for one in found),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("law")


def laser_limits(first_peak_n: pd.Series, stiffness_n_per_m: float) -> pd.DataFrame:
    """Return how finely lasers resolve the deformation of an impact, and what that leaves of its slope.

    The deformation is the difference of two floors' displacements, each read at both ends of the slope: four
    readings. A reading that is rounded to a step has a standard error of the step over the root of 12, four have
    twice that.

    Args:
        first_peak_n: Peak force of the first impact of each test [N].
        stiffness_n_per_m: The contact's stiffness [N/m].

    Returns:
        A row a test: `first_peak_n` [N], `deformation_um` at that force [um], `steps` of the sensor in it, and
        `standard_error_percent` of a stiffness read from it.
    """
    step = float(published.table("section 3.4").loc[LASER, "resolution_um"])
    deformation = 1e6 * first_peak_n / stiffness_n_per_m
    return pd.DataFrame(
        {
            "first_peak_n": first_peak_n,
            "deformation_um": deformation,
            "steps": deformation / step,
            "standard_error_percent": 100.0 * 2.0 * step / np.sqrt(12.0) / deformation,
        }
    )
