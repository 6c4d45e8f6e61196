"""Two frames knocking against each other under a record: one law, one run, everything read from it."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import frames
from contact.laws import Law
from contact.parameters import make_law, thesis_law
from experiments.errors import ExperimentError
from experiments.impacts import Impact, all_impacts
from experiments.motion import Motion, floor_coordinate
from experiments.records import Record, find
from experiments.rig import Accuracy, Contact, Rig

if TYPE_CHECKING:
    from frames.reduction import ReducedFrame


@dataclass(frozen=True, eq=False)
class Pounding:
    """A run of two frames with contacts between them.

    Attributes:
        record: The shaking, at model scale.
        motion: The run.
        impacts: What a force sensor would have counted, in time.
    """

    record: Record
    motion: Motion
    impacts: list[Impact]

    def result(self) -> dict[str, Any]:
        """Return the run's numbers, units in the keys, as `pounding pound --json` prints them."""
        contacts = self.motion.contacts
        gaps = [1e3 * contact.gap_m for contact in contacts]
        left, right = self.motion.frames
        return {
            "left": left.name,
            "right": right.name,
            "record": self.record.name,
            "law": contacts[0].law.name,
            "gap_mm": gaps[0] if len(set(gaps)) == 1 else gaps,
            "floors": [contact.floor for contact in contacts],
            "impacts": [impact.as_dict() for impact in self.impacts],
            "peaks": {"left": left.peaks(), "right": right.peaks()},
            "energy_error": self.motion.energy.error,
            "wall_s": self.motion.wall_s,
            "model_s": self.motion.model_s,
        }


def pound(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    law: Law,
    gap_m: float | Sequence[float],
    *,
    floors: Sequence[int] = (),
    duration_s: float | None = None,
    accuracy: Accuracy | None = None,
    progress: Callable[[float], None] | None = None,
) -> Pounding:
    """Shake two frames side by side; the left one moves in +x towards the right one.

    Args:
        left, right: Reduced frames.
        record: The shaking, at model scale.
        law: Impact law of all contacts.
        gap_m: Gap at rest [m], one for all floors or one a floor.
        floors: Floors that can touch; default: the lower frame's roof.
        duration_s: End of the run [s]; default: the end of the record.
        accuracy: Tolerances, see `Rig.run`.
        progress: Called now and then with the model time [s].

    Raises:
        ExperimentError: A floor that one of the frames does not have, the wrong number of gaps, or a run
            that grows without bound.
        ContactError: A negative gap.
    """
    chosen = list(floors) or [min(left.storeys, right.storeys)]
    gaps = _one_each(gap_m, chosen)
    contacts = [Contact(law, gap, floor) for gap, floor in zip(gaps, chosen, strict=True)]
    motion = Rig([left, right], contacts).run(
        record, duration_s=duration_s, accuracy=accuracy, progress=progress
    )
    return Pounding(record, motion, all_impacts(motion))


def floor_masses(left: ReducedFrame, right: ReducedFrame, floor: int) -> tuple[float, float]:
    """Return the masses [kg] of a floor of both frames, for the laws whose damping refers to them.

    A floor carries its row of the mass matrix condensed to the floors, half of its columns included.

    Raises:
        ExperimentError: A frame does not have that floor.
    """
    for frame in (left, right):
        floor_coordinate(frame, floor)
    first, second = (float(frame.storey_model()[0][floor - 1].sum()) for frame in (left, right))
    return first, second


@lru_cache(maxsize=32)
def built(
    name: str, joints: Any = "calibrated", p_delta: bool = True, damping: float | None = None
) -> ReducedFrame:
    """Return a reduced frame by name, built once a process."""
    return frames.build(frames.load(name), joints=joints, p_delta=p_delta, damping=damping)


@lru_cache(maxsize=16)
def shaking(
    name: str, folder: str | None = None, *, pga_g: float | None = None, flip: bool = False
) -> Record:
    """Return a record at model scale by name, with another peak [g] or the opposite sign if asked."""
    record = find(name, folder).scaled(pga_g=pga_g)
    return record.flipped() if flip else record


def case(
    left: str,
    right: str,
    record: str,
    law: str,
    gap_mm: float,
    *,
    parameters: str = "printed",
    stiffness: float | None = None,
    damping_n_s_per_m: float | None = None,
    tension: bool = False,
    flip: bool = False,
    damping: float | None = None,
    folder: str | None = None,
    duration_s: float | None = None,
) -> dict[str, Any]:
    """Run one case given by names, for sweeps: `experiments.sweep.sweep(case, cases)`.

    Args:
        left, right, record, law: Names.
        gap_mm: Gap at the lower frame's roof [mm].
        parameters: Parameter set of the law.
        stiffness: Contact stiffness instead of the set's [N/m or N/m^1.5].
        damping_n_s_per_m: With it, the dashpot of the linear viscoelastic law.
        tension: May the contact pull?
        flip: Turn the record's sign.
        damping: Damping ratio of the frames; their own when None.
        folder: Folder of records.
        duration_s: End of the run [s].

    Returns:
        `impacts` and `peaks` as JSON text, `count`, `peak_force_n`, `energy_error`, `wall_s`, `model_s`,
        `closest_mm`: the smallest gap left at any time (negative: the deepest overlap).
    """
    pair = built(left, damping=damping), built(right, damping=damping)
    floor = min(pair[0].storeys, pair[1].storeys)
    masses = floor_masses(*pair, floor)
    if stiffness is None:
        chosen = thesis_law(law, parameters, masses=masses, tension=tension)
    else:
        chosen = make_law(law, stiffness=stiffness, damping=damping_n_s_per_m, masses=masses, tension=tension)
    found = pound(*pair, shaking(record, folder, flip=flip), chosen, 1e-3 * gap_mm, duration_s=duration_s)
    return {
        "impacts": json.dumps([impact.as_dict() for impact in found.impacts]),
        "peaks": json.dumps(found.result()["peaks"]),
        "count": len(found.impacts),
        "peak_force_n": max((impact.peak_force_n for impact in found.impacts), default=0.0),
        "closest_mm": -1e3 * float(found.motion.contacts[0].deformation_m.max()),
        "energy_error": found.motion.energy.error,
        "wall_s": found.motion.wall_s,
        "model_s": found.motion.model_s,
    }


def _one_each(gap_m: float | Sequence[float], floors: Sequence[int]) -> list[float]:
    gaps = [float(gap_m)] if isinstance(gap_m, int | float) else [float(gap) for gap in gap_m]
    if len(gaps) == 1:
        gaps *= len(floors)
    if len(gaps) != len(floors):
        raise ExperimentError(
            f"{len(gaps)} gaps for {len(floors)} floor(s): give one for all, or one a floor"
        )
    if len(set(floors)) != len(floors):
        raise ExperimentError(f"floors {', '.join(map(str, floors))}: each can be given once")
    return gaps
