"""Models of Table 4.1 whose storeys slip or rub, with a state of each frame, a damping ratio and a gain of the table.

Slip and friction are those of `added_forces`, with the stiffness that a state means. A gain needs no runs of its own: a
motion that is g times as large moves a frame whose storeys slip at g times the drift g times as far, and the same is so
of a friction g times as large. Between neighbouring drifts or frictions, 16 to 19 % apart, peaks are taken as straight
over the logarithm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.records import RECORDS, Record
from pounding.experiments.rig.states import FREQUENCIES as PLACES
from pounding.experiments.rig.states import Frequency, first_frequency
from pounding.experiments.studies import added_forces
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.change_catalogue import STEP_S
from pounding.experiments.studies.frame_states import baseline
from pounding.experiments.studies.peak_lattice import GAINS, Lattice, motion_of
from pounding.experiments.studies.table_4_1 import FRAMES

Real = NDArray[np.float64]
Effect = Literal["slip", "friction"]
SHARES = (0.1, 0.2, 0.3, 0.4)
"""Shares of each storey's stiffness that slip."""
DRIFTS_MM = np.geomspace(0.02, 8.0, 41)
"""Drifts at which they slip [mm]; a storey of a model that is near the peaks drifts by up to 6 mm."""
FRICTIONS_N = np.geomspace(0.05, 60.0, 41)
"""Friction in every storey [N]."""
RATIOS = (None, 0.0075, 0.0105, 0.015)
"""Damping ratios beside the effect; none is each frame's own."""
NEVER_MM = 1e3
"""A drift at which nothing slips [mm]."""


class AddedLattice(Lattice):
    """The models with slip (a share of the stiffness and a drift) or with friction in all storeys.

    Args:
        effect: Which.
        records: Folder with ground motions; None for the default.
        told: Called after each frame with the share that is done.
    """

    def __init__(
        self, effect: Effect, records: Path | None = None, told: Callable[[float], None] | None = None
    ) -> None:
        self.effect = effect
        slips = product(SHARES, DRIFTS_MM.tolist())
        values = tuple(slips) if effect == "slip" else tuple(FRICTIONS_N.tolist())
        super().__init__({effect: (None, *values), "damping": RATIOS, "gain": GAINS.tolist()})
        motions = [motion_of(name, records, STEP_S) for name in RECORDS]
        self.predictions = {}
        for number, name in enumerate(FRAMES):
            peaks = np.array([[self._peaks(name, state, r, motions) for r in RATIOS] for state in PLACES])
            # (states, ratios, values, floors, records, sides) to (states, values, ratios, gains, ...)
            with_gains = np.array([self._louder(peaks, float(gain)) for gain in GAINS])
            self.predictions[name] = np.moveaxis(with_gains, (0, 3), (3, 1))
            if told is not None:
                told((number + 1) / len(FRAMES))

    def _peaks(self, frame: str, state: Frequency, ratio: float | None, motions: list[Record]) -> Real:
        """Return the peaks [mm] of a frame for all values of the effect, (values, floors, records, sides)."""
        body = baseline(frame)
        stiffer = (first_frequency(frame, state) / first_frequency(frame, "free vibration")) ** 2
        body = replace(body, stiffness=stiffer * body.stiffness, ratio=ratio or body.ratio)
        count = len(self.axes[self.effect])
        rows = np.array(self.floors[frame]) - 1
        found = [
            1e3 * change.respond(body, change.modes(body), motion, self._force(body), count)[:, rows]
            for motion in motions
        ]
        return np.stack(found, axis=2)

    def _force(self, body: change.Storeys) -> change.Force:
        if self.effect == "friction":
            return added_forces.coulomb_friction(body, np.array([0.0, *FRICTIONS_N]))
        shares, drifts = np.array([(0.0, NEVER_MM), *product(SHARES, DRIFTS_MM)]).T
        return added_forces.hysteresis(body, drifts, share=shares)

    def _louder(self, peaks: Real, gain: float) -> Real:
        """Return the peaks under a motion `gain` times as large; values of the effect are the third axis."""
        grid = DRIFTS_MM if self.effect == "slip" else FRICTIONS_N
        place = np.interp(np.log(grid / gain), np.log(grid), np.arange(len(grid)))
        lower = np.minimum(place.astype(int), len(grid) - 2)
        weight = (place - lower)[:, None, None, None]
        found = [peaks[:, :, :1]]
        for start in range(1, peaks.shape[2], len(grid)):  # each share has a grid of its own
            own = peaks[:, :, start : start + len(grid)]
            found.append((1 - weight) * own[:, :, lower] + weight * own[:, :, lower + 1])
        return gain * np.concatenate(found, axis=2)
