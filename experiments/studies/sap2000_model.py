"""The thesis' SAP2000 models as the numbers that it prints of them: three frequencies, a damping ratio, a time factor.

A frame is its first three modes. Their frequencies have the ratios that Table 3.1 prints for the SAP2000 model, their shapes
are those of our baseline model, and the table moves by the records, compressed by the factor that section 3.7 states.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.records import RECORDS, Record, find
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.frame_states import baseline
from pounding.experiments.studies.peak_lattice import STEP_S
from pounding.experiments.studies.table_4_1 import KEPT_ARIAS
from pounding.frames.response.exact import forced, modal_poles

Real = NDArray[np.float64]
TIME_FACTOR = 0.182
"""Time of the table over time of the record, as section 3.7 states it (p. 43); the root of 1/30 is 0.1826."""
MODES = 3


@cache
def printed_frequencies(frame: str) -> tuple[float, ...]:
    """Return the first three frequencies that Table 3.1 prints for the SAP2000 model of a frame [Hz]."""
    row = published.table("3.1").loc[frame]
    return tuple(float(row[("numerical", f"mode{mode}_hz")]) for mode in range(1, MODES + 1))


def table_damping(frame: str) -> float:
    """Return the damping ratio that Table 3.1 prints for a frame [-]."""
    return 0.01 * float(published.table("3.1").loc[frame, ("experiment", "damping_percent")])


def motions(folder: Path | None = None, time_factor: float = TIME_FACTOR) -> dict[str, Record]:
    """Return the motion of the table under each record of the tests, at the record's own peak.

    Args:
        folder: Folder with ground motions; None for the default.
        time_factor: Time of the table over time of the record [-].
    """
    found = {}
    for name in RECORDS:
        motion = find(name, folder).scaled(time_factor).trimmed(lower=0.0, upper=KEPT_ARIAS)
        found[name] = motion.resampled(motion.step_s / np.ceil(motion.step_s / STEP_S))
    return found


def moved(frame: str, floors: list[int], motion: Record, first_hz: float, damping: float) -> Real:
    """Return the displacements of floors relative to the table (samples, floors) [mm].

    Args:
        frame: Name of the frame.
        floors: Floors, from 1.
        motion: Motion of the table.
        first_hz: First frequency [Hz]; the others keep the ratios of `printed_frequencies`.
        damping: Damping ratio of all modes [-].
    """
    body = baseline(frame)
    printed = np.array(printed_frequencies(frame))
    circular = 2 * np.pi * first_hz * printed / printed[0]
    shapes = change.modes(body).shapes[:, :MODES]
    poles = modal_poles(circular, damping, shapes, body.mass, np.ones(len(body.mass)))
    found, _ = forced(poles, motion.acceleration_m_s2, motion.step_s, outputs=np.array(floors) - 1)
    return np.asarray(1e3 * found, np.float64)


def mean_error(ours: Real, printed: Real, gain: float = 1.0) -> float:
    """Return the mean of abs(gain ours - printed) / printed [-].

    Args:
        ours: Computed values, of any shape and unit.
        printed: The values that the thesis prints, of the same shape.
        gain: By which ours are multiplied.
    """
    return float(np.abs(gain * ours / printed - 1.0).mean())


def fitted_gain(ours: Real, printed: Real) -> float:
    """Return the gain with the smallest `mean_error`: the median of printed / ours, weighted by ours / printed.

    Args:
        ours: Computed values above zero, of any shape and unit.
        printed: The values that the thesis prints, of the same shape.
    """
    share = np.asarray(ours / printed).ravel()
    order = np.argsort(1.0 / share)
    summed = np.cumsum(share[order])
    return float(1.0 / share[order][np.searchsorted(summed, 0.5 * summed[-1])])
