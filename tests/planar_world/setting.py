"""How a case is shaken and measured: all of it but the frame and what is hidden."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.planar_world.baseline import Real
from tests.planar_world.integration import STEP_S, Shaken, respond
from tests.planar_world.measuring import Channel, Sensing
from tests.planar_world.motion import NOISE, SOURCES, motion
from tests.planar_world.plan import Plan
from tests.planar_world.refits import Scene
from tests.planar_world.structure import Structure

RUNS = 3
PEAKS, PEAKS_OF_NOISE = (2.0, 6.0), (2.0, 4.0)
"""Least and largest peaks [m/s^2]."""


@dataclass(frozen=True)
class Taken:
    """What is read of all runs without noise, and how the floors move.

    Attributes:
        readings: (times, table and channels) of each run, in the units of the channels.
        displacements: Of the floors relative to the table (times, floors) of each run [m].
    """

    readings: tuple[Real, ...]
    displacements: tuple[Real, ...]

    @property
    def responses(self) -> Real:
        """What is read but for the table (times of all runs, channels)."""
        return np.concatenate([run[:, 1:] for run in self.readings])

    def largest(self, direction: Real) -> float:
        """Return the largest drift along a direction (floors,) in any run [m]."""
        return float(max(np.abs(run @ direction).max() for run in self.displacements))


@dataclass(frozen=True)
class Setting:
    """The setting of a case.

    Attributes:
        plan: What the case is.
        sources: Of the table's motion in each run.
        shaken: The table's acceleration in each run.
        sensing: Channels and filter.
        accelerated: Floors with an accelerometer, counted from 1.
    """

    plan: Plan
    sources: tuple[str, ...]
    shaken: Sequence[Shaken]
    sensing: Sensing
    accelerated: tuple[int, ...]

    @property
    def channels(self) -> tuple[Channel, ...]:
        """All channels but the table's."""
        return self.sensing.channels

    @property
    def scene(self) -> Scene:
        """In what a frame is fitted."""
        return Scene.of(self.plan.frame, self.shaken, self.channels)

    def taken(self, structure: Structure, step: float = STEP_S) -> Taken:
        """Shake a structure in steps [s] and read the sensors."""
        motions = respond(structure, self.shaken, step)
        readings = [
            self.sensing.readings(structure, shaken, moved)
            for shaken, moved in zip(self.shaken, motions, strict=True)
        ]
        floors = self.plan.storeys
        return Taken(tuple(readings), tuple(moved.displacement[:, :floors] for moved in motions))


def drawn_setting(plan: Plan, rng: np.random.Generator) -> Setting:
    """Draw how a case is shaken and measured."""
    storeys = plan.storeys
    sources = tuple(str(source) for source in rng.permutation(SOURCES)[:RUNS])
    middle = int(rng.integers(2, storeys) if storeys == 5 else rng.integers(3, storeys - 1))
    accelerated = _accelerated(plan, rng)
    # Where there are few accelerometers, only the roof's displacement is measured.
    both = rng.random() < 0.65 and plan.accelerometers is None
    channels = [Channel(f"{plan.frame}_a{floor}", floor, True) for floor in accelerated]
    channels += [
        Channel(f"{plan.frame}_d{floor}", floor, False)
        for floor in ((middle, storeys) if both else (storeys,))
    ]
    filtered = bool(rng.random() < 0.5)
    peaks = [rng.uniform(*(PEAKS_OF_NOISE if source == NOISE else PEAKS)) for source in sources]
    own = np.random.default_rng(plan.seed + 1)
    shaken = [motion(source, own, peak) for source, peak in zip(sources, peaks, strict=True)]
    return Setting(plan, sources, shaken, Sensing(tuple(channels), filtered), accelerated)


def _accelerated(plan: Plan, rng: np.random.Generator) -> tuple[int, ...]:
    """Return the floors with an accelerometer, the roof always among them."""
    if plan.accelerometers is None:
        return tuple(range(1, plan.storeys + 1))
    others = rng.permutation(np.arange(1, plan.storeys))[: plan.accelerometers - 1]
    return tuple(sorted({plan.storeys, *others.tolist()}))
