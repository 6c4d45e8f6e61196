"""Frames in a row that knock against each other under a record: one run, and everything read from it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec

from pounding import frames
from pounding.contact.laws import Law
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record, file_of, find
from pounding.experiments.rig.contact_checks import contact_warnings
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.ductility import ductilities
from pounding.experiments.rig.impacts import MERGING_S, Impact, all_impacts
from pounding.experiments.rig.motion import Motion, distinct
from pounding.experiments.rig.required_gap import contact_floors
from pounding.experiments.rig.rig import Accuracy, Rig, Solver
from pounding.experiments.rig.shaking import linear_stress, validity
from pounding.experiments.rig.states import FrameState
from pounding.frames.definition import PlateFrame, StickFrame
from pounding.frames.response.stress import Largest
from pounding.scale import THESIS

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Value = TypeVar("Value")

SIDES = ("left", "right")
"""What results call the frames of a pair."""


@dataclass(frozen=True, eq=False)
class Pounding:
    """A run of frames in a row with contacts between neighbours.

    Attributes:
        record: The shaking, at the scale of the frames.
        motion: The run.
        impacts: What a force sensor would have counted, in time.
    """

    record: Record
    motion: Motion
    impacts: list[Impact]

    def __repr__(self) -> str:
        names = " beside ".join(repr(frame.name) for frame in self.motion.frames)
        hardest = max((impact.peak_force_n for impact in self.impacts), default=0.0)
        return f"Pounding({names}, {self.record!r}, {len(self.impacts)} impacts of at most {hardest:.4g} N)"

    @property
    def sides(self) -> tuple[str, ...]:
        """What results call the frames: ``left`` and ``right`` of two, else their names."""
        return (
            SIDES
            if len(self.motion.frames) == 2
            else tuple(distinct([frame.name for frame in self.motion.frames]))
        )

    @property
    def beside(self) -> str:
        """The frames' names in a row, in words."""
        return " beside ".join(frame.name for frame in self.motion.frames)

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the contacts' laws, each once."""
        return tuple(dict.fromkeys(contact.law.name for contact in self.motion.contacts))

    @cached_property
    def stresses(self) -> tuple[Largest | None, ...]:
        """The largest stress of each frame; None for a stick, and for a frame that may yield (see `Shaking`)."""
        return tuple(map(linear_stress, self.motion.frames))

    def validity(self) -> dict[str, Any]:
        """Return `max_stress_mpa` of each frame (see `sides`), and `warnings`: sentences on what passes a limit.

        It takes longer than `result`, for it recovers the stress of every plate.
        """
        sides = zip(self.sides, self.stresses, strict=True)
        pairs = zip(self.motion.frames, self.stresses, strict=True)
        return {
            "max_stress_mpa": {side: None if one is None else one.stress_pa / 1e6 for side, one in sides},
            "warnings": [
                *(sentence for frame, stress in pairs for sentence in validity(frame, stress)),
                *contact_warnings(self.motion),
            ],
        }

    def result(self) -> dict[str, Any]:
        """Return the run's numbers, units in the keys, as `pounding pound --json` prints them."""
        contacts = self.motion.contacts
        gaps = [1e3 * contact.gap_m for contact in contacts]
        frames = dict(zip(self.sides, self.motion.frames, strict=True))
        pair = {side: frame.name for side, frame in frames.items()} if len(frames) == 2 else {}
        return {
            **pair,
            "buildings": [frame.name for frame in frames.values()],
            "record": self.record.name,
            "law": ", ".join(self.laws),
            "gap_mm": gaps[0] if len(set(gaps)) == 1 else gaps,
            "floors": [contact.floor for contact in contacts],
            "impacts": [impact.as_dict() for impact in self.impacts],
            "peaks": {side: frame.peaks() for side, frame in frames.items()},
            "ductility": {side: ductilities(frame) for side, frame in frames.items()},
            "energy_error": self.motion.energy.error,
            "solver": self.motion.solver,
            "wall_s": self.motion.wall_s,
            "model_s": self.motion.model_s,
        }


def pound(
    left: ReducedFrame,
    right: ReducedFrame,
    record: Record,
    law: Law | Sequence[Law],
    gap_m: float | Sequence[float],
    *,
    floors: Sequence[int] = (),
    duration_s: float | None = None,
    accuracy: Accuracy | None = None,
    progress: Callable[[float], None] | None = None,
    solver: Solver = "exudyn",
    merging_s: float = MERGING_S,
) -> Pounding:
    """Shake two frames side by side; the left one moves in +x towards the right one.

    Args:
        left, right: Reduced frames.
        record: The shaking, at the scale of the frames.
        law: Impact law, one for all floors or one a floor.
        gap_m: Gap at rest [m], one for all floors or one a floor.
        floors: Floors of the lower frame that can touch; default: its roof.
        duration_s: End of the run [s]; default: the end of the record.
        accuracy: Tolerances, see `Rig.run`.
        progress: Called now and then with the model time [s].
        solver: `exudyn` or `exact`, see `Rig.run`.
        merging_s: Touches closer than this are one impact [s].

    Raises:
        ExperimentError: A floor that one of the frames does not have, the wrong number of gaps or laws, or a run
            that grows without bound.
        ContactError: A negative gap.
    """
    rig = rig_of(left, right, law, gap_m, floors)
    motion = rig.run(record, duration_s=duration_s, accuracy=accuracy, progress=progress, solver=solver)
    return Pounding(record, motion, all_impacts(motion, merging_s=merging_s))


