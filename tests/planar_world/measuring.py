"""What the sensors read: channels at the written rate, with or without an anti-aliasing filter, and their noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import firwin, lfilter

from tests.planar_world.baseline import Real
from tests.planar_world.integration import DURATION_S, STORED_HZ, Motion, Shaken
from tests.planar_world.structure import Structure

SAMPLING_HZ = 500
SAMPLES = round(DURATION_S * SAMPLING_HZ)
EVERY = STORED_HZ // SAMPLING_HZ
FILTER = firwin(129, 200, fs=STORED_HZ)
"""Anti-aliasing below 200 Hz, without delay."""
TABLE_NOISE = 0.005
"""Of the table's channel, over its rms [-]."""
POLE, SETTLING = 0.95, 500
"""Of coloured noise: pole of its first-order recursion [-], and samples until it has settled."""


@dataclass(frozen=True)
class Channel:
    """A channel on a floor, counted from 1: its acceleration in the room, or its displacement relative to the table."""

    name: str
    floor: int
    accelerometer: bool

    def reads(self, motion: Motion) -> Real:
        """Return its reading (times,) [m/s^2] or [mm]."""
        if self.accelerometer:
            return motion.acceleration[:, self.floor - 1]
        return motion.displacement[:, self.floor - 1] * 1e3


@dataclass(frozen=True)
class Sensing:
    """How a case is measured.

    Attributes:
        channels: All but the table's.
        filtered: Whether there is an anti-aliasing filter.
    """

    channels: tuple[Channel, ...]
    filtered: bool

    def readings(self, structure: Structure, shaken: Shaken, motion: Motion) -> Real:
        """Return what is read without noise (times, table and channels), in the units of the channels.

        Args:
            structure: Whose sensors may have faults.
            shaken: The table's acceleration.
            motion: Of the structure.
        """
        times = np.arange(int(DURATION_S * STORED_HZ) + 1) / STORED_HZ
        columns = [shaken(times)]
        for channel in self.channels:
            read = channel.reads(motion)
            if structure.delay and structure.delay[0] == channel.name:
                read = CubicSpline(times, read)(np.clip(times - structure.delay[1], 0, None))
            if structure.gain and structure.gain[0] == channel.name:
                read = read * structure.gain[1]
            columns.append(read)
        read = np.array(columns).T
        return (_smoothed(read) if self.filtered else read)[:-1:EVERY]


def _smoothed(read: Real) -> Real:
    half = len(FILTER) // 2
    padded = np.pad(read, ((half, half), (0, 0)), mode="edge")
    return np.array([np.convolve(column, FILTER, "valid") for column in padded.T]).T


def noisy(runs: Sequence[Real], noise: float, coloured: bool, rng: np.random.Generator) -> list[Real]:
    """Return the readings of all runs (times, table and channels) with noise.

    Args:
        runs: Readings without noise (times, table and channels).
        noise: Of every channel but the table's, over its rms in all runs [-].
        coloured: Half of its variance is first-order noise, the other half and the table's is white.
        rng: Source of chance.
    """
    rms = np.sqrt(np.concatenate([run**2 for run in runs]).mean(0))
    level = rms * noise
    level[0] = rms[0] * TABLE_NOISE
    found = []
    for run in runs:
        errors = rng.normal(size=run.shape)
        if coloured:
            white = rng.normal(size=(run.shape[0] + SETTLING, run.shape[1]))
            colour = lfilter([np.sqrt(1 - POLE**2)], [1, -POLE], white, axis=0)[SETTLING:]
            errors[:, 1:] = np.sqrt(0.5) * errors[:, 1:] + np.sqrt(0.5) * colour[:, 1:]
        found.append(run + level * errors)
    return found
