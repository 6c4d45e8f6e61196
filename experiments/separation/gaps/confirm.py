"""The required gap confirmed by collisions: frames with contacts, just below and just above it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pounding.contact.laws import LinearViscoelastic
from pounding.experiments.records import Record
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.required_gap import contact_floors, pair_gap
from pounding.experiments.rig.rig import Rig, Solver
from pounding.frames import ReducedFrame

MARGIN = 0.01
"""Share of the required gap by which the gap of a run is below or above it."""

THESIS_LAW = LinearViscoelastic(stiffness=20.66e6, damping=1255.0)
"""Kelvin-Voigt with the thesis' parameters; any law will do to see whether floors touch."""


@dataclass(frozen=True)
class Confirmed:
    """What collisions say of a required gap.

    Attributes:
        closing_mm: The required gap by the exact run without contacts [mm].
        impacts_below: Number of touches with a gap 1 % below it.
        impacts_above: Number of touches with a gap 1 % above it.
        engine_closing_mm: Largest closing motion of the run that did not touch [mm].
    """

    closing_mm: float
    impacts_below: int
    impacts_above: int
    engine_closing_mm: float

    @property
    def holds(self) -> bool:
        """Whether the frames touch below and do not touch above."""
        return self.impacts_below > 0 and self.impacts_above == 0


def confirm(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    *,
    floor: int | None = None,
    margin: float = MARGIN,
    solver: Solver = "exudyn",
) -> Confirmed:
    """Run two frames with gaps just below and just above the required one.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        record: Table motion at the frames' scale.
        floor: Floor of the lower frame; its roof when None.
        margin: Share of the required gap by which the gaps differ from it.
        solver: `exudyn` or `exact`, see `Rig.run`.
    """
    required = pair_gap(left, right, record, floor=floor)
    floors = contact_floors(left, right, floor)
    # Below, the frames first touch at the latest when the peak would have come: no need to shake on.
    below = _run(
        left, right, record, floors, (1.0 - margin) * required.closing_m, required.time_s + 0.05, solver
    )
    above = _run(left, right, record, floors, (1.0 + margin) * required.closing_m, None, solver)
    apart = above.frames[0].floor_displacement(floors[0]) - above.frames[1].floor_displacement(floors[1])
    return Confirmed(
        closing_mm=1e3 * required.closing_m,
        impacts_below=touches(below.contacts[0].deformation_m),
        impacts_above=touches(above.contacts[0].deformation_m),
        engine_closing_mm=1e3 * float(apart.max()),
    )


def touches(deformation_m: ArrayLike) -> int:
    """Return how often a deformation [m] becomes positive."""
    touching = np.asarray(deformation_m) > 0.0
    return int(touching[0]) + int(np.count_nonzero(touching[1:] & ~touching[:-1]))


def _run(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    floors: tuple[int, int],
    gap_m: float,
    duration_s: float | None,
    solver: Solver,
) -> Motion:
    rig = Rig([left, right], [Contact(THESIS_LAW, gap_m, floors)])
    return rig.run(record, duration_s=duration_s, solver=solver)
