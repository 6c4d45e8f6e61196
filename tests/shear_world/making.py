"""A case is made: the true frame is drawn, shaken, and measured with noise."""

from __future__ import annotations

import zlib
from pathlib import Path

import numpy as np

from tests.shear_world.building import Real, scattered
from tests.shear_world.cases import Case, Hidden
from tests.shear_world.integration import respond
from tests.shear_world.motion import DURATION_S, motions
from tests.shear_world.writing import write_case

SAMPLING_HZ = 500
NOISE = (0.01, 0.02)
"""Least and largest noise of a case, of each channel's rms, the table's too."""


def make(folder: Path, name: str, case: Case, seed: int) -> Hidden:
    """Write a case to an empty folder and return what is hidden in it; name and seed say which is drawn."""
    rng = np.random.default_rng([seed, zlib.crc32(name.encode())])
    frame = scattered(case.believed, rng)
    hidden, noise = case.hide(frame), rng.uniform(*NOISE)
    times = np.arange(round(DURATION_S * SAMPLING_HZ) + 1) / SAMPLING_HZ
    runs: list[tuple[Real, Real]] = []
    for shaken in motions(rng):
        # What is hidden has no damping of its own: the rest is that of the frame before.
        moved = respond(hidden.frame, hidden.laws, shaken, times, damping=frame.damping())
        rows = [floor - 1 for floor in case.floors]
        true = np.column_stack(
            [shaken(times), moved.acceleration[rows].T, 1e3 * moved.displacement[rows[-1]]]
        )
        rms = np.sqrt(np.mean(true**2, axis=0))
        runs.append((times, true + noise * rms * rng.standard_normal(true.shape)))
    write_case(folder, case.believed, case.floors, runs)
    return hidden
