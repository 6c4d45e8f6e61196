"""Errors of Table 4.1 on a lattice of models: a state of each frame, and numbers that are the same for all frames.

`PeakLattice` has the linear models: frequency factor, damping ratio and gain of the table. The first two and the state
say how a frame swings and the gain scales what it does, so that all its models follow from the responses at each first
frequency and damping ratio: between neighbouring frequencies, half a per cent apart, peaks are taken as straight.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.records import RECORDS, Record
from pounding.experiments.rig.states import FREQUENCIES as PLACES
from pounding.experiments.rig.states import Frequency, first_frequency
from pounding.experiments.studies.frame_states import (
    Setting,
    displacements,
)
from pounding.experiments.studies.single_changes import extremes
from pounding.experiments.studies.table_4_1 import BLIND, FRAMES, KEPT_ARIAS, measured, table_motion, trusted

Real = NDArray[np.float64]
STEP_S = 1e-3
"""The exact response is looked at this often [s]."""
FREQUENCIES = np.arange(0.85, 1.1301, 0.005)
"""First frequencies over those of free vibration at which responses are computed."""
FACTORS = np.concatenate([[1.0], np.arange(0.94, 0.9999, 0.01), np.arange(1.01, 1.0501, 0.01)])
RATIOS = (
    None,
    0.004,
    0.005,
    0.006,
    0.0075,
    0.009,
    0.0105,
    0.012,
    0.0135,
    0.015,
    0.0175,
    0.02,
    0.0225,
    0.025,
    0.03,
    0.04,
)
GAINS = np.concatenate([[1.0], np.arange(0.75, 0.9999, 0.025), np.arange(1.025, 1.1001, 0.025)])
"""Values of each number that are tried, first the one that changes nothing; no damping ratio is each frame's own."""

PARTS = {"slip": 2}
"""Of how many numbers one is made: a slip is a share of the stiffness and a drift."""


@dataclass(frozen=True)
class Freedom:
    """What a model may choose, the rest being as in the baseline model.

    Attributes:
        numbers: Which of the lattice's numbers are fitted.
        states: `baseline` (free vibration), `fitted` (one of `PLACES` for each frame), or a state for each frame that was
            chosen beforehand.
    """

    numbers: tuple[str, ...] = ()
    states: str | tuple[tuple[str, Frequency], ...] = "baseline"

    def allowed(self, frame: str) -> tuple[Frequency, ...]:
        """Return the states that a frame may be in."""
        if self.states == "fitted":
            return PLACES
        return ("free vibration",) if isinstance(self.states, str) else (dict(self.states)[frame],)

    @property
    def fitted(self) -> int:
        """How many numbers and choices are fitted."""
        numbers = sum(PARTS.get(name, 1) for name in self.numbers)
        return numbers + (len(FRAMES) if self.states == "fitted" else 0)


@dataclass(frozen=True)
class Chosen:
    """A model of a lattice.

    Attributes:
        numbers: Numbers for all frames by name; those that are left out change nothing.
        states: A state for each frame.
        error: Its mean error where it was fitted [-].
    """

    numbers: Mapping[str, Any]
    states: dict[str, Frequency]
    error: float

    @property
    def setting(self) -> Setting:
        """The model as the linear models of the other tables take it."""
        factor, gain = (float(self.numbers.get(name, 1.0)) for name in ("factor", "gain"))
        return Setting(self.numbers.get("damping"), factor, gain)


