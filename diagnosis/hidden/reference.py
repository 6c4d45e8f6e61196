"""Typical sizes of a run, so that a hidden effect can be given a strength without knowing its units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.modes import frequencies_hz, storey_stiffness
from pounding.diagnosis.hidden.scenario import Happened, Scenario


@dataclass(frozen=True)
class Typical:
    """One frame in the strongest run without any hidden effect; arrays run over storeys or floors.

    Attributes:
        peak_drift: Largest storey drift [m].
        rms_drift: Its root mean square [m].
        rms_rate: Root mean square of the drift's rate [m/s].
        rms_velocity: Root mean square velocity of the floors in the room [m/s].
        stiffness: Shear over drift of each storey [N/m].
        storey_damper: Dashpot in a storey that would double the first mode's damping [N s/m].
        first_hz: First frequency [Hz].
    """

    peak_drift: np.ndarray
    rms_drift: np.ndarray
    rms_rate: np.ndarray
    rms_velocity: np.ndarray
    stiffness: np.ndarray
    storey_damper: np.ndarray
    first_hz: float


def typical(scenario: Scenario, frame: str, happened: Happened, table_velocity: np.ndarray) -> Typical:
    """Return the typical sizes of one frame in a run.

    Args:
        scenario: The rig without effects.
        frame: Name of the frame.
        happened: How everything moved in the run.
        table_velocity: Velocity of the table, shape (samples,) [m/s].
    """
    beams: Beams = scenario.frames[frame]
    rows = scenario.row(frame, 1) + np.arange(beams.storeys)
    drift = np.diff(happened.displacement[rows], axis=0, prepend=0.0)
    rate = np.diff(happened.velocity[rows], axis=0, prepend=0.0)
    velocity = happened.velocity[rows] + table_velocity
    first_hz = float(frequencies_hz(beams, 1)[0])
    # In the first mode all storeys together turn 2 ratio omega M into heat; one storey has to do it alone.
    share = drift.std(axis=1) ** 2
    energy = (beams.floor_mass + beams.column_mass) @ happened.velocity[rows].std(axis=1) ** 2
    damper = 2 * beams.ratios[0] * 2 * np.pi * first_hz * energy / (share * (2 * np.pi * first_hz) ** 2)
    return Typical(
        np.abs(drift).max(axis=1),
        drift.std(axis=1),
        rate.std(axis=1),
        velocity.std(axis=1),
        storey_stiffness(beams),
        damper,
        first_hz,
    )
