"""What differs between the baseline frame and the one as built: nuisance parameters well inside the default priors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.diagnosis.case.case import Channel
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.scenario import Scenario

RAYLEIGH_SHARE = 0.3
"""Share of the frames whose damping is of Rayleigh's kind; the others have one ratio for each mode."""


def built(rng: np.random.Generator, baseline: Beams) -> Beams:
    """Return a frame as it may have been built."""
    storeys = baseline.storeys
    whole = rng.normal(1.0, 0.03)
    # A storey's shear over drift follows its columns about half, the joints do the rest.
    bending = baseline.bending * whole * rng.normal(1.0, 2 * rng.uniform(0.008, 0.02), storeys)
    joint = baseline.joint * whole * rng.normal(1.0, 0.01, storeys + 1)
    mass = baseline.floor_mass * rng.normal(1.0, rng.uniform(0.003, 0.008), storeys)
    return replace(
        baseline,
        bending=bending,
        joint=joint,
        floor_mass=mass,
        ratios=_ratios(rng, float(baseline.ratios[0]), storeys),
        dashpots=np.zeros(storeys),
    )


def _ratios(rng: np.random.Generator, baseline: float, storeys: int) -> np.ndarray:
    """Return damping ratios, mode by mode."""
    ratio = baseline * np.exp(rng.normal(0.0, 0.1))
    if storeys > 2 and rng.random() < RAYLEIGH_SHARE:
        # Mass- and stiffness-proportional, equal in the first mode and half-way up; shear-beam frequencies.
        order = np.arange(1, storeys + 1)
        omega = np.sin((2 * order - 1) * np.pi / (4 * storeys + 2))
        other = omega[(storeys + 1) // 2]
        return np.asarray(ratio * (omega[0] * other / omega + omega) / (omega[0] + other))
    return np.asarray(ratio * np.exp(rng.normal(0.0, rng.uniform(0.05, 0.15), storeys)))


def set_up(
    rng: np.random.Generator,
    frames: dict[str, Beams],
    channels: tuple[Channel, ...],
    kind: type[Scenario] = Scenario,
) -> Scenario:
    """Return the rig with the small faults that every table and sensor has.

    Args:
        rng: Draws the faults.
        frames: Frames by name.
        channels: Channels of the case.
        kind: What the rig is, by the world in which it stands.
    """
    responses = [channel for channel in channels if not channel.is_table]
    return kind(
        frames,
        table_gain=float(rng.normal(0.0, 0.005)),
        table_delay_s=float(rng.normal(0.0, 1e-4)),
        sensor_gain={channel.name: float(rng.normal(0.0, 0.003)) for channel in responses},
    )