def rig_of(
    left: ReducedFrame,
    right: ReducedFrame,
    law: Law | Sequence[Law],
    gap_m: float | Sequence[float],
    floors: Sequence[int] = (),
) -> Rig:
    """Return two frames side by side with a contact at each floor; arguments and errors as for `pound`.

    Args:
        left: Frame that moves in +x towards the other.
        right: The other frame.
        law: Impact law, one for all floors or one a floor.
        gap_m: Gap at rest [m], one for all floors or one a floor.
        floors: Floors of the lower frame; its roof when empty.
    """
    chosen: list[int | None] = list(floors) or [None]
    gaps = one_each("gaps", [gap_m] if isinstance(gap_m, int | float) else gap_m, chosen)
    laws = one_each("laws", law if isinstance(law, Sequence) else [law], chosen)
    return Rig(
        [left, right],
        [
            Contact(law, float(gap), contact_floors(left, right, floor))
            for law, gap, floor in zip(laws, gaps, chosen, strict=True)
        ],
    )


def floor_masses(
    left: ReducedFrame, right: ReducedFrame, floor: int | None = None, y_m: float = 0.0
) -> tuple[float, float]:
    """Return the masses [kg] of the floors that meet, for the laws whose damping refers to them.

    Args:
        left, right: Reduced frames.
        floor: Floor of the lower frame; its roof when None.
        y_m: Place along the floors' edge, from the middle [m]; see `ReducedFrame.mass_at`.

    Raises:
        ExperimentError: The floors cannot meet.
    """
    numbers = contact_floors(left, right, floor)
    first, second = (frame.mass_at(number, y_m) for frame, number in zip((left, right), numbers, strict=True))
    return first, second


def built(
    name: str,
    joints: Any = "calibrated",
    p_delta: bool = True,
    damping: float | None = None,
    calibration: str | None = None,
    planar: bool | None = None,
) -> ReducedFrame:
    """Return a reduced frame by name, built once a process as long as its file says the same.

    Args:
        name: Name of a shipped frame, or path of a frame file.
        joints: `calibrated` or `rigid`.
        p_delta: Geometric stiffness of gravity.
        damping: Damping ratio of every mode [-]; the frame's own when None.
        calibration: Calibration of the joints; the frame's default when None.
        planar: Whether to leave out the floors' twist, which contacts off the middle need; for a symmetric plan when None.
    """
    # By what the file says and not by its path: in a session it may be written again, or be another one in another folder.
    # Not as JSON, which has no word for infinity: a friction that nothing wears.
    said = msgspec.msgpack.encode(frames.load(name))
    return _built(said, joints, p_delta, damping, calibration, planar)


@lru_cache(maxsize=32)
def _built(said: bytes, joints: Any, p_delta: bool, *options: Any) -> ReducedFrame:
    definition = msgspec.msgpack.decode(said, type=PlateFrame | StickFrame)
    damping, calibration, planar = options
    return frames.build(
        definition, joints=joints, p_delta=p_delta, damping=damping, calibration=calibration, planar=planar
    )


def built_in(
    state: FrameState, joints: Any = "calibrated", p_delta: bool = True, planar: bool | None = None
) -> ReducedFrame:
    """Return a reduced frame in its state, built once a process.

    Args:
        state: What `states_of` says of the frame.
        joints: `calibrated` or `rigid`.
        p_delta: Geometric stiffness of gravity.
        planar: Whether to leave out the floors' twist, as for `built`.
    """
    return built(state.frame, joints, p_delta, state.damping_ratio, state.calibration, planar)


def shaking(
    name: str,
    folder: str | None = None,
    *,
    time_factor: float = THESIS.time_factor,
    pga_g: float | None = None,
    flip: bool = False,
    unit: str | None = None,
) -> Record:
    """Return a record by name at the scale of the frames, with another peak [g] or the opposite sign if asked.

    Args:
        name: Name or file of the ground motion.
        folder: Folder with ground motions; None for the default.
        time_factor: What its time is multiplied by [-], see `table_scale`; the default is that of the thesis' frames.
        pga_g: Peak acceleration [g]; the record's own when None.
        flip: Turn the record's sign.
        unit: Unit of acceleration of a file that names none.
    """
    return _shaking(name, folder, _version(file_of(name, folder)), time_factor, pga_g, flip, unit)


def _version(file: Path | None) -> tuple[str, int, int] | None:
    """Return what changes when a file is written again, or is another one."""
    if file is None or not file.is_file():
        return None
    state = file.stat()
    return str(file.resolve()), state.st_mtime_ns, state.st_size


# Read once a process as long as its file is the same: in a session it may be written again.
@lru_cache(maxsize=16)
def _shaking(
    name: str,
    folder: str | None,
    version: tuple[str, int, int] | None,
    time_factor: float,
    pga_g: float | None,
    flip: bool,
    unit: str | None,
) -> Record:
    record = find(name, folder, unit=unit).scaled(time_factor, pga_g)
    return record.flipped() if flip else record


def one_each(what: str, given: Sequence[Value], floors: Sequence[int | None]) -> list[Value]:
    """Return one value a floor, of one that is given for all or of as many as there are floors.

    Args:
        what: What is given, in the plural.
        given: One value, or one a floor.
        floors: The floors.

    Raises:
        ExperimentError: Another number of values, or a floor that is given twice.
    """
    if len(set(floors)) != len(floors):
        raise ExperimentError(f"floors {', '.join(map(str, floors))}: each can be given once")
    values = list(given) * (len(floors) if len(given) == 1 else 1)
    if len(values) != len(floors):
        raise ExperimentError(
            f"{len(values)} {what} for {len(floors)} floor(s): give one for all, or one a floor"
        )
    return values
