"""Small frames and a motion for them, shared by the tests of the rig."""

from __future__ import annotations

import numpy as np

from pounding import frames
from pounding.experiments.records import Record
from pounding.frames.reduction.reduced_frame import ReducedFrame

FIVE = ("linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp")


def shear(storeys: int, first_hz: float, *, mass_kg: float = 6.0, damping: float = 0.01) -> ReducedFrame:
    return frames.build(
        frames.StickFrame(
            name=f"{storeys} storeys of {first_hz:g} Hz",
            storeys=storeys,
            storey_height_m=0.1,
            floor_mass_kg=[mass_kg] * storeys,
            frequency_hz=[first_hz],
            damping_ratio=damping,
        )
    )


def two_sines(duration_s: float) -> Record:
    """Return a motion that brings first modes near 2.1 and 6.4 Hz up, growing for 0.4 s."""
    step = 0.004
    time = np.arange(0.0, duration_s + step / 2, step)
    motion = 3.0 * np.sin(2 * np.pi * 2.1 * time) + 2.0 * np.sin(2 * np.pi * 6.4 * time)
    return Record("two sines", motion * np.minimum(1.0, time / 0.4), step)