class Lattice:
    """The errors of all models of a lattice at all peaks of Table 4.1; one that is derived computes the predictions.

    Args:
        axes: Values of each number that are tried, in the order of the axes of `predictions`; first the one that changes
            nothing.

    Attributes:
        predictions: Peaks [mm] of each frame by all models, (states, a size for each of `axes`, floors, records, sides).
        measured: Measured peaks [mm] of each frame (floors, records, sides).
        floors: Floors of each frame whose peaks were measured.
    """

    predictions: dict[str, Real]

    def __init__(self, axes: Mapping[str, Sequence[Any]]) -> None:
        self.axes = {name: tuple(values) for name, values in axes.items()}
        truth, sure = measured(), trusted()
        self.measured = {name: truth.values[truth.frame.values == name] for name in FRAMES}
        self.sure = {name: sure.values[truth.frame.values == name] for name in FRAMES}
        self.floors = {
            name: [int(one) for one in truth.floor.values[truth.frame.values == name]] for name in FRAMES
        }

    @cached_property
    def errors(self) -> dict[str, Real]:
        """abs(ours - measured) / measured of each frame, shapes as of `predictions`."""
        return {name: np.abs(self.predictions[name] / self.measured[name] - 1.0) for name in FRAMES}

    def fit(
        self, freedom: Freedom, records: Sequence[int], frames: Sequence[str] = FRAMES, every: bool = False
    ) -> Chosen:
        """Return the model with the smallest mean error at some peaks.

        Args:
            freedom: What may be chosen.
            records: Numbers of the records whose peaks are used.
            frames: Frames whose peaks are used; the others keep the first state that they may be in.
            every: Whether contested peaks are used, too.
        """
        states: dict[str, Frequency] = {}
        each = {name: self.summed(name, freedom, records, every) for name in frames}
        total = np.sum([sums.min(axis=0) for sums, _ in each.values()], axis=0)
        count = sum(counted for _, counted in each.values())
        place = tuple(int(one) for one in np.unravel_index(int(np.argmin(total)), total.shape))
        for name in FRAMES:
            choice = int(np.argmin(each[name][0], axis=0)[place]) if name in each else 0
            states[name] = freedom.allowed(name)[choice]
        numbers = {
            name: values[number] for (name, values), number in zip(self.axes.items(), place, strict=True)
        }
        return Chosen(numbers, states, float(total[place]) / count)

    def error(
        self, chosen: Chosen, records: Sequence[int], frames: Sequence[str] = FRAMES, every: bool = False
    ) -> float:
        """Return the mean error of a model at some peaks [-].

        Args:
            chosen: The model.
            records: Numbers of the records whose peaks are used.
            frames: Frames whose peaks are used.
            every: Whether contested peaks are used, too.
        """
        place = [values.index(chosen.numbers.get(name, values[0])) for name, values in self.axes.items()]
        peaks = {name: self.predictions[name][(PLACES.index(chosen.states[name]), *place)] for name in frames}
        return self.error_of(peaks, records, frames, every)

    def error_of(
        self,
        peaks: dict[str, Real],
        records: Sequence[int],
        frames: Sequence[str] = FRAMES,
        every: bool = False,
    ) -> float:
        """Return the mean error of predicted peaks [-].

        Args:
            peaks: Predicted peaks of each frame [mm], shape (floors, records, sides).
            records: Numbers of the records whose peaks are used.
            frames: Frames whose peaks are used.
            every: Whether contested peaks are used, too.
        """
        total, count = 0.0, 0
        for name in frames:
            off = np.abs(peaks[name] / self.measured[name] - 1.0)[self._used(name, records, every)]
            total, count = total + float(off.sum()), count + off.size
        return total / count

    def summed(self, name: str, freedom: Freedom, records: Sequence[int], every: bool) -> tuple[Real, int]:
        """Return sums of errors, (allowed states, a size for each number), and how many peaks they are of.

        Args:
            name: Name of the frame.
            freedom: What may be chosen.
            records: Numbers of the records whose peaks are used.
            every: Whether contested peaks are used, too.
        """
        chosen = [PLACES.index(state) for state in freedom.allowed(name)]
        used = self._used(name, records, every)
        part = self.errors[name][np.ix_(chosen, *self._grids(freedom))]
        return np.asarray(part[..., used, :].sum(axis=(-1, -2))), 2 * int(used.sum())

    def _used(self, name: str, records: Sequence[int], every: bool) -> NDArray[np.bool_]:
        sure = self.sure[name]
        wanted = np.isin(np.arange(len(RECORDS)), list(records))
        return np.asarray((np.ones_like(sure) if every else sure) & wanted)

    def _grids(self, freedom: Freedom) -> list[list[int]]:
        return [
            list(range(len(values))) if name in freedom.numbers else [0] for name, values in self.axes.items()
        ]


class PeakLattice(Lattice):
    """The linear models: a factor on all frequencies, one damping ratio, a gain of the table.

    Args:
        records: Folder with ground motions; None for the default.
        told: Called after each frame with the share that is done.
    """

    def __init__(self, records: Path | None = None, told: Callable[[float], None] | None = None) -> None:
        super().__init__({"factor": FACTORS.tolist(), "damping": RATIOS, "gain": GAINS.tolist()})
        self.motions = [motion_of(name, records, STEP_S) for name in RECORDS]
        self._peaks: dict[str, Real] = {}
        for number, name in enumerate(FRAMES):
            self._peaks[name] = self._computed(name)
            if told is not None:
                told((number + 1) / len(FRAMES))
        self.predictions = {name: self._of_all_models(name) for name in FRAMES}

    def _computed(self, frame: str) -> Real:
        """Return the peaks [mm] of a frame, shape (floors, records, sides, frequencies, ratios)."""
        own, floors = first_frequency(frame, "free vibration"), self.floors[frame]
        found = np.empty((len(floors), len(RECORDS), 2, len(FREQUENCIES), len(RATIOS)))
        for column, motion in enumerate(self.motions):
            for i, relative in enumerate(FREQUENCIES):
                for j, ratio in enumerate(RATIOS):
                    moved = displacements(frame, floors, motion, own * relative, ratio)
                    found[:, column, :, i, j] = 1e3 * extremes(moved)
        return found

    def peaks(self, frame: str, state: Frequency, factor: float) -> Real:
        """Return the peaks [mm] of a frame in a state for all damping ratios, shape (floors, records, sides, ratios).

        Args:
            frame: Name of the frame.
            state: Its state.
            factor: Factor on its first frequency [-].
        """
        wanted = first_frequency(frame, state) * factor / first_frequency(frame, "free vibration")
        place = float(np.interp(wanted, FREQUENCIES, np.arange(len(FREQUENCIES))))
        lower = min(int(place), len(FREQUENCIES) - 2)
        weight = place - lower
        table = self._peaks[frame]
        return np.asarray((1 - weight) * table[..., lower, :] + weight * table[..., lower + 1, :])

    def _of_all_models(self, frame: str) -> Real:
        """Return the peaks [mm] of a frame, (states, factors, ratios, gains, floors, records, sides)."""
        peaks = np.array([[self.peaks(frame, state, float(f)) for f in FACTORS] for state in PLACES])
        return np.asarray(GAINS[:, None, None, None] * np.moveaxis(peaks, -1, 2)[:, :, :, None])


def motion_of(name: str, folder: Path | None, step_s: float) -> Record:
    """Return the motion of the table by a record at the frames' scale, while it shakes.

    Args:
        name: Name of the record.
        folder: Folder with ground motions; None for the default.
        step_s: Longest step [s].
    """
    motion = table_motion(name, BLIND, folder).trimmed(lower=0.0, upper=KEPT_ARIAS)
    return motion.resampled(motion.step_s / np.ceil(motion.step_s / step_s))
